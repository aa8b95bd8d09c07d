/* segment/rachis_line.h: where along the way through a compound leaf nothing but the rachis lies about it. Internal. */
#ifndef PLANTIMETER_SEGMENT_RACHIS_LINE_H
#define PLANTIMETER_SEGMENT_RACHIS_LINE_H

#include "segment/junction.h"

/** Follows the line from a leaf's foot to its farthest point and finds the stations at which a tube lies on it and nearly
 * nothing beside it, near though leaflets may be. These get the width, the middle and the points of what is on the line alone.
 * trail: count points on the way from the farthest point to the foot. clear: out, and
 * beside, where leaflets are joined at its sides: way->station_count rows each, the caller's. Writes way->station and way->tube.
 * PLM_E_MEMORY. */
plm_status plm_rachis_clear(plm_leaf_way *way, const uint32_t *trail, size_t count, bool *clear, bool *beside,
                            plm_error *error);

#endif
