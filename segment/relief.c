/* segment/relief.c: soil is not a plane. Means of the points in raster cells, in rounds with a band that follows
 * the noise, so that leaves just above are left out. */
#include "segment/relief.h"

#include <math.h>
#include <string.h>

#include "segment/subset.h"

enum { ROUNDS = 5, BINS = 256, MOST = 150000 };

static const double cells_of_patches = 4; /* a raster cell is four voxels wide */
static const double fewest = 6;           /* points that make a cell's height */

double plm_relief_over(const plm_relief *r, const double p[3])
{
    const double base = p[2] - (r->plane[0] * p[0] + r->plane[1] * p[1] + r->plane[2]);
    double at[2], part[2];
    for (int i = 0; i < 2; i++) {
        const double place = fmin(fmax((p[i] - r->low[i]) / r->cell - 0.5, 0), r->size[i] - 1.001);
        at[i] = floor(place);
        part[i] = place - at[i];
    }
    const double *h = r->height + (size_t)at[0] * (size_t)r->size[1] + (size_t)at[1];
    const double near = h[0] * (1 - part[1]) + h[1] * part[1];
    const double far = h[r->size[1]] * (1 - part[1]) + h[r->size[1] + 1] * part[1];
    return base - (near * (1 - part[0]) + far * part[0]);
}

/* Standard deviation from the median of distances to one side, found in a histogram up to band. */
static double robust_sigma(const size_t histogram[BINS], double band)
{
    size_t total = 0, sum = 0;
    for (int b = 0; b < BINS; b++) total += histogram[b];
    for (int b = 0; b < BINS; b++) {
        sum += histogram[b];
        if (2 * sum >= total) {
            const double before = (double)(sum - histogram[b]), inside = (double)histogram[b];
            const double part = inside > 0 ? (0.5 * (double)total - before) / inside : 0;
            return total ? 1.4826 * band * (b + part) / BINS : 0;
        }
    }
    return 0;
}

/* Cells without enough points take the mean of their known neighbours, ring by ring; what nothing reaches stays 0. */
static void fill_cells(plm_relief *r, double *weight)
{
    const int32_t width = r->size[0], height = r->size[1];
    for (int ring = 0; ring < 3; ring++)
        for (int32_t c = 0; c < width * height; c++) {
            if (weight[c] > 0) continue;
            double sum = 0, n = 0;
            const int32_t x = c / height, y = c % height;
            for (int32_t a = x - 1; a <= x + 1; a++)
                for (int32_t b = y - 1; b <= y + 1; b++)
                    if (a >= 0 && b >= 0 && a < width && b < height && weight[a * height + b] >= ROUNDS - ring)
                        sum += r->height[a * height + b], n++;
            if (n >= 2) {
                r->height[c] = sum / n;
                weight[c] = ROUNDS - ring - 1;
            }
        }
}

/* One round: new heights from the chosen places within band of the present ones. Gives their sigma. */
static double fit_round(const float (*place)[3], const uint32_t *chosen, size_t count, double band, plm_relief *r,
                        double *sum, double *weight)
{
    const size_t cells = (size_t)r->size[0] * (size_t)r->size[1];
    size_t histogram[BINS] = {0};
    memset(sum, 0, cells * sizeof *sum);
    memset(weight, 0, cells * sizeof *weight);
    for (size_t i = 0; i < count; i++) {
        const float *at = place[chosen[i]];
        const double p[3] = {at[0], at[1], at[2]}, over = plm_relief_over(r, p);
        if (!(fabs(over) < band)) continue;
        const double a = floor((p[0] - r->low[0]) / r->cell), b = floor((p[1] - r->low[1]) / r->cell);
        if (!(a >= 0 && a < r->size[0] && b >= 0 && b < r->size[1])) continue;
        const size_t c = (size_t)a * (size_t)r->size[1] + (size_t)b;
        sum[c] += over;
        weight[c]++;
        if (over <= 0) histogram[(int)(-over / band * BINS)]++; /* what lies above may be a plant */
    }
    for (size_t c = 0; c < cells; c++) {
        const bool known = weight[c] >= fewest;
        r->height[c] = known ? r->height[c] + sum[c] / weight[c] : 0;
        weight[c] = known ? ROUNDS : 0;
    }
    fill_cells(r, weight);
    return robust_sigma((const size_t *)histogram, band);
}

/* Rows within band of the plane that the filter admits; of many, every second, fourth, ... by their bits. */
static size_t choose(const float (*place)[3], size_t count, const double plane[3], double band,
                     plm_relief_filter filter, const void *context, uint32_t *chosen)
{
    size_t near = 0, n = 0;
    for (size_t i = 0; i < count; i++)
        near += fabs(place[i][2] - (plane[0] * place[i][0] + plane[1] * place[i][1] + plane[2])) < band;
    const uint32_t mask = plm_subset_mask(near, MOST);
    for (size_t i = 0; i < count; i++) {
        const double p[3] = {place[i][0], place[i][1], place[i][2]};
        if (!(fabs(p[2] - (plane[0] * p[0] + plane[1] * p[1] + plane[2])) < band)) continue;
        if ((plm_point_bits(place[i]) & mask) == 0 && filter(context, p)) chosen[n++] = (uint32_t)i;
    }
    return n;
}

plm_status plm_relief_fit(const plm_stand *stand, const float (*place)[3], size_t count, const double plane[3],
                          double band, plm_relief_filter filter, const void *context, plm_relief *relief,
                          plm_error *error)
{
    plm_relief r = {.cell = cells_of_patches * stand->surfels->cell};
    memcpy(r.plane, plane, sizeof r.plane);
    for (int i = 0; i < 2; i++) {
        r.low[i] = stand->low[i];
        r.size[i] = (int32_t)(stand->size[i] * stand->cell / r.cell) + 2;
    }
    const size_t cells = (size_t)r.size[0] * (size_t)r.size[1];
    r.height = plm_alloc_zero(cells, sizeof *r.height, error);
    double *sum = plm_alloc(cells, sizeof *sum, error), *weight = plm_alloc(cells, sizeof *weight, error);
    uint32_t *chosen = plm_alloc(count, sizeof *chosen, error);
    const bool room = r.height && sum && weight && chosen;
    if (room) {
        const double widest = 2 * band; /* thick noise may want more than the band that it starts with */
        const size_t n = choose(place, count, plane, widest, filter, context, chosen);
        for (int round = 0; round < ROUNDS; round++) {
            r.sigma = fit_round(place, chosen, n, band, &r, sum, weight);
            band = fmin(widest, fmax(3 * r.sigma, 0.25 * stand->surfels->cell));
        }
        *relief = r;
    } else {
        plm_free(r.height);
    }
    plm_free(chosen);
    plm_free(sum);
    plm_free(weight);
    return room ? PLM_OK : PLM_E_MEMORY;
}

void plm_relief_free(plm_relief *relief)
{
    plm_free(relief->height);
    relief->height = NULL;
}
