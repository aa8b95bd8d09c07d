/* traits/projection.h: noisy points projected onto their surface, and how high they lie then. Internal. */
#ifndef PLANTIMETER_TRAITS_PROJECTION_H
#define PLANTIMETER_TRAITS_PROJECTION_H

#include "cloud/sampling.h"
#include "cloud/subset.h"
#include "traits/sample_end.h"

/** A point moved onto the surface through its neighbours. */
typedef struct plm_projection {
    float place[3];
    double normal[3]; /**< of the surface, unit, either side */
    double leverage;  /**< variance that is left across the surface per variance of the points, at most 1 */
    double flatness;  /**< variance of the neighbours across the narrower direction of the surface over that off it */
    double axis[3];   /**< their longest principal axis, unit, either way */
    double rest;      /**< root mean square distance of the neighbours from the surface, as weighted in the fit */
} plm_projection;

/** The points that surfaces are fitted to: all of count points, or where they lie far closer than the noise, as many of them
 * as tell the surface. As plm_subset_take. */
plm_status plm_fit_points(const plm_index *index, const float (*xyz)[3], size_t count, const plm_sampling *sampling,
                          plm_subset *points, plm_error *error);

/** Projects a point onto the quadric through its neighbours within 5 noise but itself, weighted down by distance, again from
 * where that leads to until it stays. False where they determine no surface or the point lies beyond 4 noise off it: it is
 * then no point of the surface (a ghost, a floater). */
bool plm_project_to_surface(const plm_subset *points, const float point[3], double noise, plm_projection *onto);

/** What the noise in a height rests on. */
typedef struct plm_blur {
    const plm_sampling *sampling;
    double
        along; /**< of voxel means: noise along the surface per noise across it (of other points traits/sample_end.h finds it) */
    bool cut; /**< see plm_extreme_options */
} plm_blur;

/** How high a projected point lies along a unit direction, and what noise is left in that. Where its neighbours are no one surface
 * (tubes as thin as the noise, tubes that meet) it is as high as it was seen, with all of the noise.
 * Gives how far the surface faces the direction (squared cosine). */
double plm_projected_height(const plm_projection *onto, const float seen[3], const double direction[3],
                            const plm_blur *blur, plm_height *height);

#endif
