/* traits/near_hull.h: which points of a cloud lie near its convex hull. Internal. */
#ifndef PLANTIMETER_TRAITS_NEAR_HULL_H
#define PLANTIMETER_TRAITS_NEAR_HULL_H

#include "cloud/cloud.h"

/** Marks the points within a depth (m) below a face of a closed hull: near[i], for count points of which those with use[i]
 * are asked for; the others are not near. Boxes of points are dropped against the faces that come near them, so that the
 * cost is about count log count whatever the number of faces. Gives how many are near. Parallel; the same for any number of
 * threads. Its errors are those of memory. */
plm_status plm_near_hull(const plm_mesh *hull, const float (*xyz)[3], const bool *use, size_t count, double depth,
                         bool *near, size_t *near_count, plm_error *error);

#endif
