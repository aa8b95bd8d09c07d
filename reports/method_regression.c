/* reports/method_regression.c: regressions for two methods that both err: Deming and Passing-Bablok.
 * K. Linnet, Estimation of the linear relationship between the measurements of two methods with proportional errors,
 * Statistics in Medicine 9 (1990); H. Passing and W. Bablok, J. Clin. Chem. Clin. Biochem. 21 (1983). The Passing-Bablok
 * slopes are never all formed: how many lie below a slope b is the number of pairs whose order along y - b x is the
 * reverse of that along x, counted by merging; bisection leaves few enough to list. */
#include "reports/agreement.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Slopes this near to -1 are -1: decimal readings rarely give it to the last bit. */
static const double AT_MINUS_ONE = 1e-10;

/* ---- Deming ------------------------------------------------------------------------------------------------ */

static void deming_fit(double n, double sx, double sy, double sxx, double syy, double sxy, double lambda, double *slope,
                       double *intercept)
{
    const double mx = sx / n, my = sy / n;
    const double u = sxx - n * mx * mx, q = syy - n * my * my, p = sxy - n * mx * my;
    /* lambda = var(y error) / var(x error); the root that fits the sign of the covariance, in the stable form */
    const double a = q - lambda * u, root = sqrt(a * a + 4 * lambda * p * p);
    *slope = a >= 0 ? (a + root) / (2 * p) : 2 * lambda * p / (root - a);
    *intercept = my - *slope * mx;
}

plm_status plm_deming(const double *x, const double *y, size_t n, double lambda, plm_statistic *slope,
                      plm_statistic *intercept, plm_error *error)
{
    *slope = *intercept = (plm_statistic){NAN, NAN, NAN, n, "fewer than 3 pairs"};
    if (n < 3) return PLM_OK;
    /* Sums about the means, so that leaving one out cancels nothing. */
    const double mx = plm_mean(x, n), my = plm_mean(y, n);
    const double sxx = plm_sum_products(x, mx, x, mx, n), syy = plm_sum_products(y, my, y, my, n);
    const double sxy = plm_sum_products(x, mx, y, my, n);
    if (!(sxx > 0) || !(syy > 0) || sxy == 0) {
        slope->reason = intercept->reason = !(sxx > 0)   ? "all manual values are equal"
                                            : !(syy > 0) ? "all estimates are equal"
                                                         : "the values are not correlated";
        return PLM_OK;
    }
    double b, a;
    deming_fit((double)n, 0, 0, sxx, syy, sxy, lambda, &b, &a);
    a += my - b * mx;
    double *pseudo_b = plm_alloc(n, sizeof *pseudo_b, error), *pseudo_a = plm_alloc(n, sizeof *pseudo_a, error);
    if (!pseudo_b || !pseudo_a) {
        plm_free(pseudo_b);
        plm_free(pseudo_a);
        return PLM_E_MEMORY;
    }
    for (size_t i = 0; i < n; i++) {
        const double dx = x[i] - mx, dy = y[i] - my;
        double bi, ai;
        deming_fit((double)n - 1, -dx, -dy, sxx - dx * dx, syy - dy * dy, sxy - dx * dy, lambda, &bi, &ai);
        ai += my - bi * mx;
        pseudo_b[i] = (double)n * b - ((double)n - 1) * bi;
        pseudo_a[i] = (double)n * a - ((double)n - 1) * ai;
    }
    const double mean_b = plm_mean(pseudo_b, n), mean_a = plm_mean(pseudo_a, n), count = (double)n;
    const double vb = plm_sum_products(pseudo_b, mean_b, pseudo_b, mean_b, n) / (count - 1) / count;
    const double va = plm_sum_products(pseudo_a, mean_a, pseudo_a, mean_a, n) / (count - 1) / count;
    const double t = gsl_cdf_tdist_Pinv(0.975, count - 2);
    *slope = (plm_statistic){b, b - t * sqrt(vb), b + t * sqrt(vb), n, ""};
    *intercept = (plm_statistic){a, a - t * sqrt(va), a + t * sqrt(va), n, ""};
    plm_free(pseudo_b);
    plm_free(pseudo_a);
    return PLM_OK;
}

/* ---- Passing-Bablok -------------------------------------------------------------------------------------------- */

/** Points sorted by (x, y), and room for counting. */
typedef struct slope_set {
    const double *x, *y;
    size_t n;
    double steepest; /* no finite slope is as steep */
    double *key, *spare;
    uint32_t *order, *spare_order;
} slope_set;

/** Pairs met while merging; listed where list is not NULL. */
typedef struct inversion_list {
    double *slope;
    size_t count, room;
} inversion_list;

static double slope_of(const slope_set *s, uint32_t i, uint32_t j)
{
    const double dx = s->x[j] - s->x[i], dy = s->y[j] - s->y[i];
    return dx == 0 ? copysign(INFINITY, dy) : dy / dx;
}

/* Merges two sorted halves of key and counts pairs (i before j) with key_j < key_i. */
static uint64_t merge_count(slope_set *s, size_t begin, size_t end)
{
    if (end - begin < 2) return 0;
    const size_t middle = begin + (end - begin) / 2;
    uint64_t inversions = merge_count(s, begin, middle) + merge_count(s, middle, end);
    size_t i = begin, j = middle, k = begin;
    while (i < middle || j < end) {
        if (j == end || (i < middle && s->key[i] <= s->key[j])) {
            s->spare[k++] = s->key[i++];
        } else {
            inversions += middle - i;
            s->spare[k++] = s->key[j++];
        }
    }
    memcpy(s->key + begin, s->spare + begin, (end - begin) * sizeof *s->key);
    return inversions;
}

/* Slopes strictly below b (pairs of equal x and y, which have no slope, are never counted: their keys are equal; pairs of
 * equal x count as +inf or -inf: sorted by y within x, dy >= 0, so +inf). */
static uint64_t slopes_below(slope_set *s, double b)
{
    for (size_t i = 0; i < s->n; i++) s->key[i] = s->y[i] - b * s->x[i];
    return merge_count(s, 0, s->n);
}

static int by_number(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Lists all slopes in (low, high] by merging along the order of y - low x and finding what turns over by high: with few
 * slopes between, the list is short. Order along low, then insertion sort to the order along high: each exchange is one
 * slope between. */
static bool list_slopes(slope_set *s, double low, double high, inversion_list *list)
{
    for (size_t i = 0; i < s->n; i++) s->order[i] = (uint32_t)i, s->key[i] = s->y[i] - low * s->x[i];
    /* bottom-up merge sort of order by key, stable, so that equal keys stay in the order of x */
    for (size_t width = 1; width < s->n; width *= 2) {
        for (size_t begin = 0; begin < s->n; begin += 2 * width) {
            const size_t middle = begin + width < s->n ? begin + width : s->n;
            const size_t end = begin + 2 * width < s->n ? begin + 2 * width : s->n;
            size_t i = begin, j = middle;
            for (size_t k = begin; k < end; k++)
                s->spare_order[k] = j == end || (i < middle && s->key[s->order[i]] <= s->key[s->order[j]])
                                        ? s->order[i++]
                                        : s->order[j++];
        }
        memcpy(s->order, s->spare_order, s->n * sizeof *s->order);
    }
    list->count = 0;
    for (size_t i = 0; i < s->n; i++) s->key[i] = s->y[i] - high * s->x[i];
    for (size_t i = 1; i < s->n; i++) {
        const uint32_t moving = s->order[i];
        size_t j = i;
        for (; j > 0 && s->key[s->order[j - 1]] > s->key[moving]; j--) {
            if (list->count == list->room) return false;
            const uint32_t other = s->order[j - 1];
            list->slope[list->count++] = other < moving ? slope_of(s, other, moving) : slope_of(s, moving, other);
            s->order[j] = other;
        }
        s->order[j] = moving;
    }
    qsort(list->slope, list->count, sizeof *list->slope, by_number);
    return true;
}

/* The rank-th smallest slope (0-based) of those that exist. Bisection over the doubles' order (monotone map to integers),
 * so that slopes of any scale take the same 64 steps at most. */
static int64_t to_ordinal(double x)
{
    int64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits < 0 ? INT64_MIN - bits : bits;
}

static double from_ordinal(int64_t ordinal)
{
    const int64_t bits = ordinal < 0 ? INT64_MIN - ordinal : ordinal;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static double select_slope(slope_set *s, uint64_t rank, inversion_list *list)
{
    int64_t low = to_ordinal(-s->steepest), high = to_ordinal(s->steepest);
    uint64_t below_low = 0, below_high = slopes_below(s, s->steepest);
    if (below_high <= rank) return INFINITY;
    while ((uint64_t)high - (uint64_t)low > 1 && below_high - below_low > list->room / 2) {
        const int64_t middle = (low >> 1) + (high >> 1) + (low & high & 1);
        const uint64_t below = slopes_below(s, from_ordinal(middle));
        if (below <= rank)
            low = middle, below_low = below;
        else
            high = middle, below_high = below;
    }
    if (!list_slopes(s, from_ordinal(low), from_ordinal(high), list)) return from_ordinal(low);
    const uint64_t place = rank - below_low;
    return place < list->count ? list->slope[place] : from_ordinal(high);
}

static double median_residual(const slope_set *s, double slope)
{
    for (size_t i = 0; i < s->n; i++) s->key[i] = s->y[i] - slope * s->x[i];
    qsort(s->key, s->n, sizeof *s->key, by_number);
    return s->n % 2 ? s->key[s->n / 2] : (s->key[s->n / 2 - 1] + s->key[s->n / 2]) / 2;
}

typedef struct xy {
    double x, y;
} xy;

static int by_x_then_y(const void *a, const void *b)
{
    const xy *p = a, *q = b;
    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : (p->y > q->y) - (p->y < q->y);
}

static uint64_t identical_pairs(const xy *point, size_t n)
{
    uint64_t pairs = 0;
    for (size_t begin = 0, end; begin < n; begin = end) {
        end = begin + 1;
        while (end < n && point[end].x == point[begin].x && point[end].y == point[begin].y) end++;
        pairs += (uint64_t)(end - begin) * (end - begin - 1) / 2;
    }
    return pairs;
}

/* A bound of the finite slopes. Bisecting beyond it would overflow in y - b x. */
static double steepest_slope(const xy *point, size_t n)
{
    double low = point[0].y, high = point[0].y, step = INFINITY;
    for (size_t i = 1; i < n; i++) {
        low = fmin(low, point[i].y);
        high = fmax(high, point[i].y);
        if (point[i].x > point[i - 1].x) step = fmin(step, point[i].x - point[i - 1].x);
    }
    return 2 * (high - low) / step + 4; /* at least beyond -1, which the shift asks for */
}

/* Slopes of -1 have no place in the shifted median. */
static void passing_bablok_fit(slope_set *s, uint64_t slopes, inversion_list *list, plm_statistic *slope,
                               plm_statistic *intercept)
{
    const double n = (double)s->n;
    const uint64_t below = slopes_below(s, -1 - AT_MINUS_ONE), through = slopes_below(s, AT_MINUS_ONE - 1);
    const uint64_t excluded = through - below, count = slopes - excluded, shift = below;
    if (count == 0) return;
        /* rank among the slopes without those of -1 */
#define SLOPE(rank_) select_slope(s, (rank_) < below ? (rank_) : (rank_) + excluded, list)
    const uint64_t middle = (count - 1) / 2 + shift;
    if (middle >= count || (count % 2 == 0 && middle + 1 >= count)) {
        slope->reason = intercept->reason = "the slopes point downward: the methods do not measure the same";
        return;
    }
    const double first = SLOPE(middle), b = count % 2 ? first : (first + SLOPE(middle + 1)) / 2;
    const double c = 1.959963984540054 * sqrt(n * (n - 1) * (2 * n + 5) / 18);
    const int64_t m1 = (int64_t)floor(((double)count - c) / 2 + 0.5), m2 = (int64_t)count - m1 + 1;
    if (isinf(b)) {
        slope->reason = intercept->reason = "the slope is not finite";
        return;
    }
    *slope = (plm_statistic){b, NAN, NAN, s->n, ""};
    const int64_t low_rank = m1 + (int64_t)shift - 1, high_rank = m2 + (int64_t)shift - 1;
    if (m1 >= 1 && low_rank >= 0) slope->low = SLOPE((uint64_t)low_rank);
    if (m1 >= 1 && high_rank < (int64_t)count) slope->high = SLOPE((uint64_t)high_rank);
#undef SLOPE
    if (isinf(slope->low)) slope->low = NAN;
    if (isinf(slope->high)) slope->high = NAN;
    *intercept = (plm_statistic){median_residual(s, b), NAN, NAN, s->n, ""};
    if (!isnan(slope->high)) intercept->low = median_residual(s, slope->high);
    if (!isnan(slope->low)) intercept->high = median_residual(s, slope->low);
}

plm_status plm_passing_bablok(const double *x, const double *y, size_t n, plm_statistic *slope,
                              plm_statistic *intercept, plm_error *error)
{
    *slope = *intercept = (plm_statistic){NAN, NAN, NAN, n, "fewer than 3 pairs"};
    if (n < 3) return PLM_OK;
    inversion_list list = {.room = 8 * n + 64};
    xy *point = plm_alloc(n, sizeof *point, error);
    double *block = plm_alloc(n, 4 * sizeof *block, error);
    uint32_t *order = plm_alloc(n, 2 * sizeof *order, error);
    list.slope = plm_alloc(list.room, sizeof *list.slope, error);
    plm_status status = point && block && order && list.slope ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t i = 0; i < n; i++) point[i] = (xy){x[i], y[i]};
        qsort(point, n, sizeof *point, by_x_then_y);
        double *sorted_x = block + 2 * n, *sorted_y = block + 3 * n;
        for (size_t i = 0; i < n; i++) sorted_x[i] = point[i].x, sorted_y[i] = point[i].y;
        slope_set s = {sorted_x, sorted_y, n, steepest_slope(point, n), block, block + n, order, order + n};
        const uint64_t slopes = (uint64_t)n * (n - 1) / 2 - identical_pairs(point, n);
        slope->reason = intercept->reason = "all pairs are equal";
        if (slopes) passing_bablok_fit(&s, slopes, &list, slope, intercept);
    }
    plm_free(point);
    plm_free(block);
    plm_free(order);
    plm_free(list.slope);
    return status;
}
