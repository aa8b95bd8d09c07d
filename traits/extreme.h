/* traits/extreme.h: how far a noisy, sampled plant reaches in a direction. Internal. */
#ifndef PLANTIMETER_TRAITS_EXTREME_H
#define PLANTIMETER_TRAITS_EXTREME_H

#include "cloud/sampling.h"

/** The farthest surface point along a direction. */
typedef struct plm_extreme {
    double value; /**< along the direction, in the points' frame */
    double std_error;
    size_t count; /**< points of the band that it rests on */
} plm_extreme;

/** Finds how far the surface behind count points reaches along a unit direction. Only the outermost points are looked at
 * (some thousand, with a small index of their own), so the cost is one pass over the cloud.
 *
 * Free of noise: the farthest point, plus the gap that sampling leaves: what a random half of the points would reach less.
 * Noisy: the outermost points are first projected onto local quadrics, since noise inflates every extreme. Standard error
 * from gap, noise and spacing (the factors are fits over virtual scans; see docs/accuracy.md).
 * PLM_E_DEGENERATE for no points. */
plm_status plm_extreme_along(const float (*xyz)[3], size_t count, const double direction[3], plm_extreme *extreme,
                             plm_error *error);

/** Projects a point onto the quadric through its neighbours within 5 noise, weighted down by distance. neighbours come from
 * index over xyz. False, and projected untouched, where they determine no surface or the point lies beyond 4 noise off it:
 * it is then no point of the surface (a ghost, a floater). */
bool plm_project_to_surface(const plm_index *index, const float (*xyz)[3], const float point[3], double noise,
                            float projected[3]);

/** Below this ratio of noise to spacing a cloud counts as free of noise. */
#define PLM_NOISE_FREE 0.1

#endif
