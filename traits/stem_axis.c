/* traits/stem_axis.c: a stem's centre line from its foot to its tip: centroids first, then, where the ring of points is
 * sharp enough, the axis of a tube with a linear radius. */
#include "cloud/linear.h"
#include "cloud/order.h"
#include "traits/axis.h"
#include "traits/blurred_end.h"
#include "traits/centre_line.h"
#include "traits/tube_fit.h"

#include <string.h>

enum { FEWEST_POINTS = 24, MOST_POINTS = 8000, TUBE_SPANS = 6 };

/* Length of a spline's span over the tube's radius: a petiole or stem bends gently over 40 radii. */
static const double radii_per_span = 40;
/* A tube is taken over the centroids where its residuals are below this share of the radius and it is seen from this
 * share of the directions: beyond, the ring fit wanders (section 7 of the estimators' study). */
static const double sharp = 0.35, seen = 0.6;
static const double shortest_span = 6;               /* with more spans than one, in radii */
static const double sector = 1.5 / PLM_TUBE_SECTORS; /* one direction less about the tube may be seen */
static const double closer = 0.97;   /* scatter with twice the spans over that before: the stem bends more */
static const double end_shape = 0.1; /* radii by which an end's shape leaves the end of the axis open */
/* Where the labels are our own, the stem's end is told from the topmost petiole's foot by the change of radius only, which
 * the radius and the noise blur (errors of 0.6 mm clean, 2.8 and 5 mm in noise of 0.5 mm, median over simulated plants);
 * a chord to a wrong end leans by the angle between the stem's end and the chord. */
static const double own_end_radii = 0.5, own_end_noise = 8, end_lean = 0.15;
/* Share of the noise that lies along the tube: depth noise is seen from the side, splats' noise is normal to it. */
static const double noise_along = 0.7;

/* Variance along a stem over that across it, from which there is a direction: a tube's own is L^2 / 6 r^2, so a stem that
 * is less than three radii long has none. */
static const double longer_than_wide = 1.5;

/* Direction of largest extent of the points, upwards, and their centroid. Gives how much more variance there is along it
 * than across; 0 where all points coincide. */
static double principal(const plm_tube_points *points, double centroid[3], double direction[3])
{
    double moment[6] = {0}, value[3], vector[3][3];
    memset(centroid, 0, 3 * sizeof *centroid);
    for (size_t i = 0; i < points->count; i++)
        for (int k = 0; k < 3; k++) centroid[k] += points->xyz[i][k] / (double)points->count;
    for (size_t i = 0; i < points->count; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = points->xyz[i][k] - centroid[k];
        for (int a = 0, m = 0; a < 3; a++)
            for (int b = a; b < 3; b++) moment[m++] += d[a] * d[b];
    }
    plm_eigen3(moment, value, vector);
    if (!(value[0] > 0)) return 0;
    for (int k = 0; k < 3; k++) direction[k] = vector[0][2] < 0 ? -vector[0][k] : vector[0][k];
    return value[1] > 0 ? value[0] / value[1] : INFINITY;
}

/* Ends of the chord: mean places of the lowest and highest 3 % of the points along the direction. */
static plm_status chord(const plm_tube_points *points, const double centroid[3], const double direction[3],
                        double ends[2][3], plm_error *error)
{
    double *along = plm_alloc(2 * points->count, sizeof *along, error);
    if (!along) return PLM_E_MEMORY;
    double *sorted = along + points->count;
    for (size_t i = 0; i < points->count; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = points->xyz[i][k] - centroid[k];
        along[i] = sorted[i] = plm_dot(d, direction);
    }
    const double limit[2] = {plm_order_quantile(sorted, points->count, 0.03),
                             plm_order_quantile(sorted, points->count, 0.97)};
    memset(ends, 0, 6 * sizeof(double));
    size_t count[2] = {0, 0};
    for (size_t i = 0; i < points->count; i++)
        for (int end = 0; end < 2; end++)
            if (end ? along[i] >= limit[1] : along[i] <= limit[0]) {
                for (int k = 0; k < 3; k++) ends[end][k] += points->xyz[i][k];
                count[end]++;
            }
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) ends[end][k] /= (double)count[end];
    plm_free(along);
    return PLM_OK;
}

static int spans_for(double length, double radius, int most)
{
    const double spans = radius > 0 ? length / (radii_per_span * radius) : 1;
    return spans < 1 ? 1 : spans > most ? most : (int)spans;
}

/* Centre line in two passes: the first finds the radius that says how many spans the second may have. */
static plm_status centroids(const plm_tube_points *points, double ends[2][3], plm_centre_line *line, plm_error *error)
{
    plm_status status = plm_centre_line_fit((const double(*)[3])points->xyz, points->count, ends[0], ends[1],
                                            (plm_line_shape){3, 1, 0}, line, error);
    if (status != PLM_OK) return status;
    const int spans = spans_for(2 * line->curve.half, line->distance, TUBE_SPANS);
    return plm_centre_line_fit((const double(*)[3])points->xyz, points->count, ends[0], ends[1],
                               (plm_line_shape){3, spans, 0}, line, error);
}

static plm_status fit_both(const plm_tube_points *points, double ends[2][3], int spans, plm_centre_line *line,
                           plm_tube *tube, plm_error *error)
{
    const double(*xyz)[3] = (const double(*)[3])points->xyz;
    const plm_status status =
        plm_centre_line_fit(xyz, points->count, ends[0], ends[1], (plm_line_shape){3, spans, 0}, line, error);
    if (status != PLM_OK) return status;
    return plm_tube_fit(xyz, points->count, &line->curve, PLM_TUBE_TAPERED, tube, error);
}

/* Robust SD off the tube, by the points that are more than its parameters. */
static double free_sd(const plm_tube_points *points, const plm_tube *tube)
{
    const double count = (double)points->count;
    return tube->robust_sd * sqrt(count / fmax(count - tube->parameter_count, 1));
}

/* Stems bend at their nodes within less than a span: twice the spans as long as a tube then lies closer to the points. */
static plm_status bend(const plm_tube_points *points, double ends[2][3], plm_centre_line *line, plm_tube *tube,
                       plm_error *error)
{
    const double length = 2 * line->curve.half;
    for (int spans = 2 * line->curve.spans; spans <= PLM_CURVE_SPANS; spans *= 2) {
        if (length < shortest_span * tube->radius[0] * spans) break;
        plm_centre_line bent_line;
        plm_tube bent;
        plm_error why = {0};
        const plm_status status = fit_both(points, ends, spans, &bent_line, &bent, &why);
        if (status == PLM_E_MEMORY) return plm_fail(error, status, "%s", why.message);
        if (status != PLM_OK || !bent.converged || !(fabs(bent.radius[1]) < bent.radius[0])) break;
        if (!(free_sd(points, &bent) < closer * free_sd(points, tube)) || bent.coverage < tube->coverage - sector)
            break;
        *line = bent_line;
        *tube = bent;
    }
    return PLM_OK;
}

/* Positions along the line, from its middle, of the points that belong to it; gives their number. Points off the line by
 * more than reach are left out. */
static size_t positions(const plm_tube_points *points, const plm_curve *line, double reach, double *position)
{
    size_t count = 0;
    for (size_t i = 0; i < points->count; i++) {
        const double t = plm_curve_foot(line, points->xyz[i]);
        double at[3], gap[3];
        plm_curve_point(line, t, at);
        for (int k = 0; k < 3; k++) gap[k] = points->xyz[i][k] - at[k];
        if (plm_norm(gap) <= reach) position[count++] = plm_curve_length(line, 0, t);
    }
    return count;
}

/* Finds base and tip from the positions and completes the axis. */
static plm_status find_ends(const plm_tube_points *points, double reach, plm_axis *axis, plm_error *error)
{
    double *position = plm_alloc(points->count, sizeof *position, error);
    if (!position) return PLM_E_MEMORY;
    const size_t count = positions(points, &axis->line, reach, position);
    plm_status status = PLM_OK;
    if (count < FEWEST_POINTS) {
        status = plm_fail(error, PLM_E_DEGENERATE, "only %zu points lie along one line; %d are needed", count,
                          FEWEST_POINTS);
    } else {
        const plm_end upper = plm_blurred_end(position, count, noise_along * axis->noise);
        for (size_t i = 0; i < count; i++) position[i] = -position[i];
        const plm_end lower = plm_blurred_end(position, count, noise_along * axis->noise);
        axis->begin = plm_curve_walk(&axis->line, 0, -lower.position);
        axis->end = plm_curve_walk(&axis->line, 0, upper.position);
        axis->length = upper.position + lower.position;
        if (!(axis->length > 0)) status = plm_fail(error, PLM_E_DEGENERATE, "the stem's points have no length");
        axis->length_error = hypot(hypot(lower.std_error, upper.std_error), end_shape * axis->radius);
        axis->point_count = count;
    }
    plm_free(position);
    return status;
}

/* Where the soil is known and the stem ends near it, the stem comes out of the soil there: its foot is at the soil's
 * height, whatever the cut between soil and stem took or left. */
static void stand_on_soil(const plm_scene *scene, plm_axis *axis)
{
    if (!scene->ground || !scene->ground->found) return;
    const double soil = scene->ground->soil_height - scene->cloud->origin[2];
    double base[3], tangent[3];
    plm_curve_point(&axis->line, axis->begin, base);
    plm_curve_tangent(&axis->line, axis->begin, tangent);
    const double missing = base[2] - soil;
    if (!(tangent[2] > 0.2) || fabs(missing) > 2 * axis->radius + 3 * axis->noise) return;
    const double begin = plm_curve_walk(&axis->line, axis->begin, -missing / tangent[2]);
    axis->length += plm_curve_length(&axis->line, begin, axis->begin);
    axis->begin = begin;
}

static void complete(plm_axis *axis)
{
    plm_curve_point(&axis->line, axis->begin, axis->base);
    plm_curve_point(&axis->line, axis->end, axis->tip);
    for (int k = 0; k < 3; k++) axis->direction[k] = axis->tip[k] - axis->base[k];
    plm_normalise(axis->direction);
    axis->carrier = -1;
    axis->node = axis->node_error = axis->insertion = axis->insertion_error = NAN;
}

static plm_status fit(const plm_scene *scene, const plm_tube_points *points, plm_axis *axis, plm_error *error)
{
    double centroid[3], direction[3], ends[2][3];
    const double elongation = principal(points, centroid, direction);
    if (!(elongation > 0)) return plm_fail(error, PLM_E_DEGENERATE, "all points coincide");
    if (elongation < longer_than_wide)
        return plm_fail(error, PLM_E_DEGENERATE, "the stem's points are about as wide as they are long");
    plm_status status = chord(points, centroid, direction, ends, error);
    plm_centre_line line;
    if (status == PLM_OK) status = centroids(points, ends, &line, error);
    if (status != PLM_OK) return status;
    plm_tube tube;
    status = plm_tube_fit((const double(*)[3])points->xyz, points->count, &line.curve, PLM_TUBE_TAPERED, &tube, error);
    if (status == PLM_OK && bend(points, ends, &line, &tube, error) != PLM_OK) return PLM_E_MEMORY;
    if (status == PLM_E_MEMORY) return status;
    *axis = (plm_axis){.line = line.curve, .radius = line.distance, .radius_error = INFINITY, .method = "centre line"};
    axis->noise = line.distance * 0.5;
    double reach = 2.5 * line.distance;
    if (status == PLM_OK) axis->fit = plm_tube_note(&tube);
    if (status == PLM_OK && fabs(tube.radius[1]) < tube.radius[0]) {
        axis->radius = plm_tube_radius(&tube, 0, &axis->radius_error);
        axis->taper = tube.radius[1];
        axis->noise = tube.robust_sd;
        reach = 1.5 * (tube.radius[0] + fabs(tube.radius[1])) + 3 * tube.robust_sd;
        if (tube.robust_sd < sharp * tube.radius[0] && tube.coverage >= seen) {
            axis->line = tube.axis;
            axis->method = "tube fit";
        }
    }
    status = find_ends(points, reach, axis, error);
    if (status != PLM_OK) return status;
    stand_on_soil(scene, axis);
    axis->direction_error = hypot(plm_centre_line_direction_error(&line, -1, 1), 0.04 * axis->radius / axis->length);
    if (scene->habit != PLM_HABIT_UNKNOWN) { /* labels are the segmentation's */
        const double tip_error = hypot(own_end_radii * axis->radius, own_end_noise * axis->noise);
        axis->length_error = hypot(axis->length_error, tip_error);
        axis->direction_error = hypot(axis->direction_error, end_lean * tip_error / axis->length);
    }
    complete(axis);
    return PLM_OK;
}

plm_status plm_stem_axis_fit(const plm_scene *scene, const plm_organ *stem, plm_axis *axis, plm_error *error)
{
    if (stem->count < FEWEST_POINTS)
        return plm_fail(error, PLM_E_DEGENERATE, "the stem has %zu points; %d are needed", stem->count, FEWEST_POINTS);
    plm_tube_points points;
    plm_status status = plm_tube_points_gather(stem, MOST_POINTS, &points, error);
    if (status != PLM_OK) return status;
    plm_axis out;
    status = fit(scene, &points, &out, error);
    plm_free(points.xyz);
    if (status == PLM_OK) *axis = out;
    return status;
}
