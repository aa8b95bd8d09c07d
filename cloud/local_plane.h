/* cloud/local_plane.h: the plane of a few points. Internal. */
#ifndef PLANTIMETER_CLOUD_LOCAL_PLANE_H
#define PLANTIMETER_CLOUD_LOCAL_PLANE_H

#include <stddef.h>
#include <stdint.h>

/** Distance of a place from the plane by least squares of some rows of xyz: row holds count of them, one or more. scatter: SD of these
 * rows off the plane, count - 3 in the denominator, 0 for three and fewer; or NULL. */
double plm_local_plane_distance(const float (*xyz)[3], const uint32_t *row, size_t count, const float place[3],
                                double *scatter);

#endif
