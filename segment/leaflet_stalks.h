/* segment/leaflet_stalks.h: leaflets whose stalks were not seen. Internal. */
#ifndef PLANTIMETER_SEGMENT_LEAFLET_STALKS_H
#define PLANTIMETER_SEGMENT_LEAFLET_STALKS_H

#include "segment/side_groups.h"

/** Links leaflets of a compound plant that hang on another leaf by a touch alone with the rachis at which their base lies, and finds
 * the side groups anew, if there are any such. groups: as found, and so out. blade_cost: as for plm_side_groups_find. */
plm_status plm_leaflet_stalks(plm_sketch *sketch, double blade_cost, plm_side_groups *groups, plm_error *error);

#endif
