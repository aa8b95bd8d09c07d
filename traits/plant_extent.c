/* traits/plant_extent.c: how wide a plant is: bounding box, largest horizontal distance, extents along principal axes (laser-scanning
 * paper, PCA1 and PCA2 of the ground projection). Extents are differences of extremes (traits/extreme.c): condition 1. The axes
 * are area-weighted; where two eigenvalues are nearly equal the axes, not the plant, are ill-determined, and the standard
 * error holds how the extent changes as the axis turns. */
#include "cloud/linear.h"
#include "traits/extreme.h"
#include "traits/families.h"
#include "traits/principal_axes.h"
#include "traits/scene.h"

#include <math.h>
#include <string.h>

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

/* Extent along axis `which`; its standard error holds the turn of the axis against its neighbour in size. */
static plm_status principal_extent(const plm_scene *scene, bool flat, int which, plm_estimate *out, plm_error *error)
{
    plm_principal axes;
    plm_status status = plm_principal_axes(scene, flat, &axes, error);
    if (status != PLM_OK) return status;
    const double *value = axes.value;
    double(*axis)[3] = axes.axis;
    plm_extreme end[2];
    status = extent_between(scene, axis[which], NULL, end, &out->value, &out->std_error, error);
    if (status != PLM_OK) return status;
    const int other = flat ? 1 - which : which == 1 ? (value[0] - value[1] < value[1] - value[2] ? 0 : 2) : 1;
    const double gap = fabs(value[which] - value[other]) / fmax(value[which], value[other]);
    const double turn = fmin(axes.turn / fmax(gap, 1e-3), 0.8);
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
