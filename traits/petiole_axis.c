/* traits/petiole_axis.c: a petiole's centre line from the stem's surface to the (last) blade junction.
 *
 * The ends decide: half a millimetre at one end of 20 mm is 1.4 degrees. The stem cuts the petiole obliquely, so
 * centroids near it are pulled outwards; those points are left out of the fit, and the line is extended straight to the
 * surface of the stem. */
#include "cloud/linear.h"
#include "cloud/order.h"
#include "traits/axis.h"
#include "traits/blurred_end.h"
#include "traits/centre_line.h"
#include "traits/line_blend.h"
#include "traits/petiole_course.h"
#include "traits/petiole_end.h"
#include "traits/stem_surface.h"
#include "traits/tube_fit.h"

#include <string.h>

enum { FEWEST_POINTS = 12, MOST_POINTS = 4000, FEWEST_TUBE_POINTS = 30, MOST_SPANS = 8 };

static const double least_angle = 0.03;  /* radians between petiole and stem */
static const double shallow_angle = 0.2; /* below, the crossing alone tells no base */
static const double bends_away = 0.35;   /* radians from the stem to which a petiole that begins along it soon bends */
static const double end_share = 0.02;    /* points that stand for an end at the start */
static const double radii_per_span = 25;
/* Prior SD of a petiole's cubic term, in lengths: an arch that turns by 30 degrees as the 1.3rd power of the way has as much (0.002 to
 * 0.0035 are alike to 0.1 degrees of RMSE over 340 virtual petioles). Without it the ends of a noisy line swing; a parabola leaves
 * arches that bend most near one end 0.5 degrees off in the mean. */
static const double skew = 0.0025;
/* Petioles of a rosette lie on each other at their feet, and points of others draw the line up there: what lies so near to the
 * foot, in radii, but not more than this share of the length, does not give the line (464 virtual petioles: 2 to 4 radii are alike). */
static const double crowded_radii = 3, crowded_most = 0.3;
static const double sharp = 0.2, seen = 0.6; /* residuals over the radius, directions seen: a tube beats centroids */
static const double flares = 0.95, widest_flare = 2; /* a flare is told by scatter so much less; its most, in radii */
static const double noise_along = 0.7;               /* share of the noise that lies along the tube */
static const double turned_round = 0.4; /* of the length: the base lies so much nearer to the leaf than the far end */
static const double least_ring = 0.45;  /* share of a ring that must be outside of the stem */
static const double longest_way = 3;    /* halves of its chord, from its middle, to which the line is followed */
/* Where the labels are our own: what they leave open of the junction along the petiole and of the foot across it, in radii
 * and in SDs of the noise, and of the direction (medians over simulated plants). */
static const double own_junction_radii = 1.2, own_junction_noise = 3, own_foot_radii = 0.1, own_foot_noise = 0.75;
/* A tube ends rounded in its blade: where it is sharp and labels are our own, its last points lie beyond the junction by so many
 * radii (500 virtual petioles of six kinds and 29 of the development clouds: 0.5 and 0.2). */
static const double rounded_end = 0.25;
static const double own_free_foot_noise = 1.9; /* instead, where no stem tells the foot: rosettes */
/* Petioles of a rosette lie on each other at their feet: noise brings points from beyond the crown among one's own, so that it seems to
 * begin deeper by so many SDs of the noise (20 virtual rosettes from depth cameras and as many as splats: 0.93 and 0.82 mm in the mean,
 * 0.35 in clean scans, which stays), but not by more than this share of its length. */
static const double deep_foot_noise = 2.0, deep_foot_most = 0.3;
/* Own labels in noise call stem what is so near to its surface, in SDs of the noise and in its radii. */
static const double own_margin_noise = 1.0, own_margin_radii = 0.1;
static const double own_direction = 0.25 * PLM_PI / 180;
static const double node_turn = 0.4 * PLM_PI / 180; /* of the stem at its nodes, within less than a span of its line */
static const double model_error = 0.12 * PLM_PI / 180; /* of a direction: what degree and shape leave */

typedef struct petiole {
    const plm_organ *organ;
    plm_tube_points points;
    const plm_organ *stem;      /* NULL where there is none */
    const plm_organ *leaf;      /* NULL where there is none */
    double *distance, *scratch; /* as many as points */
    plm_centre_line line;
    plm_tube tube;
    bool has_tube;
    bool own;         /* labels are the segmentation's, not given */
    bool is_rosettes; /* own labels too */
    bool is_clear;    /* the line begins where the petiole comes clear of its stem */
    double radius, noise;
    double margin; /* off the stem's surface: what lies nearer is not called petiole */
} petiole;

/* The stem that the petiole's points come nearest to: by the 2 % quantile of their distances. */
static void find_stem(const plm_scene *scene, petiole *p)
{
    double nearest = INFINITY;
    for (size_t s = 0; s < scene->organ_count; s++) {
        const plm_organ *organ = &scene->organ[s];
        if (organ->label != PLM_LABEL_STEM || !organ->axis) continue;
        double foot;
        for (size_t i = 0; i < p->points.count; i++) p->scratch[i] = plm_stem_off(organ->axis, p->points.xyz[i], &foot);
        const double distance = plm_order_quantile(p->scratch, p->points.count, end_share);
        if (distance < nearest) {
            nearest = distance;
            p->stem = organ;
        }
    }
}

/* ---- First ends ------------------------------------------------------------------------------------------------- */

/* Mean of the points with the smallest keys (end_share of them, at least 3). keys are kept. */
static void mean_of_nearest(const petiole *p, const double *keys, double mean[3])
{
    const size_t count = p->points.count;
    size_t wanted = (size_t)ceil(end_share * (double)count);
    if (wanted < 3) wanted = 3;
    memcpy(p->scratch, keys, count * sizeof *keys);
    const double limit = plm_order_select(p->scratch, count, wanted - 1);
    size_t taken = 0;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t i = 0; i < count; i++)
        if (keys[i] <= limit) {
            for (int k = 0; k < 3; k++) mean[k] += p->points.xyz[i][k];
            taken++;
        }
    for (int k = 0; k < 3; k++) mean[k] /= (double)taken;
}

/* Ends without a stem: of the two ends of the largest extent, the one farther from the petiole's leaf is the base;
 * without a leaf, the lower one. */
static void ends_without_stem(petiole *p, double base[3], double far[3])
{
    double one[3], other[3];
    const size_t count = p->points.count;
    size_t outermost = 0; /* one point: a mean of several, from both ends, would be no end */
    for (size_t i = 0; i < count; i++) p->distance[i] = plm_distance(p->points.xyz[i], p->organ->centroid);
    for (size_t i = 1; i < count; i++)
        if (p->distance[i] > p->distance[outermost]) outermost = i;
    for (size_t i = 0; i < count; i++) p->distance[i] = -plm_distance(p->points.xyz[i], p->points.xyz[outermost]);
    mean_of_nearest(p, p->distance, other);
    for (size_t i = 0; i < count; i++) p->distance[i] = -plm_distance(p->points.xyz[i], other);
    mean_of_nearest(p, p->distance, one);
    const bool one_is_base =
        p->leaf ? plm_distance(one, p->leaf->centroid) > plm_distance(other, p->leaf->centroid) : one[2] < other[2];
    memcpy(base, one_is_base ? one : other, 3 * sizeof *base);
    memcpy(far, one_is_base ? other : one, 3 * sizeof *far);
}

/* Ends: the base is the one nearest to the stem, except where the leaf begins there: then what was called stem is not what
 * carries the petiole, and is left out of it. */
static void first_ends(petiole *p, double base[3], double far[3])
{
    if (!p->stem) {
        ends_without_stem(p, base, far);
        return;
    }
    double foot;
    for (size_t i = 0; i < p->points.count; i++) p->distance[i] = plm_stem_off(p->stem->axis, p->points.xyz[i], &foot);
    mean_of_nearest(p, p->distance, base);
    for (size_t i = 0; i < p->points.count; i++) p->distance[i] = -plm_distance(p->points.xyz[i], base);
    mean_of_nearest(p, p->distance, far);
    if (!p->leaf) return;
    const double turned = plm_organ_gap(p->leaf, far) - plm_organ_gap(p->leaf, base);
    if (!(turned > turned_round * plm_distance(base, far))) return;
    p->stem = NULL;
    ends_without_stem(p, base, far);
}

/* ---- The line --------------------------------------------------------------------------------------------------- */

static plm_status fit_line(const plm_tube_points *points, const double base[3], const double far[3], double radius,
                           plm_centre_line *line, plm_error *error)
{
    const int spans = (int)fmin(fmax(plm_distance(base, far) / (radii_per_span * radius), 1), MOST_SPANS);
    return plm_centre_line_fit((const double(*)[3])points->xyz, points->count, base, far,
                               (plm_line_shape){3, spans, skew}, line, error);
}

static bool is_tube(const petiole *p, const plm_tube *tube)
{
    return fabs(tube->radius[1]) < tube->radius[0] && tube->radius[0] < 2 * p->line.distance;
}

/* Radius and noise from a tube about the line; where none fits, from the distances to the line: in noise and where one
 * side is seen they lie between 0.6 and 1.1 radii. */
static plm_status fit_tube(petiole *p, plm_error *error)
{
    p->radius = p->line.distance;
    p->noise = 0.5 * p->line.distance;
    p->has_tube = false;
    if (p->points.count < FEWEST_TUBE_POINTS) return PLM_OK;
    const plm_status status = plm_tube_fit((const double(*)[3])p->points.xyz, p->points.count, &p->line.curve,
                                           PLM_TUBE_TAPERED, &p->tube, error);
    if (status == PLM_E_MEMORY) return status;
    if (status != PLM_OK || !is_tube(p, &p->tube)) return PLM_OK;
    p->has_tube = true;
    p->radius = p->tube.radius[0];
    p->noise = p->tube.robust_sd;
    return PLM_OK;
}

static const plm_curve *line_of(const petiole *p)
{
    return p->has_tube && p->tube.robust_sd < sharp * p->tube.radius[0] && p->tube.coverage >= seen ? &p->tube.axis
                                                                                                    : &p->line.curve;
}

/* A sharp tube tells how it widens towards the stem, too: about a flare that is not told, the axis of a bent petiole is drawn off by
 * 0.1 to 0.2 mm at its foot. */
static plm_status flare(petiole *p, plm_error *error)
{
    const double(*xyz)[3] = (const double(*)[3])p->points.xyz;
    plm_tube plain, flared;
    plm_error why = {0};
    plm_status status = plm_tube_fit(xyz, p->points.count, &p->line.curve, PLM_TUBE_TAPERED, &plain, &why);
    if (status == PLM_OK) status = plm_tube_fit(xyz, p->points.count, &p->line.curve, PLM_TUBE_FLARED, &flared, &why);
    if (status == PLM_E_MEMORY) return plm_fail(error, status, "%s", why.message);
    if (status != PLM_OK || !flared.converged || !is_tube(p, &flared)) return PLM_OK;
    const double radius = plm_tube_radius(&flared, 0, NULL);
    if (!(flared.flare > 0 && flared.flare < widest_flare * radius) || flared.coverage < seen) return PLM_OK;
    if (!(flared.robust_sd < sharp * radius && flared.robust_sd < flares * plain.robust_sd)) return PLM_OK;
    p->tube = flared;
    p->radius = radius;
    p->noise = flared.robust_sd;
    return PLM_OK;
}

/* Radius of the petiole at t: they widen towards the stem. */
static double radius_at(const petiole *p, double t)
{
    const double before = p->has_tube && p->tube.flare > 0 ? p->tube.flare_length : 0;
    const double radius = p->has_tube ? plm_tube_radius(&p->tube, fmin(fmax(t, -1 - before), 1), NULL) : p->radius;
    return fmax(radius, 0.3 * p->radius);
}

static bool is_free(const petiole *p, const plm_curve *line, double t, double mean[3])
{
    return plm_stem_ring_left(p->stem->axis, line, t, radius_at(p, t), p->margin, mean) >= least_ring;
}

/* The points where most of the ring is outside of the stem, of a rosette those clear of the others' feet; centred: without the
 * bias that the oblique cut gives the centroids. Gives the least of their parameters on the line. */
static double gather_free(const petiole *p, const plm_curve *line, bool centred, plm_tube_points *kept)
{
    const double crowded = fmin(crowded_radii * p->radius, crowded_most * plm_curve_length(line, -1, 1));
    /* behind the stem the line is free again, where points are none of the petiole's, unless it passes the stem by */
    const double entry = p->stem ? plm_stem_crossing(p->stem->axis, line, 0, -longest_way) : NAN;
    const double from = isnan(entry) ? -INFINITY : entry;
    double low = 1;
    kept->count = 0;
    for (size_t i = 0; i < p->points.count; i++) {
        double mean[3] = {0};
        const double t = plm_curve_foot(line, p->points.xyz[i]);
        if (t < from || (p->stem && !is_free(p, line, t, mean))) continue;
        if (p->is_rosettes && plm_curve_length(line, -1, t) < crowded) continue;
        for (int k = 0; k < 3; k++) kept->xyz[kept->count][k] = p->points.xyz[i][k] - (centred ? mean[k] : 0);
        kept->count++;
        low = fmin(low, t);
    }
    return low;
}

/* Takes off the bias that the oblique cut with the stem gives the centroids, leaves out the points where most of the ring
 * is gone, and fits again. */
static plm_status refit_free_part(petiole *p, plm_error *error)
{
    if (p->own && line_of(p) != &p->tube.axis)
        p->margin = own_margin_noise * p->noise + own_margin_radii * p->stem->axis->radius;
    plm_tube_points kept = {.count = 0, .xyz = plm_alloc(p->points.count, sizeof *kept.xyz, error)};
    if (!kept.xyz) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (int round = 0; round < 2 && status == PLM_OK; round++) {
        const plm_curve line = p->line.curve;
        double begin[3], far[3];
        const double low = gather_free(p, &line, true, &kept);
        if (kept.count < FEWEST_POINTS || low > 0) break; /* too short to lose anything */
        plm_curve_point(&line, fmax(low, -1), begin);
        plm_curve_point(&line, 1, far);
        plm_centre_line again;
        status = fit_line(&kept, begin, far, p->radius, &again, error);
        if (status == PLM_OK) p->line = again, p->is_clear = kept.count < p->points.count;
        if (status == PLM_E_DEGENERATE) { /* the line before stands */
            status = PLM_OK;
            break;
        }
    }
    plm_free(kept.xyz);
    return status;
}

static void direction_between(const plm_curve *line, double begin, double end, double direction[3])
{
    double from[3];
    plm_curve_point(line, begin, from);
    plm_curve_point(line, end, direction);
    for (int k = 0; k < 3; k++) direction[k] -= from[k];
    plm_normalise(direction);
}

/* A petiole of a rosette is short, and what is clear of the others tells no more than a straight line. Not where little is left clear of
 * them: what would be prolonged there is longer than what is seen. */
static plm_status straighten(petiole *p, plm_error *error)
{
    if (!p->is_rosettes) return PLM_OK;
    plm_tube_points kept = {.count = 0, .xyz = plm_alloc(p->points.count, sizeof *kept.xyz, error)};
    if (!kept.xyz) return PLM_E_MEMORY;
    const double low = gather_free(p, &p->line.curve, true, &kept);
    double begin[3], far[3];
    plm_curve_point(&p->line.curve, -1, begin);
    plm_curve_point(&p->line.curve, 1, far);
    plm_status status = PLM_E_DEGENERATE;
    if (kept.count >= FEWEST_POINTS && low <= 0)
        status = plm_centre_line_fit((const double(*)[3])kept.xyz, kept.count, begin, far, (plm_line_shape){1, 1, 0},
                                     &p->line, error);
    plm_free(kept.xyz);
    return status == PLM_E_DEGENERATE ? PLM_OK : status; /* the line before stands */
}

/* A tube that plainly beats centroids has told already; elsewhere it tells a part, but of petioles too short to lose what the stem
 * cuts. Where the labels are our own, petioles of a rosette lie on each other at their feet, where a tube fits none of them. */
static plm_status blend_with_tube(petiole *p, plm_error *error)
{
    if (p->is_rosettes || !p->has_tube || line_of(p) == &p->tube.axis) return PLM_OK;
    plm_tube_points kept = {.count = 0, .xyz = plm_alloc(p->points.count, sizeof *kept.xyz, error)};
    if (!kept.xyz) return PLM_E_MEMORY;
    const double low = gather_free(p, &p->line.curve, false, &kept);
    plm_tube tube;
    plm_status status = PLM_E_DEGENERATE;
    if (kept.count >= FEWEST_TUBE_POINTS && low <= 0)
        status = plm_tube_fit((const double(*)[3])kept.xyz, kept.count, &p->line.curve, PLM_TUBE_TAPERED, &tube, error);
    plm_free(kept.xyz);
    if (status == PLM_E_MEMORY) return status;
    if (status == PLM_OK && tube.converged && is_tube(p, &tube)) plm_line_blend(&p->line, &tube);
    return PLM_OK;
}

/* ---- Ends ------------------------------------------------------------------------------------------------------- */

/* Lengths along the line, from its middle, of the points that belong to it. */
static size_t positions(const petiole *p, const plm_curve *line, double *position)
{
    const double reach = p->has_tube
                             ? 1.5 * (p->radius + fabs(p->tube.radius[1]) + fmax(p->tube.flare, 0)) + 3 * p->noise
                             : 2.5 * p->line.distance;
    size_t count = 0;
    for (size_t i = 0; i < p->points.count; i++) {
        const double t = plm_curve_foot(line, p->points.xyz[i]);
        double at[3];
        plm_curve_point(line, t, at);
        if (plm_distance(at, p->points.xyz[i]) <= reach) position[count++] = plm_curve_length(line, 0, t);
    }
    return count;
}

/* Base: where the line crosses the stem's surface, and where the petiole comes clear of it, which points of the stem that are called
 * petiole leave where it is (of 385 arched virtual petioles in noise the RMSE along them is 0.24 to 1.2 mm for 0.9 to 4.9 by the first points;
 * the steeper against the stem the less). Of a tube, which has no such place, half the oblique cut behind its first points, as the cut
 * begins r cot(angle) before the crossing. The two are weighed by what is known of them: at shallow angles the crossing moves by
 * 1 / sin(angle) of any error of the stem's radius, and a line that passes the stem by tells nothing. Where the labels are
 * our own what lies within the margin of the stem is called stem, and in noise the petiole seems to begin later by
 * margin / sin(angle); of a sharp tube, for which no margin is known, the crossing tells alone where it is not nearly along
 * the stem. Without stem: the first points. */
static plm_end find_base(const petiole *p, const plm_curve *line, plm_end first)
{
    if (!p->stem) return first;
    const plm_axis *stem = p->stem->axis;
    const bool is_clear = p->is_clear && line == &p->line.curve;
    const double start = is_clear ? plm_curve_length(line, 0, -1) : first.position;
    const double t = plm_curve_walk(line, 0, start);
    const double angle = fmax(plm_stem_angle(stem, line, t), least_angle), bent = fmax(angle, bends_away);
    const double half_cut = radius_at(p, t) / tan(bent);
    const double crossing_error = (0.1 * stem->radius + 0.3 * (p->noise + stem->noise)) / sin(angle);
    const double first_error = 0.4 * half_cut + 0.2 * p->radius + 0.5 * p->noise + (is_clear ? 0 : first.std_error);
    const double high = plm_curve_walk(line, t, 2 * half_cut + 3 * (crossing_error + first_error));
    const double low = plm_curve_walk(line, t, -3 * (crossing_error + first_error));
    const double behind = start + (is_clear ? 0 : half_cut) - p->margin / sin(bent),
                 at = plm_stem_crossing(stem, line, high, low);
    if (isnan(at)) return (plm_end){behind, first_error};
    const double crossing = plm_curve_length(line, 0, at);
    const double crossing_weight = 1 / (crossing_error * crossing_error),
                 first_weight = 1 / (first_error * first_error);
    const double sum = crossing_weight + first_weight;
    if (p->own && line == &p->tube.axis && angle > shallow_angle)
        return (plm_end){crossing, fmax(crossing_error, 0.25 * fabs(crossing - behind))};
    const double both =
        is_clear ? fmin(crossing_error, first_error) : 1 / sqrt(sum); /* one line and one stem tell them */
    return (plm_end){(crossing_weight * crossing + first_weight * behind) / sum,
                     fmax(both, 0.5 * fabs(crossing - behind))};
}

/* Change of the chord's direction when its ends are off by their standard errors along the line. */
static double end_error(const plm_curve *line, double begin, double end, double begin_error, double end_error)
{
    double direction[3], moved[3], cross[3], squares = 0;
    direction_between(line, begin, end, direction);
    for (int move = 0; move < 4; move++) { /* either end, to both sides */
        const double by = (move % 2 ? 1 : -1) * (move < 2 ? begin_error : end_error) / line->half;
        direction_between(line, begin + (move < 2 ? by : 0), end + (move < 2 ? 0 : by), moved);
        plm_cross(direction, moved, cross);
        squares += 0.5 * plm_dot(cross, cross);
    }
    return sqrt(squares);
}

static void finish_node(const petiole *p, double base_error, plm_axis *axis)
{
    axis->carrier = -1;
    axis->node = axis->node_error = axis->insertion = axis->insertion_error = NAN;
    if (!p->stem) return;
    const plm_axis *stem = p->stem->axis;
    double foot, tangent[3], cross[3];
    plm_stem_off(stem, axis->base, &foot);
    plm_curve_tangent(&stem->line, foot, tangent);
    if (stem->end < stem->begin)
        for (int k = 0; k < 3; k++) tangent[k] = -tangent[k];
    plm_cross(tangent, axis->direction, cross);
    axis->carrier = p->stem->id;
    axis->node = fabs(plm_curve_length(&stem->line, stem->begin, foot));
    axis->node_error = base_error;
    axis->insertion = atan2(plm_norm(cross), plm_dot(tangent, axis->direction));
    axis->insertion_error = hypot(axis->direction_error, hypot(stem->direction_error, node_turn));
}

static plm_status finish(petiole *p, plm_axis *axis, plm_error *error)
{
    const plm_curve *line = line_of(p);
    double *position = p->distance;
    const size_t count = positions(p, line, position);
    if (count < FEWEST_POINTS)
        return plm_fail(error, PLM_E_DEGENERATE, "only %zu of %zu points lie along one line", count, p->points.count);
    plm_end far = plm_blurred_end(position, count, noise_along * p->noise);
    if (p->own)
        far.std_error = hypot(far.std_error, hypot(own_junction_radii * p->radius, own_junction_noise * p->noise));
    if (p->own && line == &p->tube.axis) far.position -= rounded_end * p->radius;
    for (size_t i = 0; i < count; i++) position[i] = -position[i];
    plm_end first = plm_blurred_end(position, count, noise_along * p->noise);
    first.position = -first.position;
    plm_end base = find_base(p, line, first);
    if (!(far.position > base.position))
        return plm_fail(error, PLM_E_DEGENERATE, "the petiole has no length outside of the stem");
    if (p->is_rosettes)
        base.position += fmin(deep_foot_noise * p->noise, deep_foot_most * (far.position - base.position));
    *axis = (plm_axis){.line = *line,
                       .begin = plm_curve_walk(line, 0, base.position),
                       .end = plm_curve_walk(line, 0, far.position),
                       .length = far.position - base.position,
                       .length_error = hypot(base.std_error, far.std_error),
                       .radius = p->radius,
                       .radius_error = INFINITY,
                       .noise = p->noise,
                       .point_count = count,
                       .method = line == &p->line.curve ? "centre line" : "tube fit"};
    if (p->has_tube) axis->fit = plm_tube_note(&p->tube);
    plm_curve_point(line, axis->begin, axis->base);
    plm_curve_point(line, axis->end, axis->tip);
    direction_between(line, axis->begin, axis->end, axis->direction);
    const double fit_error = line == &p->tube.axis ? plm_tube_direction_error(&p->tube, axis->begin, axis->end)
                                                   : plm_centre_line_direction_error(&p->line, axis->begin, axis->end);
    const double shift_error =
        end_error(line, axis->begin, axis->end, base.std_error, hypot(far.std_error, 0.3 * p->radius));
    axis->direction_error = sqrt(1.44 * fit_error * fit_error + shift_error * shift_error + model_error * model_error);
    if (p->own) {
        const double foot_noise = p->stem ? own_foot_noise : own_free_foot_noise;
        const double across = hypot(own_foot_radii * p->radius, foot_noise * p->noise) / axis->length;
        axis->direction_error =
            sqrt(axis->direction_error * axis->direction_error + across * across + own_direction * own_direction);
    }
    if (p->has_tube) plm_tube_radius(&p->tube, 0, &axis->radius_error);
    finish_node(p, base.std_error, axis);
    return PLM_OK;
}

static plm_status fit(const plm_scene *scene, petiole *p, plm_axis *axis, plm_error *error)
{
    double base[3], far[3];
    find_stem(scene, p);
    first_ends(p, base, far);
    const bool has_leaflets = p->leaf && p->leaf->leaflet;
    plm_status status = has_leaflets ? plm_petiole_course(&p->points, base, far, error) : PLM_OK;
    if (status == PLM_OK)
        status = plm_centre_line_fit((const double(*)[3])p->points.xyz, p->points.count, base, far,
                                     (plm_line_shape){1, 1, 0}, &p->line, error);
    if (status == PLM_OK) status = fit_line(&p->points, base, far, p->line.distance, &p->line, error);
    if (status == PLM_OK) status = fit_tube(p, error);
    if (status == PLM_OK && p->stem) status = refit_free_part(p, error);
    if (status == PLM_OK) status = line_of(p) == &p->tube.axis ? flare(p, error) : straighten(p, error);
    if (status == PLM_OK) status = blend_with_tube(p, error);
    if (status == PLM_OK) status = finish(p, axis, error);
    return status;
}

plm_status plm_petiole_axis_fit(const plm_scene *scene, const plm_organ *organ, plm_axis *axis, plm_error *error)
{
    if (organ->count < FEWEST_POINTS)
        return plm_fail(error, PLM_E_DEGENERATE, "the petiole has %zu points; %d are needed", organ->count,
                        FEWEST_POINTS);
    petiole p = {.organ = organ,
                 .leaf = plm_scene_organ(scene, PLM_LABEL_LEAF, organ->id),
                 .own = scene->habit != PLM_HABIT_UNKNOWN,
                 .is_rosettes = scene->habit == PLM_HABIT_ROSETTE};
    plm_status status = plm_tube_points_gather(organ, MOST_POINTS, &p.points, error);
    if (status != PLM_OK) return status;
    p.distance = plm_alloc(2 * p.points.count, sizeof *p.distance, error);
    status = p.distance ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        p.scratch = p.distance + p.points.count;
        plm_axis out;
        status = fit(scene, &p, &out, error);
        if (status == PLM_OK) *axis = out;
    }
    plm_free(p.distance);
    plm_free(p.points.xyz);
    return status;
}
