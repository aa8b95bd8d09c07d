/* segment/rachis_sides.h: the leaflets that hang at the sides of a compound leaf's line. Internal. */
#ifndef PLANTIMETER_SEGMENT_RACHIS_SIDES_H
#define PLANTIMETER_SEGMENT_RACHIS_SIDES_H

#include "segment/junction.h"

/** Of each of way->count points, in the way's order: whether it is of a blade that lies beside the line along a part of it only
 * and leaves it well before the tip, as leaflets at the rachis' sides do. The two halves of the last leaflet, which the line
 * parts, accompany it to the tip. Pieces smaller than a blade are of none.
 * off, station  distance of each point from the line, and the line's station nearest to it.
 * reach         what is within is on the line, up to twice as far lies beside it.
 * aside         out, the caller's. PLM_E_MEMORY. */
plm_status plm_rachis_sides(const plm_leaf_way *way, const float *off, const uint32_t *station, double reach,
                            bool *aside, plm_error *error);

#endif
