/* simulate/scan_dome.c: the laser-scanning paper's dome: 13 layers of 25 scanners on a hemisphere, each sending rays
 * into the cone that holds the scene; a point is the first hit of a ray. Also uniform sampling of the surface. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/ray_order.h"
#include "simulate/scan.h"
#include "simulate/turn.h"

size_t plm_dome_positions(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3])
{
    size_t count = 0;
    for (int layer = 0; layer < PLM_DOME_LAYERS; layer++) {
        const double elevation = 0.5 * PLM_PI * (layer + 0.5) / PLM_DOME_LAYERS;
        for (int k = 0; k < PLM_DOME_AROUND; k++, count++) {
            /* every other layer is turned by half a step */
            const double azimuth = 2 * PLM_PI * (k + 0.5 * (layer % 2)) / PLM_DOME_AROUND;
            const double radius = fmax(options->dome_radius, 1.5 * stage->target_radius);
            position[count][0] = stage->target[0] + radius * cos(elevation) * cos(azimuth);
            position[count][1] = stage->target[1] + radius * cos(elevation) * sin(azimuth);
            position[count][2] = stage->target[2] + radius * sin(elevation);
        }
    }
    return count;
}

/* One scanner, and rays of it that are cast together, in an order in which neighbours run side by side. */
typedef struct dome_rays {
    double from[3], axis[3], u[3], v[3];
    double low; /* cosine of the cone's rim */
    double shift[2];
    float cone[PLM_RAY_BATCH], turn[PLM_RAY_BATCH];   /* share of the cone, share of the turn */
    uint16_t order[PLM_RAY_BATCH], at[PLM_RAY_BATCH]; /* ray k of the batch stands at[k]-th in the order */
    plm_ray_lanes lanes;
    plm_hit hit[PLM_RAY_BATCH];
} dome_rays;

static void set_up(const plm_stage_set *stage, const double from[3], uint64_t key, dome_rays *rays)
{
    memcpy(rays->from, from, sizeof rays->from);
    for (int i = 0; i < 3; i++) rays->axis[i] = stage->target[i] - from[i];
    const double distance = plm_normalise(rays->axis), sine = fmin(stage->target_radius / distance, 1);
    plm_frame_of_axis(rays->axis, rays->u, rays->v);
    rays->low = sqrt(1 - sine * sine);
    for (int i = 0; i < 2; i++) rays->shift[i] = plm_uniform_at(key, (uint64_t)i);
}

/* Casts rays [first, first + count): directions spread evenly over the cone that holds the target. The R2 sequence (M. Roberts,
 * The unreasonable effectiveness of quasirandom sequences, 2018), shifted at random for each scanner, fills it evenly. */
static void cast_batch(const plm_stage_set *stage, uint64_t first, size_t count, dome_rays *rays)
{
    for (size_t k = 0; k < count; k++) {
        const double a = rays->shift[0] + 0.7548776662466927 * (double)(first + k);
        const double b = rays->shift[1] + 0.5698402909980532 * (double)(first + k);
        rays->cone[k] = (float)(a - (double)(int64_t)a); /* neither is negative */
        rays->turn[k] = (float)(b - (double)(int64_t)b);
    }
    plm_ray_order(rays->cone, rays->turn, count, rays->order);
    for (size_t at = 0; at < count; at++) {
        const size_t k = rays->order[at];
        float sine_round, cosine_round;
        plm_turn_of(rays->turn[k], &sine_round, &cosine_round);
        const double cosine = 1 - (1 - rays->low) * (double)rays->cone[k], away = sqrt(fmax(1 - cosine * cosine, 0));
        const double x = away * (double)cosine_round, y = away * (double)sine_round;
        for (int i = 0; i < 3; i++) {
            rays->lanes.direction[i][at] = (float)(cosine * rays->axis[i] + x * rays->u[i] + y * rays->v[i]);
            rays->lanes.origin[i][at] = (float)rays->from[i];
        }
        rays->at[k] = (uint16_t)at;
    }
    plm_rays_first_many(stage->rays, &rays->lanes, count, true, rays->hit);
}

/* All rays of scanner number s: hits to samples (where they are wanted) in the order of the rays. */
static plm_status cast_scanner(const plm_stage_set *stage, const plm_scan_options *options, const double from[3],
                               size_t s, uint64_t rays, bool is_wanted, plm_samples *samples, size_t *hits,
                               plm_error *error)
{
    dome_rays *batch = plm_alloc(1, sizeof *batch, error);
    plm_status status = batch ? PLM_OK : PLM_E_MEMORY;
    if (batch) set_up(stage, from, plm_key(options->seed, 1000 + s), batch);
    for (uint64_t first = 0; first < rays && status == PLM_OK; first += PLM_RAY_BATCH) {
        const size_t count = rays - first < PLM_RAY_BATCH ? (size_t)(rays - first) : PLM_RAY_BATCH;
        cast_batch(stage, first, count, batch);
        for (size_t k = 0; k < count && status == PLM_OK; k++) {
            const size_t at = batch->at[k];
            const plm_hit *hit = &batch->hit[at];
            double direction[3];
            plm_sample sample;
            if (hit->face == PLM_NO_HIT) continue;
            *hits += hit->face < stage->plant_faces;
            if (!is_wanted) continue;
            for (int i = 0; i < 3; i++) {
                direction[i] = (double)batch->lanes.direction[i][at];
                sample.xyz[i] = (float)(from[i] + hit->t * direction[i]);
            }
            plm_sample_label(stage, hit->face, direction, options->seed, &sample);
            status = plm_samples_add(samples, &sample, error);
        }
    }
    plm_free(batch);
    return status;
}

plm_status plm_dome_cast(const plm_stage_set *stage, const plm_scan_options *options, uint64_t rays,
                         plm_samples *samples, size_t *hits, plm_error *error)
{
    enum { SCANNERS = PLM_DOME_LAYERS * PLM_DOME_AROUND };
    double position[SCANNERS][3];
    plm_samples part[SCANNERS] = {{0}};
    plm_status made[SCANNERS], status = PLM_OK;
    size_t sum = 0;
    plm_dome_positions(stage, options, position);
#pragma omp parallel for schedule(dynamic) reduction(+ : sum)
    for (int s = 0; s < SCANNERS; s++) /* a message would be written by several threads: the status says enough */
        made[s] = cast_scanner(stage, options, position[s], (size_t)s, rays, samples != NULL, &part[s], &sum, NULL);
    for (int s = 0; s < SCANNERS && status == PLM_OK; s++)
        if (made[s] != PLM_OK)
            status = plm_fail(error, made[s], "scanner %d of the dome: %s", s, plm_status_name(made[s]));
    for (int s = 0; s < SCANNERS; s++) {
        for (size_t k = 0; samples && k < part[s].count && status == PLM_OK; k++)
            status = plm_samples_add(samples, &part[s].sample[k], error);
        plm_free(part[s].sample);
    }
    if (status == PLM_OK) *hits += sum;
    return status;
}

/* Leaves `wanted` plant points (and the same share of the others), taken at random. */
static void thin(plm_samples *samples, const plm_stage_set *stage, size_t hits, size_t wanted, uint64_t seed)
{
    const uint64_t key = plm_key(seed, 13);
    size_t kept = 0, left = hits, needed = wanted;
    const double share = hits ? (double)wanted / (double)hits : 1;
    for (size_t k = 0; k < samples->count; k++) {
        const bool is_plant = samples->sample[k].face < stage->plant_faces;
        const double draw = plm_uniform_at(key, k);
        if (is_plant ? draw * (double)left < (double)needed : draw < share) {
            samples->sample[kept++] = samples->sample[k];
            needed -= is_plant;
        }
        left -= is_plant;
    }
    samples->count = kept;
}

static plm_status finish(const plm_stage_set *stage, const plm_scan_options *options, double area, plm_samples *samples,
                         plm_scan *scan, plm_error *error)
{
    size_t hits = 0;
    for (size_t k = 0; k < samples->count; k++) hits += samples->sample[k].face < stage->plant_faces;
    scan->hits_per_area = area > 0 ? (double)hits / area : 0;
    plm_add_noise(samples, options->noise, options->seed);
    return plm_add_floaters(stage, options->outliers, options->seed, samples, error);
}

plm_status plm_dome_rays(const plm_stage_set *stage, const plm_scan_options *options, size_t wanted, uint64_t *rays,
                         plm_error *error)
{
    enum { TRIAL = 512, MOST = 4000000 };
    size_t hits = 0;
    const plm_status status = plm_dome_cast(stage, options, TRIAL, NULL, &hits, error);
    if (status != PLM_OK) return status;
    if (!hits) return plm_fail(error, PLM_E_DEGENERATE, "of %d rays from each scanner none met the plant", TRIAL);
    const double rate = fmax((double)hits - 6 * sqrt((double)hits), 0.1 * (double)hits) / TRIAL; /* 6 standard errors */
    *rays = (uint64_t)fmin((double)wanted / rate + 64, MOST);
    return PLM_OK;
}

plm_status plm_scan_dome(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                         plm_scan *scan, plm_error *error)
{
    const double area = plm_plant_area(stage->plant);
    const size_t wanted = options->points ? options->points : (size_t)(options->density * area + 0.5);
    size_t hits = 0;
    uint64_t rays = 0;
    plm_status status = plm_dome_rays(stage, options, wanted, &rays, error);
    if (status == PLM_OK) status = plm_dome_cast(stage, options, rays, samples, &hits, error);
    if (status == PLM_OK && hits > wanted) thin(samples, stage, hits, wanted, options->seed);
    return status == PLM_OK ? finish(stage, options, area, samples, scan, error) : status;
}

plm_status plm_scan_uniform(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                            plm_scan *scan, plm_error *error)
{
    const double area = plm_plant_area(stage->plant);
    const size_t wanted = options->points ? options->points : (size_t)(options->density * area + 0.5);
    const uint64_t key = plm_key(options->seed, 14);
    plm_face_sampler sampler;
    plm_status status = plm_face_sampler_make(&stage->mesh, stage->mesh.triangle_count, &sampler, error);
    if (status != PLM_OK) return status;
    const double all = sampler.sum[sampler.count - 1];
    const size_t count = (size_t)((double)wanted * (area > 0 ? all / area : 1) + 0.5);
    for (size_t k = 0; k < count && status == PLM_OK; k++) {
        double point[3];
        plm_sample sample;
        const uint32_t face =
            plm_face_sampler_draw(&sampler, plm_uniform_at(key, 3 * k), plm_uniform_at(key, 3 * k + 1),
                                  plm_uniform_at(key, 3 * k + 2), point);
        for (int i = 0; i < 3; i++) sample.xyz[i] = (float)point[i];
        plm_sample_label(stage, face, NULL, options->seed, &sample);
        status = plm_samples_add(samples, &sample, error);
    }
    plm_face_sampler_free(&sampler);
    return status == PLM_OK ? finish(stage, options, area, samples, scan, error) : status;
}
