/* segment/scale.c: below three radii tubes look flat, above five or six their neighbours spoil them: the length of what
 * looks like a tube, over the radius R of the balls that it is judged in, peaks between. A folded strap looks like a tube
 * too, in balls of its width; but points on a tube all lie a radius off its middle, those of a strap do not. */
#include "segment/scale.h"

#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "cloud/order.h"
#include "segment/ball_shape.h"
#include "segment/scratch.h"
#include "segment/thinning.h"

static const double SERIES_RATIO = 1.3;
static const double SMALLEST_SPACINGS = 5, SMALLEST_SIZE = 0.012, LARGEST_SIZE = 0.075;
static const double BALL_CELLS = 5;        /* voxels in R: a ball on a sheet holds about 100 points */
static const double TUBE_LINEARITY = 0.45; /* above: long */
static const double TUBE_ROUNDNESS = 0.6;  /* above: round, not flat */
static const double PEAK_SHARE = 0.75;     /* the smallest R this near to the peak: folded straps peak later */
static const double THICK_RADII =
    2; /* R in radii of the thick tubes at the peak, at least: balls on them reach across */
static const double THICK_GROWTH = 1.1; /* of that radius to the next R, at most: that of straps grows with R */
static const double NOISE_RADII = 10;   /* R in sigmas, at least: a noisier ball is round whatever it holds */
static const double NOISE_WHOLE = 6;    /* the same in sigmas that are not cut by their ball (NOISE_BALL) */
static const double NOISE_BALL = 5;     /* radius in sigmas of the ball that tells sigma: smaller ones cut the noise */
/* ... and so do larger ones, up to this, where the next ball finds so much more (gaussians of a rosette: 5.2 sigmas and 1.5 times). */
static const double NOISE_BALL_DOUBTFUL = 6.5, NOISE_GROWTH = 1.35;
static const double TUBE_THICKNESS = 0.05; /* radius in R, at least: thinner is a line of few points */
static const double TUBE_LEAST = 0.13;     /* tubes shorter than this share of the size are none, ... */
static const double TUBE_DOUBTFUL = 0.06;  /* ... but for this a rosette's petioles, or a sparse plant's stem; ... */
/* ... or for this where the smallest balls are so large a share of the size (COARSE), and the noise of them (BLUR), that they see little of
 * short petioles: noise over radius is 0.1 and more in small rosettes, 0.02 in heads of a few thousand points. (Rosettes of 50 to 60 mm
 * in 0.5 mm of noise: 0.028 and 0.040; 11 single leaves as blurred, 0.006 to 0.07, are not parted by such tubes.) */
static const double TUBE_BLURRED = 0.02, COARSE = 0.03, BLUR = 0.08;
/* Where the smallest balls find the longest tubes, the share of those that lies on a ring, at least (each at its best): 0.35 and more
 * over 90 clouds with tubes, 0.2 and less where balls of a few points on noisy sheets look long. */
static const double TUBE_RING = 0.22;
/* With noise of such a share of the size petioles, whose radius is about as much, show no rings, but are no longer than so many
 * times TUBE_LEAST. (Rosettes whose noise is as wide as their petioles: 0.0065 to 0.012, tubes of 0.2; heads of 2500 to 5000 points
 * and 1.2 mm of noise, whose sheets look long: 0.0044 to 0.0058. Of 12 single leaves with more each stays one, as its tubes part
 * nothing.) */
static const double RINGLESS = 0.008, RINGLESS_LONGEST = 2;
static const double RING_LOW = 0.75, RING_HIGH = 1.3; /* distance from the ball's centroid over the tube's radius */
enum { SPACING_POINTS = 25000, SERIES_MAXIMUM = 24, SMALLEST_COUNT = 20 };

float plm_quantile(float *value, size_t count, double quantile)
{
    if (!count) return 0;
    plm_order_sort(value, count);
    const double place = quantile * (double)(count - 1);
    const size_t low = (size_t)place, high = low + 1 < count ? low + 1 : low;
    return (float)(value[low] + (place - (double)low) * ((double)value[high] - value[low]));
}

static plm_status robust_size(const float (*xyz)[3], size_t count, double *size, plm_error *error)
{
    float *value = plm_alloc(count, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        for (size_t i = 0; i < count; i++) value[i] = xyz[i][axis];
        const double low = plm_quantile(value, count, 0.005), high = plm_quantile(value, count, 0.995);
        sum += (high - low) * (high - low);
    }
    *size = sqrt(sum);
    plm_free(value);
    return PLM_OK;
}

static plm_status thinned_spacing(const float (*xyz)[3], size_t count, double *spacing, plm_error *error)
{
    double cell;
    plm_thinned thinned = {0};
    plm_index *index = NULL;
    float *squared = NULL;
    plm_status status = plm_thin_cell(xyz, count, SPACING_POINTS, &cell, error);
    if (status == PLM_OK) status = plm_thin(xyz, count, cell, &thinned, error);
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])thinned.xyz, thinned.count, &index, error);
    if (status == PLM_OK && !(squared = plm_alloc(thinned.count, sizeof *squared, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_index_table(index, 1, NULL, squared, error);
    if (status == PLM_OK) *spacing = sqrt(plm_quantile(squared, thinned.count, 0.5));
    plm_free(squared);
    plm_index_free(index);
    plm_thinned_free(&thinned);
    return status;
}

/* What one R of the series shows. */
typedef struct trial {
    double radius, tube_length, stem_radius;
    double ring_length; /* of those tube points that lie where the surface of a tube is: straps fill all distances */
    double flat_noise;  /* from the points that deviate least from their sheets */
} trial;

static plm_status try_radius(const float (*xyz)[3], size_t count, double radius, trial *result, plm_error *error)
{
    plm_thinned thinned = {0};
    plm_graph graph = {0};
    plm_ball_shape *shape = NULL;
    float *value = NULL;
    const double cell = radius / BALL_CELLS;
    plm_status status = plm_thin(xyz, count, cell, &thinned, error);
    if (status == PLM_OK) status = plm_ball_graph((const float(*)[3])thinned.xyz, thinned.count, cell, &graph, error);
    if (status == PLM_OK) {
        shape = plm_alloc(thinned.count, sizeof *shape, error);
        value = plm_alloc(thinned.count, sizeof *value, error);
        status = shape && value ? plm_ball_shapes(&graph, radius, shape, error) : PLM_E_MEMORY;
    }
    if (status == PLM_OK) {
        double length = 0, ring = 0;
        size_t tubes = 0;
        for (size_t i = 0; i < thinned.count; i++) value[i] = shape[i].value[2];
        const double noise = sqrt(plm_quantile(value, thinned.count, 0.2));
        for (size_t i = 0; i < thinned.count; i++) {
            const float *l = shape[i].value;
            if (!(l[1] > 0) || 1 - sqrt(l[1] / l[0]) <= TUBE_LINEARITY || sqrt(l[2] / l[1]) <= TUBE_ROUNDNESS) continue;
            const double tube_radius = sqrt((double)l[1] + l[2]); /* a ring has variance r^2 / 2 in each direction */
            if (tube_radius < TUBE_THICKNESS * radius) continue;
            const double own = cell * cell / (2 * PLM_PI * tube_radius), off = shape[i].offset / tube_radius;
            length += own;
            if (off > RING_LOW && off < RING_HIGH) ring += own;
            value[tubes++] = (float)tube_radius;
        }
        *result = (trial){radius, length, plm_quantile(value, tubes, 0.75), ring, noise};
    }
    plm_free(value);
    plm_free(shape);
    plm_graph_free(&graph);
    plm_thinned_free(&thinned);
    return status;
}

/* The smallest R that shows nearly as long tubes as the best one, and shows the thick ones round. */
static int choose_radius(const trial *series, int trials)
{
    int peak = 0, chosen = 0;
    for (int i = 1; i < trials; i++)
        if (series[i].ring_length > series[peak].ring_length) peak = i;
    while (series[chosen].ring_length < PEAK_SHARE * series[peak].ring_length) chosen++;
    const double thick = series[peak].stem_radius;
    if (peak + 1 < trials && series[peak + 1].stem_radius < THICK_GROWTH * thick)
        while (chosen < peak && series[chosen].radius < THICK_RADII * thick) chosen++;
    return chosen;
}

/* Whether the balls of a trial are too small to hold the noise. */
static bool is_cut(const trial *series, int trials, int i)
{
    if (i + 1 >= trials) return false;
    const double radius = series[i].radius, noise = series[i].flat_noise;
    return radius < NOISE_BALL * noise ||
           (radius < NOISE_BALL_DOUBTFUL * noise && series[i + 1].flat_noise > NOISE_GROWTH * noise);
}

plm_status plm_find_scale(const float (*xyz)[3], size_t count, plm_scale *scale, plm_error *error)
{
    if (count < SMALLEST_COUNT) return plm_fail(error, PLM_E_DEGENERATE, "%zu points are too few for organs", count);
    plm_scale out = {0};
    plm_status status = robust_size(xyz, count, &out.size, error);
    if (status == PLM_OK && !(out.size > 0)) status = plm_fail(error, PLM_E_DEGENERATE, "all points are in one place");
    if (status == PLM_OK) status = thinned_spacing(xyz, count, &out.spacing, error);
    if (status != PLM_OK) return status;
    trial series[SERIES_MAXIMUM];
    int trials = 0;
    double radius = fmax(SMALLEST_SPACINGS * out.spacing, SMALLEST_SIZE * out.size);
    const double last = fmax(LARGEST_SIZE * out.size, radius);
    for (; radius <= last && trials < SERIES_MAXIMUM && status == PLM_OK; radius *= SERIES_RATIO)
        status = try_radius(xyz, count, radius, &series[trials++], error);
    if (status != PLM_OK) return status;
    double peak = 0, ring = 0;
    for (int i = 0; i < trials; i++) {
        peak = fmax(peak, series[i].tube_length);
        ring = fmax(ring, series[i].ring_length);
    }
    const bool is_round = series[0].tube_length < peak || ring >= TUBE_RING * peak;
    int wide = 0;
    while (is_cut(series, trials, wide)) wide++;
    out.noise = series[wide].flat_noise;
    trial best = series[choose_radius(series, trials)];
    /* as far as the series goes: a plant of a few such balls shows no tubes in larger ones */
    const double least = fmin(fmax(NOISE_RADII * series[0].flat_noise, NOISE_WHOLE * out.noise), last);
    if (best.radius < least) status = try_radius(xyz, count, least, &best, error);
    out.radius = best.radius;
    out.stem_radius = best.stem_radius;
    out.tube_length = best.tube_length;
    out.has_tubes = is_round && peak >= TUBE_LEAST * out.size;
    /* Tubes as short as a rosette's may not show round; long ones would, but in much noise. */
    out.is_blurred = series[0].radius > COARSE * out.size && series[0].flat_noise > BLUR * series[0].radius;
    const double doubtful = out.is_blurred ? TUBE_BLURRED : TUBE_DOUBTFUL;
    const bool may_be_round = is_round || peak < TUBE_LEAST * out.size;
    const bool is_ringless =
        out.is_blurred && out.noise > RINGLESS * out.size && peak < RINGLESS_LONGEST * TUBE_LEAST * out.size;
    out.is_doubtful = !out.has_tubes && peak >= doubtful * out.size && (may_be_round || is_ringless);
    out.rises = trials > 1 && series[trials - 1].tube_length >= peak;
    if (status == PLM_OK) *scale = out;
    return status;
}
