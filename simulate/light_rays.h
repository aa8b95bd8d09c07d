/* simulate/light_rays.h: rays of light on their way, batch by batch. Internal. */
#ifndef PLANTIMETER_SIMULATE_LIGHT_RAYS_H
#define PLANTIMETER_SIMULATE_LIGHT_RAYS_H

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

/* Rays of one source that are on their way together. Each holds its energy, and the shares of the bands in it. */
enum { PLM_RAY_BATCH = 4096 };
typedef struct plm_ray_batch {
    size_t count;
    int source;
    double origin[PLM_RAY_BATCH][3], direction[PLM_RAY_BATCH][3], band[PLM_RAY_BATCH][PLM_LIGHT_BANDS];
    uint64_t energy[PLM_RAY_BATCH], number[PLM_RAY_BATCH];
    plm_hit hit[PLM_RAY_BATCH];
} plm_ray_batch;

enum { PLM_LIGHT_CELLS = 64 };

/** Place of a cell of 64 x 64 along a curve that keeps neighbours together (Morton's). */
uint32_t plm_curve_place(uint32_t column, uint32_t row);

/** Fills in the directions of the sources; their shifts of the sequence follow from key. */
void plm_light_place_sources(plm_light_run *run);
void plm_light_shift(plm_light_run *run, uint64_t key);

/** Rays [first, first + count) of a source, on the disc across its direction that covers the sphere, count at most PLM_RAY_BATCH.
 * They are put in an order in which neighbours run side by side. */
void plm_light_start(const plm_light_run *run, int number, uint64_t first, size_t count,
                     const uint16_t place[PLM_LIGHT_CELLS][PLM_LIGHT_CELLS], plm_ray_batch *batch);

/** Follows a batch hit by hit to its end; key is that of the part. */
void plm_light_follow(const plm_light_run *run, uint64_t key, plm_ray_batch *batch, plm_light_tally *count);

#endif
