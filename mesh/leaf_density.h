/* mesh/leaf_density.h: the area of a patch from its density of points, beside the triangulation's: noise along the surface does
 * not push it outward. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_DENSITY_H
#define PLANTIMETER_MESH_LEAF_DENSITY_H

#include "mesh/leaf_patch.h"

typedef struct plm_density_areas {
    double half; /**< area where the blurred density is at least half of the interior's nearby, and filled holes */
    double first[3], second[6]; /**< its moments: sums of area times x, y, z and times xx, xy, xz, yy, yz, zz */
} plm_density_areas;

/** Adds the area of the patch's own chart to areas. state: a triangle's PLM_TRIANGLE_..., from plm_leaf_trim. */
plm_status plm_leaf_density(const plm_leaf_patch *patch, const uint8_t *state, const plm_leaf_charts *charts,
                            plm_density_areas *areas, plm_error *error);

#endif
