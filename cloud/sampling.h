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
} plm_sampling;

/** Spacing at each of count points (out, count long): 1 / sqrt of the local density in the tangent plane, from the k =
 * 8 nearest neighbours, then the median over these neighbours. Both faces of a thin leaf count, and should. 0 where
 * nine points coincide. index is over xyz. PLM_E_DEGENERATE below 2 points. Parallel. */
plm_status plm_spacing_local(const plm_index *index, const float (*xyz)[3], size_t count, float *spacing,
                             plm_error *error);

/** Sampling of count points that belong together (one organ, or the plant). fused_known: NULL to find it out here, else
 * the answer of the whole cloud (small organs cannot tell). index is over xyz. Some 6000 points are looked at, chosen
 * by their coordinates, so the cost does not grow with the cloud. PLM_E_DEGENERATE below 12 points. */
plm_status plm_sampling_measure(const plm_index *index, const float (*xyz)[3], size_t count, const bool *fused_known,
                                plm_sampling *sampling, plm_error *error);

#endif
