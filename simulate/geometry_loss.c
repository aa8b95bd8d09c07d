/* simulate/geometry_loss.c: what loss of geometry does to traits (laser-scanning paper): faces are removed, the rest is scanned by the
 * dome and lit. Rays and light stay those of the intact plant, so that a step shows the loss and not another draw. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/smoothness.h"
#include "simulate/build.h"
#include "simulate/scan.h"

struct plm_thinning {
    const plm_virtual_plant *plant;
    plm_thinning_options options;
    plm_scan_options dome;
    plm_stage_set intact;   /* the stage of the intact plant: where the dome stands */
    uint64_t rays;          /* a scanner */
    size_t ellipsoid_faces; /* of the half ellipsoid: area and hits of each face */
    double *ellipsoid_area;
    uint32_t *ellipsoid_hits;
    double full_density;                   /* hits per m2 of a fully visible half ellipsoid of the plant's size */
    double sf_mean, sf_variance, sf_count; /* of the intact plant */
};

const char *plm_loss_name(plm_loss loss)
{
    static const char *const name[PLM_LOSS_COUNT] = {"random", "inside-out", "outside-in"};
    return loss < PLM_LOSS_COUNT ? name[loss] : "unknown";
}

const char *plm_thinning_trait_name(plm_thinning_trait trait)
{
    static const char *const name[PLM_THIN_COUNT] = {"plant_height",
                                                     "pca1",
                                                     "pca2",
                                                     "convex_hull_volume",
                                                     "absorbed_radiation",
                                                     "surface_area",
                                                     "visible_area",
                                                     "visible_face_share",
                                                     "points",
                                                     "sf_mean",
                                                     "sf_sd",
                                                     "sf_boundary_share",
                                                     "sf_welch_t"};
    return trait < PLM_THIN_COUNT ? name[trait] : "unknown";
}

/* ---- Which faces go ---------------------------------------------------------------------------------------------- */

typedef struct ranked_face {
    double rank;
    uint32_t face;
} ranked_face;

static int by_rank(const void *a, const void *b)
{
    const ranked_face *p = a, *q = b;
    if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

/* A copy of the plant without its first `removed` faces in the order of the loss. Shares the vertices. */
static plm_status remove_faces(const plm_virtual_plant *plant, plm_loss loss, size_t removed, uint64_t seed,
                               plm_virtual_plant *rest, plm_error *error)
{
    const size_t count = plant->mesh.triangle_count;
    ranked_face *order = plm_alloc(count, sizeof *order, error);
    uint8_t *is_gone = plm_alloc_zero(count, 1, error);
    *rest = *plant;
    rest->mesh.triangle = plm_alloc(count, sizeof *rest->mesh.triangle, error);
    rest->mesh.face_organ = plm_alloc(count, sizeof *rest->mesh.face_organ, error);
    rest->face_label = plm_alloc(count, 1, error);
    rest->face_leaflet = plm_alloc(count, sizeof *rest->face_leaflet, error);
    rest->mesh.triangle_count = 0;
    const bool has_room =
        order && is_gone && rest->mesh.triangle && rest->mesh.face_organ && rest->face_label && rest->face_leaflet;
    const uint64_t key = plm_key(seed, 70);
    for (size_t f = 0; has_room && f < count; f++) {
        double middle[2] = {0, 0};
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 2; i++) middle[i] += plant->mesh.vertex[plant->mesh.triangle[f][k]][i] / 3;
        const double away = hypot(middle[0], middle[1]); /* from the axis over the stem's base */
        const double rank = loss == PLM_LOSS_RANDOM       ? plm_uniform_at(key, f)
                            : loss == PLM_LOSS_INSIDE_OUT ? away
                                                          : -away;
        order[f] = (ranked_face){rank, (uint32_t)f};
    }
    if (has_room) qsort(order, count, sizeof *order, by_rank);
    for (size_t k = 0; has_room && k < removed; k++) is_gone[order[k].face] = 1;
    for (size_t f = 0; has_room && f < count; f++) {
        if (is_gone[f]) continue;
        const size_t at = rest->mesh.triangle_count++;
        memcpy(rest->mesh.triangle[at], plant->mesh.triangle[f], sizeof *rest->mesh.triangle);
        rest->mesh.face_organ[at] = plant->mesh.face_organ[f];
        rest->face_label[at] = plant->face_label[f];
        rest->face_leaflet[at] = plant->face_leaflet[f];
    }
    plm_free(order);
    plm_free(is_gone);
    return has_room ? PLM_OK : PLM_E_MEMORY;
}

static void free_rest(plm_virtual_plant *rest)
{
    plm_free(rest->mesh.triangle);
    plm_free(rest->mesh.face_organ);
    plm_free(rest->face_label);
    plm_free(rest->face_leaflet);
}

/* ---- What is measured --------------------------------------------------------------------------------------------- */

/* Hits of each face against a face that every scanner of its side sees: the paper's rule. */
static plm_status visible(const plm_thinning *thinning, const plm_virtual_plant *rest, const plm_samples *samples,
                          double *value, plm_error *error)
{
    size_t *hits = plm_alloc_zero(rest->mesh.triangle_count, sizeof *hits, error);
    if (!hits) return PLM_E_MEMORY;
    for (size_t k = 0; k < samples->count; k++) hits[samples->sample[k].face]++;
    size_t visible_faces = 0;
    for (size_t f = 0; f < rest->mesh.triangle_count; f++) {
        double normal[3];
        const double area = plm_face_normal(&rest->mesh, f, normal);
        /* area x density / full density; leaves are hit on both sides, and a face has no more to show than its area */
        const double seen = fmin((double)hits[f] / thinning->full_density, area);
        value[PLM_THIN_AREA] += area;
        value[PLM_THIN_VISIBLE_AREA] += seen;
        visible_faces += seen > 0.5 * area;
    }
    value[PLM_THIN_VISIBLE_FACES] = (double)visible_faces / (double)rest->mesh.triangle_count;
    plm_free(hits);
    return PLM_OK;
}

/* Extent of the points' ground projection along its principal axes. */
static void ground_axes(const plm_samples *samples, double *value)
{
    double mean[2] = {0, 0}, matrix[6] = {0}, variance[3], axis[3][3];
    const double count = (double)samples->count;
    for (size_t k = 0; k < samples->count; k++)
        for (int i = 0; i < 2; i++) mean[i] += (double)samples->sample[k].xyz[i] / count;
    for (size_t k = 0; k < samples->count; k++) {
        const double x = (double)samples->sample[k].xyz[0] - mean[0], y = (double)samples->sample[k].xyz[1] - mean[1];
        matrix[0] += x * x / count;
        matrix[1] += x * y / count;
        matrix[3] += y * y / count;
    }
    plm_eigen3(matrix, variance, axis);
    for (int i = 0; i < 2; i++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < samples->count; k++) {
            const double at =
                (double)samples->sample[k].xyz[0] * axis[i][0] + (double)samples->sample[k].xyz[1] * axis[i][1];
            low = fmin(low, at);
            high = fmax(high, at);
        }
        value[i ? PLM_THIN_PCA2 : PLM_THIN_PCA1] = high - low;
    }
}

static void smoothness_statistics(const float *factor, size_t count, double *value, double *variance)
{
    double mean = 0, squares = 0;
    size_t boundary = 0;
    for (size_t k = 0; k < count; k++) {
        const double change = (double)factor[k] - mean;
        mean += change / (double)(k + 1);
        squares += change * ((double)factor[k] - mean);
        boundary += factor[k] > 0.5F;
    }
    *variance = count > 1 ? squares / (double)(count - 1) : 0;
    value[PLM_THIN_SF_MEAN] = mean;
    value[PLM_THIN_SF_SD] = sqrt(*variance);
    value[PLM_THIN_SF_BOUNDARY] = (double)boundary / (double)count;
}

/* Height, axes, hull and smoothness of the scanned points. variance: of the smoothness factor. */
static plm_status of_points(const plm_thinning *thinning, const plm_samples *samples, double *value, double *variance,
                            plm_error *error)
{
    float(*xyz)[3] = plm_alloc(samples->count, sizeof *xyz, error);
    float *factor = plm_alloc(samples->count, sizeof *factor, error);
    double area;
    plm_status status = xyz && factor ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        value[PLM_THIN_HEIGHT] = -INFINITY;
        for (size_t k = 0; k < samples->count; k++) {
            memcpy(xyz[k], samples->sample[k].xyz, sizeof *xyz);
            value[PLM_THIN_HEIGHT] = fmax(value[PLM_THIN_HEIGHT], (double)xyz[k][2]);
        }
        value[PLM_THIN_POINTS] = (double)samples->count;
        ground_axes(samples, value);
        const plm_neighbour_measures measures = {.smoothness = factor};
        status = plm_neighbour_pass((const float(*)[3])xyz, samples->count, (size_t)thinning->options.neighbours,
                                    &measures, error);
    }
    if (status == PLM_OK) smoothness_statistics(factor, samples->count, value, variance);
    if (status == PLM_OK)
        status = thinning->options.hull((const float(*)[3])xyz, samples->count, &value[PLM_THIN_HULL_VOLUME], &area,
                                        NULL, error);
    plm_free(xyz);
    plm_free(factor);
    return status;
}

static plm_status absorbed(const plm_thinning *thinning, const plm_virtual_plant *rest, double *value, plm_error *error)
{
    plm_light_options options;
    plm_light light;
    plm_light_defaults(&options);
    options.seed = thinning->options.seed;
    options.rays = thinning->options.light_rays;
    memcpy(options.centre, thinning->intact.centre, sizeof options.centre);
    options.radius = thinning->intact.radius; /* the same light for all steps */
    const plm_status status = plm_light_trace(&rest->mesh, NULL, 0, &options, &light, error);
    if (status != PLM_OK) return status;
    *value = light.absorbed;
    plm_light_free(&light);
    return PLM_OK;
}

/* Scans the rest with the intact plant's dome. */
static plm_status scan_rest(const plm_thinning *thinning, const plm_virtual_plant *rest, plm_samples *samples,
                            plm_error *error)
{
    plm_stage_set stage = {0};
    size_t hits = 0;
    plm_status status = plm_stage_make(rest, &thinning->dome, &stage, error);
    if (status == PLM_OK) {
        memcpy(stage.target, thinning->intact.target, sizeof stage.target);
        stage.target_radius = thinning->intact.target_radius;
        status = plm_dome_cast(&stage, &thinning->dome, thinning->rays, samples, &hits, error);
    }
    if (status == PLM_OK && samples->count < 20)
        status = plm_fail(error, PLM_E_DEGENERATE, "only %zu rays met what is left of the plant", samples->count);
    plm_stage_free(&stage);
    return status;
}

static plm_status measure(const plm_thinning *thinning, const plm_virtual_plant *rest, double *value, double *variance,
                          plm_error *error)
{
    plm_samples samples = {0};
    memset(value, 0, PLM_THIN_COUNT * sizeof *value);
    plm_status status = scan_rest(thinning, rest, &samples, error);
    if (status == PLM_OK) status = visible(thinning, rest, &samples, value, error);
    if (status == PLM_OK) status = of_points(thinning, &samples, value, variance, error);
    if (status == PLM_OK) status = absorbed(thinning, rest, &value[PLM_THIN_ABSORBED], error);
    plm_free(samples.sample);
    return status;
}

/* ---- The study ----------------------------------------------------------------------------------------------------- */

static plm_status keep_ellipsoid(plm_thinning *thinning, const plm_virtual_plant *dome, const plm_samples *samples,
                                 plm_error *error)
{
    const size_t count = dome->mesh.triangle_count;
    thinning->ellipsoid_area = plm_alloc(count, sizeof *thinning->ellipsoid_area, error);
    thinning->ellipsoid_hits = plm_alloc_zero(count, sizeof *thinning->ellipsoid_hits, error);
    if (!thinning->ellipsoid_area || !thinning->ellipsoid_hits) return PLM_E_MEMORY;
    thinning->ellipsoid_faces = count;
    for (size_t f = 0; f < count; f++) {
        double normal[3];
        thinning->ellipsoid_area[f] = plm_face_normal(&dome->mesh, f, normal);
    }
    for (size_t k = 0; k < samples->count; k++) thinning->ellipsoid_hits[samples->sample[k].face]++;
    return PLM_OK;
}

/* Hits per area on a half ellipsoid of the plant's width and height, from the same dome. */
static plm_status full_density(plm_thinning *thinning, plm_error *error)
{
    plm_builder builder;
    plm_virtual_plant dome;
    plm_samples samples = {0};
    const plm_true_plant *whole = &thinning->plant->whole;
    const double radius = 0.5 * whole->width, stretch = whole->height / radius;
    /* faces of about 125 mm2, the middle of the paper's classes: 1536 faces at resolution 2 */
    const double surface = 2 * PLM_PI * radius * (radius + 2 * whole->height) / 3;
    const double resolution = fmin(fmax(2 * sqrt(surface / (1536 * 125e-6)), 2), 8);
    plm_builder_start(&builder, "half ellipsoid", &(plm_plant_options){.resolution = resolution}, &dome, error);
    builder.label = PLM_LABEL_LEAF;
    builder.organ = 0;
    plm_build_spheroid(&builder, (double[3]){0, 0, 0}, radius, stretch);
    plm_status status = builder.status;
    if (status == PLM_OK) { /* keep the upper half */
        size_t kept = 0;
        for (size_t f = 0; f < dome.mesh.triangle_count; f++) {
            const uint32_t *t = dome.mesh.triangle[f];
            const double lowest =
                fmin(dome.mesh.vertex[t[0]][2], fmin(dome.mesh.vertex[t[1]][2], dome.mesh.vertex[t[2]][2]));
            if (lowest > -1e-9) memmove(dome.mesh.triangle[kept++], t, sizeof *dome.mesh.triangle);
        }
        dome.mesh.triangle_count = kept;
        status = scan_rest(thinning, &dome, &samples, error);
    }
    if (status == PLM_OK) status = keep_ellipsoid(thinning, &dome, &samples, error);
    if (status == PLM_OK) thinning->full_density = (double)samples.count / plm_plant_area(&dome);
    plm_free(samples.sample);
    if (builder.status == PLM_OK) plm_virtual_plant_free(&dome);
    plm_builder_finish(&builder);
    return status;
}

plm_status plm_thinning_start(const plm_virtual_plant *plant, const plm_thinning_options *options,
                              plm_thinning **thinning, plm_error *error)
{
    plm_thinning *made = plm_alloc_zero(1, sizeof *made, error);
    double value[PLM_THIN_COUNT];
    if (!made) return PLM_E_MEMORY;
    made->plant = plant;
    made->options = *options;
    if (made->options.density == 0) made->options.density = 0.105e6;
    if (made->options.light_rays == 0) made->options.light_rays = 1000000;
    if (made->options.neighbours == 0) made->options.neighbours = 16;
    made->dome = (plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = options->seed, .dome_radius = 3.6};
    const size_t wanted = (size_t)(made->options.density * plm_plant_area(plant));
    plm_status status =
        options->hull ? PLM_OK : plm_fail(error, PLM_E_ARGUMENT, "no function for convex hulls was given");
    if (status == PLM_OK) status = plm_stage_make(plant, &made->dome, &made->intact, error);
    if (status == PLM_OK) status = plm_dome_rays(&made->intact, &made->dome, wanted, &made->rays, error);
    if (status == PLM_OK) status = full_density(made, error);
    if (status == PLM_OK) status = measure(made, plant, value, &made->sf_variance, error);
    if (status == PLM_OK) {
        made->sf_mean = value[PLM_THIN_SF_MEAN];
        made->sf_count = value[PLM_THIN_POINTS];
        *thinning = made;
    } else {
        plm_thinning_free(made);
    }
    return status;
}

void plm_thinning_free(plm_thinning *thinning)
{
    if (!thinning) return;
    plm_stage_free(&thinning->intact);
    plm_free(thinning->ellipsoid_area);
    plm_free(thinning->ellipsoid_hits);
    plm_free(thinning);
}

void plm_thinning_ellipsoid(const plm_thinning *thinning, const double **area, const uint32_t **hits, size_t *count)
{
    *area = thinning->ellipsoid_area;
    *hits = thinning->ellipsoid_hits;
    *count = thinning->ellipsoid_faces;
}

plm_status plm_thinning_step(const plm_thinning *thinning, plm_loss loss, double loss_percent,
                             double value[PLM_THIN_COUNT], plm_error *error)
{
    plm_virtual_plant rest;
    double measured[PLM_THIN_COUNT], variance;
    if (!(loss_percent >= 0 && loss_percent < 100) || loss >= PLM_LOSS_COUNT)
        return plm_fail(error, PLM_E_ARGUMENT, "a loss of %g %%; 0 to below 100 was expected", loss_percent);
    const size_t removed = (size_t)(loss_percent / 100 * (double)thinning->plant->mesh.triangle_count + 0.5);
    plm_status status = remove_faces(thinning->plant, loss, removed, thinning->options.seed, &rest, error);
    if (status == PLM_OK) status = measure(thinning, &rest, measured, &variance, error);
    if (status == PLM_OK) {
        /* Welch: of two samples of unlike variance */
        const double spread = variance / measured[PLM_THIN_POINTS] + thinning->sf_variance / thinning->sf_count;
        measured[PLM_THIN_SF_T] = spread > 0 ? (measured[PLM_THIN_SF_MEAN] - thinning->sf_mean) / sqrt(spread) : 0;
        memcpy(value, measured, sizeof measured);
    }
    free_rest(&rest);
    return status;
}
