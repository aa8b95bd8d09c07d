/* segment/ground_scene.h: is there soil, a pot, a table below the plant? Decided on surface patches alone. Internal. */
#ifndef PLANTIMETER_SEGMENT_GROUND_SCENE_H
#define PLANTIMETER_SEGMENT_GROUND_SCENE_H

#include "segment/pot.h"

/** What was found below a plant, in the coordinates of stand. */
typedef struct plm_ground_scene {
    plm_stand stand;
    plm_level level[PLM_LEVELS];
    int levels;
    bool has_pot;
    plm_pot pot;
    int soil;          /**< the level that the plant stands on; -1: none (a pot may still be there) */
    int table;         /**< the level that the pot stands on; -1: none */
    double confidence; /**< 0: no ground; to 1 */
} plm_ground_scene;

/** Looks for ground below a plant that stands along up (unit, in the cloud's axes), tilted by 15 degrees at most.
 * The caller frees it with plm_ground_scene_free. */
plm_status plm_ground_look(const plm_surfels *surfels, const double up[3], plm_ground_scene *scene, plm_error *error);

void plm_ground_scene_free(plm_ground_scene *scene);

#endif
