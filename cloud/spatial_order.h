/* cloud/spatial_order.h: one canonical order of points, whatever the order of a file's rows. Internal. */
#ifndef PLANTIMETER_CLOUD_SPATIAL_ORDER_H
#define PLANTIMETER_CLOUD_SPATIAL_ORDER_H

#include "cloud/cloud.h"

/** order (count long, the caller's): rows along a Morton curve through the points' bounding box; points in one cell of
 * the curve by their coordinates, equal points by row. So shuffled rows give the same sequence of points, and near
 * points lie near in memory. Finite coordinates are the caller's duty. O(count).
 * PLM_E_ARGUMENT  more than 2^32 - 2 points. */
plm_status plm_spatial_order(const float (*xyz)[3], size_t count, uint32_t *order, plm_error *error);

#endif
