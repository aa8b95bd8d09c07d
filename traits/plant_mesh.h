/* traits/plant_mesh.h: the measured surfaces of a plant as one mesh. Internal. */
#ifndef PLANTIMETER_TRAITS_PLANT_MESH_H
#define PLANTIMETER_TRAITS_PLANT_MESH_H

#include "traits/scene.h"

/** All leaf surfaces, and stems and petioles as tubes about their fitted lines, in the frame of the scene's offsets. closed: tubes
 * have ends. face_organ: the
 * place of each face's organ in scene->organ. Both the caller's (plm_mesh_free, plm_free); a mesh without faces where no organ has a
 * surface. PLM_E_MEMORY, and PLM_E_LIBRARY for more vertices than a mesh holds. */
plm_status plm_scene_mesh(const plm_scene *scene, bool closed, plm_mesh *mesh, int32_t **face_organ, plm_error *error);

/** Whether an organ has a part in that mesh. */
bool plm_organ_has_mesh(const plm_organ *organ);

#endif
