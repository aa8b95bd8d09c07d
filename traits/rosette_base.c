/* traits/rosette_base.c: the lowest surface of a rosette is the underside of its lowest petiole where all of them meet, which
 * the others hide. Each petiole says where that would be: its line prolonged to the plant's foot, less its radius. The least of
 * unsure values is too low: so each is drawn towards their mean as far as it is unsure (empirical Bayes), and the expected least
 * one is taken. Condition: length of the prolonged petiole over that of the seen one. */
#include "traits/rosette_base.h"

#include "cloud/linear.h"
#include "traits/axis.h"
#include "traits/plant_foot.h"
#include "traits/tube_diameter.h"

#include <math.h>

enum { FEWEST_PETIOLES = 3, NEWTON_STEPS = 8, INTEGRAL_STEPS = 400 };

static const double low_share = 0.45; /* height over width: virtual rosettes have 0.2 to 0.4 */
static const double tail = 6;         /* SD beyond which a normal value is not looked for */
/* Part of the noise that stays in all radii as a common error, as in an extreme of the surface. */
static const double noise_unknown = 0.5;

bool plm_may_be_rosette(const plm_scene *scene)
{
    double mean[2] = {0}, low = INFINITY, high = -INFINITY, farthest = 0;
    for (size_t i = 0; i < scene->plant_count; i++) {
        for (int k = 0; k < 2; k++) mean[k] += scene->plant[i][k] / (double)scene->plant_count;
        low = fmin(low, scene->plant[i][2]);
        high = fmax(high, scene->plant[i][2]);
    }
    for (size_t i = 0; i < scene->plant_count; i++)
        farthest = fmax(farthest, hypot(scene->plant[i][0] - mean[0], scene->plant[i][1] - mean[1]));
    return high - low < low_share * 2 * farthest;
}

/** The height of the plant's underside as a petiole tells it. */
typedef struct underside {
    double height, std_error;
    double noise; /* of the petiole's points */
} underside;

/* Parameter at which a petiole's line comes nearest to a vertical one. */
static double nearest_to_vertical(const plm_axis *axis, const double place[2])
{
    double t = axis->begin;
    for (int step = 0; step < NEWTON_STEPS; step++) {
        double at[3], first[3], second[3];
        plm_curve_derivatives(&axis->line, t, at, first, second);
        const double off[2] = {at[0] - place[0], at[1] - place[1]};
        t -= (off[0] * first[0] + off[1] * first[1]) / (first[0] * first[0] + first[1] * first[1]);
    }
    return t;
}

/* Whether a petiole leads to the foot, and then its underside there. */
static bool underside_of(const plm_scene *scene, const plm_axis *axis, const double foot[2], double foot_error,
                         underside *out)
{
    double diameter, diameter_error;
    if (!isfinite(axis->radius_error)) return false; /* no tube was found */
    plm_tube_deflate(2 * axis->radius, 2 * axis->radius_error, axis->noise, &scene->sampling, &diameter,
                     &diameter_error);
    const double t = nearest_to_vertical(axis, foot);
    double at[3], tangent[3];
    plm_curve_point(&axis->line, t, at);
    plm_curve_tangent(&axis->line, t, tangent);
    const double behind = fabs(plm_curve_length(&axis->line, t, axis->begin)), lever = 0.5 * axis->length + behind;
    /* a line that misses the foot sideways misses it as much in height; along the line the foot is as unsure as it is */
    const double flat = hypot(tangent[0], tangent[1]), shift = foot_error * fabs(tangent[2]) / flat;
    const double off = hypot(hypot(at[0] - foot[0], at[1] - foot[1]), shift);
    *out = (underside){.height = at[2] - 0.5 * diameter * flat,
                       .std_error = hypot(off, hypot(axis->direction_error * lever, 0.5 * diameter_error)),
                       .noise = axis->noise};
    return behind < axis->length && isfinite(out->height) && isfinite(out->std_error) && out->std_error > 0;
}

/* Draws the heights towards their mean as far as they are unsure: each becomes what is known of it beside the others, with the
 * standard error that is its own. Gives that of the mean, as far as they share it. */
static double draw_together(underside *side, size_t count)
{
    double weights = 0, squares = 0, mean = 0, chi = 0;
    for (size_t i = 0; i < count; i++) {
        const double w = 1 / (side[i].std_error * side[i].std_error);
        weights += w, squares += w * w, mean += w * side[i].height;
    }
    mean /= weights;
    for (size_t i = 0; i < count; i++) chi += pow((side[i].height - mean) / side[i].std_error, 2);
    /* variance of the true heights, by moments (R. DerSimonian, N. Laird 1986) */
    const double between = fmax(chi - (double)(count - 1), 0) / (weights - squares / weights);
    double centre = 0, centre_weights = 0;
    for (size_t i = 0; i < count; i++) {
        const double w = 1 / (side[i].std_error * side[i].std_error + between);
        centre += w * side[i].height, centre_weights += w;
    }
    centre /= centre_weights;
    double shared = 0;
    for (size_t i = 0; i < count; i++) {
        const double variance = side[i].std_error * side[i].std_error, kept = between / (between + variance);
        side[i].height = centre + kept * (side[i].height - centre);
        side[i].std_error = sqrt(kept * variance);
        shared += pow(1 - kept, 2) / centre_weights / (double)count;
    }
    return sqrt(shared);
}

/* Mean and SD of the least of independent normal values, from the chance that all lie above a height. */
static underside least_of(const underside *side, size_t count)
{
    double low = INFINITY, high = INFINITY, noise = 0;
    for (size_t i = 0; i < count; i++) {
        low = fmin(low, side[i].height - tail * side[i].std_error);
        high = fmin(high, side[i].height + tail * side[i].std_error);
        noise += side[i].noise / (double)count;
    }
    if (!(high > low)) return (underside){low, 0, noise}; /* all alike */
    const double step = (high - low) / INTEGRAL_STEPS;
    double mean = 0, squares = 0; /* of the least value over low */
    for (int k = 0; k < INTEGRAL_STEPS; k++) {
        const double over = (k + 0.5) * step;
        double above = 1;
        for (size_t i = 0; i < count; i++)
            above *= 0.5 * erfc((low + over - side[i].height) / (sqrt(2) * side[i].std_error));
        mean += above * step, squares += 2 * over * above * step;
    }
    return (underside){low + mean, sqrt(fmax(squares - mean * mean, 0)), noise};
}

/* What was seen lies no lower than the base: as far as it lies higher than can be chance it tells nothing. Where it lies lower
 * than is told, or is known better, it stays: false. */
static bool join(const underside *told, plm_extreme *base)
{
    const double told_error = hypot(told->std_error, noise_unknown * told->noise), above = -base->value - told->height;
    if (!(told_error < base->std_error) || !(above > 0)) return false;
    const double told_squared = told_error * told_error;
    const double seen_squared = fmax(base->std_error * base->std_error, above * above - told_squared);
    const double sum = 1 / seen_squared + 1 / told_squared;
    base->value = (base->value / seen_squared - told->height / told_squared) / sum;
    base->std_error = sqrt(1 / sum);
    return true;
}

static bool has_stem(const plm_scene *scene)
{
    for (size_t k = 0; k < scene->organ_count; k++)
        if (scene->organ[k].label == PLM_LABEL_STEM) return true;
    return false;
}

plm_status plm_rosette_base(const plm_scene *scene, plm_extreme *base, bool *lowered, plm_error *error)
{
    *lowered = false;
    if (scene->options->deadline || has_stem(scene)) return PLM_OK;
    double foot[2], foot_error;
    bool found;
    const plm_status status = plm_plant_foot(scene, foot, &foot_error, &found, error);
    if (status != PLM_OK || !found) return status;
    underside *side = plm_alloc(scene->organ_count, sizeof *side, error);
    if (!side) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t k = 0; k < scene->organ_count; k++) {
        const plm_organ *organ = &scene->organ[k];
        if (organ->label == PLM_LABEL_PETIOLE && organ->axis)
            count += underside_of(scene, organ->axis, foot, foot_error, &side[count]);
    }
    if (count >= FEWEST_PETIOLES) {
        const double shared = draw_together(side, count);
        underside told = least_of(side, count);
        told.std_error = hypot(told.std_error, shared);
        *lowered = join(&told, base);
    }
    plm_free(side);
    return status;
}
