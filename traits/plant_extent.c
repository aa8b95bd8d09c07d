/* traits/plant_extent.c: how wide a plant is: bounding box, largest horizontal distance, extents along principal axes (laser-scanning
 * paper, PCA1 and PCA2 of the ground projection). Extents are differences of extremes (traits/extreme.c): condition 1. The axes
 * are area-weighted; where two eigenvalues are nearly equal the axes, not the plant, are ill-determined, and the standard
 * error holds how the extent changes as the axis turns. */
#include "cloud/linear.h"
#include "cloud/voxel.h"
#include "traits/extreme.h"
#include "traits/families.h"
#include "traits/scene.h"

#include <math.h>
#include <string.h>

/* Voxels along the plant's longest side for its second moments; fewer where more than a share of them has one point. */
enum { FINEST_VOXELS = 200, COARSEST_VOXELS = 50 };
static const double most_lonely = 0.3;
/* Turn of the axis times relative gap of the eigenvalues, radians: 0.006 clean, 0.013 in noise, on virtual plants. */
static const double axis_turn = 0.012;
/* A pair of points that is wider apart than the surface there by this factor, and by so many SD of noise at each end, holds stray
 * points. */
static const double stray_share = 1.02, stray_noise = 3;

/* end: out, both ends, may be NULL. known: NULL, or ends in nearly the same direction, whose sampling is taken over. */
static plm_status extent_between(const plm_scene *scene, const double axis[3], const plm_extreme *known,
                                 plm_extreme end[2], double *extent, double *std_error, plm_error *error)
{
    plm_extreme found[2];
    plm_status status = PLM_OK;
    for (int i = 0; i < 2 && status == PLM_OK; i++) {
        const double sign = i ? -1 : 1, direction[3] = {sign * axis[0], sign * axis[1], sign * axis[2]};
        const plm_extreme_options options = {.sampling = known ? &known[i].sampling : NULL,
                                             .disc = scene->sampling.extent};
        status = plm_extreme_along((const float(*)[3])scene->plant, scene->plant_count, direction, &options, &found[i],
                                   error);
    }
    if (status != PLM_OK) return status;
    if (end) memcpy(end, found, sizeof found);
    *extent = found[0].value + found[1].value;
    *std_error = hypot(found[0].std_error, found[1].std_error);
    return PLM_OK;
}

static plm_status extent_along(const plm_scene *scene, const double axis[3], double *extent, double *std_error,
                               plm_error *error)
{
    return extent_between(scene, axis, NULL, NULL, extent, std_error, error);
}

static plm_status box_length(const plm_scene *scene, int axis, plm_estimate *out, plm_error *error)
{
    double direction[3] = {0};
    direction[axis] = 1;
    out->method = "extremes of the surface";
    return extent_along(scene, direction, &out->value, &out->std_error, error);
}

plm_status plm_trait_box_x(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    return box_length(scene, 0, out, error);
}

plm_status plm_trait_box_y(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    return box_length(scene, 1, out, error);
}

plm_status plm_trait_box_z(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    return box_length(scene, 2, out, error);
}

/* ---- Largest horizontal distance --------------------------------------------------------------------------------- */

/* The direction of the widest pair of points: rows are taken to their support points along 180 directions first, as
 * only those can be the widest pair to within 1 - cos(0.5 degrees) of its length. */
static double widest_direction(const float (*xyz)[3], size_t count, double direction[3])
{
    enum { DIRECTIONS = 360 };
    uint32_t support[DIRECTIONS];
#pragma omp parallel for schedule(static)
    for (int d = 0; d < DIRECTIONS; d++) {
        const float c = (float)cos(PLM_PI * d / (DIRECTIONS / 2)), s = (float)sin(PLM_PI * d / (DIRECTIONS / 2));
        float best = -INFINITY;
        support[d] = 0;
        for (size_t i = 0; i < count; i++) {
            const float along = xyz[i][0] * c + xyz[i][1] * s;
            if (along > best) best = along, support[d] = (uint32_t)i;
        }
    }
    double widest = -1;
    for (int a = 0; a < DIRECTIONS; a++)
        for (int b = a + 1; b < DIRECTIONS; b++) {
            const double x = xyz[support[a]][0] - xyz[support[b]][0], y = xyz[support[a]][1] - xyz[support[b]][1];
            const double length = hypot(x, y);
            if (length <= widest) continue;
            widest = length;
            direction[0] = length > 0 ? x / length : 1;
            direction[1] = length > 0 ? y / length : 0;
        }
    direction[2] = 0;
    return widest;
}

/* The widest extent of the surface itself, where stray points make the widest pair: by 5 degrees, then finer about the best. */
static plm_status widest_extent(const plm_scene *scene, plm_estimate *out, plm_error *error)
{
    enum { COARSE = 36, FINE = 4 };
    double step = PLM_PI / COARSE, best = 0;
    plm_status status = PLM_OK;
    out->value = -INFINITY;
    for (int k = 0; k < COARSE + 2 * FINE && status == PLM_OK; k++) {
        if (k >= COARSE && k % 2 == 0) step /= 2;
        const double angle = k < COARSE ? k * step : best + (k % 2 ? -step : step);
        double extent, std_error;
        status = extent_along(scene, (const double[3]){cos(angle), sin(angle), 0}, &extent, &std_error, error);
        if (status != PLM_OK || extent <= out->value) continue;
        best = angle;
        out->value = extent;
        out->std_error = std_error;
    }
    return status;
}

plm_status plm_trait_plant_width(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    double direction[3];
    const double widest = widest_direction((const float(*)[3])scene->plant, scene->plant_count, direction);
    out->method = "widest pair";
    plm_extreme end[2];
    const plm_status status = extent_between(scene, direction, NULL, end, &out->value, &out->std_error, error);
    if (status != PLM_OK) return status;
    const double thrown = stray_noise * (end[0].sampling.noise + end[1].sampling.noise);
    if (widest <= stray_share * out->value + thrown) return PLM_OK;
    return widest_extent(scene, out, error);
}

/* ---- Principal axes ----------------------------------------------------------------------------------------------- */

/* Share of voxels with a single point: where it is large, dense parts of the plant have more voxels than sparse ones. */
static double lonely_share(const plm_voxels *voxels)
{
    size_t lonely = 0;
    for (size_t i = 0; i < voxels->count; i++) lonely += voxels->size[i] == 1;
    return (double)lonely / (double)voxels->count;
}

/* Thins the plant to voxels as small as its sampling allows. */
static plm_status even_voxels(const plm_scene *scene, double size, plm_voxels *voxels, plm_error *error)
{
    plm_status status = PLM_OK;
    for (double pieces = FINEST_VOXELS; status == PLM_OK; pieces *= 0.7) {
        plm_voxels_free(voxels);
        status = plm_voxel_thin((const float(*)[3])scene->plant, scene->plant_count, size / pieces, voxels, error);
        if (status == PLM_OK && (pieces < COARSEST_VOXELS || lonely_share(voxels) < most_lonely)) break;
    }
    return status;
}

/* Second moments of the plant, a voxel counting as one piece of area. flat: of the ground projection. */
static plm_status principal_axes(const plm_scene *scene, bool flat, double value[3], double axis[3][3],
                                 plm_error *error)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < scene->plant_count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fminf(low[k], scene->plant[i][k]);
            high[k] = fmaxf(high[k], scene->plant[i][k]);
        }
    const double size = fmax(fmax((double)high[0] - low[0], (double)high[1] - low[1]), (double)high[2] - low[2]);
    if (!(size > 0)) return plm_fail(error, PLM_E_DEGENERATE, "all points of the plant are in one place");
    plm_voxels voxels = {0};
    plm_status status = even_voxels(scene, size, &voxels, error);
    if (status != PLM_OK) return status;
    double mean[3] = {0}, m[6] = {0};
    for (size_t i = 0; i < voxels.count; i++)
        for (int k = 0; k < 3; k++) mean[k] += voxels.xyz[i][k];
    for (int k = 0; k < 3; k++) mean[k] /= (double)voxels.count;
    for (size_t i = 0; i < voxels.count; i++) {
        const double x = voxels.xyz[i][0] - mean[0], y = voxels.xyz[i][1] - mean[1];
        const double z = flat ? 0 : voxels.xyz[i][2] - mean[2];
        m[0] += x * x, m[1] += x * y, m[2] += x * z, m[3] += y * y, m[4] += y * z, m[5] += z * z;
    }
    for (int k = 0; k < 6; k++) m[k] /= (double)voxels.count;
    plm_eigen3(m, value, axis);
    plm_voxels_free(&voxels);
    return PLM_OK;
}

/* Extent along axis `which`; its standard error holds the turn of the axis against its neighbour in size. */
static plm_status principal_extent(const plm_scene *scene, bool flat, int which, plm_estimate *out, plm_error *error)
{
    double value[3], axis[3][3];
    plm_status status = principal_axes(scene, flat, value, axis, error);
    if (status != PLM_OK) return status;
    plm_extreme end[2];
    status = extent_between(scene, axis[which], NULL, end, &out->value, &out->std_error, error);
    if (status != PLM_OK) return status;
    const int other = flat ? 1 - which : which == 1 ? (value[0] - value[1] < value[1] - value[2] ? 0 : 2) : 1;
    const double gap = fabs(value[which] - value[other]) / fmax(value[which], value[other]);
    /* Voxels stand for area to a few per cent each: the axis turns by so much over the relative gap. */
    const double turn = fmin(axis_turn / fmax(gap, 1e-3), 0.8);
    double squares = 0;
    for (int side = -1; side <= 1 && status == PLM_OK; side += 2) {
        double turned[3], extent = 0, ignored;
        for (int k = 0; k < 3; k++) turned[k] = cos(turn) * axis[which][k] + side * sin(turn) * axis[other][k];
        status = extent_between(scene, turned, end, NULL, &extent, &ignored, error);
        squares += 0.5 * (extent - out->value) * (extent - out->value);
    }
    out->std_error = sqrt(out->std_error * out->std_error + squares);
    out->method = "extent along principal axis";
    return status;
}

#define PRINCIPAL(name, flat, which)                                                                                   \
    plm_status name(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)               \
    {                                                                                                                  \
        (void)organ;                                                                                                   \
        return principal_extent(scene, flat, which, out, error);                                                       \
    }

PRINCIPAL(plm_trait_pca1, true, 0)
PRINCIPAL(plm_trait_pca2, true, 1)
PRINCIPAL(plm_trait_pca3d_1, false, 0)
PRINCIPAL(plm_trait_pca3d_2, false, 1)
PRINCIPAL(plm_trait_pca3d_3, false, 2)
