/* segment/broken_tubes.h: petioles that a gap in the scan parts from their leaf. Internal. */
#ifndef PLANTIMETER_SEGMENT_BROKEN_TUBES_H
#define PLANTIMETER_SEGMENT_BROKEN_TUBES_H

#include "segment/side_groups.h"

/** Links the end of each long foot without a blade to the tube straight ahead of it to which no tube leads. groups: as found.
 * Changes sketch->graph alone; links: out, how many were made: where there are any, side groups are to be found again.
 * PLM_E_MEMORY only. */
plm_status plm_bridge_tubes(plm_sketch *sketch, const plm_side_groups *groups, size_t *links, plm_error *error);

#endif
