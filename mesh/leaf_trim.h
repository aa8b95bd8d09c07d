/* mesh/leaf_trim.h: which triangles of a patch are leaf, and their sums. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_TRIM_H
#define PLANTIMETER_MESH_LEAF_TRIM_H

#include "mesh/leaf_patch.h"

/** Sums over the triangles that belong to the patches' own charts. */
typedef struct plm_trim_sums {
    double area; /**< holes that were filled included */
    double hole_area;
    double gap_area;     /**< enclosed holes too large to be filled */
    double boundary;     /**< length of the rim */
    double spacing_area; /**< integral of the local spacing over the area */
    double sparse_area;  /**< area where the local spacing exceeds three times the patch's median */
} plm_trim_sums;

/** How triangles are chosen. */
typedef struct plm_trim {
    double factor;       /**< largest circumradius in local spacings; not used where radius is set */
    double radius;       /**< largest circumradius in metres, or 0 */
    double largest_hole; /**< enclosed holes up to this share of the patch's area are filled */
} plm_trim;

/** Chooses the triangles with small circumradius, drops small islands, fills enclosed holes: state (a triangle each).
 * Triangles of other charts are judged too, so that seams are no rims, but only own ones are added to sums. */
plm_status plm_leaf_trim(const plm_leaf_patch *patch, const plm_trim *trim, uint8_t *state, plm_trim_sums *sums,
                         plm_error *error);

/** Whether triangle t belongs to the patch's own chart: the chart of most of its corners. The same answer in every patch
 * that has the triangle. */
bool plm_patch_owns(const plm_leaf_patch *patch, size_t t);

#endif
