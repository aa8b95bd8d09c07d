/* io/mesh_openmesh.h: mesh files by OpenMesh. Adapter: the contract is pure C. Internal to io/. */
#ifndef PLANTIMETER_IO_MESH_OPENMESH_H
#define PLANTIMETER_IO_MESH_OPENMESH_H

#include "io/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Writes mesh to output in OpenMesh's format "PLY" (binary), "OBJ" or "STL" (binary). Coordinates are origin + vertex,
 * rounded to float by OpenMesh. face_colour (one a triangle, may be NULL) and mesh->face_organ (as the face property
 * `organ`) are written where the format is PLY. All triangle indices must be in range. PLM_E_WRITE, PLM_E_LIBRARY. */
plm_status plm_mesh_openmesh_write(const plm_mesh *mesh, const double origin[3], const uint8_t (*face_colour)[3],
                                   const char *format, plm_output *output, plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
