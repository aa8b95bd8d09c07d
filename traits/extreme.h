/* traits/extreme.h: how far a noisy, sampled plant reaches in a direction. Internal. */
#ifndef PLANTIMETER_TRAITS_EXTREME_H
#define PLANTIMETER_TRAITS_EXTREME_H

#include "cloud/sampling.h"

/** The farthest surface point along a direction. */
typedef struct plm_extreme {
    double value; /**< along the direction, in the points' frame */
    double std_error;
    size_t count;          /**< points of the band that it rests on */
    plm_sampling sampling; /**< there */
} plm_extreme;

/** What is known beforehand; {0}: nothing. */
typedef struct plm_extreme_options {
    const plm_sampling *sampling; /**< spacing and noise of the surface there, which is most of the work; or NULL */
    double noise; /**< measured elsewhere on the plant: taken where the surface there reads more, as a tube as thin as a
                   * quadric is wide does; or 0 */
    /** Measured elsewhere: taken where the surface there reads less, as leaves narrower than the quadrics that such noise needs do;
     * or 0. */
    double least_noise;
    /** The end is that of a tube that is cut off there (the foot of a stem), not the side of one: in points that are no voxel means
     * nothing says then which part of the noise blurs it, but how its last points lie. (In voxel means the projected points tell.) */
    bool cut;
    double disc; /**< of splats, the radius by which fitted discs reach past their centres, added where the surface
                   * ends side-on; 0 for other clouds, and where it is cut off rather than rimmed (the foot of a stem) */
} plm_extreme_options;

/** Finds how far the surface behind count points reaches along a unit direction. Only the outermost points are looked at
 * (some thousand, with a small index of their own), so the cost is one pass over the cloud.
 *
 * Noisy: points without support are left out, the others projected onto local quadrics, but for those whose
 * neighbours are no surface, which count as seen. Where the surface ends behind them
 * and how sure that is say the outermost heights (traits/sample_end.h).
 * PLM_E_DEGENERATE for no points. */
plm_status plm_extreme_along(const float (*xyz)[3], size_t count, const double direction[3],
                             const plm_extreme_options *options, plm_extreme *extreme, plm_error *error);

/** Whether a point (one of xyz) has neighbours as near as the surface of the plant would have them. What has not (a trail
 * of ghosts off a rim, a floater) makes no extreme and no corner of a hull. */
bool plm_is_supported(const plm_index *index, const float (*xyz)[3], const float point[3],
                      const plm_sampling *sampling);

/** The centres of fitted discs (splats) stay inside a rim by this part of their radius, give or take as much: 0.1 and 0.7 in two
 * families of virtual splats. */
#define PLM_DISC_REACH 0.4

/** Below this ratio of noise to spacing a cloud counts as free of noise. */
#define PLM_NOISE_FREE 0.1

#endif
