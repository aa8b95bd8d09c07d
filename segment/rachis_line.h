/* segment/rachis_line.h: where along the way through a compound leaf nothing but the rachis lies about it. Internal. */
#ifndef PLANTIMETER_SEGMENT_RACHIS_LINE_H
#define PLANTIMETER_SEGMENT_RACHIS_LINE_H

#include "segment/junction.h"

/** Follows the line from a leaf's foot to its farthest point and finds the stations at which a tube lies on it and nearly
 * nothing beside it, near though leaflets may be. Those at which leaflets are joined get the width, the middle and the points
 * of what is on the line alone; the tube gets the width of clear stations where that is much narrower.
 * way      its stations and tube are written.
 * trail    count points on the way from the farthest point to the foot.
 * clear, beside  out, way->station_count rows each, the caller's: whether a station is clear, and whether leaflets are joined
 *          beside it.
 * PLM_E_MEMORY. */
plm_status plm_rachis_clear(plm_leaf_way *way, const uint32_t *trail, size_t count, bool *clear, bool *beside,
                            plm_error *error);

#endif
