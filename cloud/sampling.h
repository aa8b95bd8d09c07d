/* cloud/sampling.h: what a cloud's sampling is like: spacing, noise, fused on voxels or not. Internal.
 * Source: shared notes on estimators, section 1. */
#ifndef PLANTIMETER_CLOUD_SAMPLING_H
#define PLANTIMETER_CLOUD_SAMPLING_H

#include "cloud/neighbours.h"

/** Sampling of one organ or of a whole cloud. Lengths in metres. */
typedef struct plm_sampling {
    double spacing; /**< s = 1 / sqrt(points per area), median over points; reads high where noise nears it: by 8 % at
                         sigma = 0.5 s, by 24 % at sigma = s */
    double noise;   /**< sigma: SD of the points off a local quadric */
    double extent;  /**< of splats: median of the mean of the two larger scales (a); 0 else, and 0 from
                         plm_sampling_measure: the caller knows it */
    bool fused;     /**< points are voxel means (they keep apart) */
    /** The voxels, where they are known (cloud/voxel_pitch.h): their edge, and how strongly the points gather about their
     * middles, mean of the two axes along which they do more: 0 for one pixel a voxel, 0.3 to 0.7 for a few to many. 0 else, and
     * 0 from plm_sampling_measure: the caller knows them of the whole cloud. */
    double pitch, gathering;
} plm_sampling;

/** The spacing that a share of count points stay below (0.9: that of the sparser parts): at each of some 6000 points,
 * chosen by their coordinates, 1 / sqrt of the local density in the tangent plane from the k = 8 nearest neighbours, the
 * median of that over these neighbours, and then the quantile. Both faces of a thin leaf count, and should. index is over
 * xyz. PLM_E_DEGENERATE below 2 points. Parallel. */
plm_status plm_spacing_quantile(const plm_index *index, const float (*xyz)[3], size_t count, double share,
                                double *spacing, plm_error *error);

/** Sampling of count points that belong together (one organ, or the plant). fused_known: NULL to find it out here, else
 * the answer of the whole cloud (small organs cannot tell). index is over xyz. Some 6000 points are looked at, chosen
 * by their coordinates, so the cost does not grow with the cloud. PLM_E_DEGENERATE below 12 points. */
plm_status plm_sampling_measure(const plm_index *index, const float (*xyz)[3], size_t count, const bool *fused_known,
                                plm_sampling *sampling, plm_error *error);

/** The noise of plm_sampling_measure alone: median of the residual SD of 25 to 250 local quadrics. At least 1 point. */
plm_status plm_noise_measure(const plm_index *index, const float (*xyz)[3], size_t count, double *noise,
                             plm_error *error);

/** Whether a point's nearest neighbour is far nearer than its count-th, as happens by chance but not in voxel means.
 * squared: sorted squared distances to its neighbours (8 of them for plm_close_share_is_fused). */
bool plm_neighbour_is_close(const float *squared, size_t count);
/** Whether points of which this share is close to a neighbour are voxel means. */
bool plm_close_share_is_fused(double share);

#endif
