/* segment/thinning.h: a cloud thinned to a number of points, or to voxels of an edge. Internal. */
#ifndef PLANTIMETER_SEGMENT_THINNING_H
#define PLANTIMETER_SEGMENT_THINNING_H

#include "cloud/voxel.h"

/** One point a voxel, by plm_voxel_thin. */
typedef struct plm_thinned {
    double cell; /**< edge of the voxels */
    plm_voxels voxels;
    size_t count; /**< voxels.count and voxels.xyz, for short */
    float (*xyz)[3];
} plm_thinned;

/** Thins to voxels of edge cell; at least 2^-20 of the extent, else it is enlarged to that. */
plm_status plm_thin(const float (*xyz)[3], size_t count, double cell, plm_thinned *thinned, plm_error *error);

/** The edge of voxels of which about budget are occupied; 2^-20 of the extent when there are fewer points. */
plm_status plm_thin_cell(const float (*xyz)[3], size_t count, size_t budget, double *cell, plm_error *error);

/** Keeps the voxels of which keep says so, in their order; the points of each of the others go to the nearest that stays, whose
 * place is then not the mean of all of its points. All stay where keep names none. PLM_E_MEMORY. */
plm_status plm_thinned_keep(plm_thinned *thinned, const bool *keep, plm_error *error);

void plm_thinned_free(plm_thinned *thinned);

#endif
