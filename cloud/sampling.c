/* cloud/sampling.c: spacing from nearest neighbours in the tangent plane, noise from local quadrics, and whether points
 * keep apart as voxel means do. Large inputs are judged on a sample of points that is chosen by their coordinates, so
 * that the order of rows does not matter. */
#include "cloud/sampling.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "cloud/subset.h"

#include <math.h>
#include <string.h>

enum {
    SPACING_NEIGHBOURS = 8,
    SAMPLE_SPACING = 6000, /* points that decide spacing and class */
    QUADRIC_NEIGHBOURS = 24,
    QUADRIC_MAXIMUM = 1500, /* largest neighbourhood of a quadric: 5 sigma of a spacing of sigma / 4 ... */
    QUADRIC_USED = 60,      /* ... of which so many strided points are fitted */
    QUADRIC_MOST = 240,     /* neighbours that are looked at: beyond, the cloud is thinned instead */
    QUADRIC_WORK = 6000,    /* neighbours looked at in all: the median of 250 residuals is known to about 1 % */
    QUADRIC_TERMS = 6,
    MINIMUM_POINTS = 12
};

/* A quadric needs a ball of 5 sigma; below this the heights are cut off (checked on simulated sheets). */
static const double ball_per_noise = 5.0;

/* Share of points with r_1 < 0.25 r_8: at most 0.03 in voxel means, at least 0.10 in other clouds. */
static const double near_ratio = 0.25, fused_share = 0.06;

bool plm_neighbour_is_close(const float *squared, size_t count)
{
    size_t first = 0;
    while (first < count && squared[first] == 0) first++; /* duplicates tell nothing of voxels */
    return first < count && sqrt(squared[first]) < near_ratio * sqrt(squared[count - 1]);
}

bool plm_close_share_is_fused(double share)
{
    return share < fused_share;
}

static float median_of(float *values, size_t count)
{
    plm_order_sort(values, count);
    return count % 2 ? values[count / 2] : 0.5f * (values[count / 2 - 1] + values[count / 2]);
}

/* Mean and principal axes of the points named by row. */
static void principal_axes(const float (*xyz)[3], const uint32_t *row, size_t count, double mean[3], double value[3],
                           double axis[3][3])
{
    double sum[3] = {0, 0, 0};
    for (size_t j = 0; j < count; j++)
        for (int i = 0; i < 3; i++) sum[i] += xyz[row[j]][i];
    for (int i = 0; i < 3; i++) mean[i] = sum[i] / (double)count;
    double moment[6] = {0};
    for (size_t j = 0; j < count; j++) {
        const double d[3] = {xyz[row[j]][0] - mean[0], xyz[row[j]][1] - mean[1], xyz[row[j]][2] - mean[2]};
        moment[0] += d[0] * d[0];
        moment[1] += d[0] * d[1];
        moment[2] += d[0] * d[2];
        moment[3] += d[1] * d[1];
        moment[4] += d[1] * d[2];
        moment[5] += d[2] * d[2];
    }
    plm_eigen3(moment, value, axis);
}

/* 1 / sqrt(density) at self from its nearest neighbours (self left out): r_k is the largest of their distances in the
 * plane that fits them best, density (k - 0.5) / (pi r_k^2). 0 when all coincide. */
static float spacing_at(const float (*xyz)[3], uint32_t self, const uint32_t *neighbour, size_t count)
{
    uint32_t row[SPACING_NEIGHBOURS + 1];
    memcpy(row, neighbour, count * sizeof *row);
    row[count] = self;
    double mean[3], value[3], axis[3][3];
    principal_axes(xyz, row, count + 1, mean, value, axis);
    double largest = 0;
    for (size_t j = 0; j < count; j++) {
        double d[3];
        for (int i = 0; i < 3; i++) d[i] = (double)xyz[neighbour[j]][i] - (double)xyz[self][i];
        const double height = plm_dot(d, axis[2]);
        largest = fmax(largest, plm_dot(d, d) - height * height);
    }
    return (float)sqrt(PLM_PI * largest / ((double)count - 0.5));
}

/* The nearest rows of a point but itself, at most SPACING_NEIGHBOURS of them, and their squared distances. */
static size_t others_near(const plm_index *index, const float (*xyz)[3], uint32_t self,
                          uint32_t row[SPACING_NEIGHBOURS + 1], float squared[SPACING_NEIGHBOURS + 1])
{
    const size_t found = plm_index_nearest(index, xyz[self], SPACING_NEIGHBOURS + 1, row, squared);
    size_t known = 0;
    for (size_t j = 0; j < found; j++)
        if (row[j] != self) row[known] = row[j], squared[known++] = squared[j];
    /* Where self was not among them, more points than that coincide with it. */
    return known < SPACING_NEIGHBOURS ? known : SPACING_NEIGHBOURS;
}

/* Median over a point and its neighbours of the spacing at each. */
static float smooth_spacing_at(const plm_index *index, const float (*xyz)[3], uint32_t self)
{
    uint32_t row[SPACING_NEIGHBOURS + 1], its[SPACING_NEIGHBOURS + 1];
    float squared[SPACING_NEIGHBOURS + 1], near[SPACING_NEIGHBOURS + 1];
    const size_t known = others_near(index, xyz, self, row, squared);
    row[known] = self;
    for (size_t j = 0; j <= known; j++) {
        const size_t its_count = others_near(index, xyz, row[j], its, squared);
        near[j] = spacing_at(xyz, row[j], its, its_count);
    }
    return median_of(near, known + 1);
}

plm_status plm_spacing_quantile(const plm_index *index, const float (*xyz)[3], size_t count, double share,
                                double *spacing, plm_error *error)
{
    if (count < 2) return plm_fail(error, PLM_E_DEGENERATE, "%zu points have no spacing; at least 2 are needed", count);
    uint32_t *sample = plm_alloc(count, sizeof *sample, error);
    if (!sample) return PLM_E_MEMORY;
    const size_t taken = plm_sample_rows(xyz, count, SAMPLE_SPACING, sample);
    float *local = plm_alloc(taken, sizeof *local, error);
    const plm_status status = local ? PLM_OK : PLM_E_MEMORY;
    if (local) {
#pragma omp parallel for schedule(static)
        for (size_t i = 0; i < taken; i++) local[i] = smooth_spacing_at(index, xyz, sample[i]);
        plm_order_sort(local, taken);
        *spacing = local[(size_t)fmin(share * (double)taken, (double)taken - 1)];
    }
    plm_free(local);
    plm_free(sample);
    return status;
}

/* Finds the median spacing and the share of points with a neighbour far nearer than the sheet's spacing. */
static plm_status measure_spacing(const plm_index *index, const float (*xyz)[3], const uint32_t *sample, size_t count,
                                  double *spacing, double *share, plm_error *error)
{
    float *local = plm_alloc(count, sizeof *local, error);
    if (!local) return PLM_E_MEMORY;
    size_t close = 0;
#pragma omp parallel for schedule(static) reduction(+ : close)
    for (size_t i = 0; i < count; i++) {
        uint32_t row[SPACING_NEIGHBOURS + 1];
        float squared[SPACING_NEIGHBOURS + 1];
        const size_t known = others_near(index, xyz, sample[i], row, squared);
        local[i] = spacing_at(xyz, sample[i], row, known);
        close += plm_neighbour_is_close(squared, known);
    }
    *spacing = median_of(local, count);
    *share = (double)close / (double)count;
    plm_free(local);
    return PLM_OK;
}

/* SD of the points named by row off the quadric that fits them best; n - 6 in the denominator. NAN when the points do
 * not determine one. */
static double quadric_residual(const float (*xyz)[3], const uint32_t *row, size_t count)
{
    enum { N = QUADRIC_TERMS };
    double mean[3], value[3], axis[3][3];
    principal_axes(xyz, row, count, mean, value, axis);
    const double scale = sqrt(value[0] / (double)count);
    if (!(scale > 0)) return NAN;
    double normal[N * N] = {0}, right[N] = {0}, squares = 0;
    for (size_t j = 0; j < count; j++) {
        const double d[3] = {xyz[row[j]][0] - mean[0], xyz[row[j]][1] - mean[1], xyz[row[j]][2] - mean[2]};
        const double u = plm_dot(d, axis[0]) / scale, v = plm_dot(d, axis[1]) / scale, z = plm_dot(d, axis[2]) / scale;
        const double term[N] = {1, u, v, u * u, u * v, v * v};
        for (int a = 0; a < N; a++) {
            for (int b = 0; b <= a; b++) normal[a * N + b] += term[a] * term[b];
            right[a] += term[a] * z;
        }
        squares += z * z;
    }
    double solution[N];
    memcpy(solution, right, sizeof solution);
    if (!plm_solve_spd(N, normal, solution)) return NAN;
    for (int a = 0; a < N; a++) squares -= solution[a] * right[a];
    return scale * sqrt(fmax(squares, 0) / ((double)count - N));
}

/* Median over the sample, rows of xyz, of the residual of quadrics through wanted neighbours of the index each, at most
 * QUADRIC_USED of them fitted; radius: median distance to the last of them. */
static plm_status measure_residual(const plm_subset *among, const float (*xyz)[3], const uint32_t *sample, size_t count,
                                   size_t wanted, double *residual, double *radius, plm_error *error)
{
    float *value = plm_alloc(count, sizeof *value, error);
    float *reach = plm_alloc(count, sizeof *reach, error);
    plm_status status = value && reach ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
#pragma omp parallel for schedule(static)
        for (size_t i = 0; i < count; i++) {
            uint32_t row[QUADRIC_MOST];
            float squared[QUADRIC_MOST];
            const size_t found = plm_index_nearest(among->index, xyz[sample[i]], wanted, row, squared);
            const size_t step = (found + QUADRIC_USED - 1) / QUADRIC_USED;
            size_t used = 0;
            for (size_t j = 0; j < found; j += step) row[used++] = row[j];
            value[i] = used > QUADRIC_TERMS ? (float)quadric_residual(among->xyz, row, used) : NAN;
            reach[i] = sqrtf(squared[found - 1]);
        }
        size_t good = 0;
        for (size_t i = 0; i < count; i++)
            if (isfinite(value[i])) value[good] = value[i], reach[good++] = reach[i];
        *residual = good ? median_of(value, good) : 0; /* every neighbourhood on one spot or line: no noise */
        *radius = good ? median_of(reach, good) : 0;
    }
    plm_free(value);
    plm_free(reach);
    return status;
}

/* The residual of quadrics over the area that wanted neighbours take up; sample: room for total rows. */
static plm_status residual_over(const plm_index *index, const float (*xyz)[3], size_t total, size_t wanted,
                                uint32_t *sample, double *residual, double *radius, plm_error *error)
{
    plm_subset among = {.xyz = xyz, .index = index};
    size_t near = wanted;
    plm_status status = PLM_OK;
    if (wanted > QUADRIC_MOST) { /* the same area with fewer points in it */
        near = QUADRIC_USED;
        status = plm_subset_take(index, xyz, total, (double)near / (double)wanted, &among, error);
    }
    if (status == PLM_OK) {
        const size_t count = plm_sample_rows(xyz, total, QUADRIC_WORK / near, sample);
        status = measure_residual(&among, xyz, sample, count, near, residual, radius, error);
    }
    plm_subset_free(&among);
    return status;
}

/* The neighbourhood is grown until its radius is 5 sigma: where sigma is near the spacing, 24 neighbours are a ball and
 * their plane is any plane. */
plm_status plm_noise_measure(const plm_index *index, const float (*xyz)[3], size_t total, double *noise,
                             plm_error *error)
{
    const size_t most = total < QUADRIC_MAXIMUM ? total : QUADRIC_MAXIMUM;
    size_t wanted = total < QUADRIC_NEIGHBOURS ? total : QUADRIC_NEIGHBOURS;
    uint32_t *sample = plm_alloc(total, sizeof *sample, error);
    if (!sample) return PLM_E_MEMORY;
    plm_status status;
    double found = 0;
    for (int round = 0;; round++) {
        double radius;
        status = residual_over(index, xyz, total, wanted, sample, &found, &radius, error);
        if (status != PLM_OK || round == 5 || wanted == most || !(radius > 0) || radius >= ball_per_noise * found)
            break;
        const double ratio = ball_per_noise * found / radius;
        const double larger = ceil((double)wanted * ratio * ratio);
        wanted = larger < (double)most ? (size_t)larger : most;
    }
    plm_free(sample);
    if (status == PLM_OK) *noise = found;
    return status;
}

plm_status plm_sampling_measure(const plm_index *index, const float (*xyz)[3], size_t count, const bool *fused_known,
                                plm_sampling *sampling, plm_error *error)
{
    if (count < MINIMUM_POINTS)
        return plm_fail(error, PLM_E_DEGENERATE, "%zu points are too few to measure spacing and noise; %d are needed",
                        count, MINIMUM_POINTS);
    uint32_t *sample = plm_alloc(count, sizeof *sample, error);
    if (!sample) return PLM_E_MEMORY;
    plm_sampling found = {0};
    double share = 0;
    const size_t taken = plm_sample_rows(xyz, count, SAMPLE_SPACING, sample);
    plm_status status = measure_spacing(index, xyz, sample, taken, &found.spacing, &share, error);
    if (status == PLM_OK) found.fused = fused_known ? *fused_known : plm_close_share_is_fused(share);
    if (status == PLM_OK) status = plm_noise_measure(index, xyz, count, &found.noise, error);
    plm_free(sample);
    if (status == PLM_OK) *sampling = found;
    return status;
}
