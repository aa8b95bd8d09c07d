/* traits/extreme.c: extremes of a sampled, noisy surface: the outermost points are chosen, freed of those that nothing
 * supports, and projected onto the surface; traits/sample_end.c says where the surface ends behind them. */
#include "traits/extreme.h"

#include "cloud/linear.h"
#include "traits/sample_end.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    BINS = 4096,
    BAND_POINTS = 2000, /* enough to know spacing and noise by */
    BALL_ROOM = 1024,
    QUADRIC_POINTS = 400,
    QUADRIC_USUAL = 48, /* fewer leave half of the noise in the projected points */
    QUADRIC_FEWEST = 12,
    PROJECTION_STEPS = 2,
    FIT_POINTS = 160,
    SUPPORT = 8 /* neighbours that support a point */
};

/* Noise along the surface per noise across it, which projection does not take away: of voxel means (elsewhere a quarter to the whole of
 * it: traits/sample_end.c finds which). */
static const double fused_along = 0.7;
/* Part of the noise that stays in an extreme as a common error: the noise is known to a half. */
static const double noise_unknown = 0.5;
/* Distance to the 8th neighbour on a sheet in spacings, and by which factor it may be exceeded: in voxel means, which are
 * even, points of the plant reach 1.7 at leaf tips, ghosts begin at 1.2. Elsewhere against that of the neighbours. */
static const double reach_per_spacing = 1.545, fused_reach = 1.8, uneven_reach = 3.0;
/* ... and against the whole plant's, as floaters have floaters beside them: splats are 20-fold uneven, a factor of 4.5. */
static const double alone_reach = 6.0;
/* SD of noise by which a point is thrown off its surface at most. */
static const double thrown_down = 3;
/* Neighbours that lie off the quadric by so much more than the noise, as much again by their shape, are no one surface: thin
 * tubes that meet, as the petioles at a rosette's foot. A point there is as high as it was seen, with all of its noise. */
static const double no_surface = 1.4;
/* So are neighbours that lie hardly less far off their surface than they reach across it, as a tube thinner than the noise and the
 * end of any have them: their normal points anywhere. What was seen counts there, with the noise across the tube. (Below 1.3 and
 * above 1.7 tops and feet of 96 virtual splats are worse.) */
static const double least_flatness = 1.5;
/* A projection whose last step is shorter than this much of the noise is done. */
static const double settled = 0.4;
/* The centres of fitted discs stay inside a rim: by which part of their radius and give or take which; 0.1 and 0.7 in two
 * families of virtual splats. */
static const double disc_reach = 0.4, disc_known = 0.4;
/* Depth cameras look from the side, and noise lies along their rays: an upper end has less of it than the surface's noise says, and
 * comes out too low by so many SD (48 virtual plants 0.72, 32 others 0.38, four of another family 0.6, cameras 15 to 40 degrees above
 * the horizon; scatter 0.66 between plants). */
static const double top_lost = 0.55, top_unknown = 0.66;
/* Depth of a band per noise, at least. */
static const double band_noise = 12;

/* ---- Projection ------------------------------------------------------------------------------------------------ */

typedef struct patch {
    double (*local)[3]; /* u, v, height of the neighbours about the point, in the tangent frame */
    double *weight;
    size_t count;
} patch;

/* Tangent frame of weighted neighbours: axis[2] is the normal. Gives their flatness (see plm_projection). */
static double tangent_frame(const double (*offset)[3], const double *weight, size_t count, double axis[3][3])
{
    double sum = 0, mean[3] = {0}, moment[6] = {0}, value[3];
    for (size_t i = 0; i < count; i++) {
        sum += weight[i];
        for (int k = 0; k < 3; k++) mean[k] += weight[i] * offset[i][k];
    }
    for (int k = 0; k < 3; k++) mean[k] /= sum;
    for (size_t i = 0; i < count; i++) {
        const double x = offset[i][0] - mean[0], y = offset[i][1] - mean[1], z = offset[i][2] - mean[2];
        moment[0] += weight[i] * x * x, moment[1] += weight[i] * x * y, moment[2] += weight[i] * x * z;
        moment[3] += weight[i] * y * y, moment[4] += weight[i] * y * z, moment[5] += weight[i] * z * z;
    }
    plm_eigen3(moment, value, axis);
    return value[0] > 0 ? value[1] / fmax(value[2], 1e-12 * value[0]) : INFINITY;
}

/* The products of powers of u and v up to the fourth, and which of them is the product of two terms of a quadric. */
enum { TERMS = 6, PRODUCTS = 15 };

static const unsigned char product[TERMS][TERMS] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                                    {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                                    {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};

/** Sums over the neighbours, by weight and by its square. */
typedef struct quadric_sums {
    double product[PRODUCTS], product_squared[PRODUCTS], right[TERMS], squares;
} quadric_sums;

static quadric_sums sum_up(const patch *p, double scale)
{
    quadric_sums sum = {0};
    for (size_t i = 0; i < p->count; i++) {
        const double u = p->local[i][0] / scale, v = p->local[i][1] / scale, uu = u * u, uv = u * v, vv = v * v;
        const double of[PRODUCTS] = {1,      u,      v,       uu,      uv,      vv,      u * uu, v * uu,
                                     u * vv, v * vv, uu * uu, uu * uv, uu * vv, uv * vv, vv * vv};
        const double w = p->weight[i], squared = w * w, h = p->local[i][2];
        for (int k = 0; k < PRODUCTS; k++) sum.product[k] += w * of[k];
        for (int k = 0; k < PRODUCTS; k++) sum.product_squared[k] += squared * of[k];
        for (int k = 0; k < TERMS; k++) sum.right[k] += w * h * of[k];
        sum.squares += w * h * h;
    }
    return sum;
}

/* The weighted quadric at u = v = 0: its height, its leverage (the variance of that height per variance of the points), and
 * the points' root mean square distance from it. False where the neighbours do not determine it. */
static bool quadric_height(const patch *p, double scale, double *height, double *leverage, double *rest)
{
    const quadric_sums sum = sum_up(p, scale);
    double normal[TERMS * TERMS], factor[TERMS * TERMS], solved[TERMS], unit[TERMS] = {1}, squares = sum.squares;
    for (int a = 0; a < TERMS; a++)
        for (int b = 0; b < TERMS; b++) normal[a * TERMS + b] = sum.product[product[a][b]];
    for (int a = 1; a < TERMS; a++) normal[a * (TERMS + 1)] *= 1 + 1e-6; /* a ridge for slivers */
    memcpy(solved, sum.right, sizeof solved);
    memcpy(factor, normal, sizeof factor);
    if (!plm_solve_spd(TERMS, normal, solved) || !plm_solve_spd(TERMS, factor, unit)) return false;
    *height = solved[0];
    *leverage = 0;
    for (int a = 0; a < TERMS; a++) squares -= solved[a] * sum.right[a];
    *rest = sqrt(fmax(squares, 0) / sum.product[0]);
    for (int a = 0; a < TERMS; a++)
        for (int b = 0; b < TERMS; b++) *leverage += unit[a] * sum.product_squared[product[a][b]] * unit[b];
    return true;
}

/* Fits the quadric through the neighbours of a place but the point `without`, weighted down by distance, and moves the
 * place onto it. False where they determine none. */
static bool step_to_surface(const plm_subset *points, const float without[3], double noise, const double place[3],
                            double moved[3], plm_projection *onto)
{
    const plm_index *index = points->index;
    const float(*xyz)[3] = points->xyz;
    uint32_t row[BALL_ROOM];
    float squared[BALL_ROOM];
    const float centre[3] = {(float)place[0], (float)place[1], (float)place[2]};
    size_t found = plm_index_ball(index, centre, (float)(5 * noise), BALL_ROOM, row, squared);
    if (found < QUADRIC_USUAL) found = plm_index_nearest(index, centre, QUADRIC_USUAL, row, squared);
    if (found > BALL_ROOM) found = plm_index_nearest(index, centre, BALL_ROOM, row, squared);
    if (found < QUADRIC_FEWEST) return false;
    const size_t stride = (found + QUADRIC_POINTS - 1) / QUADRIC_POINTS;
    double offset[QUADRIC_POINTS][3], weight[QUADRIC_POINTS], local[QUADRIC_POINTS][3], axis[3][3];
    patch p = {local, weight, 0};
    for (size_t i = 0; i < found; i += stride) {
        if (memcmp(xyz[row[i]], without, sizeof xyz[row[i]]) == 0) continue;
        const double d = sqrt((double)squared[i]) / (3 * noise);
        weight[p.count] = 1 / (1 + d * d * d * d);
        for (int k = 0; k < 3; k++) offset[p.count][k] = (double)xyz[row[i]][k] - place[k];
        p.count++;
    }
    if (p.count < QUADRIC_FEWEST) return false;
    onto->flatness = tangent_frame((const double(*)[3])offset, weight, p.count, axis);
    for (size_t i = 0; i < p.count; i++)
        for (int k = 0; k < 3; k++) local[i][k] = plm_dot(offset[i], axis[k]);
    double height;
    if (!quadric_height(&p, 5 * noise, &height, &onto->leverage, &onto->rest) || !(fabs(height) < 4 * noise))
        return false;
    onto->leverage = fmin(onto->leverage, 1);
    for (int k = 0; k < 3; k++) {
        moved[k] = place[k] + height * axis[2][k];
        onto->normal[k] = axis[2][k];
        onto->axis[k] = axis[0][k];
    }
    return true;
}

/* An outermost point is one that noise threw out: it would draw the surface to itself, so it has no say in it, and what lies
 * beside it, which counts more, was thrown out like it: the step is repeated from where it led to. */
bool plm_project_to_surface(const plm_subset *points, const float point[3], double noise, plm_projection *onto)
{
    double place[3] = {point[0], point[1], point[2]}, moved[3];
    for (int step = 0; step < PROJECTION_STEPS; step++) {
        if (!step_to_surface(points, point, noise, place, moved, onto)) return false;
        double squares = 0;
        for (int k = 0; k < 3; k++) squares += pow(moved[k] - place[k], 2), place[k] = moved[k];
        if (squares < pow(settled * noise, 2)) break;
    }
    /* Steps on a tube that is thinner than the fit is wide drift along it: only what lies across the surface is noise. */
    double across = 0;
    for (int k = 0; k < 3; k++) across += (place[k] - point[k]) * onto->normal[k];
    for (int k = 0; k < 3; k++) onto->place[k] = (float)(point[k] + across * onto->normal[k]);
    return true;
}

/* A ball of 5 noise holds at least FIT_POINTS of a sheet, up to twice as many, all of which are fitted to: QUADRIC_POINTS leave room for
 * what is denser. More would cost more than they tell (with four times as many, heights of rosettes as splats are no better). */
plm_status plm_fit_points(const plm_index *index, const float (*xyz)[3], size_t count, const plm_sampling *sampling,
                          plm_subset *points, plm_error *error)
{
    const double reach = 5 * sampling->noise / sampling->spacing;
    return plm_subset_take(index, xyz, count, FIT_POINTS / (PLM_PI * reach * reach), points, error);
}

/* ---- Support --------------------------------------------------------------------------------------------------- */

static double reach_at(const plm_index *index, const float point[3], uint32_t *row)
{
    float squared[SUPPORT + 1]; /* the point itself is one of them */
    const size_t found = plm_index_nearest(index, point, SUPPORT + 1, row, squared);
    return found > SUPPORT ? sqrt((double)squared[SUPPORT]) : INFINITY;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bool plm_is_supported(const plm_index *index, const float (*xyz)[3], const float point[3], const plm_sampling *sampling)
{
    uint32_t row[SUPPORT + 1], ignored[SUPPORT + 1];
    const double reach = reach_at(index, point, row);
    if (!isfinite(reach)) return true; /* too few points to tell */
    const double usual = reach_per_spacing * sampling->spacing;
    if (reach > (sampling->fused ? fused_reach : alone_reach) * usual) return false;
    if (sampling->fused) return true;
    double near[SUPPORT];
    for (int i = 0; i < SUPPORT; i++) near[i] = reach_at(index, xyz[row[i + 1]], ignored);
    qsort(near, SUPPORT, sizeof *near, ascending);
    return reach <= uneven_reach * near[SUPPORT / 2];
}

/* ---- Extremes -------------------------------------------------------------------------------------------------- */

/* Where the highest points end: the upper band of at least `wanted` points that is at least `thickness` deep. */
static double band_floor(const double *along, size_t count, double low, double high, size_t wanted, double thickness)
{
    size_t bin[BINS] = {0};
    const double width = (high - low) / BINS;
    if (!(width > 0)) return low;
    for (size_t i = 0; i < count; i++) {
        const double place = (high - along[i]) / width;
        bin[place < BINS - 1 ? (size_t)place : BINS - 1]++;
    }
    size_t total = 0;
    for (int k = 0; k < BINS; k++) {
        total += bin[k];
        if (total >= wanted && (k + 1) * width >= thickness) return high - (k + 1) * width;
    }
    return low;
}

static size_t collect(const float (*xyz)[3], const double *along, size_t count, double floor, float (*band)[3])
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        if (along[i] < floor) continue;
        if (band) memcpy(band[found], xyz[i], sizeof *band);
        found++;
    }
    return found;
}

/** A point of the band and how high it is. */
typedef struct ranked {
    double height;
    float place[3];
} ranked;

/* Highest first; an order that does not depend on that of the rows. */
static int compare_ranked(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    if (x->height != y->height) return x->height > y->height ? -1 : 1;
    return memcmp(x->place, y->place, sizeof x->place);
}

/** The heights that an end is found from. */
typedef struct heights {
    size_t count;
    plm_height *of;
    double facing; /* mean squared cosine between the surface and the direction */
} heights;

/** What the heights are taken from. */
typedef struct source {
    const plm_index *index; /* over the band */
    const float (*band)[3];
    const plm_subset *points; /* that surfaces are fitted to */
    const double *direction;
    const plm_sampling *sampling;
    bool cut; /* see plm_extreme_options */
} source;

/* A point of the band, projected: how high it is, what noise is left in that, and how far (squared cosine) the surface faces the
 * direction. What projection leaves differs: little within a leaf, nearly all at its rim. False where no surface supports it. */
static bool height_of(const source *from, const float place[3], plm_height *out, double *facing)
{
    const double noise = from->sampling->noise;
    const bool fused = from->sampling->fused;
    plm_projection onto;
    if (!plm_is_supported(from->index, from->band, place, from->sampling)) return false;
    if (!plm_project_to_surface(from->points, place, noise, &onto)) return false;
    const bool thin =
        onto.flatness < least_flatness && !(fused && from->cut); /* voxel means keep a stem's end a surface */
    const bool as_seen = thin || onto.rest > no_surface * noise;
    if (as_seen) memcpy(onto.place, place, sizeof onto.place), onto.leverage = 1;
    const double across = plm_dot(onto.normal, from->direction),
                 run = fmin(fabs(plm_dot(onto.axis, from->direction)), 1);
    const double squared = thin ? 1 - run * run : as_seen ? 1 : across * across;
    out->at = 0;
    for (int k = 0; k < 3; k++) out->at += onto.place[k] * from->direction[k];
    const bool unknown = as_seen && from->cut && !fused;
    out->spread = unknown ? 0 : noise * sqrt(squared * onto.leverage);
    out->along = unknown ? noise : noise * sqrt(fmax(1 - squared, 0));
    if (fused) out->spread = hypot(out->spread, fused_along * out->along), out->along = 0;
    *facing = squared;
    return true;
}

/* The band's supported points, projected, from the highest on, as far down as one could come to lie among those that show the
 * end. */
static void take_noisy(const source *from, const ranked *rank, size_t count, heights *out)
{
    double top = -INFINITY, squares = 0; /* the highest, and the sum of squared spreads */
    for (size_t i = 0; i < count; i++) {
        /* Noise may have thrown a point as far below the surface as the surface faces the direction. */
        const double used = (double)out->count, spread = sqrt(squares / fmax(1, used)),
                     thrown = from->sampling->noise * sqrt(out->facing / fmax(1, used));
        if (out->count > PLM_END_FEWEST && rank[i].height < top - PLM_END_DEPTH * spread - thrown_down * thrown) break;
        plm_height height;
        double facing;
        if (!height_of(from, rank[i].place, &height, &facing)) continue;
        out->of[out->count++] = height;
        out->facing += facing;
        squares += pow(plm_height_spread(&height), 2);
        top = fmax(top, height.at);
    }
    out->facing /= fmax(1, (double)out->count);
}

static plm_status rank_heights(const float (*band)[3], size_t count, const double direction[3], ranked **rank,
                               plm_error *error)
{
    *rank = plm_alloc(count, sizeof **rank, error);
    if (!*rank) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        (*rank)[i].height = band[i][0] * direction[0] + band[i][1] * direction[1] + band[i][2] * direction[2];
        memcpy((*rank)[i].place, band[i], sizeof band[i]);
    }
    qsort(*rank, count, sizeof **rank, compare_ranked);
    return PLM_OK;
}

/* The end behind the heights. Narrow tips: what is not as wide as a noisy point cloud's spacing has no points of its own,
 * which is as much of the tip as the spacing is of the width that the points show. */
static void find_end(heights *found, const plm_sampling *sampling, const double direction[3], plm_extreme *extreme)
{
    double depth;
    const size_t used = plm_end_of_sample(found->of, found->count, &extreme->value, &extreme->std_error, &depth);
    if (!(plm_height_spread(&found->of[0]) > 0)) return;
    const double tip = depth * depth / (2 * (double)used * sampling->spacing);
    const double under = sampling->fused && direction[2] < 0 ? -direction[2] * found->facing * sampling->spacing : 0;
    const bool is_top = sampling->fused && direction[2] > 0;
    const double noise = (is_top ? top_unknown : noise_unknown) * sampling->noise;
    const double rim = sampling->extent * sqrt(fmax(1 - found->facing, 0)), unsure = disc_known * rim;
    extreme->value += disc_reach * rim;
    if (is_top) extreme->value += top_lost * sampling->noise * direction[2];
    extreme->std_error =
        sqrt(extreme->std_error * extreme->std_error + tip * tip + under * under + noise * noise + unsure * unsure);
}

static plm_status measure_band(const float (*band)[3], size_t count, const double direction[3],
                               const plm_extreme_options *options, plm_sampling *sampling, plm_extreme *extreme,
                               plm_error *error)
{
    heights found = {.of = plm_alloc(count, sizeof *found.of, error)};
    ranked *rank = NULL;
    plm_index *index = NULL;
    plm_status status = found.of ? rank_heights(band, count, direction, &rank, error) : PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_index_build(band, count, &index, error);
    if (status == PLM_OK && options->sampling) {
        *sampling = *options->sampling;
    } else if (status == PLM_OK) {
        *sampling = (plm_sampling){0};
        status = plm_sampling_measure(index, band, count, NULL, sampling, error);
        if (status == PLM_E_DEGENERATE) status = PLM_OK; /* a few points, or all in one place: taken as they are */
    }
    if (options->noise > 0) sampling->noise = fmin(sampling->noise, options->noise);
    if (sampling->spacing > 0)
        sampling->noise = fmax(sampling->noise, options->least_noise); /* not where all coincide */
    sampling->extent = options->disc;
    const bool noisy = status == PLM_OK && sampling->noise > PLM_NOISE_FREE * sampling->spacing;
    plm_subset points = {0};
    if (noisy) status = plm_fit_points(index, band, count, sampling, &points, error);
    if (status == PLM_OK) {
        const source from = {index, band, &points, direction, sampling, options->cut};
        if (noisy) take_noisy(&from, rank, count, &found);
        if (found.count == 0)
            for (; found.count < count; found.count++)
                found.of[found.count] = (plm_height){rank[found.count].height, 0, 0};
        find_end(&found, sampling, direction, extreme);
        extreme->count = count;
        extreme->sampling = *sampling;
    }
    plm_subset_free(&points);
    plm_index_free(index);
    plm_free(rank);
    plm_free(found.of);
    return status;
}

plm_status plm_extreme_along(const float (*xyz)[3], size_t count, const double direction[3],
                             const plm_extreme_options *options, plm_extreme *extreme, plm_error *error)
{
    if (count == 0) return plm_fail(error, PLM_E_DEGENERATE, "there are no points");
    double *along = plm_alloc(count, sizeof *along, error);
    if (!along) return PLM_E_MEMORY;
    double low = INFINITY, high = -INFINITY, thickness = options->sampling ? band_noise * options->sampling->noise : 0;
    for (size_t i = 0; i < count; i++) {
        along[i] = xyz[i][0] * direction[0] + xyz[i][1] * direction[1] + xyz[i][2] * direction[2];
        low = fmin(low, along[i]);
        high = fmax(high, along[i]);
    }
    plm_status status = PLM_OK;
    plm_extreme found = {0};
    for (int round = 0; round < 2 && status == PLM_OK; round++) {
        const double floor = band_floor(along, count, low, high, BAND_POINTS, thickness);
        const size_t size = collect(xyz, along, count, floor, NULL);
        float(*band)[3] = plm_alloc(size, sizeof *band, error);
        plm_sampling sampling = {0};
        status = band ? PLM_OK : PLM_E_MEMORY;
        if (status == PLM_OK) {
            collect(xyz, along, count, floor, band);
            status = measure_band((const float(*)[3])band, size, direction, options, &sampling, &found, error);
        }
        plm_free(band);
        /* Points of the band's lower side must find their neighbours in it. */
        thickness = band_noise * sampling.noise;
        if (high - floor >= thickness || floor <= low) break;
    }
    if (status == PLM_OK) *extreme = found;
    plm_free(along);
    return status;
}
