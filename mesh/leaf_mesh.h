/* mesh/leaf_mesh.h: one mesh from the patches of a leaf. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_MESH_H
#define PLANTIMETER_MESH_LEAF_MESH_H

#include "mesh/leaf_patch.h"
#include "mesh/mesh.h"

/** A mesh in the making. Vertices are rows of the leaf's points until it is finished. */
typedef struct plm_leaf_draft {
    size_t point_count;
    double (*place)[3];   /**< smoothed position of a point */
    double (*outward)[3]; /**< at rim points: sum over rim edges of length times the direction off the leaf; else 0 */
    uint8_t *placed;      /**< 0: not yet; 1: by a neighbouring patch; 2: by its own */
    size_t count, room;
    uint32_t (*triangle)[3]; /**< rows, counter-clockwise seen from the side of the charts' normals */
} plm_leaf_draft;

plm_status plm_leaf_draft_create(size_t point_count, plm_leaf_draft *draft, plm_error *error);
void plm_leaf_draft_free(plm_leaf_draft *draft);

/** Adds the chosen triangles (state) that belong to the patch's own chart. */
plm_status plm_leaf_draft_add(plm_leaf_draft *draft, const plm_leaf_patch *patch, const uint8_t *state,
                              plm_error *error);

/** Takes out triangles from `first` on that would use a side of another triangle once more, and closes gaps of a few
 * sides: where two charts meet, their triangulations may differ in a diagonal. */
plm_status plm_leaf_draft_mend(plm_leaf_draft *draft, size_t first, plm_error *error);

/** Makes the mesh, its rim moved outward (inward where negative) so that its area becomes `area`, by most `furthest`.
 * drawn: out, the sum of the triangles before that. The mesh is the caller's. */
plm_status plm_leaf_draft_finish(const plm_leaf_draft *draft, double area, double furthest, plm_mesh *mesh,
                                 double *drawn, plm_error *error);

#endif
