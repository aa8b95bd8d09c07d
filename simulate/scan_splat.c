/* simulate/scan_splat.c: points such as centres of 3D gaussians fitted to photographs: uneven density, noise along the
 * normal, blurred and greyish rims, floaters; and, where wanted, the gaussians themselves: flat, in the surface, some
 * needles. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/scan.h"

/* Of the spacing: how far the centres of gaussians keep off a rim. A disc that was fitted to photographs reaches past its centre
 * by some 0.85 of its scale, which is 0.62 of the spacing in the mean (see gaussian). */
static const double RIM_GAP = 0.53;

size_t plm_splat_positions(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3])
{
    /* a spiral of even steps in height: from a little below the middle to nearly overhead */
    for (int k = 0; k < options->views; k++) {
        const double height = -0.15 + 1.1 * (k + 0.5) / options->views, azimuth = k * plm_radians(137.50776405);
        const double flat = sqrt(fmax(1 - height * height, 0)), radius = 3 * stage->radius;
        position[k][0] = stage->centre[0] + radius * flat * cos(azimuth);
        position[k][1] = stage->centre[1] + radius * flat * sin(azimuth);
        position[k][2] = stage->centre[2] + radius * height;
    }
    return (size_t)options->views;
}

/* Density at a point against its largest value: a few waves of random direction make it vary smoothly over the plant,
 * from 1 / unevenness to 1. */
static double density_at(const plm_stage_set *stage, const plm_scan_options *options, const double point[3])
{
    enum { WAVES = 5 };
    const uint64_t key = plm_key(options->seed, 50);
    double sum = 0;
    for (uint64_t k = 0; k < WAVES; k++) {
        double phase = 2 * PLM_PI * plm_uniform_at(key, 8 * k);
        for (uint64_t i = 0; i < 3; i++)
            phase += plm_normal_at(key, 4 * k + 1 + i) * 2.2 * (point[i] - stage->centre[i]) / stage->radius;
        sum += cos(phase);
    }
    const double level = 0.5 + 0.5 * fmin(fmax(sum / 2.2, -1), 1);
    return pow(options->unevenness, level - 1);
}

typedef struct splat_scan {
    const plm_stage_set *stage;
    const plm_scan_options *options;
    plm_face_sampler sampler;
    size_t views;
    double (*position)[3];
    uint64_t key;
    double spacing; /* where the density is largest */
} splat_scan;

static bool is_seen(const splat_scan *splat, uint32_t face, const double point[3], uint64_t start)
{
    double normal[3], off[3], direction[3];
    plm_face_normal(&splat->stage->mesh, face, normal);
    for (size_t k = 0; k < splat->views; k++) {
        const double *from = splat->position[(start + 7 * k) % splat->views];
        plm_hit hit;
        for (int i = 0; i < 3; i++) direction[i] = from[i] - point[i];
        const double side = plm_dot(normal, direction) < 0 ? -1 : 1;
        for (int i = 0; i < 3; i++) {
            off[i] = point[i] + side * 2e-5 * normal[i];
            direction[i] = from[i] - off[i];
        }
        if (!plm_rays_first(splat->stage->rays, off, direction, 0, 1, &hit)) return true;
    }
    return false;
}

/* Distance of a point of a face to its blade's rim: that of the nearest corner is good to an edge's length. */
static double rim_distance(const plm_stage_set *stage, uint32_t face, const double point[3])
{
    double sum = 0, weights = 0;
    if (face >= stage->plant_faces) return INFINITY;
    for (int k = 0; k < 3; k++) {
        const uint32_t corner = stage->mesh.triangle[face][k];
        double squared = 1e-16;
        for (int i = 0; i < 3; i++) squared += pow(point[i] - stage->mesh.vertex[corner][i], 2);
        const float rim = stage->plant->vertex_rim[corner];
        if (isinf(rim)) return INFINITY;
        sum += (double)rim / squared;
        weights += 1 / squared;
    }
    return sum / weights;
}

/* Blur of the point: along the normal, a little along the surface, more at the rim; rims take on some grey. */
static void blur(const splat_scan *splat, uint64_t at, double rim, double spacing, const double normal[3],
                 const double point[3], plm_sample *sample)
{
    double u[3], v[3];
    const double sigma = splat->options->noise, edge = exp(-rim / (1.5 * spacing));
    const double out = sigma * plm_normal_at(splat->key, at + 3), along = sigma * (0.25 + 0.6 * edge);
    const double a = along * plm_normal_at(splat->key, at + 4), b = along * plm_normal_at(splat->key, at + 5);
    plm_frame_of_axis(normal, u, v);
    for (int i = 0; i < 3; i++) sample->xyz[i] = (float)(point[i] + out * normal[i] + a * u[i] + b * v[i]);
    for (int i = 0; i < 3; i++) sample->rgb[i] = (uint8_t)((1 - 0.6 * edge) * sample->rgb[i] + 0.6 * edge * 150);
}

/* Candidate number k; true when it is a point: dense enough there, seen, and (gaussians) far enough from the rim. */
static bool candidate(const splat_scan *splat, uint64_t k, plm_sample *sample)
{
    const uint64_t at = 16 * k;
    double point[3], normal[3];
    const uint32_t face =
        plm_face_sampler_draw(&splat->sampler, plm_uniform_at(splat->key, at), plm_uniform_at(splat->key, at + 1),
                              plm_uniform_at(splat->key, at + 2), point);
    const double density = density_at(splat->stage, splat->options, point), spacing = splat->spacing / sqrt(density);
    if (plm_uniform_at(splat->key, at + 3) > density) return false;
    const double rim = rim_distance(splat->stage, face, point);
    if (splat->options->is_gaussians && rim < RIM_GAP * spacing) return false;
    if (!is_seen(splat, face, point, plm_mix(k))) return false;
    plm_face_normal(&splat->stage->mesh, face, normal);
    plm_sample_label(splat->stage, face, NULL, splat->options->seed, sample);
    blur(splat, 8 * k, rim, spacing, normal, point, sample);
    return true;
}

static plm_status gather(const splat_scan *splat, size_t wanted, plm_samples *samples, plm_error *error)
{
    enum { CHUNK = 8192, ROUNDS = 4000 };
    plm_status status = PLM_OK;
    plm_sample *found = plm_alloc(CHUNK, sizeof *found, error);
    bool *is_point = plm_alloc(CHUNK, sizeof *is_point, error);
    if (!found || !is_point) status = PLM_E_MEMORY;
    size_t plant_points = 0;
    for (uint64_t round = 0; round < ROUNDS && status == PLM_OK && plant_points < wanted; round++) {
#pragma omp parallel for schedule(static)
        for (int k = 0; k < CHUNK; k++) is_point[k] = candidate(splat, round * CHUNK + (uint64_t)k, &found[k]);
        for (int k = 0; k < CHUNK && status == PLM_OK && plant_points < wanted; k++) {
            if (!is_point[k]) continue;
            plant_points += found[k].label != PLM_LABEL_GROUND;
            status = plm_samples_add(samples, &found[k], error);
        }
    }
    plm_free(found);
    plm_free(is_point);
    return status;
}

/* Quaternion (w x y z) of the rotation whose columns are a, b, c. Shepperd's method. */
static void quaternion(const double a[3], const double b[3], const double c[3], float q[4])
{
    const double m[3][3] = {{a[0], b[0], c[0]}, {a[1], b[1], c[1]}, {a[2], b[2], c[2]}};
    const double four[4] = {1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2],
                            1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2]};
    int largest = 0;
    for (int k = 1; k < 4; k++)
        if (four[k] > four[largest]) largest = k;
    const double r = sqrt(four[largest]), s = 0.5 / r;
    const double wx = (m[2][1] - m[1][2]) * s, wy = (m[0][2] - m[2][0]) * s, wz = (m[1][0] - m[0][1]) * s;
    const double xy = (m[0][1] + m[1][0]) * s, xz = (m[0][2] + m[2][0]) * s, yz = (m[1][2] + m[2][1]) * s;
    const double table[4][4] = {
        {0.5 * r, wx, wy, wz}, {wx, 0.5 * r, xy, xz}, {wy, xy, 0.5 * r, yz}, {wz, xz, yz, 0.5 * r}};
    for (int k = 0; k < 4; k++) q[k] = (float)table[largest][k];
}

/* The gaussian of a point: flat in the surface and about as wide as the points are apart; one in twenty is a needle;
 * floaters are round, large and faint. */
static void gaussian(const splat_scan *splat, const plm_sample *sample, uint64_t k, float log_scale[3],
                     float rotation[4], float *logit_opacity)
{
    const uint64_t key = plm_key(splat->options->seed, 52);
    const bool is_floater = sample->face == PLM_NO_FACE;
    double draw[6], normal[3], u[3], v[3], point[3];
    for (uint64_t i = 0; i < 6; i++) draw[i] = plm_uniform_at(key, 16 * k + i);
    for (int i = 0; i < 3; i++) {
        normal[i] = (double)sample->normal[i];
        point[i] = (double)sample->xyz[i];
    }
    const double spacing = splat->spacing / sqrt(density_at(splat->stage, splat->options, point));
    double large = spacing * (0.45 + 0.5 * draw[0]), middle = large * (0.55 + 0.45 * draw[1]),
           small = large * (0.03 + 0.1 * draw[2]);
    if (draw[3] < 0.05) { /* a needle */
        large *= 2.5;
        middle *= 0.35;
    }
    if (is_floater) {
        large = middle = small = splat->spacing * (1 + 6 * draw[0]);
        small *= 0.5;
    }
    log_scale[0] = (float)log(large);
    log_scale[1] = (float)log(middle);
    log_scale[2] = (float)log(small);
    double turned[3], across[3];
    plm_frame_of_axis(normal, u, v);
    const double c = cos(2 * PLM_PI * draw[4]), s = sin(2 * PLM_PI * draw[4]);
    for (int i = 0; i < 3; i++) turned[i] = c * u[i] + s * v[i];
    plm_cross(normal, turned, across);
    quaternion(turned, across, normal, rotation);
    for (int i = 0; i < 4; i++) rotation[i] *= (float)(0.5 + 1.5 * draw[5]); /* files do not keep them at length 1 */
    const double opacity = is_floater ? 0.02 + 0.25 * draw[3] : 0.6 + 0.39 * draw[3];
    *logit_opacity = (float)log(opacity / (1 - opacity));
}

static plm_status make_gaussians(const splat_scan *splat, const plm_samples *samples, plm_gaussians *out,
                                 plm_error *error)
{
    out->log_scale = plm_alloc(samples->count, sizeof *out->log_scale, error);
    out->rotation = plm_alloc(samples->count, sizeof *out->rotation, error);
    out->logit_opacity = plm_alloc(samples->count, sizeof *out->logit_opacity, error);
    if (!out->log_scale || !out->rotation || !out->logit_opacity) return PLM_E_MEMORY;
    for (size_t k = 0; k < samples->count; k++)
        gaussian(splat, &samples->sample[k], k, out->log_scale[k], out->rotation[k], &out->logit_opacity[k]);
    return PLM_OK;
}

plm_status plm_scan_splat(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                          plm_scan *scan, plm_error *error)
{
    const double area = plm_plant_area(stage->plant);
    const size_t wanted = options->points ? options->points : (size_t)(options->density * area + 0.5);
    splat_scan splat = {.stage = stage, .options = options, .key = plm_key(options->seed, 51)};
    /* the mean of unevenness^(level - 1) over levels 0 to 1 is (1 - 1/u) / ln u */
    const double mean = (1 - 1 / options->unevenness) / log(options->unevenness);
    splat.spacing = sqrt(mean * area / (double)(wanted ? wanted : 1));
    splat.position = plm_alloc(PLM_POSITIONS_MAXIMUM, sizeof *splat.position, error);
    plm_status status = splat.position ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        splat.views = plm_splat_positions(stage, options, splat.position);
        status = plm_face_sampler_make(&stage->mesh, stage->mesh.triangle_count, &splat.sampler, error);
    }
    if (status == PLM_OK) status = gather(&splat, wanted, samples, error);
    if (status == PLM_OK) {
        scan->hits_per_area = (double)samples->count / area;
        status = plm_add_floaters(stage, options->outliers, options->seed, samples, error);
    }
    if (status == PLM_OK && options->is_gaussians) status = make_gaussians(&splat, samples, &scan->splat, error);
    plm_face_sampler_free(&splat.sampler);
    plm_free(splat.position);
    return status;
}
