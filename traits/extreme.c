/* traits/extreme.c: extremes of a sampled surface. The expected maximum of a random half of sorted heights z1 >= z2 >= ... is
 * sum z_i 2^-i / sum 2^-i; what it falls short of z1 is, for an edge, what z1 falls short of the surface. */
#include "traits/extreme.h"

#include "cloud/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    BINS = 4096,
    BAND_POINTS = 2000, /* enough to know spacing and noise by */
    HALF_TERMS = 40,    /* 2^-40 ends the sum */
    BALL_ROOM = 2048,
    QUADRIC_POINTS = 120,
    QUADRIC_USUAL = 48, /* fewer leave half of the noise in the projected points */
    QUADRIC_FEWEST = 12,
    GHOSTS = 4, /* points that may stand out at one end */
    BACKING = 3 /* a point of the surface has so many near its height */
};

/* ---- Projection ------------------------------------------------------------------------------------------------ */

typedef struct patch {
    double (*local)[3]; /* u, v, height of the neighbours about the point, in the tangent frame */
    double *weight;
    size_t count;
} patch;

/* Tangent frame of weighted neighbours: axis[2] is the normal. */
static void tangent_frame(const double (*offset)[3], const double *weight, size_t count, double axis[3][3])
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
}

/* Height of the weighted quadric at u = v = 0. False where the neighbours do not determine it. */
static bool quadric_height(const patch *p, double scale, double *height)
{
    double normal[36] = {0}, right[6] = {0};
    for (size_t i = 0; i < p->count; i++) {
        const double u = p->local[i][0] / scale, v = p->local[i][1] / scale, w = p->weight[i];
        const double row[6] = {1, u, v, u * u, u * v, v * v};
        for (int a = 0; a < 6; a++) {
            right[a] += w * row[a] * p->local[i][2];
            for (int b = 0; b < 6; b++) normal[a * 6 + b] += w * row[a] * row[b];
        }
    }
    for (int a = 1; a < 6; a++) normal[a * 7] *= 1 + 1e-6; /* a ridge for slivers */
    if (!plm_solve_spd(6, normal, right)) return false;
    *height = right[0];
    return true;
}

bool plm_project_to_surface(const plm_index *index, const float (*xyz)[3], const float point[3], double noise,
                            float projected[3])
{
    uint32_t row[BALL_ROOM];
    float squared[BALL_ROOM];
    const float radius = (float)(5 * noise);
    size_t found = plm_index_ball(index, point, radius, BALL_ROOM, row, squared);
    if (found < QUADRIC_USUAL) found = plm_index_nearest(index, point, QUADRIC_USUAL, row, squared);
    if (found > BALL_ROOM) found = plm_index_nearest(index, point, 1024, row, squared);
    if (found < QUADRIC_FEWEST) return false;
    const size_t stride = (found + QUADRIC_POINTS - 1) / QUADRIC_POINTS;
    double offset[QUADRIC_POINTS][3], weight[QUADRIC_POINTS], local[QUADRIC_POINTS][3], axis[3][3];
    patch p = {local, weight, 0};
    for (size_t i = 0; i < found; i += stride) {
        const double d = sqrt((double)squared[i]) / (3 * noise);
        weight[p.count] = 1 / (1 + d * d * d * d);
        for (int k = 0; k < 3; k++) offset[p.count][k] = (double)xyz[row[i]][k] - point[k];
        p.count++;
    }
    tangent_frame((const double(*)[3])offset, weight, p.count, axis);
    for (size_t i = 0; i < p.count; i++)
        for (int k = 0; k < 3; k++) local[i][k] = plm_dot(offset[i], axis[k]);
    double height;
    if (!quadric_height(&p, 5 * noise, &height) || !(fabs(height) < 4 * noise)) return false;
    for (int k = 0; k < 3; k++) projected[k] = (float)(point[k] + height * axis[2][k]);
    return true;
}

/* ---- Extremes -------------------------------------------------------------------------------------------------- */

static int descending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

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

/* Extreme from heights, any order, overwritten. A few heights that stand out by more than `alone` from those behind them are
 * ghosts that the cleaning let through: a surface that is sampled at all has its next points near. */
static void reach(double *height, size_t count, bool noisy, double alone, double *top, double *gap)
{
    qsort(height, count, sizeof *height, descending);
    for (int dropped = 0; dropped < GHOSTS && count > 8 * GHOSTS && height[0] - height[BACKING] > alone; dropped++)
        height++, count--;
    double sum = 0, weights = 0, weight = 0.5;
    for (size_t i = 0; i < count && i < HALF_TERMS; i++, weight /= 2) {
        sum += weight * (height[0] - height[i]);
        weights += weight;
    }
    *gap = sum / weights;
    *top = height[0] + (noisy ? 0 : *gap);
}

/* Heights along the direction of the band's points after projection; those deep below the top cannot become it. */
static size_t projected_heights(const plm_index *index, const float (*band)[3], size_t count, const double direction[3],
                                double noise, double high, double *height)
{
    size_t used = 0;
    for (size_t i = 0; i < count; i++) {
        const double at = band[i][0] * direction[0] + band[i][1] * direction[1] + band[i][2] * direction[2];
        if (at < high - 8 * noise) continue;
        float moved[3];
        if (!plm_project_to_surface(index, band, band[i], noise, moved)) continue;
        height[used++] = moved[0] * direction[0] + moved[1] * direction[1] + moved[2] * direction[2];
    }
    return used;
}

static plm_status measure_band(const float (*band)[3], size_t count, const double direction[3], double high,
                               plm_sampling *sampling, plm_extreme *extreme, plm_error *error)
{
    double *height = plm_alloc(count, sizeof *height, error);
    if (!height) return PLM_E_MEMORY;
    plm_index *index = NULL;
    plm_status status = plm_index_build(band, count, &index, error);
    if (status == PLM_OK) {
        *sampling = (plm_sampling){0};
        status = plm_sampling_measure(index, band, count, NULL, sampling, error);
        if (status == PLM_E_DEGENERATE) status = PLM_OK; /* a few points, or all in one place: taken as they are */
    }
    if (status == PLM_OK) {
        const double s = sampling->spacing;
        const bool noisy = sampling->noise > PLM_NOISE_FREE * s;
        size_t used = count;
        if (noisy) used = projected_heights(index, band, count, direction, sampling->noise, high, height);
        if (!noisy || used == 0)
            for (used = 0; used < count; used++)
                height[used] =
                    band[used][0] * direction[0] + band[used][1] * direction[1] + band[used][2] * direction[2];
        double gap;
        reach(height, used, noisy, noisy ? 2 * fmax(sampling->noise, s) : INFINITY, &extreme->value, &gap);
        const double noise = noisy ? 1.3 * sampling->noise / sqrt(2.0) : 0; /* the factor is for two ends */
        extreme->std_error = sqrt(0.64 * gap * gap + noise * noise + 0.02 * s * s);
        extreme->count = count;
    }
    plm_index_free(index);
    plm_free(height);
    return status;
}

plm_status plm_extreme_along(const float (*xyz)[3], size_t count, const double direction[3], plm_extreme *extreme,
                             plm_error *error)
{
    if (count == 0) return plm_fail(error, PLM_E_DEGENERATE, "there are no points");
    double *along = plm_alloc(count, sizeof *along, error);
    if (!along) return PLM_E_MEMORY;
    double low = INFINITY, high = -INFINITY, thickness = 0;
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
            status = measure_band((const float(*)[3])band, size, direction, high, &sampling, &found, error);
        }
        plm_free(band);
        /* Points of the band's lower side must find their neighbours in it. */
        thickness = 12 * sampling.noise;
        if (high - floor >= thickness || floor <= low) break;
    }
    if (status == PLM_OK) *extreme = found;
    plm_free(along);
    return status;
}
