/* simulate/light.c: absorbed light by Monte Carlo (laser-scanning paper, section on light absorption).
 *
 * A ray is a parcel of energy in three bands. Where it meets a face, a share is left there, and what remains is either reflected or
 * transmitted as a whole, by a draw in proportion to both. Energy is counted in whole numbers: sums then come out the same in any order
 * of threads, and nothing is lost. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "simulate/random.h"
#include "simulate/rays.h"
#include "simulate/simulate.h"

enum { PARTS = 16, MAXIMUM_DEPTH = 100 };

/* Energy of one ray when it starts. 1e9 rays of it still fit into 64 bits. */
#define PARCEL ((uint64_t)1 << 33)

void plm_light_defaults(plm_light_options *options)
{
    *options = (plm_light_options){.seed = 1,
                                   .rays = 10000000,
                                   .circles = 6,
                                   .around = 12,
                                   .power = 1000,
                                   .reflectance = {0, 0.9, 0},
                                   .transmittance = {0.1, 0.1, 0.1},
                                   .depth = 10};
}

typedef struct light_source {
    double up[3], u[3], v[3];
    double shift[5]; /* of the sequence, drawn anew for each part of the rays */
} light_source;

/* Everything that a ray needs to know. */
typedef struct light_run {
    const plm_mesh *mesh;
    const plm_light_options *options;
    const plm_rays *rays;
    light_source *source;
    double (*normal)[3];           /* of every face */
    double centre[3], radius, gap; /* gap: how far off a face a new ray starts */
    double absorptance[PLM_LIGHT_BANDS];
} light_run;

/* What one thread has counted. */
typedef struct tally {
    uint64_t *face;
    uint64_t escaped, rays;
} tally;

/* ---- Rays ------------------------------------------------------------------------------------------------------- */

/* Five numbers in [0, 1) for ray k of a source: the R5 sequence (M. Roberts, 2018: powers of the root of x^6 = x + 1), shifted. */
static void spread(const double shift[5], uint64_t k, double draw[5])
{
    static const double step[5] = {0.8812714616335696, 0.7766393890897682, 0.6844301295853426, 0.6031687406857282,
                                   0.5315553977157913};
    for (int i = 0; i < 5; i++) {
        const double at = shift[i] + step[i] * (double)k;
        draw[i] = at - (double)(int64_t)at; /* at is not negative */
    }
}

static void draw_shifts(light_run *run, uint64_t key)
{
    for (int k = 0; k < run->options->circles * run->options->around; k++)
        for (int i = 0; i < 5; i++) run->source[k].shift[i] = plm_uniform_at(plm_key(key, (uint64_t)k), (uint64_t)i);
}

/* Direction to each source, and two axes across it. */
static void place_sources(light_run *run)
{
    for (int k = 0; k < run->options->circles * run->options->around; k++) {
        const int circle = k / run->options->around, place = k % run->options->around;
        const double elevation = 0.5 * PLM_PI * (circle + 0.5) / run->options->circles;
        const double azimuth = 2 * PLM_PI * (place + 0.5 * (circle % 2)) / run->options->around;
        light_source *source = &run->source[k];
        source->up[0] = cos(elevation) * cos(azimuth);
        source->up[1] = cos(elevation) * sin(azimuth);
        source->up[2] = sin(elevation);
        plm_frame_of_axis(source->up, source->u, source->v);
    }
}

/* Start of a ray: on the disc across the source's direction that covers the sphere. */
static void start_ray(const light_run *run, int number, const double draw[2], double origin[3], double direction[3])
{
    const light_source *source = &run->source[number];
    const double r = run->radius * sqrt(draw[0]), a = 2 * PLM_PI * draw[1], x = r * cos(a), y = r * sin(a);
    for (int i = 0; i < 3; i++) {
        direction[i] = -source->up[i];
        origin[i] = run->centre[i] + 1.01 * run->radius * source->up[i] + x * source->u[i] + y * source->v[i];
    }
}

/* A direction about a unit normal with density cosine / pi. */
static void scatter(const double normal[3], double first, double second, double direction[3])
{
    double u[3], v[3];
    const double r = sqrt(first), a = 2 * PLM_PI * second, up = sqrt(fmax(1 - first, 0));
    plm_frame_of_axis(normal, u, v);
    for (int i = 0; i < 3; i++) direction[i] = r * cos(a) * u[i] + r * sin(a) * v[i] + up * normal[i];
}

/* Leaves the absorbed share of the ray's energy on the face; gives the rest. band holds the shares of the bands in the energy. */
static uint64_t absorb(const light_run *run, uint64_t energy, const double band[PLM_LIGHT_BANDS], uint64_t *face)
{
    double share = 0;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) share += band[b] * run->absorptance[b];
    uint64_t left = (uint64_t)(share * (double)energy + 0.5);
    left = left > energy ? energy : left;
    *face += left;
    return energy - left;
}

/* Reflected or transmitted; the bands' shares follow. True when reflected. */
static bool choose_side(const light_run *run, double draw, double band[PLM_LIGHT_BANDS])
{
    double reflected = 0, transmitted = 0, sum = 0;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) {
        reflected += band[b] * run->options->reflectance[b];
        transmitted += band[b] * run->options->transmittance[b];
    }
    const bool is_reflected = draw * (reflected + transmitted) < reflected;
    const double *share = is_reflected ? run->options->reflectance : run->options->transmittance;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) sum += band[b] *= share[b];
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) band[b] /= sum;
    return is_reflected;
}

static void follow(const light_run *run, uint64_t key, uint64_t number, int source, tally *count)
{
    double draw[5], origin[3], direction[3], band[PLM_LIGHT_BANDS] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    uint64_t energy = PARCEL;
    uint64_t later = 0; /* the stream of the second scattering and those after it: few rays get there */
    spread(run->source[source].shift, number, draw);
    start_ray(run, source, draw, origin, direction);
    for (int depth = 0; depth < run->options->depth && energy; depth++) {
        plm_hit hit;
        count->rays++;
        if (!plm_rays_first(run->rays, origin, direction, 0, INFINITY, &hit)) break;
        energy = absorb(run, energy, band, &count->face[hit.face]);
        if (!energy) break;
        if (depth == 1) later = plm_key(key, 1000003 + number * 131072 + (uint64_t)source);
        for (int i = 0; depth && i < 3; i++) draw[2 + i] = plm_uniform_at(later, (uint64_t)(3 * depth + i));
        const double *n = run->normal[hit.face];
        const bool is_front = plm_dot(n, direction) < 0;
        /* reflected to the side it came from, transmitted to the other */
        const double sign = choose_side(run, draw[2], band) == is_front ? 1 : -1;
        const double side[3] = {sign * n[0], sign * n[1], sign * n[2]};
        for (int i = 0; i < 3; i++) origin[i] += hit.t * direction[i] + run->gap * side[i];
        scatter(side, draw[3], draw[4], direction);
    }
    count->escaped += energy;
}

/* ---- The run ---------------------------------------------------------------------------------------------------- */

static plm_status check(const plm_mesh *mesh, const plm_light_options *options, plm_error *error)
{
    if (options->circles < 1 || options->around < 1 || options->circles * options->around > 100000)
        return plm_fail(error, PLM_E_ARGUMENT, "%d circles of %d sources", options->circles, options->around);
    if (options->depth < 1 || options->depth > MAXIMUM_DEPTH)
        return plm_fail(error, PLM_E_ARGUMENT, "depth %d; 1 to %d was expected", options->depth, MAXIMUM_DEPTH);
    if (!(options->power >= 0 && isfinite(options->power)))
        return plm_fail(error, PLM_E_ARGUMENT, "a power of %g W", options->power);
    if (options->rays < 1 || options->rays > 1000000000u)
        return plm_fail(error, PLM_E_ARGUMENT, "%llu rays; 1 to 1e9 was expected", (unsigned long long)options->rays);
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) {
        const double r = options->reflectance[b], t = options->transmittance[b];
        if (!(r >= 0 && t >= 0 && r + t <= 1 + 1e-12))
            return plm_fail(error, PLM_E_ARGUMENT,
                            "reflectance %g and transmittance %g in band %d: each from 0, both to 1", r, t, b);
    }
    if (!mesh->triangle_count) return plm_fail(error, PLM_E_DEGENERATE, "the mesh has no faces to absorb light");
    return PLM_OK;
}

static void normals(const plm_mesh *mesh, double (*normal)[3])
{
    for (size_t f = 0; f < mesh->triangle_count; f++) {
        const double *a = mesh->vertex[mesh->triangle[f][0]], *b = mesh->vertex[mesh->triangle[f][1]],
                     *c = mesh->vertex[mesh->triangle[f][2]];
        const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        plm_cross(u, v, normal[f]);
        if (!(plm_normalise(normal[f]) > 0)) normal[f][2] = 1;
    }
}

/* The sphere that the sources light: the caller's, or the one about the mesh's bounding box. */
static void place_sphere(light_run *run)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, half[3];
    for (size_t k = 0; k < run->mesh->vertex_count; k++)
        for (int i = 0; i < 3; i++) {
            low[i] = fmin(low[i], run->mesh->vertex[k][i]);
            high[i] = fmax(high[i], run->mesh->vertex[k][i]);
        }
    for (int i = 0; i < 3; i++) {
        run->centre[i] = 0.5 * (low[i] + high[i]);
        half[i] = 0.5 * (high[i] - low[i]);
    }
    run->radius = plm_norm(half) * 1.0001;
    run->gap = 1e-6 * run->radius; /* floats at that distance round at 1e-7 of it */
    if (!(run->options->radius > 0)) return;
    memcpy(run->centre, run->options->centre, sizeof run->centre);
    run->radius = run->options->radius;
}

/* Rays [part's share] of every source; thread t counts into count[t]. */
static void trace_part(light_run *run, int part, tally *count, int threads)
{
    const int sources = run->options->circles * run->options->around;
    const uint64_t key = plm_key(run->options->seed, 500 + (uint64_t)part);
    const uint64_t jobs = run->options->rays;
    draw_shifts(run, key);
    const uint64_t first = jobs * (uint64_t)part / PARTS, last = jobs * ((uint64_t)part + 1) / PARTS;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++) {
        const uint64_t begin = first + (last - first) * (uint64_t)t / (uint64_t)threads;
        const uint64_t end = first + (last - first) * ((uint64_t)t + 1) / (uint64_t)threads;
        for (uint64_t k = begin; k < end; k++)
            follow(run, key, (k - first) / (uint64_t)sources, (int)((k - first) % (uint64_t)sources), &count[t]);
    }
}

/* Sums of the groups over all threads, in units of energy; part sums are differences of these. */
static void group_sums(const tally *count, int threads, size_t faces, const int32_t *face_group, uint64_t *sum,
                       size_t group_count, uint64_t *all)
{
    memset(sum, 0, group_count * sizeof *sum);
    *all = 0;
    for (int t = 0; t < threads; t++)
        for (size_t f = 0; f < faces; f++) {
            *all += count[t].face[f];
            if (face_group && face_group[f] >= 0) sum[face_group[f]] += count[t].face[f];
        }
}

/* Mean of a group's parts times PARTS is its power; their scatter gives the standard error of it. */
typedef struct part_statistics {
    uint64_t before;
    double mean, squares; /* Welford */
} part_statistics;

static void add_part(part_statistics *statistics, int part, uint64_t sum)
{
    const double value = (double)(sum - statistics->before);
    const double change = value - statistics->mean;
    statistics->before = sum;
    statistics->mean += change / (part + 1);
    statistics->squares += change * (value - statistics->mean);
}

static double std_error(const part_statistics *statistics)
{
    return sqrt(PARTS * statistics->squares / (PARTS - 1));
}

static plm_status trace_all(light_run *run, const int32_t *face_group, size_t group_count, plm_light *light,
                            plm_error *error)
{
    const size_t faces = run->mesh->triangle_count;
    const double unit = run->options->power / ((double)run->options->rays * (double)PARCEL);
    enum { THREADS = 16 }; /* of counting, not of running: no sum depends on it */
    tally count[THREADS] = {{0}};
    part_statistics whole = {0}, *groups = plm_alloc_zero(group_count, sizeof *groups, error);
    uint64_t *sum = plm_alloc(group_count, sizeof *sum, error), all = 0;
    plm_status status = groups && sum ? PLM_OK : PLM_E_MEMORY;
    const int threads = faces < 2000000 ? THREADS : 2;
    for (int t = 0; t < threads && status == PLM_OK; t++) {
        count[t].face = plm_alloc_zero(faces, sizeof *count[t].face, error);
        if (!count[t].face) status = PLM_E_MEMORY;
    }
    for (int part = 0; part < PARTS && status == PLM_OK; part++) {
        trace_part(run, part, count, threads);
        group_sums(count, threads, faces, face_group, sum, group_count, &all);
        add_part(&whole, part, all);
        for (size_t g = 0; g < group_count; g++) add_part(&groups[g], part, sum[g]);
    }
    if (status == PLM_OK) {
        uint64_t escaped = 0;
        for (size_t f = 0; f < faces; f++) {
            uint64_t energy = 0;
            for (int t = 0; t < threads; t++) energy += count[t].face[f];
            light->face_power[f] = (double)energy * unit;
        }
        for (int t = 0; t < threads; t++) {
            escaped += count[t].escaped;
            light->ray_count += count[t].rays;
        }
        for (size_t g = 0; g < group_count; g++) {
            light->group_power[g] = (double)sum[g] * unit;
            light->group_std_error[g] = std_error(&groups[g]) * unit;
        }
        light->emitted = run->options->power;
        light->absorbed = (double)all * unit;
        light->absorbed_std_error = std_error(&whole) * unit;
        light->escaped = (double)escaped * unit;
    }
    for (int t = 0; t < threads; t++) plm_free(count[t].face);
    plm_free(groups);
    plm_free(sum);
    return status;
}

plm_status plm_light_trace(const plm_mesh *mesh, const int32_t *face_group, size_t group_count,
                           const plm_light_options *options, plm_light *light, plm_error *error)
{
    light_run run = {.mesh = mesh, .options = options};
    plm_rays *rays = NULL;
    plm_light made = {.face_count = mesh->triangle_count, .group_count = group_count};
    plm_status status = check(mesh, options, error);
    if (status != PLM_OK) return status;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++)
        run.absorptance[b] = fmax(1 - options->reflectance[b] - options->transmittance[b], 0);
    run.normal = plm_alloc(mesh->triangle_count, sizeof *run.normal, error);
    run.source = plm_alloc((size_t)(options->circles * options->around), sizeof *run.source, error);
    made.face_power = plm_alloc(mesh->triangle_count, sizeof *made.face_power, error);
    made.group_power = plm_alloc(group_count, sizeof *made.group_power, error);
    made.group_std_error = plm_alloc(group_count, sizeof *made.group_std_error, error);
    if (!run.normal || !run.source || !made.face_power || !made.group_power || !made.group_std_error)
        status = PLM_E_MEMORY;
    if (status == PLM_OK)
        status = plm_rays_build((const double(*)[3])mesh->vertex, mesh->vertex_count,
                                (const uint32_t(*)[3])mesh->triangle, 0, mesh->triangle_count, &rays, error);
    if (status == PLM_OK) {
        normals(mesh, run.normal);
        place_sphere(&run);
        place_sources(&run);
        run.rays = rays;
        status = trace_all(&run, face_group, group_count, &made, error);
    }
    if (status == PLM_OK)
        *light = made;
    else
        plm_light_free(&made);
    plm_rays_free(rays);
    plm_free(run.normal);
    plm_free(run.source);
    return status;
}

void plm_light_free(plm_light *light)
{
    if (!light) return;
    plm_free(light->face_power);
    plm_free(light->group_power);
    plm_free(light->group_std_error);
    *light = (plm_light){0};
}
