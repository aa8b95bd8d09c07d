/* traits/extreme.c: extremes of a sampled, noisy surface: the outermost points are chosen, freed of those that nothing
 * supports, and projected onto the surface; traits/sample_end.c says where the surface ends behind them. */
#include "traits/extreme.h"

#include "traits/projection.h"
#include "traits/sample_end.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    BINS = 4096,
    BAND_POINTS = 2000, /* enough to know spacing and noise by */
    SUPPORT = 8         /* neighbours that support a point */
};

/* Noise along the surface per noise across it, which projection does not take away: of voxel means. */
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
/* Depth cameras look from the side, and noise lies along their rays: an upper end has less of it than the surface's noise says, and
 * comes out too low by so many SD (48 virtual plants 0.72, 32 others 0.38, four of another family 0.6, cameras 15 to 40 degrees above
 * the horizon; scatter 0.66 between plants). */
static const double top_lost = 0.55, top_unknown = 0.66;
/* Depth of a band per noise, at least. */
static const double band_noise = 12;

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
    plm_projection onto;
    if (!plm_is_supported(from->index, from->band, place, from->sampling)) return false;
    if (!plm_project_to_surface(from->points, place, from->sampling->noise, &onto)) return false;
    const plm_blur blur = {from->sampling, fused_along, from->cut};
    *facing = plm_projected_height(&onto, place, from->direction, &blur, out);
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
    const double rim = sampling->extent * sqrt(fmax(1 - found->facing, 0)), disc = PLM_DISC_REACH * rim;
    extreme->value += disc;
    if (is_top) extreme->value += top_lost * sampling->noise * direction[2];
    extreme->std_error =
        sqrt(extreme->std_error * extreme->std_error + tip * tip + under * under + noise * noise + disc * disc);
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
