/* cloud/voxel.h: one point for each voxel of a cubic grid. Internal.
 *
 * The grid is anchored at offset 0: which points share a voxel depends on them alone. Voxels come in Morton order (near
 * in space, near in memory). Nothing depends on the order of the rows or on the number of threads, to the last digit. */
#ifndef PLANTIMETER_CLOUD_VOXEL_H
#define PLANTIMETER_CLOUD_VOXEL_H

#include "cloud/cloud.h"

/** A thinned cloud: count voxels that hold points. */
typedef struct plm_voxels {
    size_t count;
    float (*xyz)[3];  /**< mean of the voxel's points */
    uint32_t *size;   /**< how many there are */
    uint32_t *owner;  /**< of each of the points that were thinned: its voxel */
    uint32_t *first;  /**< count + 1 long: members of voxel v are member[first[v]] to member[first[v + 1] - 1] */
    uint32_t *member; /**< rows of the points, voxel by voxel, ascending within each */
} plm_voxels;

/** Thins count finite points by cubes of edge `cell` (unit of xyz). voxels is overwritten unfreed and is the caller's
 * (plm_voxels_free). O(n), 24 bytes a point while it runs, 8 that stay.
 * PLM_E_ARGUMENT  cell is not positive, or the points span more than 2 million cells along an axis (the message says
 *                 which cell would do). */
plm_status plm_voxel_thin(const float (*xyz)[3], size_t count, double cell, plm_voxels *voxels, plm_error *error);

/** NULL and a zeroed plm_voxels are allowed. */
void plm_voxels_free(plm_voxels *voxels);

#endif
