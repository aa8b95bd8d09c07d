/* traits/rosette_base.c: the lowest surface of a rosette is the underside of its lowest petiole where all of them meet, which
 * the others hide, and the noise of the soil below it. Each petiole says where that would be: its line prolonged to the plant's
 * foot, less its radius. The least of unsure values is too low: so each is drawn towards their mean as far as it is unsure
 * (empirical Bayes), and the expected least one is taken; soil that is seen tells as well. Condition: length of the prolonged
 * petiole over that of the seen one. */
#include "traits/rosette_base.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "traits/axis.h"
#include "traits/plant_foot.h"
#include "traits/soil_base.h"
#include "traits/tube_diameter.h"

#include <math.h>

enum { FEWEST_PETIOLES = 3, NEWTON_STEPS = 8, INTEGRAL_STEPS = 400 };

static const double low_share = 0.45; /* height over width: virtual rosettes have 0.2 to 0.4 */
static const double stands = 3;       /* petiole's radii from the soil up to the plant's underside, at most */
/* What was seen ends so many SDs of the noise above that, at most, and what soil and petioles tell are so many standard errors apart. */
static const double near_noise = 4, most_apart = 3;
static const double tail = 6; /* SD beyond which a normal value is not looked for */
/* What petioles tell is known no worse than so many times what was seen is (1.9 of a splat that it mends, by 0.9 mm of 19.7). */
static const double least_known = 3;
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
    double noise;  /* of the petiole's points */
    double radius; /* of the petiole */
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
                       .noise = axis->noise,
                       .radius = 0.5 * diameter};
    return behind < axis->length && isfinite(out->height) && isfinite(out->std_error) && out->std_error > 0;
}

/* Draws the heights towards their mean as far as they are unsure: each becomes what is known of it beside the others, with the
 * standard error that is its own. Gives that of the mean, as far as they share it. apart: SD of the true heights, at least, as petioles
 * that come out of one crown lie on each other. (Of few unsure heights moments often tell none, and the least is the mean then: bases of 134
 * virtual rosettes in noise were 0.22 mm too high, and are 0.09.) */
static double draw_together(underside *side, size_t count, double apart)
{
    double weights = 0, squares = 0, mean = 0, chi = 0;
    for (size_t i = 0; i < count; i++) {
        const double w = 1 / (side[i].std_error * side[i].std_error);
        weights += w, squares += w * w, mean += w * side[i].height;
    }
    mean /= weights;
    for (size_t i = 0; i < count; i++) chi += pow((side[i].height - mean) / side[i].std_error, 2);
    /* variance of the true heights, by moments (R. DerSimonian, N. Laird 1986) */
    const double moments = fmax(chi - (double)(count - 1), 0) / (weights - squares / weights);
    const double between = fmax(moments, apart * apart);
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

/* radius: room for count. */
static double usual_radius(const underside *side, size_t count, double *radius)
{
    for (size_t i = 0; i < count; i++) radius[i] = side[i].radius;
    return plm_order_median(radius, count);
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
    if (!(high > low)) return (underside){low, 0, noise, 0}; /* all alike */
    const double step = (high - low) / INTEGRAL_STEPS;
    double mean = 0, squares = 0; /* of the least value over low */
    for (int k = 0; k < INTEGRAL_STEPS; k++) {
        const double over = (k + 0.5) * step;
        double above = 1;
        for (size_t i = 0; i < count; i++)
            above *= 0.5 * erfc((low + over - side[i].height) / (sqrt(2) * side[i].std_error));
        mean += above * step, squares += 2 * over * above * step;
    }
    return (underside){low + mean, sqrt(fmax(squares - mean * mean, 0)), noise, 0};
}

static bool is_noisy(const plm_extreme *base)
{
    return base->sampling.noise > PLM_NOISE_FREE * base->sampling.spacing;
}

/* Where the soil about the foot is seen, and what was seen of the plant ends near it, the rosette stands on it: the underside of its
 * lowest petiole is somewhere between the soil and `stands` of a petiole's radii above it (the least of radii: points of others make
 * petioles wide). Weighs that with what petioles tell, each as far as the two may be apart by chance. Labels that were given, and
 * scans without noise, need no soil for it. */
static plm_status stand_on_soil(const plm_scene *scene, const double foot[2], double height, const plm_extreme *base,
                                const underside *side, size_t count, underside *told, bool *standing, plm_error *error)
{
    const double noise = base->sampling.noise;
    double radius = INFINITY, soil, soil_error;
    *standing = false;
    if (scene->labels_given || !is_noisy(base)) return PLM_OK;
    for (size_t i = 0; i < count; i++) radius = fmin(radius, side[i].radius);
    bool seen;
    const plm_status status =
        plm_soil_height(scene, foot, radius, height, height, told->noise, &soil, &soil_error, &seen, error);
    if (status != PLM_OK || !seen) return status;
    const double above = 0.5 * stands * radius, apart = told->height - (soil + above);
    const double soils = soil_error * soil_error + above * above / 3, petioles = told->std_error * told->std_error;
    if (-base->value - soil > 2 * above + near_noise * noise ||
        apart * apart > most_apart * most_apart * (soils + petioles))
        return PLM_OK;
    const double between = 0.5 * fmax(apart * apart - soils - petioles, 0); /* variance, by moments as above */
    const double one = 1 / (soils + between), other = 1 / (petioles + between);
    told->height = (one * (soil + above) + other * told->height) / (one + other);
    told->std_error = sqrt(1 / (one + other));
    *standing = true;
    return PLM_OK;
}

/* Weighs what petioles tell with what was seen. In noise what was seen lies no lower than the base, which is hidden: as far as it lies
 * higher than can be chance it tells nothing, and just above soil, where labels end in the noise of both, nothing at all. Where it lies
 * lower than is told (leaves may hang), or is known far better, it stays: false. A scan without noise shows points of the base or none,
 * and how far it lies beyond them is a guess: what is told counts as far as the two may be apart by chance. */
static bool join(const underside *told, bool standing, plm_extreme *base)
{
    const double above = -base->value - told->height;
    if (!(base->std_error > 0) || !isfinite(above)) return false;
    if (is_noisy(base) && (!(above > 0) || !(standing || told->std_error < least_known * base->std_error)))
        return false;
    double told_squared = told->std_error * told->std_error, seen_squared = base->std_error * base->std_error;
    if (standing)
        seen_squared = INFINITY;
    else if (above > 0)
        seen_squared = fmax(seen_squared, above * above - told_squared);
    else
        told_squared = fmax(told_squared, above * above - seen_squared);
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

plm_status plm_rosette_base(const plm_scene *scene, double height, plm_extreme *base, bool *lowered, bool *on_soil,
                            plm_error *error)
{
    *lowered = *on_soil = false;
    if (scene->options->deadline || has_stem(scene)) return PLM_OK;
    double foot[2], foot_error;
    bool found;
    plm_status status = plm_plant_foot(scene, foot, &foot_error, &found, error);
    if (status != PLM_OK || !found) return status;
    underside *side = plm_alloc(scene->organ_count, sizeof *side, error);
    double *radius = plm_alloc(scene->organ_count, sizeof *radius, error);
    if (!side || !radius) status = PLM_E_MEMORY;
    size_t count = 0;
    for (size_t k = 0; k < scene->organ_count && status == PLM_OK; k++) {
        const plm_organ *organ = &scene->organ[k];
        if (organ->label == PLM_LABEL_PETIOLE && organ->axis)
            count += underside_of(scene, organ->axis, foot, foot_error, &side[count]);
    }
    if (count >= FEWEST_PETIOLES) {
        const double apart = usual_radius(side, count, radius), shared = draw_together(side, count, apart);
        underside told = least_of(side, count);
        told.std_error = hypot(hypot(told.std_error, shared), noise_unknown * told.noise);
        bool standing = false;
        status = stand_on_soil(scene, foot, height, base, side, count, &told, &standing, error);
        if (status == PLM_OK) *lowered = join(&told, standing, base);
        *on_soil = standing && *lowered;
    }
    plm_free(side);
    plm_free(radius);
    return status;
}
