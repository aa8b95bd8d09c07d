/* reports/rank_tests.c: Wilcoxon's signed rank test and the Shapiro-Wilk test of normality.
 * Wilcoxon 1945; exact distribution by the recursion over ranks. Shapiro-Wilk by P. Royston, Remark AS R94, Applied
 * Statistics 44 (1995): polynomial approximations of weights and of the null distribution, whose coefficients are the
 * published ones. */
#include "reports/agreement.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EXACT_BELOW = 50, SHAPIRO_MAXIMUM = 5000 };

typedef struct ranked {
    double magnitude;
    bool positive;
} ranked;

static int by_magnitude(const void *a, const void *b)
{
    const double x = ((const ranked *)a)->magnitude, y = ((const ranked *)b)->magnitude;
    return (x > y) - (x < y);
}

/* P(V <= v) of the signed rank statistic of n values without ties: counts of subsets of 1..n by their sum. */
static double signed_rank_below(double v, size_t n)
{
    static const size_t room = EXACT_BELOW * (EXACT_BELOW + 1) / 2 + 1;
    double count[EXACT_BELOW * (EXACT_BELOW + 1) / 2 + 1] = {1};
    for (size_t rank = 1; rank <= n; rank++)
        for (size_t sum = room - 1; sum >= rank; sum--) count[sum] += count[sum - rank];
    double below = 0;
    for (size_t sum = 0; sum < room && (double)sum <= v; sum++) below += count[sum];
    return below / exp2((double)n);
}

plm_status plm_wilcoxon(const double *difference, size_t n, plm_statistic *out, plm_error *error)
{
    ranked *list = plm_alloc(n, sizeof *list, error);
    if (!list) return PLM_E_MEMORY;
    size_t used = 0;
    for (size_t i = 0; i < n; i++)
        if (difference[i] != 0) list[used++] = (ranked){fabs(difference[i]), difference[i] > 0};
    const bool zeros = used < n;
    qsort(list, used, sizeof *list, by_magnitude);
    double v = 0, tie_sum = 0;
    for (size_t begin = 0, end; begin < used; begin = end) {
        end = begin + 1;
        while (end < used && list[end].magnitude == list[begin].magnitude) end++;
        const double ties = (double)(end - begin), rank = (double)(begin + end + 1) / 2;
        tie_sum += ties * ties * ties - ties;
        for (size_t i = begin; i < end; i++) v += list[i].positive ? rank : 0;
    }
    plm_free(list);
    *out = (plm_statistic){NAN, NAN, NAN, n, "no difference but zeros"};
    if (used == 0) return PLM_OK;
    out->reason = "";
    const double m = (double)used, mean = m * (m + 1) / 4;
    if (used < EXACT_BELOW && !zeros && tie_sum == 0) {
        const double tail = v > mean ? 1 - signed_rank_below(v - 1, used) : signed_rank_below(v, used);
        out->value = fmin(1, 2 * tail);
        return PLM_OK;
    }
    const double z = v - mean, sigma = sqrt(m * (m + 1) * (2 * m + 1) / 24 - tie_sum / 48);
    const double corrected = (z - (z > 0 ? 0.5 : z < 0 ? -0.5 : 0)) / sigma;
    out->value = 2 * fmin(gsl_cdf_ugaussian_P(corrected), gsl_cdf_ugaussian_Q(corrected));
    return PLM_OK;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double polynomial(const double *coefficient, int count, double x)
{
    double sum = 0;
    for (int i = count; i-- > 0;) sum = sum * x + coefficient[i];
    return sum;
}

/* Royston's weights of the upper half, largest first: weight[0..n/2). */
static void shapiro_weights(size_t n, double *weight)
{
    static const double c1[] = {0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056};
    static const double c2[] = {0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
    const size_t half = n / 2;
    if (n == 3) {
        weight[0] = sqrt(0.5);
        return;
    }
    double sum = 0;
    for (size_t i = 0; i < half; i++) {
        weight[i] = -gsl_cdf_ugaussian_Pinv(((double)i + 1 - 0.375) / ((double)n + 0.25));
        sum += 2 * weight[i] * weight[i];
    }
    const double u = 1 / sqrt((double)n), root = sqrt(sum);
    const double first = polynomial(c1, 6, u) + weight[0] / root;
    size_t kept = 1;
    double scale;
    if (n > 5) {
        const double second = weight[1] / root + polynomial(c2, 6, u);
        scale = sqrt((sum - 2 * weight[0] * weight[0] - 2 * weight[1] * weight[1]) /
                     (1 - 2 * first * first - 2 * second * second));
        weight[1] = second;
        kept = 2;
    } else {
        scale = sqrt((sum - 2 * weight[0] * weight[0]) / (1 - 2 * first * first));
    }
    weight[0] = first;
    for (size_t i = kept; i < half; i++) weight[i] /= scale;
}

static double shapiro_p(double w, size_t n)
{
    static const double c3[] = {0.544, -0.39978, 0.025054, -6.714e-4};
    static const double c4[] = {1.3822, -0.77857, 0.062767, -0.0020322};
    static const double c5[] = {-1.5861, -0.31082, -0.083751, 0.0038915};
    static const double c6[] = {-0.4803, -0.082676, 0.0030302};
    static const double g[] = {-2.273, 0.459};
    const double size = (double)n, deficit = log1p(-w), length = log(size);
    if (n == 3) {
        const double p = 6 / 3.14159265358979323846 * (asin(sqrt(w)) - asin(sqrt(0.75)));
        return fmax(0, p);
    }
    if (n <= 11) {
        const double gamma = polynomial(g, 2, size);
        if (deficit >= gamma) return 1e-99;
        const double y = -log(gamma - deficit);
        return gsl_cdf_ugaussian_Q((y - polynomial(c3, 4, size)) / exp(polynomial(c4, 4, size)));
    }
    return gsl_cdf_ugaussian_Q((deficit - polynomial(c5, 4, length)) / exp(polynomial(c6, 3, length)));
}

plm_status plm_shapiro(const double *value, size_t n, plm_statistic *out, plm_error *error)
{
    *out = (plm_statistic){NAN, NAN, NAN, n, ""};
    if (n < 3 || n > SHAPIRO_MAXIMUM) {
        out->reason = n < 3 ? "fewer than 3 pairs" : "the approximation holds up to 5000 pairs";
        return PLM_OK;
    }
    double *sorted = plm_alloc(n, sizeof *sorted, error), *weight = plm_alloc(n, sizeof *weight, error);
    if (!sorted || !weight) {
        plm_free(sorted);
        plm_free(weight);
        return PLM_E_MEMORY;
    }
    for (size_t i = 0; i < n; i++) sorted[i] = value[i];
    qsort(sorted, n, sizeof *sorted, by_value);
    const double range = sorted[n - 1] - sorted[0];
    if (!(range > 1e-19 * fmax(fabs(sorted[0]), fabs(sorted[n - 1])))) {
        out->reason = "all differences are equal";
    } else {
        shapiro_weights(n, weight);
        const double mean = plm_mean(sorted, n), squares = plm_sum_products(sorted, mean, sorted, mean, n);
        double b = 0;
        for (size_t i = 0; i < n / 2; i++) b += weight[i] * (sorted[n - 1 - i] - sorted[i]);
        out->value = shapiro_p(fmin(1, b * b / squares), n);
    }
    plm_free(sorted);
    plm_free(weight);
    return PLM_OK;
}
