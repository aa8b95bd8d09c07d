/* traits/sample_end.c: the end of a distribution from its highest values. Condition: the error is that of the gap behind the
 * highest points, some 0.3 of it, however the surface ends. */
#include "traits/sample_end.h"

#include "cloud/linear.h"

#include <math.h>
#include <stdlib.h>

enum {
    MOST = 300, /* heights: more stand for parts of the plant further down */
    STEPS = 96, /* of the grid of ends */
    SMOOTH_POWERS = 4,
    CORNER_POWERS = 5,
    NOISY_POWERS = 2, /* whole numbers: their blurred densities have closed forms */
    PARTS = 4,
    MOST_WEIGHTS = NOISY_POWERS * PARTS
};
_Static_assert((int)MOST_WEIGHTS >= (int)SMOOTH_POWERS && (int)MOST_WEIGHTS >= (int)CORNER_POWERS,
               "weights of one end");

static const double smooth_power[SMOOTH_POWERS] = {1.0, 1.5, 2.0, 2.5},
                    corner_power[CORNER_POWERS] = {1.0, 1.25, 1.5, 1.75, 2.0};
static const double part_of_along[PARTS] = {0.25, 0.5, 0.75, 1};
static const double below_top = 4.0; /* SD of noise below the highest point from which the end is sought ... */

static int descending(const void *a, const void *b)
{
    const plm_height *x = a, *y = b;
    if (x->at != y->at) return x->at < y->at ? 1 : -1;
    if (x->spread != y->spread) return x->spread > y->spread ? 1 : -1;
    return (x->along > y->along) - (x->along < y->along);
}

/* Log likelihoods, up to a constant, of the heights above the last one (height[used]) for an end and each power. */
static void smooth_likelihood(const plm_height *height, size_t used, double end, const double *power, size_t powers,
                              double *out)
{
    double sum = 0;
    for (size_t i = 0; i < used; i++) sum += log(end - height[i].at);
    const double depth = log(end - height[used].at);
    for (size_t p = 0; p < powers; p++)
        out[p] = (double)used * (log(power[p]) - power[p] * depth) + (power[p] - 1) * sum;
}

/* Far below 0 the tail's leading term, as the closed form cancels. */
void plm_blurred_powers(double y, double mean[3])
{
    const double density = exp(-0.5 * y * y) / sqrt(2 * PLM_PI), below = 0.5 * erfc(-y / sqrt(2));
    if (y < -6) {
        mean[0] = fmax(density / -y, 1e-300);
        mean[1] = fmax(density / (y * y), 1e-300);
        mean[2] = fmax(-2 * density / (y * y * y), 1e-300);
        return;
    }
    mean[0] = below;
    mean[1] = y * below + density;
    mean[2] = (y * y + 1) * below + y * density;
}

static double spread_of(const plm_height *height, double part)
{
    return hypot(height->spread, part * height->along);
}

double plm_height_spread(const plm_height *height)
{
    return spread_of(height, 1);
}

/* The same with noise, each height's own, for the powers 1 and 2. part: of the noise `along`. */
static void noisy_likelihood(const plm_height *height, size_t used, double end, double part, double out[NOISY_POWERS])
{
    double mean[3], all[3], last = -1;
    for (int power = 1; power <= NOISY_POWERS; power++) out[power - 1] = 0;
    for (size_t i = 0; i < used; i++) {
        const double spread = spread_of(&height[i], part);
        if (spread != last) plm_blurred_powers((end - height[used].at) / spread, all);
        last = spread;
        plm_blurred_powers((end - height[i].at) / spread, mean);
        for (int power = 1; power <= NOISY_POWERS; power++)
            out[power - 1] += log(power * mean[power - 1] / (spread * all[power]));
    }
}

/* Mean and SD over a grid of ends from weights in logarithms. */
static void grid_moments(const double (*weight)[MOST_WEIGHTS], size_t weights, double first, double step, double *end,
                         double *std_error)
{
    double most = -INFINITY, total = 0, sum = 0, squares = 0;
    for (size_t j = 0; j < STEPS; j++)
        for (size_t p = 0; p < weights; p++) most = fmax(most, weight[j][p]);
    for (size_t j = 0; j < STEPS; j++)
        for (size_t p = 0; p < weights; p++) {
            const double w = exp(weight[j][p] - most), at = ((double)j + 0.5) * step;
            total += w;
            sum += w * at;
            squares += w * at * at;
        }
    const double mean = sum / total;
    *end = first + mean;
    *std_error = sqrt(fmax(squares / total - mean * mean, 0) + step * step / 12);
}

/* How many of the sorted heights say where the end is. */
static size_t heights_to_use(const plm_height *height, size_t count, double spread)
{
    size_t used = 0;
    const double floor = height[0].at - PLM_END_DEPTH * spread;
    while (used + 1 < count && used < MOST && (used < PLM_END_FEWEST || height[used].at > floor)) used++;
    return used;
}

size_t plm_end_of_sample(plm_height *height, size_t count, double *end, double *std_error, double *depth)
{
    qsort(height, count, sizeof *height, descending);
    double squares = 0, along = 0;
    for (size_t i = 0; i < count; i++) {
        squares += pow(plm_height_spread(&height[i]), 2);
        along = fmax(along, height[i].along);
    }
    const double spread = sqrt(squares / (double)count);
    const size_t used = heights_to_use(height, count, spread);
    const double span = height[0].at - height[used].at;
    if (!(span > 0)) { /* all at one height */
        *end = height[0].at;
        *std_error = spread;
        *depth = 0;
        return count;
    }
    const double first = fmax(height[used].at, height[0].at - below_top * fmax(spread, plm_height_spread(&height[0]))),
                 step = (height[0].at + span - first) / STEPS;
    const int parts = along > 0 ? PARTS : 1;
    double weight[STEPS][MOST_WEIGHTS];
    for (size_t j = 0; j < STEPS; j++) {
        const double at = first + ((double)j + 0.5) * step;
        for (int p = 0; spread > 0 && p < parts; p++)
            noisy_likelihood(height, used, at, part_of_along[p], &weight[j][NOISY_POWERS * p]);
        if (!(spread > 0)) smooth_likelihood(height, used, at, smooth_power, SMOOTH_POWERS, weight[j]);
    }
    grid_moments((const double(*)[MOST_WEIGHTS])weight, spread > 0 ? (size_t)(NOISY_POWERS * parts) : SMOOTH_POWERS,
                 first, step, end, std_error);
    *depth = fmax(*end - height[used].at, 0);
    return used;
}

void plm_end_of_corner(plm_height *height, size_t count, size_t used, double *end, double *std_error)
{
    qsort(height, count, sizeof *height, descending);
    const size_t last = used < count - 1 ? used : count - 1;
    const double step = (height[0].at - height[last].at) / STEPS;
    *end = height[0].at;
    *std_error = 0;
    if (!(step > 0)) return;
    double weight[STEPS][MOST_WEIGHTS];
    for (size_t j = 0; j < STEPS; j++)
        smooth_likelihood(height, last, height[0].at + ((double)j + 0.5) * step, corner_power, CORNER_POWERS,
                          weight[j]);
    grid_moments((const double(*)[MOST_WEIGHTS])weight, CORNER_POWERS, height[0].at, step, end, std_error);
}
