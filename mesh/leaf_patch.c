/* mesh/leaf_patch.c: from the points of a chart to a smooth triangulated height field. */
#include "mesh/leaf_patch.h"

#include "cloud/linear.h"
#include "cloud/selection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RING_MAXIMUM = 64 /* neighbours of a point in the triangulation that are looked at */ };

static const double width_per_spacing = 1.5, width_per_noise = 1.5;
static const double margin_per_width = 5.0; /* points beyond the chart that smooth and triangulate its seams */
/* Degrees by which such a point's normal may lean: steeper ones, beyond a fold, lie over or under the chart. */
static const double steepest_margin = 70.0;
static const double stray_noise = 5.0;     /* points off the sheet by so many SD ... */
static const double stray_spacing = 0.5;   /* ... and so many spacings belong to something else */
static const double steepest_secant = 3.0; /* in medians of the chart */
static const double mad_to_sd = 1.4826;
static const double layered_kurtosis = 2.0; /* 3 for normal noise, 1.8 for a uniform one, 1 for two sharp layers */
static const double slope_variance = 0.618; /* 2 pi 0.0984 */
/* Median edge at a point of the Delaunay triangulation of random points, median over its neighbours (simulated). */
static const double edge_per_spacing = 1.01;

/* The spacing at a point from the distance to its 8th neighbour (density (k - 0.5) / (pi r_k^2)). */
static double spacing_of_reach(double reach)
{
    return reach * sqrt(PLM_PI / 7.5);
}

/* The width of the smoothing: by the sparser quartile, or by the noise where that is larger. */
static plm_status choose_width(const plm_leaf_points *points, const uint32_t *row, size_t count,
                               const plm_leaf_charts *charts, size_t chart, double noise, double *width,
                               plm_error *error)
{
    double *spacing = plm_alloc(count, sizeof *spacing, error);
    if (!spacing) return PLM_E_MEMORY;
    size_t members = 0;
    for (size_t j = 0; j < count; j++) {
        const float *p = points->xyz[row[j]];
        if (plm_leaf_chart_of(charts, (const double[3]){p[0], p[1], p[2]}) == chart)
            spacing[members++] = spacing_of_reach(points->reach[row[j]]);
    }
    *width =
        members ? fmax(width_per_spacing * plm_select_quantile(spacing, members, 0.75), width_per_noise * noise) : 0;
    plm_free(spacing);
    return PLM_OK;
}

/* Points of the chart and of its margin, projected. */
static void gather(const plm_leaf_points *points, const uint32_t *row, size_t count, const plm_leaf_charts *charts,
                   plm_leaf_patch *patch)
{
    const double margin = margin_per_width * patch->width;
    for (size_t j = 0; j < count; j++) {
        const float *p = points->xyz[row[j]];
        const double point[3] = {p[0], p[1], p[2]};
        const size_t owner = plm_leaf_chart_of(charts, point);
        if (owner != patch->self) {
            if (plm_leaf_chart_distance(charts, patch->self, point) > margin) continue;
            double normal[3];
            plm_leaf_chart_normal(charts, point, normal);
            if (plm_dot(normal, patch->chart.normal) < cos(plm_radians(steepest_margin))) continue;
        }
        const size_t at = patch->count++;
        patch->row[at] = row[j];
        patch->owner[at] = owner;
        patch->member_count += patch->owner[at] == patch->self;
        plm_leaf_chart_project(&patch->chart, point, patch->uvz[at]);
    }
}

/* Distance of a point from the sheet, along the sheet's normal. */
static double residual_of(const plm_sheet_place *place, double height)
{
    return (height - place->height) / sqrt(1 + place->slope_u * place->slope_u + place->slope_v * place->slope_v);
}

/* Root mean square of deviations (their absolute values), those beyond three robust SD left out: two layers give half of
 * their distance, where the median alone would give three quarters. Two layers at +-d with normal noise have second and
 * fourth moments m2 = d^2 + s^2 and m4 = d^4 + 6 d^2 s^2 + 3 s^4, so d^4 = (3 m2^2 - m4) / 2. */
static void measure_deviation(double *deviation, size_t count, double *noise, double *layers)
{
    *noise = *layers = 0;
    if (!count) return;
    const double limit = 3 * mad_to_sd * plm_select_quantile(deviation, count, 0.5);
    double second = 0, fourth = 0;
    size_t used = 0;
    for (size_t i = 0; i < count; i++) {
        if (deviation[i] > limit) continue;
        const double squared = deviation[i] * deviation[i];
        second += squared;
        fourth += squared * squared;
        used++;
    }
    second /= (double)used;
    fourth /= (double)used;
    *noise = sqrt(second);
    if (fourth < layered_kurtosis * second * second) *layers = sqrt(sqrt(0.5 * (3 * second * second - fourth)));
}

/* Secant at a place, less what noise adds on average: the variance of a slope under the Gaussian weights of SD h with
 * twicing is 0.0984 sigma^2 s^2 / h^4 (integral of w^2 g^2 (2 - g)^2 over frequencies), and s^2 = 2 pi h^2 / weight. */
static double secant_of(const plm_sheet_place *place, double noise)
{
    const double pp = place->slope_u * place->slope_u, qq = place->slope_v * place->slope_v;
    const double secant = sqrt(1 + pp + qq);
    if (!(place->weight > 0)) return secant;
    const double variance = slope_variance * noise * noise / (place->weight * place->width * place->width);
    return fmax(secant - 0.5 * variance * (2 + pp + qq) / (secant * secant * secant), 1);
}

/* Fits the sheet, measures what is left, and widens the smoothing once more where the noise (a double layer, say) turns
 * out larger than was known. residual: count long. */
static plm_status fit_sheet(plm_leaf_patch *patch, const bool *use, double *residual, double *scratch, plm_error *error)
{
    plm_status status = PLM_OK;
    for (int round = 0; round < 3; round++) {
        plm_leaf_sheet_free(&patch->sheet);
        status =
            plm_leaf_sheet_fit((const double(*)[3])patch->uvz, use, patch->count, patch->width, &patch->sheet, error);
        if (status != PLM_OK) return status;
        size_t used = 0;
        for (size_t i = 0; i < patch->count; i++) {
            const plm_sheet_place place = plm_leaf_sheet_at(&patch->sheet, patch->uvz[i][0], patch->uvz[i][1]);
            residual[i] = residual_of(&place, patch->uvz[i][2]);
            if (!use || use[i]) scratch[used++] = fabs(residual[i]);
        }
        measure_deviation(scratch, used, &patch->noise, &patch->layers);
        if (width_per_noise * patch->noise <= 1.1 * patch->width) break;
        patch->width = width_per_noise * patch->noise;
    }
    return status;
}

/* Smooths the heights; leaves out points that lie off the sheet. */
static plm_status smooth(const plm_leaf_points *points, plm_leaf_patch *patch, plm_error *error)
{
    const size_t n = patch->count;
    double *residual = plm_alloc(n, sizeof *residual, error);
    double *scratch = plm_alloc(n, sizeof *scratch, error);
    bool *use = plm_alloc(n, sizeof *use, error);
    plm_status status = residual && scratch && use ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = fit_sheet(patch, NULL, residual, scratch, error);
    size_t kept = 0;
    if (status == PLM_OK) {
        for (size_t i = 0; i < n; i++) {
            const double spacing = spacing_of_reach(points->reach[patch->row[i]]);
            use[i] = fabs(residual[i]) <= stray_noise * patch->noise + stray_spacing * spacing;
            kept += use[i];
        }
        if (kept < n) status = fit_sheet(patch, use, residual, scratch, error);
    }
    if (status == PLM_OK) {
        size_t at = 0;
        patch->member_count = 0;
        for (size_t i = 0; i < n; i++) {
            if (!use[i]) continue;
            const plm_sheet_place place = plm_leaf_sheet_at(&patch->sheet, patch->uvz[i][0], patch->uvz[i][1]);
            patch->row[at] = patch->row[i];
            patch->owner[at] = patch->owner[i];
            patch->uvz[at][0] = patch->uvz[i][0];
            patch->uvz[at][1] = patch->uvz[i][1];
            patch->uvz[at][2] = place.height;
            patch->secant[at] = secant_of(&place, patch->noise);
            patch->member_count += patch->owner[at] == patch->self;
            at++;
        }
        patch->count = at;
    }
    plm_free(residual);
    plm_free(scratch);
    plm_free(use);
    return status;
}

/* A few wild slopes at the rim must not carry the area. */
static plm_status clip_secants(plm_leaf_patch *patch, plm_error *error)
{
    if (!patch->count) return PLM_OK;
    double *sorted = plm_alloc(patch->count, sizeof *sorted, error);
    if (!sorted) return PLM_E_MEMORY;
    memcpy(sorted, patch->secant, patch->count * sizeof *sorted);
    const double limit = steepest_secant * plm_select_quantile(sorted, patch->count, 0.5);
    for (size_t i = 0; i < patch->count; i++) patch->secant[i] = fmin(patch->secant[i], limit);
    plm_free(sorted);
    return PLM_OK;
}

static double distance_between(const plm_leaf_patch *patch, uint32_t a, uint32_t b)
{
    double d[3];
    for (int i = 0; i < 3; i++) d[i] = patch->uvz[a][i] - patch->uvz[b][i];
    return plm_norm(d);
}

/* Median over each point and those joined to it of value. first and ring: neighbours of point i are ring[first[i] ..
 * first[i + 1]). */
static void ring_medians(const uint32_t *first, const uint32_t *ring, const double *value, size_t count, double *out)
{
    for (size_t i = 0; i < count; i++) {
        double near[RING_MAXIMUM + 1];
        size_t known = 0;
        near[known++] = value[i];
        for (uint32_t j = first[i]; j < first[i + 1] && known <= RING_MAXIMUM; j++) near[known++] = value[ring[j]];
        out[i] = plm_select_quantile(near, known, 0.5);
    }
}

/* Local spacing: the median edge at each point, then the median over its neighbours. Long edges across bays and along
 * the hull are the minority at every point. */
static plm_status find_spacing(plm_leaf_patch *patch, plm_error *error)
{
    const plm_triangulation *mesh = &patch->triangulation;
    const size_t n = patch->count;
    uint32_t *first = plm_alloc_zero(n + 2, sizeof *first, error);
    uint32_t *ring = plm_alloc(mesh->count, 3 * sizeof *ring, error);
    double *median = plm_alloc(n, sizeof *median, error);
    const bool good = first && ring && median;
    if (good) {
        for (size_t t = 0; t < mesh->count; t++)
            for (int i = 0; i < 3; i++) first[mesh->corner[t][i] + 2]++;
        for (size_t i = 0; i < n; i++) first[i + 2] += first[i + 1];
        for (size_t t = 0; t < mesh->count; t++)
            for (int i = 0; i < 3; i++) ring[first[mesh->corner[t][i] + 1]++] = mesh->corner[t][(i + 1) % 3];
        for (size_t i = 0; i < n; i++) {
            double edge[RING_MAXIMUM];
            size_t known = 0;
            for (uint32_t j = first[i]; j < first[i + 1] && known < RING_MAXIMUM; j++)
                edge[known++] = distance_between(patch, (uint32_t)i, ring[j]);
            median[i] = known ? plm_select_quantile(edge, known, 0.5) / edge_per_spacing : 0;
        }
        ring_medians(first, ring, median, n, patch->spacing);
    }
    plm_free(first);
    plm_free(ring);
    plm_free(median);
    return good ? PLM_OK : PLM_E_MEMORY;
}

/* Radius of the circle through the corners of each triangle, on the smooth surface: product of sides / (4 area). */
static void find_circumradii(plm_leaf_patch *patch)
{
    for (size_t t = 0; t < patch->triangulation.count; t++) {
        const uint32_t *corner = patch->triangulation.corner[t];
        double a[3], b[3], normal[3];
        for (int i = 0; i < 3; i++) {
            a[i] = patch->uvz[corner[1]][i] - patch->uvz[corner[0]][i];
            b[i] = patch->uvz[corner[2]][i] - patch->uvz[corner[0]][i];
        }
        plm_cross(a, b, normal);
        const double sides = plm_norm(a) * plm_norm(b) * distance_between(patch, corner[1], corner[2]);
        patch->circumradius[t] = sides / fmax(2 * plm_norm(normal), 1e-300);
    }
}

static plm_status triangulate(plm_leaf_patch *patch, plm_error *error)
{
    plm_status status = plm_delaunay_cgal(&patch->uvz[0][0], 3, patch->count, &patch->triangulation, error);
    if (status != PLM_OK) return status;
    patch->circumradius = plm_alloc(patch->triangulation.count, sizeof *patch->circumradius, error);
    patch->state = plm_alloc_zero(patch->triangulation.count, sizeof *patch->state, error);
    if (!patch->circumradius || !patch->state) return PLM_E_MEMORY;
    status = find_spacing(patch, error);
    if (status == PLM_OK) find_circumradii(patch);
    return status;
}

plm_status plm_leaf_patch_make(const plm_leaf_points *points, const uint32_t *row, size_t count,
                               const plm_leaf_charts *charts, size_t chart, double noise, plm_leaf_patch *patch,
                               plm_error *error)
{
    plm_leaf_patch made = {.chart = charts->chart[chart], .self = chart};
    made.row = plm_alloc(count, sizeof *made.row, error);
    made.uvz = plm_alloc(count, sizeof *made.uvz, error);
    made.secant = plm_alloc(count, sizeof *made.secant, error);
    made.spacing = plm_alloc(count, sizeof *made.spacing, error);
    made.owner = plm_alloc(count, sizeof *made.owner, error);
    plm_status status = made.row && made.uvz && made.secant && made.spacing && made.owner ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = choose_width(points, row, count, charts, chart, noise, &made.width, error);
    if (status == PLM_OK) {
        gather(points, row, count, charts, &made);
        status = smooth(points, &made, error);
    }
    if (status == PLM_OK) status = clip_secants(&made, error);
    if (status == PLM_OK) status = triangulate(&made, error);
    if (status == PLM_OK)
        *patch = made;
    else
        plm_leaf_patch_free(&made);
    return status;
}

void plm_leaf_patch_free(plm_leaf_patch *patch)
{
    if (!patch) return;
    plm_free(patch->row);
    plm_free(patch->uvz);
    plm_free(patch->secant);
    plm_free(patch->spacing);
    plm_free(patch->owner);
    plm_leaf_sheet_free(&patch->sheet);
    plm_triangulation_free(&patch->triangulation);
    plm_free(patch->circumradius);
    plm_free(patch->state);
    *patch = (plm_leaf_patch){0};
}
