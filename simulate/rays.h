/* simulate/rays.h: casting rays at triangles, by Embree. Internal.
 *
 * The scene is built by one thread, so that its tree, and with it every hit, is the same from run to run; rays are cast
 * from any number of threads. Embree works in float: keep coordinates near the origin. */
#ifndef PLANTIMETER_SIMULATE_RAYS_H
#define PLANTIMETER_SIMULATE_RAYS_H

#include "cloud/cloud.h"

typedef struct plm_rays plm_rays;

/** A hit: the face, how far (in lengths of the direction), and where in the triangle (weights of its second and third
 * vertex). */
typedef struct plm_hit {
    uint32_t face;
    double t, u, v;
} plm_hit;

/** Builds the scene of the triangles [first, first + count) of vertex and triangle; faces are numbered from 0 at
 * `first`. PLM_E_LIBRARY, PLM_E_MEMORY. */
plm_status plm_rays_build(const double (*vertex)[3], size_t vertex_count, const uint32_t (*triangle)[3], size_t first,
                          size_t count, plm_rays **rays, plm_error *error);

/** NULL is allowed. */
void plm_rays_free(plm_rays *rays);

/** First face along origin + t * direction with near < t < far. */
bool plm_rays_first(const plm_rays *rays, const double origin[3], const double direction[3], double near, double far,
                    plm_hit *hit);

#define PLM_NO_HIT UINT32_MAX

/** Most rays that are cast at once. */
enum { PLM_RAY_BATCH = 4096 };

/** Rays to be cast together, in the floats that Embree works with. */
typedef struct plm_ray_lanes {
    float origin[3][PLM_RAY_BATCH], direction[3][PLM_RAY_BATCH];
} plm_ray_lanes;

/** First face of each of count rays; hit[k].face is PLM_NO_HIT where ray k meets nothing. are_side_by_side: rays that lie side by
 * side in the arrays run side by side, so that eight are best led through the tree together; else each goes alone. */
void plm_rays_first_many(const plm_rays *rays, const plm_ray_lanes *lanes, size_t count, bool are_side_by_side,
                         plm_hit *hit);

/** True when a face lies between the two points (share 0.001 of the way kept off both ends). */
bool plm_rays_blocked(const plm_rays *rays, const double from[3], const double to[3]);

/** Hands every face that the segment cuts to `meet`, until that returns true; then true comes back. */
bool plm_rays_cut(const plm_rays *rays, const double from[3], const double to[3],
                  bool (*meet)(uint32_t face, double t, void *user), void *user);

#endif
