/* traits/principal_axes.h: axes along which the plant's surface is spread. Internal. */
#ifndef PLANTIMETER_TRAITS_PRINCIPAL_AXES_H
#define PLANTIMETER_TRAITS_PRINCIPAL_AXES_H

#include "traits/scene.h"

/** Second moments of a plant's surface. */
typedef struct plm_principal {
    double value[3];   /**< m2, largest first */
    double axis[3][3]; /**< unit vectors */
    double turn; /**< standard error of an axis' direction, radians, times the relative gap to the nearest moment */
} plm_principal;

/** Area-weighted moments of the measured surfaces and tubes, and of what no surface stands for (where there are no organs, all): voxels
 * that each count as one piece of area. flat: of the ground projection, weighted by the area of the surface itself.
 * PLM_E_DEGENERATE  all points are in one place, or no surface has an area. PLM_E_MEMORY, and PLM_E_LIBRARY as plm_scene_mesh. */
plm_status plm_principal_axes(const plm_scene *scene, bool flat, plm_principal *axes, plm_error *error);

#endif
