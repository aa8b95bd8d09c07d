/* traits/plant_mesh.h: the measured surfaces of a plant as one mesh. Internal. */
#ifndef PLANTIMETER_TRAITS_PLANT_MESH_H
#define PLANTIMETER_TRAITS_PLANT_MESH_H

#include "traits/scene.h"

/** All leaf surfaces, and stems and petioles as tubes about their fitted lines (but those that their points do not lie on), in
 * the frame of the scene's offsets; closed: tubes have ends. face_organ: the place of each face's organ in scene->organ. The
 * caller's (plm_mesh_free); without faces where no organ has a surface. PLM_E_MEMORY, and PLM_E_LIBRARY for more vertices than a
 * mesh holds. */
plm_status plm_scene_mesh(const plm_scene *scene, bool closed, plm_mesh *mesh, plm_error *error);

/** All leaf surfaces at the cloud's origin. face_organ: the leaf's number. As plm_scene_mesh else. */
plm_status plm_scene_leaf_mesh(const plm_scene *scene, plm_mesh *mesh, plm_error *error);

/** Whether an organ has a part in plm_scene_mesh. */
bool plm_organ_has_mesh(const plm_scene *scene, const plm_organ *organ);

#endif
