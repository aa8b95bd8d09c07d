/* mesh/mesh_cluster.h: a coarser mesh in linear time. Internal. */
#ifndef PLANTIMETER_MESH_MESH_CLUSTER_H
#define PLANTIMETER_MESH_MESH_CLUSTER_H

#include "mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A mesh of about `triangles` triangles, for showing: the vertices in a cube become their mean, and what is left of a
 * triangle in fewer than three cubes falls away (J. Rossignac and P. Borrel, Multi-resolution 3D approximations for
 * rendering complex scenes, 1993). Every triangle must name vertices that there are. face_organ and origin are kept. out is
 * overwritten unfreed and the caller's. PLM_E_MEMORY, and those of plm_mesh_area and plm_voxel_thin. */
plm_status plm_mesh_cluster(const plm_mesh *mesh, size_t triangles, plm_mesh *out, plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
