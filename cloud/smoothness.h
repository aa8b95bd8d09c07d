/* cloud/smoothness.h: what a point's neighbours say about the surface around it, for all points in one pass. Internal.
 *
 * One search serves all measures that are asked for; no neighbour is stored. */
#ifndef PLANTIMETER_CLOUD_SMOOTHNESS_H
#define PLANTIMETER_CLOUD_SMOOTHNESS_H

#include "cloud/cloud.h"

/** Where the measures go: count rows each, the caller's; NULL: not asked for. */
typedef struct plm_neighbour_measures {
    /** Smoothness factor: |sum of the unit vectors to the N neighbours| / N (laser-scanning paper, Eq. 1). 0 inside a flat
     * leaf, towards 1 at an edge. Neighbours at the point's own place are left out of sum and N; 0 where none is left. */
    float *smoothness;
    /** Mean distance to the neighbours (those at the point's own place count as 0), what outliers are told by. */
    float *mean_distance;
    /** Unit normal: the direction in which the point and its neighbours spread least. Its sign: z, else y, else x is
     * positive. 0, 0, 1 where they do not spread at all. */
    float (*normal)[3];
    /** Surface variation: share of that direction in the spread, 0 (plane) to 1/3 (ball) (Pauly, Gross and Kobbelt 2002). */
    float *curvature;
} plm_neighbour_measures;

/** Measures count points by their k nearest neighbours (1 to 1024; ties to the smaller row). Parallel; same digits for any
 * number of threads. Costs as plm_all_nearest. */
plm_status plm_neighbour_pass(const float (*xyz)[3], size_t count, size_t k, const plm_neighbour_measures *out,
                              plm_error *error);

#endif
