/* traits/tube_diameter.c: diameter by a robust tube fit to all points of a window at once, which beats circles slice by
 * slice (0.003 / 0.21 / 0.04 mm against 0.05 / 0.38 / 0.26 mm on stems of 2 to 4 mm, clean / fused / splat, before any
 * correction), and the correction for noise. */
#include "traits/tube_diameter.h"

#include "cloud/linear.h"
#include "traits/tube_fit.h"
#include "traits/tube_moment.h"

#include <math.h>
#include <string.h>

enum { MOST_POINTS = PLM_MOMENT_POINTS, FEWEST_POINTS = 16 };

/* Noise adds 4 c q^2 / d to the diameter d, q the SD of the residuals. Noise along the normal adds nothing (c = 0),
 * isotropic noise c = 0.5; the values are fits to simulated scans (the estimators' study, section 6).
 * Where points are no voxel means and noise comes near the radius, points of one side lie beyond the axis: they are off it by the
 * normal's folded distribution, whose mean is larger than the radius and whose SD is smaller than the noise. The mean of the squares
 * is the square of the radius and of the noise in any case, and the noise is known from the whole plant. */
static const double inflation_plain = 0.1, inflation_plain_error = 0.10;
static const double thick = 3, folded = 2;   /* radius over spread where folding begins to tell, and where it is all */
static const double folded_inflation = 0.1;  /* on top of the plain one: 421 petioles of splats */
static const double folded_error = 0.35 / 2; /* the same, of its error */
static const double least_radius = 0.3;      /* of the fitted one */
static const double inflation_fused = 0.55, inflation_fused_error = 0.30, inflation_fused_most = 1.6;
/* Depth cameras: each view's own errors (of its place, and of the mixed pixels along both edges) shift its arc of the ring
 * as a whole. At small noise that adds more than the noise of single points does: so many spreads to the diameter, and so many
 * as an SD between scans (virtual stems of 2-4 mm from 12 views, 114 and 136: of one scene all are off alike). */
static const double view_inflation = 0.38, view_error = 0.34;
/* The more pixels a voxel has, the farther out one of them makes a voxel: per gathering (plm_sampling) and spread squared over the
 * diameter. */
static const double pixel_inflation = 2.3;
/* Residuals over the radius from which fused inflation and its uncertainty grow. */
static const double thick_noise = 0.3, very_thick_noise = 0.45;
static const double model_error = 0.0015;   /* facets, roundness: share of the diameter */
static const double fit_error_factor = 1.3; /* residuals of neighbouring points are alike */
/* A petiole whose points scatter by more than this share of the fitted diameter, or that is stouter than the tube along
 * the whole petiole, was not resolved: the fit follows the edge of a blade or a ghost. */
static const double hidden = 0.3, stouter = 1.4;
static const double unresolved = 4; /* diameter over spread below which the ring is no longer resolved: a thin rod and a
                                               short arc of a thick one look alike then */
static const double unresolved_error =
    0.15; /* share of the diameter that is left open then: measured on virtual petioles */

/* Scatter about the tube over the radius without noise from where on the ring of voxel means is blurred, and from where there is none.
 * (Fitted tubes of 30 stems from depth cameras are 3 % too slim in the mean below 0.38, 6 to 20 % each beyond; those of maize in 4 mm
 * of noise and more by half.) */
static const double blurred = 0.38, no_ring = 0.46;

static double square(double x)
{
    return x * x;
}

/* Of voxel means. */
static void deflate_fused(double fit, double spread, const plm_sampling *sampling, double *diameter,
                          double *noise_error)
{
    const double thickness = 2 * spread / fit;
    const double inflation = fmin(inflation_fused + 3 * fmax(0, thickness - thick_noise), inflation_fused_most);
    const double inflation_error = inflation_fused_error + fmax(0, thickness - very_thick_noise);
    const double pixels = pixel_inflation * sampling->gathering * spread * spread / fit;
    const double excess = fmax(4 * inflation * spread * spread / fit, view_inflation * spread) + pixels;
    *diameter = fmax(fit - excess, least_radius * fit);
    *noise_error = fmax(4 * inflation_error * spread * spread / *diameter, view_error * spread);
}

/* Of points as they were seen. */
static void deflate_plain(double fit, double spread, const plm_sampling *sampling, double *diameter,
                          double *noise_error)
{
    const double radius = 0.5 * fit, squares = spread * spread;
    const double thin = fmin(fmax((thick - radius / fmax(spread, 1e-3 * radius)) / (thick - folded), 0), 1);
    const double variance = squares + thin * fmax(sampling->noise * sampling->noise - squares, 0);
    const double inflation = inflation_plain + thin * folded_inflation;
    const double inflation_error = inflation_plain_error + thin * folded_error;
    const double left = radius * radius + squares - (1 + 2 * inflation) * variance;
    *diameter = 2 * sqrt(fmax(left, square(least_radius * radius)));
    *noise_error = 4 * inflation_error * variance / *diameter;
}

void plm_tube_deflate(double fit, double fit_error, double spread, const plm_sampling *sampling, double *diameter,
                      double *std_error)
{
    double noise_error = 0;
    if (sampling->fused)
        deflate_fused(fit, spread, sampling, diameter, &noise_error);
    else
        deflate_plain(fit, spread, sampling, diameter, &noise_error);
    *std_error = sqrt(square(fit_error_factor * fit_error) + square(noise_error) + square(model_error * *diameter));
}

/* The organ's points within reach of t along the line, and not far off it. */
static plm_status window(const plm_organ *organ, double t, double reach, plm_tube_points *points, plm_error *error)
{
    const plm_axis *axis = organ->axis;
    plm_status status = plm_tube_points_gather(organ, SIZE_MAX, points, error);
    if (status != PLM_OK) return status;
    const double limit = 2.5 * plm_axis_radius(axis, t) + 3 * axis->noise;
    const double low = plm_curve_walk(&axis->line, t, -reach), high = plm_curve_walk(&axis->line, t, reach);
    size_t kept = 0;
    for (size_t i = 0; i < points->count; i++) {
        const double foot = plm_curve_foot(&axis->line, points->xyz[i]);
        double at[3], gap[3];
        plm_curve_point(&axis->line, foot, at);
        for (int k = 0; k < 3; k++) gap[k] = points->xyz[i][k] - at[k];
        if (foot < low || foot > high || plm_norm(gap) > limit) continue;
        memmove(points->xyz[kept++], points->xyz[i], sizeof *points->xyz);
    }
    const size_t step = kept > MOST_POINTS ? (kept + MOST_POINTS - 1) / MOST_POINTS : 1;
    points->count = 0;
    for (size_t i = 0; i < kept; i += step) memmove(points->xyz[points->count++], points->xyz[i], sizeof *points->xyz);
    return PLM_OK;
}

/* Diameter of the tube that fits the stem which carries a petiole, a median over its length; INFINITY where there is none. */
static double carrier_diameter(const plm_scene *scene, const plm_organ *organ)
{
    if (organ->label != PLM_LABEL_PETIOLE || organ->axis->carrier < 0) return INFINITY;
    const plm_organ *stem = plm_scene_organ(scene, PLM_LABEL_STEM, organ->axis->carrier);
    return stem && stem->axis && isfinite(stem->axis->radius_error) ? 2 * stem->axis->radius : INFINITY;
}

static plm_status fit_window(const plm_axis *axis, double t, double reach, const plm_tube_points *points,
                             plm_tube *tube, plm_error *error)
{
    double ends[2][3];
    plm_curve_point(&axis->line, plm_curve_walk(&axis->line, t, -reach), ends[0]);
    plm_curve_point(&axis->line, plm_curve_walk(&axis->line, t, reach), ends[1]);
    plm_curve start;
    if (!plm_curve_line(ends[0], ends[1], 2, 1, &start))
        return plm_fail(error, PLM_E_DEGENERATE, "the window around the place of measurement has no length");
    return plm_tube_fit((const double(*)[3])points->xyz, points->count, &start, PLM_TUBE_TAPERED, tube, error);
}

/* By a fitted tube; points: those of the window, within reach of t. blur: out, the scatter about it over its radius. */
static plm_status by_fit(const plm_scene *scene, const plm_organ *organ, double t, double reach,
                         const plm_tube_points *points, plm_estimate *out, double *blur, plm_error *error)
{
    const size_t count = points->count;
    plm_tube tube;
    plm_error why = {0};
    const plm_status status =
        count < FEWEST_POINTS ? PLM_E_DEGENERATE : fit_window(organ->axis, t, reach, points, &tube, &why);
    if (status == PLM_E_MEMORY) return plm_fail(error, status, "%s", why.message);
    if (status != PLM_OK)
        return plm_trait_failed(out,
                                "%zu points within %.1f mm of the place of measurement determine no tube; "
                                "a denser scan there is needed",
                                count, 1e3 * reach);
    out->fit = plm_tube_note(&tube);
    double place[3], fit_error;
    plm_curve_point(&organ->axis->line, t, place);
    const double fit = 2 * plm_tube_radius(&tube, plm_curve_foot(&tube.axis, place), &fit_error);
    if (!(fit > 0) || !(fit_error < 0.25 * fit))
        return plm_trait_failed(out,
                                "the points around the place of measurement leave the radius undetermined "
                                "(seen from %.0f %% of the directions)",
                                100 * tube.coverage);
    if (organ->label == PLM_LABEL_PETIOLE && (tube.spread > hidden * fit || fit > 2 * stouter * organ->axis->radius))
        return plm_trait_failed(
            out,
            "the points scatter by %.2f mm about a tube of %.2f mm (%.2f mm along the petiole): its "
            "ring is not resolved; a scan with less noise is needed",
            1e3 * tube.spread, 1e3 * fit, 2e3 * organ->axis->radius);
    const double stem = carrier_diameter(scene, organ);
    if (fit - 2 * fit_error > stem) /* by more than the diameter's standard error */
        return plm_trait_failed(out,
                                "a tube of %.2f mm fits best, wider than the stem that carries the petiole (%.2f mm): "
                                "it follows points that are not the petiole's",
                                1e3 * fit, 1e3 * stem);
    plm_tube_deflate(fit, 2 * fit_error, tube.spread, &scene->sampling, &out->value, &out->std_error);
    if (out->value < unresolved * tube.spread) {
        out->flags |= PLM_FLAG_LOW_DENSITY;
        out->std_error = hypot(out->std_error, unresolved_error * out->value);
    }
    if (tube.coverage < 0.6) {
        out->flags |= PLM_FLAG_OCCLUDED;
        out->std_error = hypot(out->std_error, 0.1 * out->value * (1 - tube.coverage));
    }
    *blur = tube.spread / (0.5 * out->value);
    out->point_count = tube.inlier_count;
    out->method = "tube fit";
    return PLM_OK;
}

/* In noise that blurs a stem's ring the mean square of distances from its middle tells, the more so; alone where no tube fits in so much. */
static void blend(const plm_scene *scene, const plm_organ *organ, double t, const plm_tube_points *points, double blur,
                  plm_estimate *out)
{
    double diameter, std_error;
    plm_moment_query query = {
        .xyz = (const double(*)[3])points->xyz, .count = points->count, .sampling = &scene->sampling};
    plm_curve_point(&organ->axis->line, t, query.place);
    plm_curve_tangent(&organ->axis->line, t, query.along);
    if (!plm_tube_moment(&query, &diameter, &std_error)) return;
    const bool has_fit = out->state == PLM_STATE_OK;
    if (!has_fit) blur = 2 * scene->sampling.noise / diameter;
    if (blur < blurred) return;
    const double share = has_fit ? fmin((blur - blurred) / (no_ring - blurred), 1) : 1;
    const unsigned flags = out->flags | PLM_FLAG_LOW_DENSITY;
    if (!has_fit) *out = (plm_estimate){.point_count = points->count};
    out->value = share * diameter + (1 - share) * out->value;
    out->std_error = share * std_error + (1 - share) * out->std_error;
    out->flags = flags;
    if (share > 0.5) out->method = "mean square distance from the middle";
}

plm_status plm_tube_diameter(const plm_scene *scene, const plm_organ *organ, double t, double reach, plm_estimate *out,
                             plm_error *error)
{
    plm_tube_points points;
    double blur = 0;
    plm_status status = window(organ, t, reach, &points, error);
    if (status != PLM_OK) return status;
    status = by_fit(scene, organ, t, reach, &points, out, &blur, error);
    if (status == PLM_OK && organ->label == PLM_LABEL_STEM && scene->sampling.fused)
        blend(scene, organ, t, &points, blur, out);
    plm_free(points.xyz);
    return status;
}
