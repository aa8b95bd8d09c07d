/* traits/plant_foot.h: where a plant stands, seen from above. Internal. */
#ifndef PLANTIMETER_TRAITS_PLANT_FOOT_H
#define PLANTIMETER_TRAITS_PLANT_FOOT_H

#include "traits/scene.h"

/** The place (x, y; metres, offsets from the cloud's origin) where the plant stands, and the standard error of each
 * coordinate: the lower end of the main stem, or of rosettes the place where the lines of the petioles meet. found: false
 * where there is no stem, and fewer than three petioles. PLM_E_MEMORY. */
plm_status plm_plant_foot(const plm_scene *scene, double foot[2], double *std_error, bool *found, plm_error *error);

#endif
