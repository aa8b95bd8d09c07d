/* simulate/light.c: absorbed light by Monte Carlo (laser-scanning paper, section on light absorption).
 *
 * A ray is a parcel of energy in three bands. Where it meets a face, a share is left there, and what remains is either reflected or
 * transmitted as a whole, by a draw in proportion to both. Energy is counted in whole numbers: sums then come out the same in any order
 * of threads, and nothing is lost. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/light_rays.h"

enum { PARTS = 16, MAXIMUM_DEPTH = 100 };

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

/* ---- The run ---------------------------------------------------------------------------------------------------- */

static plm_status check(const plm_mesh *mesh, const plm_light_options *options, plm_error *error)
{
    if (options->circles < 1 || options->around < 1 || options->circles * options->around > 100000)
        return plm_fail(error, PLM_E_ARGUMENT, "%d circles of %d sources", options->circles, options->around);
    if (options->depth < 1 || options->depth > MAXIMUM_DEPTH)
        return plm_fail(error, PLM_E_ARGUMENT, "depth %d; 1 to %d was expected", options->depth, MAXIMUM_DEPTH);
    if (!(options->power >= 0 && isfinite(options->power)))
        return plm_fail(error, PLM_E_ARGUMENT, "a power of %g W", options->power);
    if (!(options->irradiance >= 0 && isfinite(options->irradiance)))
        return plm_fail(error, PLM_E_ARGUMENT, "an irradiance of %g W/m2", options->irradiance);
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
static void place_sphere(plm_light_run *run)
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

/* The part's rays of every source. Who counts which batch is left to chance: sums of whole numbers come out the same. */
static void trace_part(plm_light_run *run, int part, plm_ray_batch *batch, plm_light_tally *count)
{
    const uint64_t sources = (uint64_t)(run->options->circles * run->options->around), rays = run->options->rays;
    const uint64_t key = plm_key(run->options->seed, 500 + (uint64_t)part);
    const uint64_t here = rays * ((uint64_t)part + 1) / PARTS - rays * (uint64_t)part / PARTS;
    const uint64_t batches =
        (here + sources * PLM_RAY_BATCH - 1) / (sources * PLM_RAY_BATCH); /* of the source with most rays */
    plm_light_shift(run, key);
#pragma omp parallel for schedule(dynamic)
    for (uint64_t job = 0; job < sources * batches; job++) {
        const uint64_t source = job / batches, all = (here + sources - 1 - source) / sources;
        const uint64_t first = all * (job % batches) / batches, last = all * (job % batches + 1) / batches;
        const int thread = omp_get_thread_num();
        plm_light_start(run, (int)source, first, (size_t)(last - first), &batch[thread]);
        plm_light_follow(run, key, &batch[thread], &count[thread]);
    }
}

/* Sums of the groups over all threads, in units of energy; part sums are differences of these. */
static void group_sums(const plm_light_tally *count, int threads, size_t faces, const int32_t *face_group,
                       uint64_t *sum, size_t group_count, uint64_t *all)
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

/* What the threads have counted, in watts. */
static void collect(const plm_light_run *run, const plm_light_tally *count, int threads, plm_light *light)
{
    uint64_t escaped = 0, absorbed = 0;
    const double power = run->options->irradiance > 0 ? run->options->irradiance * PLM_PI * run->radius * run->radius
                                                      : run->options->power;
    const double unit = power / ((double)run->options->rays * (double)PLM_PARCEL);
    for (size_t f = 0; f < light->face_count; f++) {
        uint64_t energy = 0;
        for (int t = 0; t < threads; t++) energy += count[t].face[f];
        light->face_power[f] = (double)energy * unit;
        absorbed += energy;
    }
    for (int t = 0; t < threads; t++) {
        escaped += count[t].escaped;
        light->ray_count += count[t].rays;
    }
    light->emitted = power;
    light->absorbed = (double)absorbed * unit;
    light->escaped = (double)escaped * unit;
    light->absorbed_std_error *= unit;
    for (size_t g = 0; g < light->group_count; g++) {
        light->group_power[g] *= unit;
        light->group_std_error[g] *= unit;
    }
}

/* All parts, one after the other; sums of groups and their errors come in units of energy. */
static plm_status trace_parts(plm_light_run *run, const int32_t *face_group, plm_ray_batch *batch,
                              plm_light_tally *count, int threads, plm_light *light, plm_error *error)
{
    part_statistics whole = {0}, *groups = plm_alloc_zero(light->group_count, sizeof *groups, error);
    uint64_t *sum = plm_alloc(light->group_count, sizeof *sum, error), all = 0;
    const bool has_room = groups && sum;
    for (int part = 0; part < PARTS && has_room; part++) {
        trace_part(run, part, batch, count);
        group_sums(count, threads, light->face_count, face_group, sum, light->group_count, &all);
        add_part(&whole, part, all);
        for (size_t g = 0; g < light->group_count; g++) add_part(&groups[g], part, sum[g]);
    }
    for (size_t g = 0; has_room && g < light->group_count; g++) {
        light->group_power[g] = (double)sum[g];
        light->group_std_error[g] = std_error(&groups[g]);
    }
    light->absorbed_std_error = std_error(&whole);
    plm_free(groups);
    plm_free(sum);
    return has_room ? PLM_OK : PLM_E_MEMORY;
}

static plm_status trace_all(plm_light_run *run, const int32_t *face_group, plm_light *light, plm_error *error)
{
    const int threads = omp_get_max_threads();
    plm_light_tally *count = plm_alloc_zero((size_t)threads, sizeof *count, error);
    plm_ray_batch *batch = plm_alloc((size_t)threads, sizeof *batch, error);
    plm_status status = count && batch ? PLM_OK : PLM_E_MEMORY;
    for (int t = 0; t < threads && status == PLM_OK; t++) {
        count[t].face = plm_alloc_zero(light->face_count, sizeof *count[t].face, error);
        if (!count[t].face) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) status = trace_parts(run, face_group, batch, count, threads, light, error);
    if (status == PLM_OK) collect(run, count, threads, light);
    for (int t = 0; count && t < threads; t++) plm_free(count[t].face);
    plm_free(count);
    plm_free(batch);
    return status;
}

plm_status plm_light_trace(const plm_mesh *mesh, const int32_t *face_group, size_t group_count,
                           const plm_light_options *options, plm_light *light, plm_error *error)
{
    plm_light_run run = {.mesh = mesh, .options = options};
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
        plm_light_place_sources(&run);
        run.rays = rays;
        status = trace_all(&run, face_group, &made, error);
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
