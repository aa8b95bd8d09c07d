/* mesh/hull_cgal.h: the convex hull by CGAL's exact predicates. Internal. */
#ifndef PLANTIMETER_MESH_HULL_CGAL_H
#define PLANTIMETER_MESH_HULL_CGAL_H

#include "mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Convex hull of count points as a closed mesh, outward facing, origin 0; its vertices are corners of the hull, in no
 * particular order. Points that all lie in one plane give the two faces of the flat hull. dimension: out, 3, or 2 for a
 * flat hull, or (no mesh is made then) 1 for points on a line, 0 for one place, -1 for no point at all. */
plm_status plm_hull_cgal(const double (*point)[3], size_t count, plm_mesh *hull, int *dimension, plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
