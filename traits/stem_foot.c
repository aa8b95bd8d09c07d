/* traits/stem_foot.c: the end of the tube that a plant stands on. The lowest point of a leaning stem that is cut off is that of a
 * slanting rim: by heights alone a rim looks like an end that narrows, and the gap behind the lowest point is taken for several times
 * what it is. Along the tube's axis the rim is one place, which all points of the foot tell. Condition: 1; the error is the gap between
 * points along the axis, the noise along it over the root of the points that it blurs, and how the stem is cut. */
#include "traits/stem_foot.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "cloud/subset.h"
#include "traits/cut_end.h"
#include "traits/tube_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIRST = 60,  /* points: how wide the foot is */
    FEWEST = 40, /* points of a foot */
    MOST_POINTS = 20000,
    TUBE_POINTS = 600, /* that the tube is fitted to, at most */
    LOWEST = 5,        /* point from which on the foot's height counts: lower ones may be stray */
    WINDOWS = 2,
    ROUNDS = 3
};

/* The foot's height in radii: the shorter where other organs reach into the longer. */
static const double window[WINDOWS] = {8, 4};
/* Points so near to the tube are on it, by its radius or by the noise; so many of them must be, on so much of its sides. */
static const double near_radius = 0.35, near_noise = 3, least_share = 0.85, least_coverage = 0.5;
/* Robust SD of the points off the tube, at most, by both; and noise per radius. */
static const double rough_radius = 0.2, rough_noise = 1.2, most_noise = 0.8;
static const double upright = 0.82; /* cosine of 35 degrees */
/* Points off the tube that may lie below its end: so many, or this share of the foot's. */
static const double few = 2, stray_share = 0.01;
/* A tube so many times as thick as the lowest points are wide is what several organs lie on. */
static const double widest = 3;
/* What is left by the model: of the radius, as no stem is a cone cut by a plane, and of the noise. */
static const double round_error = 0.04, noise_error = 0.2;
/* An end that is less sure than what was seen, and than this part of the radius, tells nothing. */
static const double told = 0.2;
/* Heights alone know their error from points that are taken for an end that narrows. Where it is so much less than that of the tube's
 * end they lie close, and tell it all the same. */
static const double surer = 4;
/* The foot's part of the height, at most; and change of its radius by length. */
static const double tallest = 0.5, most_taper = 0.1;

/** The points of the foot, the lowest first. */
typedef struct foot_points {
    size_t count;
    double (*xyz)[3];
} foot_points;

static int compare_heights(const void *a, const void *b)
{
    const double *p = a, *q = b;
    for (int k = 2; k >= 0; k--)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* The points up to a height, in place of what foot held; where there are many more than tell it, about MOST_POINTS of them. */
static plm_status take_below(const float (*xyz)[3], size_t count, double height, foot_points *foot, plm_error *error)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) found += xyz[i][2] <= height;
    float(*all)[3] = plm_alloc(found, sizeof *all, error);
    uint32_t *row = plm_alloc(found, sizeof *row, error);
    plm_free(foot->xyz);
    foot->count = 0;
    foot->xyz = NULL;
    plm_status status = all && row ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        found = 0;
        for (size_t i = 0; i < count; i++)
            if (xyz[i][2] <= height) memcpy(all[found++], xyz[i], sizeof *all);
        foot->count = plm_sample_rows((const float(*)[3])all, found, MOST_POINTS, row);
        foot->xyz = plm_alloc(foot->count, sizeof *foot->xyz, error);
        if (!foot->xyz) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) {
        for (size_t i = 0; i < foot->count; i++)
            for (int k = 0; k < 3; k++) foot->xyz[i][k] = all[row[i]][k];
        qsort(foot->xyz, foot->count, sizeof *foot->xyz, compare_heights);
        if (foot->count < FIRST) status = plm_fail(error, PLM_E_DEGENERATE, "most points are in one place");
    }
    plm_free(all);
    plm_free(row);
    return status;
}

/** What the FIRST lowest points tell. */
typedef struct lowest_points {
    double low, high, width; /* heights of the lowest that is not stray and of the highest of them; see width_of */
    double plant;            /* from the highest of them to the plant's top */
} lowest_points;

/* Median distance of the first points from their middle, seen from above. */
static double width_of(const foot_points *foot)
{
    double value[FIRST], middle[2];
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < FIRST; i++) value[i] = foot->xyz[i][k];
        middle[k] = plm_order_median(value, FIRST);
    }
    for (size_t i = 0; i < FIRST; i++) value[i] = hypot(foot->xyz[i][0] - middle[0], foot->xyz[i][1] - middle[1]);
    return plm_order_median(value, FIRST);
}

static plm_status look_at_lowest(const float (*xyz)[3], size_t count, foot_points *foot, lowest_points *lowest,
                                 plm_error *error)
{
    double *z = plm_alloc(count, sizeof *z, error), top = -INFINITY;
    if (!z) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) z[i] = xyz[i][2], top = fmax(top, z[i]);
    const double first = plm_order_select(z, count, FIRST - 1);
    plm_free(z);
    const plm_status status = take_below(xyz, count, first, foot, error);
    if (status == PLM_OK) *lowest = (lowest_points){foot->xyz[LOWEST][2], first, width_of(foot), top - first};
    return status;
}

/* The mean of a third of the foot's points: 0 the lowest, 2 the highest. */
static void mean_of_third(const foot_points *foot, size_t third, double mean[3])
{
    const size_t first = third * foot->count / 3, end = (third + 1) * foot->count / 3;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t i = first; i < end; i++)
        for (int k = 0; k < 3; k++) mean[k] += foot->xyz[i][k] / (double)(end - first);
}

/* Fits the tube to TUBE_POINTS of the foot's points. PLM_E_DEGENERATE: they tell none. */
static plm_status fit_tube(const foot_points *foot, plm_tube *tube, plm_error *error)
{
    const size_t stride = (foot->count + TUBE_POINTS - 1) / TUBE_POINTS;
    double sample[TUBE_POINTS][3], begin[3], end[3];
    size_t count = 0;
    for (size_t i = 0; i < foot->count; i += stride) memcpy(sample[count++], foot->xyz[i], sizeof *sample);
    mean_of_third(foot, 0, begin);
    mean_of_third(foot, 2, end);
    plm_curve start;
    if (!plm_curve_line(begin, end, 1, 1, &start))
        return plm_fail(error, PLM_E_DEGENERATE, "the lowest points are in one place");
    return plm_tube_fit((const double(*)[3])sample, count, &start, PLM_TUBE_TAPERED, tube, error);
}

/* The tube as a cone about a straight axis that points up. */
static plm_cut_tube straight(const plm_tube *tube, double noise, bool fused)
{
    plm_cut_tube cone = {.noise = noise, .fused = fused};
    double end[3];
    plm_curve_point(&tube->axis, 0, cone.origin);
    plm_curve_point(&tube->axis, 1, end);
    for (int k = 0; k < 3; k++) cone.axis[k] = end[k] - cone.origin[k];
    const double half = plm_norm(cone.axis), sign = cone.axis[2] < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) cone.axis[k] *= sign / half;
    cone.radius = tube->radius[0];
    cone.taper = sign * tube->radius[1] / half;
    return cone;
}

/* Leaves the points that are on the tube, their order kept; gives how low the others reach but for those that may be stray (INFINITY:
 * there are no more). */
static double keep_on_tube(foot_points *foot, const plm_cut_tube *tube, double tolerance)
{
    const size_t stray = (size_t)fmax(few, stray_share * (double)foot->count);
    size_t kept = 0, off_tube = 0;
    double others = INFINITY;
    for (size_t i = 0; i < foot->count; i++) {
        double gap[3];
        for (int k = 0; k < 3; k++) gap[k] = foot->xyz[i][k] - tube->origin[k];
        const double along = plm_dot(gap, tube->axis), off = sqrt(fmax(plm_dot(gap, gap) - along * along, 0));
        if (fabs(off - (tube->radius + tube->taper * along)) <= tolerance)
            memmove(foot->xyz[kept++], foot->xyz[i], sizeof *foot->xyz);
        else if (off_tube++ == stray)
            others = foot->xyz[i][2];
    }
    foot->count = kept;
    return others;
}

/* The foot within a window of so many radii, and its tube, found together. PLM_E_DEGENERATE: it is none. */
static plm_status find_foot(const float (*xyz)[3], size_t count, double radii, double noise,
                            const lowest_points *lowest, foot_points *foot, plm_tube *tube, plm_error *error)
{
    double width = lowest->width;
    plm_status status = PLM_OK;
    if (radii * width > tallest * lowest->plant)
        return plm_fail(error, PLM_E_DEGENERATE, "the lowest points are no foot");
    for (int round = 0; round < ROUNDS && status == PLM_OK; round++) {
        const double height = fmax(lowest->low + radii * fmax(width, noise), lowest->high);
        status = take_below(xyz, count, height, foot, error);
        if (status == PLM_OK) status = fit_tube(foot, tube, error);
        if (status == PLM_OK && tube->radius[0] > widest * fmax(lowest->width, noise))
            status = plm_fail(error, PLM_E_DEGENERATE, "the lowest points are no foot");
        if (status == PLM_OK) width = tube->radius[0];
    }
    return status;
}

static bool is_tube(const plm_tube *tube, const plm_cut_tube *cone)
{
    return cone->noise < most_noise * cone->radius && cone->axis[2] > upright && fabs(cone->taper) < most_taper &&
           tube->coverage >= least_coverage &&
           tube->robust_sd < rough_radius * cone->radius + rough_noise * cone->noise;
}

/* The end of the foot's tube. end: NAN where the points lie on none, or what is off it lies lower. */
static plm_status find_end(foot_points *foot, const plm_tube *tube, const plm_sampling *sampling, double noise,
                           double *end, double *std_error, plm_error *error)
{
    *end = NAN;
    plm_cut_tube cone = straight(tube, noise, sampling->fused);
    if (!is_tube(tube, &cone)) return PLM_OK;
    cone.noise = fmin(noise, tube->robust_sd); /* on surfaces as bent as a thin stem's too much is read */
    const double all = (double)foot->count,
                 others = keep_on_tube(foot, &cone, fmax(near_radius * cone.radius, near_noise * noise));
    if (foot->count < FEWEST || (double)foot->count < least_share * all) return PLM_OK;
    const plm_status status = plm_cut_end((const double(*)[3])foot->xyz, foot->count, &cone, end, std_error, error);
    if (status != PLM_OK) return status;
    const double turn = plm_tube_direction_error(tube, -1, 1) * cone.radius;
    *std_error = sqrt(*std_error * *std_error + turn * turn + pow(round_error * cone.radius, 2) +
                      pow(noise_error * cone.noise, 2));
    if (!(others > *end - near_noise * cone.noise)) *end = NAN;
    return PLM_OK;
}

plm_status plm_stem_foot(const float (*xyz)[3], size_t count, plm_extreme *base, bool *changed, plm_error *error)
{
    *changed = false;
    if (count < FIRST) return PLM_OK;
    const plm_sampling *sampling = &base->sampling;
    const double noise = sampling->noise > PLM_NOISE_FREE * sampling->spacing ? sampling->noise : 0;
    foot_points foot = {0};
    lowest_points lowest;
    plm_status status = look_at_lowest(xyz, count, &foot, &lowest, error);
    for (int w = 0; w < WINDOWS && status == PLM_OK && !*changed; w++) {
        plm_tube tube = {0};
        double end = NAN, std_error = NAN;
        status = find_foot(xyz, count, window[w], noise, &lowest, &foot, &tube, error);
        if (status == PLM_OK) status = find_end(&foot, &tube, sampling, noise, &end, &std_error, error);
        if (status == PLM_E_DEGENERATE) status = PLM_OK;
        const double most_error = fmin(fmax(base->std_error, told * tube.radius[0]), surer * base->std_error);
        if (isnan(end) || !(std_error < most_error)) continue;
        base->value = -end;
        base->std_error = std_error;
        *changed = true;
    }
    plm_free(foot.xyz);
    return status == PLM_E_DEGENERATE ? PLM_OK : status;
}
