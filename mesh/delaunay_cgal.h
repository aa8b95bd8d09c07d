/* mesh/delaunay_cgal.h: the Delaunay triangulation of points in a plane, by CGAL's exact predicates. Internal. */
#ifndef PLANTIMETER_MESH_DELAUNAY_CGAL_H
#define PLANTIMETER_MESH_DELAUNAY_CGAL_H

#include "cloud/cloud.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Across this side of a triangle there is none. */
#define PLM_NO_TRIANGLE UINT32_MAX

/** Triangles of a triangulation. corner: rows of points, counter-clockwise. across[t][i] is the triangle across the side
 * that faces corner i, or PLM_NO_TRIANGLE on the hull. */
typedef struct plm_triangulation {
    size_t count;
    uint32_t (*corner)[3];
    uint32_t (*across)[3];
} plm_triangulation;

/** Delaunay triangulation of count points uv[i * stride], uv[i * stride + 1]. Points are inserted in row order, each
 * searched from the one before: have neighbours in space near each other in the list. A point on the place of an earlier
 * one is in no triangle. No triangle at all (points on one line) is not an error. The result is the caller's. */
plm_status plm_delaunay_cgal(const double *uv, size_t stride, size_t count, plm_triangulation *triangulation,
                             plm_error *error);

/** NULL and a zeroed triangulation are allowed. */
void plm_triangulation_free(plm_triangulation *triangulation);

#ifdef __cplusplus
}
#endif
#endif
