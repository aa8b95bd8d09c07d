/* simulate/light_rays.h: rays of light on their way, batch by batch. Internal. */
#ifndef PLANTIMETER_SIMULATE_LIGHT_RAYS_H
#define PLANTIMETER_SIMULATE_LIGHT_RAYS_H

#include "simulate/ray_order.h"
#include "simulate/rays.h"
#include "simulate/simulate.h"

/* Energy of one ray when it starts. 1e9 rays of it still fit into 64 bits. */
#define PLM_PARCEL ((uint64_t)1 << 33)

typedef struct plm_light_source {
    double up[3], u[3], v[3];
    double shift[5]; /* of the sequence, drawn anew for each part of the rays */
} plm_light_source;

/* Everything that a ray needs to know. */
typedef struct plm_light_run {
    const plm_mesh *mesh;
    const plm_light_options *options;
    const plm_rays *rays;
    plm_light_source *source;
    double (*normal)[3];           /* of every face */
    double centre[3], radius, gap; /* gap: how far off a face a new ray starts */
    double absorptance[PLM_LIGHT_BANDS];
} plm_light_run;

/* What one thread has counted. */
typedef struct plm_light_tally {
    uint64_t *face;
    uint64_t escaped, rays;
} plm_light_tally;

/* Rays of one source that are on their way together. Until their first hit all have a whole parcel, a third of it in each band, and
 * energy and band are not set. */
typedef struct plm_ray_batch {
    size_t count;
    int source;
    uint64_t first; /* number of the first ray */
    float share[2][PLM_RAY_BATCH],
        place[2][PLM_RAY_BATCH]; /* of the start: of disc and turn; in the square about the disc */
    plm_ray_lanes lanes;
    uint16_t order[PLM_RAY_BATCH]; /* of each ray: its number, counted from the first */
    uint64_t energy[PLM_RAY_BATCH];
    double band[PLM_RAY_BATCH][PLM_LIGHT_BANDS]; /* shares of the bands in the energy */
    plm_hit hit[PLM_RAY_BATCH];
} plm_ray_batch;

/** Fills in the directions of the sources; their shifts of the sequence follow from key. */
void plm_light_place_sources(plm_light_run *run);
void plm_light_shift(plm_light_run *run, uint64_t key);

/** Rays [first, first + count) of a source, on the disc across its direction that covers the sphere, count at most PLM_RAY_BATCH.
 * They are put in an order in which neighbours run side by side. */
void plm_light_start(const plm_light_run *run, int number, uint64_t first, size_t count, plm_ray_batch *batch);

/** Follows a batch hit by hit to its end; key is that of the part. */
void plm_light_follow(const plm_light_run *run, uint64_t key, plm_ray_batch *batch, plm_light_tally *count);

#endif
