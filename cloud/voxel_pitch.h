/* cloud/voxel_pitch.h: the grid that averaged a cloud's points, found again from their coordinates. Internal.
 *
 * The mean of many pixels lies near the middle of its voxel, that of one pixel anywhere in it: how strongly coordinates
 * gather about the grid's period tells both its pitch and how many pixels a voxel had. Source: the mean of n uniform
 * offsets has the characteristic function (sin(pi/n) / (pi/n))^n at the grid's frequency: 0, 0.41, 0.57, 0.71, 0.85 for n = 1,
 * 2, 3, 5, 10. */
#ifndef PLANTIMETER_CLOUD_VOXEL_PITCH_H
#define PLANTIMETER_CLOUD_VOXEL_PITCH_H

#include "cloud/cloud.h"
#include "cloud/sampling.h"

/** Edge of the cubes whose means the points are, in their unit, so exact that it drifts by less than a twentieth of a voxel over
 * the points' extent; 0 where the coordinates show no grid along all three axes, or well along two and
 * points stacked along the third: no voxel means, one pixel a voxel, a cloud that was turned off its grid, a single depth image, or
 * coordinates that lie on a grid themselves (rounded, or centres of voxels). spacing: as plm_sampling.
 * A few thousand points are looked at, chosen by their coordinates. PLM_E_MEMORY. */
plm_status plm_voxel_pitch_find(const float (*xyz)[3], size_t count, double spacing, double *pitch, plm_error *error);

/** How strongly the points gather about a grid of this pitch along each axis: |mean of exp(2 pi i x / pitch)| less what chance
 * adds to its square, 0 (not at all, or fewer than two points) to 1. */
void plm_voxel_gathering(const float (*xyz)[3], size_t count, double pitch, double gathering[3]);

/** Pitch and gathering of points whose sampling is known so far without them: both stay 0 where it is not fused, where no grid
 * shows, and where the noise is so small beside the voxels that points only were thinned to their means. PLM_E_MEMORY. */
plm_status plm_voxels_measure(const float (*xyz)[3], size_t count, plm_sampling *sampling, plm_error *error);

#endif
