/* mesh/leaf_points.h: the points of a leaf as its surface is made from them: ordered along a space-filling curve, each
 * place once, thinned where there are very many; and the connected parts that they form. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_POINTS_H
#define PLANTIMETER_MESH_LEAF_POINTS_H

#include "cloud/neighbours.h"

/** Most parts that a leaf is kept in; the smallest ones beyond are dropped. */
enum { PLM_LEAF_PARTS_MAXIMUM = 128 };

/** A leaf's points. xyz: offsets in the frame of the input, in Morton order, without duplicates. */
typedef struct plm_leaf_points {
    size_t count;
    float (*xyz)[3];
    plm_index *index;    /**< over xyz */
    float *reach;        /**< distance to the 8th neighbour */
    uint32_t *component; /**< number of the connected part, by size, largest first; PLM_NO_ROW: dropped as stray */
    bool fused;          /**< the points are voxel means */
    size_t component_count;
    size_t *component_size;
} plm_leaf_points;

/** Takes count points, in any order: the result is the same for every order. More than most of them are thinned by a hash
 * of their coordinates. fused: the points are voxel means, 1 yes, 0 no, -1 found out; of such, those that lie apart from the
 * others (ghosts off the rim) are left out. Parts are joined by edges to the 8 nearest neighbours that are not much longer than others; parts
 * too small to be a surface are dropped. The result is the caller's. PLM_E_DEGENERATE: fewer than 12 places. */
plm_status plm_leaf_points_make(const float (*xyz)[3], size_t count, size_t most, int fused, plm_leaf_points *points,
                                plm_error *error);

void plm_leaf_points_free(plm_leaf_points *points);

#endif
