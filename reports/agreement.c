/* reports/agreement.c: the statistics of agreement between two methods: definitions in one table, computed from two
 * compensated passes. Sources: seedling paper Eq. 26-29 (its Eq. 28 omits the division by the mean); Bland and Altman
 * 1986 and 1999; Lin 1989 and 2000; Pitman 1939 and Morgan 1939; Schuirmann 1987. */
#include "reports/agreement.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

static const plm_statistic_row rows[PLM_STAT_COUNT] = {
    [PLM_STAT_R2] = {"r2", PLM_UNIT_NONE,
                     "1 - sum (p - m)^2 / sum (m - mean m)^2; can be negative (seedling paper, Eq. 26); BCa interval"},
    [PLM_STAT_R_PEARSON] = {"r_pearson", PLM_UNIT_NONE, "Pearson correlation; interval by Fisher's z"},
    [PLM_STAT_R2_PEARSON] = {"r2_pearson", PLM_UNIT_NONE, "square of r_pearson: blind to bias and scale"},
    [PLM_STAT_RMSE] = {"rmse", PLM_UNIT_OF_TRAIT, "sqrt(mean (p - m)^2) (seedling paper, Eq. 27); BCa interval"},
    [PLM_STAT_RRMSE] = {"rrmse", PLM_UNIT_PERCENT,
                        "rmse / mean m * 100 (seedling paper, Eq. 28 with the mean that it omits)"},
    [PLM_STAT_NRMSE_RANGE] = {"nrmse_range", PLM_UNIT_PERCENT, "rmse / (max m - min m) * 100"},
    [PLM_STAT_MAPE] = {"mape", PLM_UNIT_PERCENT,
                       "mean |p - m| / |m| * 100 over m != 0 (seedling paper, Eq. 29); BCa interval"},
    [PLM_STAT_MAE] = {"mae", PLM_UNIT_OF_TRAIT, "mean |p - m|"},
    [PLM_STAT_BIAS] = {"bias", PLM_UNIT_OF_TRAIT, "mean (p - m); t interval"},
    [PLM_STAT_BIAS_PERCENT] = {"bias_percent", PLM_UNIT_PERCENT, "bias / mean m * 100"},
    [PLM_STAT_SD_DIFF] = {"sd_diff", PLM_UNIT_OF_TRAIT, "standard deviation of p - m; chi-square interval"},
    [PLM_STAT_LOA_LOW] = {"loa_low", PLM_UNIT_OF_TRAIT,
                          "lower limit of agreement, bias - 1.96 sd_diff (Bland and Altman 1986, interval 1999)"},
    [PLM_STAT_LOA_HIGH] = {"loa_high", PLM_UNIT_OF_TRAIT, "upper limit of agreement, bias + 1.96 sd_diff"},
    [PLM_STAT_PROPORTIONAL_BIAS_SLOPE] = {"proportional_bias_slope", PLM_UNIT_NONE,
                                          "slope of p - m on (p + m) / 2; t interval"},
    [PLM_STAT_PROPORTIONAL_BIAS_P] = {"proportional_bias_p", PLM_UNIT_NONE, "p value of that slope being 0"},
    [PLM_STAT_CCC] = {"ccc", PLM_UNIT_NONE,
                      "Lin's concordance 2 s_pm / (s_p^2 + s_m^2 + bias^2), moments over n (Lin 1989; interval 2000)"},
    [PLM_STAT_CCC_ACCURACY] = {"ccc_accuracy", PLM_UNIT_NONE, "Lin's C_b: ccc / r_pearson"},
    [PLM_STAT_OLS_SLOPE] = {"ols_slope", PLM_UNIT_NONE, "least-squares slope of p on m; t interval"},
    [PLM_STAT_OLS_INTERCEPT] = {"ols_intercept", PLM_UNIT_OF_TRAIT, "least-squares intercept of p on m; t interval"},
    [PLM_STAT_DEMING_SLOPE] = {"deming_slope", PLM_UNIT_NONE,
                               "Deming slope of p on m; jackknife interval (Linnet 1990)"},
    [PLM_STAT_DEMING_INTERCEPT] = {"deming_intercept", PLM_UNIT_OF_TRAIT, "Deming intercept; jackknife interval"},
    [PLM_STAT_PASSING_BABLOK_SLOPE] = {"passing_bablok_slope", PLM_UNIT_NONE,
                                       "shifted median of pairwise slopes (Passing and Bablok 1983)"},
    [PLM_STAT_PASSING_BABLOK_INTERCEPT] = {"passing_bablok_intercept", PLM_UNIT_OF_TRAIT,
                                           "median of p - slope m (Passing and Bablok 1983)"},
    [PLM_STAT_PAIRED_T_P] = {"paired_t_p", PLM_UNIT_NONE, "p value of bias 0, paired t test (test of bias)"},
    [PLM_STAT_WILCOXON_P] = {"wilcoxon_p", PLM_UNIT_NONE, "p value of Wilcoxon's signed rank test"},
    [PLM_STAT_SHAPIRO_P] = {"shapiro_p", PLM_UNIT_NONE, "p value of normal differences, Shapiro-Wilk (Royston 1995)"},
    [PLM_STAT_TOST_P] = {"tost_p", PLM_UNIT_NONE,
                         "larger p value of the two one-sided t tests that |bias| < tolerance (Schuirmann 1987)"},
    [PLM_STAT_VARIANCE_RATIO] = {"variance_ratio", PLM_UNIT_NONE, "variance of p over variance of m"},
    [PLM_STAT_VARIANCE_P] = {"variance_p", PLM_UNIT_NONE,
                             "p value of equal variances, paired values (Pitman 1939, Morgan 1939; test of variance)"},
};

static const double Z975 = 1.959963984540054; /* 97.5 % point of the normal distribution */

const plm_statistic_row *plm_statistic_describe(plm_statistic_id id)
{
    return &rows[id];
}

double plm_sum(const double *value, size_t n)
{
    double sum = 0, lost = 0;
    for (size_t i = 0; i < n; i++) {
        const double next = sum + value[i];
        lost += fabs(sum) >= fabs(value[i]) ? (sum - next) + value[i] : (value[i] - next) + sum;
        sum = next;
    }
    return sum + lost;
}

double plm_mean(const double *value, size_t n)
{
    double sum = 0, lost = 0;
    for (size_t i = 0; i < n; i++) {
        const double term = value[i] - value[0];
        const double next = sum + term;
        lost += fabs(sum) >= fabs(term) ? (sum - next) + term : (term - next) + sum;
        sum = next;
    }
    return n ? value[0] + (sum + lost) / (double)n : NAN;
}

double plm_sum_products(const double *a, double mean_a, const double *b, double mean_b, size_t n)
{
    double sum = 0, lost = 0;
    for (size_t i = 0; i < n; i++) {
        const double term = (a[i] - mean_a) * (b[i] - mean_b);
        const double next = sum + term;
        lost += fabs(sum) >= fabs(term) ? (sum - next) + term : (term - next) + sum;
        sum = next;
    }
    return sum + lost;
}

/** The pairs and their moments, as the groups of statistics below need them. */
typedef struct pair_set {
    const double *p, *m, *d;
    size_t n;
    double mean_p, mean_m, bias;
    double spp, smm, spm, sdd, see; /* sums of squares and products about the means; see: of d about 0 */
} pair_set;

static plm_statistic value_of(double value, size_t n)
{
    return (plm_statistic){value, NAN, NAN, n, ""};
}

static plm_statistic interval_of(double value, double half_width, size_t n)
{
    return (plm_statistic){value, value - half_width, value + half_width, n, ""};
}

static plm_statistic none(const char *reason, size_t n)
{
    return (plm_statistic){NAN, NAN, NAN, n, reason};
}

static double t975(size_t degrees)
{
    return gsl_cdf_tdist_Pinv(0.975, (double)degrees);
}

/* GSL's own inverse does not converge beyond some thousand degrees. Newton's steps from Wilson and Hilferty's start. */
static double chi_square_quantile(double probability, double degrees)
{
    if (degrees < 100) return gsl_cdf_chisq_Pinv(probability, degrees);
    const double k = 2 / (9 * degrees);
    double x = degrees * pow(1 - k + gsl_cdf_ugaussian_Pinv(probability) * sqrt(k), 3);
    for (int step = 0; step < 8; step++)
        x -= (gsl_cdf_chisq_P(x, degrees) - probability) / gsl_ran_chisq_pdf(x, degrees);
    return x;
}

static double two_sided_t(double t, size_t degrees)
{
    return 2.0 * gsl_cdf_tdist_Q(fabs(t), (double)degrees);
}

static void errors_of(const pair_set *s, plm_statistic *out)
{
    const double n = (double)s->n;
    const double rmse = sqrt(s->see / n);
    double low = s->m[0], high = s->m[0], absolute = 0, relative = 0;
    size_t nonzero = 0;
    for (size_t i = 0; i < s->n; i++) {
        low = fmin(low, s->m[i]);
        high = fmax(high, s->m[i]);
        absolute += fabs(s->d[i]);
        if (s->m[i] != 0) relative += fabs(s->d[i] / s->m[i]), nonzero++;
    }
    out[PLM_STAT_RMSE] = value_of(rmse, s->n);
    out[PLM_STAT_MAE] = value_of(absolute / n, s->n);
    out[PLM_STAT_MAPE] =
        nonzero ? value_of(100 * relative / (double)nonzero, nonzero) : none("all manual values are 0", 0);
    const bool no_mean = s->mean_m == 0;
    out[PLM_STAT_RRMSE] = no_mean ? none("the manual mean is 0", s->n) : value_of(100 * rmse / s->mean_m, s->n);
    out[PLM_STAT_BIAS_PERCENT] =
        no_mean ? none("the manual mean is 0", s->n) : value_of(100 * s->bias / s->mean_m, s->n);
    out[PLM_STAT_NRMSE_RANGE] =
        high > low ? value_of(100 * rmse / (high - low), s->n) : none("all manual values are equal", s->n);
    out[PLM_STAT_R2] = s->smm > 0 ? value_of(1 - s->see / s->smm, s->n) : none("all manual values are equal", s->n);
}

static void differences_of(const pair_set *s, double tolerance, plm_statistic *out)
{
    if (s->n < 2) {
        out[PLM_STAT_BIAS] = value_of(s->bias, s->n);
        return; /* the others keep "fewer than 2 pairs" */
    }
    const double n = (double)s->n, degrees = n - 1;
    const double sd = sqrt(s->sdd / degrees), standard_error = sd / sqrt(n), t = t975(s->n - 1);
    out[PLM_STAT_BIAS] = interval_of(s->bias, t * standard_error, s->n);
    out[PLM_STAT_SD_DIFF] = (plm_statistic){sd, sd * sqrt(degrees / chi_square_quantile(0.975, degrees)),
                                            sd * sqrt(degrees / chi_square_quantile(0.025, degrees)), s->n, ""};
    const double half = t * sd * sqrt(1 / n + Z975 * Z975 / (2 * degrees));
    out[PLM_STAT_LOA_LOW] = interval_of(s->bias - Z975 * sd, half, s->n);
    out[PLM_STAT_LOA_HIGH] = interval_of(s->bias + Z975 * sd, half, s->n);
    if (!(sd > 0)) {
        out[PLM_STAT_PAIRED_T_P] = none("all differences are equal", s->n);
        out[PLM_STAT_TOST_P] = none(tolerance > 0 ? "all differences are equal" : "no tolerance was given", s->n);
        return;
    }
    out[PLM_STAT_PAIRED_T_P] = value_of(two_sided_t(s->bias / standard_error, s->n - 1), s->n);
    if (tolerance > 0) {
        const double low = gsl_cdf_tdist_Q((s->bias + tolerance) / standard_error, degrees);
        const double high = gsl_cdf_tdist_P((s->bias - tolerance) / standard_error, degrees);
        out[PLM_STAT_TOST_P] = value_of(fmax(low, high), s->n);
    } else {
        out[PLM_STAT_TOST_P] = none("no tolerance was given", s->n);
    }
}

/* Least squares of y on x from sums about the means: slope and intercept with t intervals, p value of slope 0. */
static void line_of(double mean_x, double mean_y, double sxx, double sxy, double syy, size_t n, plm_statistic *slope,
                    plm_statistic *intercept, plm_statistic *p)
{
    const double b = sxy / sxx, a = mean_y - b * mean_x;
    const double residual = fmax(0, syy - b * sxy);
    const double variance = n > 2 ? residual / (double)(n - 2) : NAN;
    const double error = sqrt(variance / sxx), t = n > 2 ? t975(n - 2) : NAN;
    *slope = n > 2 ? interval_of(b, t * error, n) : value_of(b, n);
    if (intercept)
        *intercept =
            n > 2 ? interval_of(a, t * sqrt(variance * (1 / (double)n + mean_x * mean_x / sxx)), n) : value_of(a, n);
    if (p && n > 2) *p = error > 0 ? value_of(two_sided_t(b / error, n - 2), n) : none("the fit is exact", n);
}

static void correlations_of(const pair_set *s, plm_statistic *out)
{
    const double n = (double)s->n;
    const bool constant_m = !(s->smm > 0), constant_p = !(s->spp > 0);
    if (constant_m || constant_p) {
        const char *why = constant_m ? "all manual values are equal" : "all estimates are equal";
        for (int id = 0; id < PLM_STAT_COUNT; id++)
            if (id == PLM_STAT_R_PEARSON || id == PLM_STAT_R2_PEARSON || id == PLM_STAT_CCC_ACCURACY ||
                id == PLM_STAT_VARIANCE_P || id == PLM_STAT_VARIANCE_RATIO || id == PLM_STAT_OLS_SLOPE ||
                id == PLM_STAT_OLS_INTERCEPT || id == PLM_STAT_CCC)
                out[id] = none(why, s->n);
        if (constant_m && constant_p) return;
        if (!constant_m)
            line_of(s->mean_m, s->mean_p, s->smm, s->spm, s->spp, s->n, &out[PLM_STAT_OLS_SLOPE],
                    &out[PLM_STAT_OLS_INTERCEPT], NULL);
        out[PLM_STAT_CCC] = value_of(0, s->n); /* the covariance is 0 */
        return;
    }
    const double r = fmax(-1, fmin(1, s->spm / sqrt(s->spp * s->smm)));
    out[PLM_STAT_R_PEARSON] = value_of(r, s->n);
    out[PLM_STAT_R2_PEARSON] = value_of(r * r, s->n);
    if (s->n > 3 && fabs(r) < 1) {
        const double z = atanh(r), half = Z975 / sqrt(n - 3);
        out[PLM_STAT_R_PEARSON].low = tanh(z - half);
        out[PLM_STAT_R_PEARSON].high = tanh(z + half);
    }
    line_of(s->mean_m, s->mean_p, s->smm, s->spm, s->spp, s->n, &out[PLM_STAT_OLS_SLOPE], &out[PLM_STAT_OLS_INTERCEPT],
            NULL);
    const double vp = s->spp / n, vm = s->smm / n;
    const double ccc = 2 * s->spm / n / (vp + vm + s->bias * s->bias);
    out[PLM_STAT_CCC] = value_of(ccc, s->n);
    out[PLM_STAT_CCC_ACCURACY] = r != 0 ? value_of(ccc / r, s->n) : none("the correlation is 0", s->n);
    if (s->n > 2 && fabs(r) > 0 && fabs(r) < 1 && fabs(ccc) < 1) { /* Lin 1989 with the correction of 2000 */
        const double u2 = s->bias * s->bias / sqrt(vp * vm), c2 = ccc * ccc;
        const double variance = ((1 - r * r) * c2 * (1 - c2) / (r * r) + 2 * c2 * ccc * (1 - ccc) * u2 / r -
                                 0.5 * c2 * c2 * u2 * u2 / (r * r)) /
                                (n - 2);
        const double half = Z975 * sqrt(fmax(0, variance)) / (1 - c2), z = atanh(ccc);
        out[PLM_STAT_CCC].low = tanh(z - half);
        out[PLM_STAT_CCC].high = tanh(z + half);
    }
    const double ratio = s->spp / s->smm;
    out[PLM_STAT_VARIANCE_RATIO] = value_of(ratio, s->n);
    if (s->n > 2) {
        if (fabs(r) < 1) {
            const double t = (ratio - 1) * sqrt(n - 2) / (2 * sqrt(ratio * (1 - r * r)));
            out[PLM_STAT_VARIANCE_P] = value_of(two_sided_t(t, s->n - 2), s->n);
            /* Its interval: ratios that the test would not reject (Pitman 1939). */
            const double k = 1 + 2 * (1 - r * r) * gsl_cdf_fdist_Pinv(0.95, 1, n - 2) / (n - 2), w = sqrt(k * k - 1);
            out[PLM_STAT_VARIANCE_RATIO].low = ratio * (k - w);
            out[PLM_STAT_VARIANCE_RATIO].high = ratio * (k + w);
        } else {
            out[PLM_STAT_VARIANCE_P] = none("the correlation is exact", s->n);
        }
    }
}

static void proportional_bias_of(const pair_set *s, plm_statistic *out)
{
    /* d on (p + m) / 2, from the sums that are there already. */
    const double saa = (s->spp + 2 * s->spm + s->smm) / 4, sad = (s->spp - s->smm) / 2;
    if (s->n < 3) return;
    if (!(saa > 0)) {
        out[PLM_STAT_PROPORTIONAL_BIAS_SLOPE] = out[PLM_STAT_PROPORTIONAL_BIAS_P] = none("all means are equal", s->n);
        return;
    }
    line_of((s->mean_p + s->mean_m) / 2, s->bias, saa, sad, s->sdd, s->n, &out[PLM_STAT_PROPORTIONAL_BIAS_SLOPE], NULL,
            &out[PLM_STAT_PROPORTIONAL_BIAS_P]);
}

static plm_status prepare(const double *estimate, const double *manual, size_t n, bool circular, double *p, double *d,
                          plm_error *error)
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(estimate[i]) || !isfinite(manual[i]))
            return plm_fail(error, PLM_E_ARGUMENT, "pair %zu holds a value that is not finite", i + 1);
        d[i] = estimate[i] - manual[i];
        if (circular) d[i] = remainder(d[i], 360.0);
        p[i] = circular ? manual[i] + d[i] : estimate[i]; /* 359 against 1 degree is -2, not 358 */
    }
    return PLM_OK;
}

plm_status plm_agreement(const double *estimate, const double *manual, const uint32_t *cluster, size_t n,
                         const plm_agreement_options *options, plm_statistic out[PLM_STAT_COUNT], plm_error *error)
{
    static const plm_agreement_options defaults = {0};
    if (!options) options = &defaults;
    gsl_set_error_handler_off(); /* the library never aborts; what GSL cannot compute comes back as NaN */
    plm_statistic draft[PLM_STAT_COUNT];
    for (int id = 0; id < PLM_STAT_COUNT; id++)
        draft[id] = none(n == 0 ? "no pairs" : n == 1 ? "fewer than 2 pairs" : "fewer than 3 pairs", n);
    double *p = plm_alloc(n, sizeof *p, error), *d = plm_alloc(n, sizeof *d, error);
    plm_status status = p && d ? prepare(estimate, manual, n, options->circular, p, d, error) : PLM_E_MEMORY;
    if (status == PLM_OK && n > 0) {
        pair_set s = {.p = p, .m = manual, .d = d, .n = n};
        s.mean_p = plm_mean(p, n), s.mean_m = plm_mean(manual, n), s.bias = plm_mean(d, n);
        s.spp = plm_sum_products(p, s.mean_p, p, s.mean_p, n);
        s.smm = plm_sum_products(manual, s.mean_m, manual, s.mean_m, n);
        s.spm = plm_sum_products(p, s.mean_p, manual, s.mean_m, n);
        s.sdd = plm_sum_products(d, s.bias, d, s.bias, n);
        s.see = plm_sum_products(d, 0, d, 0, n);
        errors_of(&s, draft);
        differences_of(&s, options->tolerance, draft);
        if (n > 1) correlations_of(&s, draft);
        proportional_bias_of(&s, draft);
        status = plm_wilcoxon(d, n, &draft[PLM_STAT_WILCOXON_P], error);
        if (status == PLM_OK) status = plm_shapiro(d, n, &draft[PLM_STAT_SHAPIRO_P], error);
        if (status == PLM_OK)
            status = plm_deming(manual, p, n, options->variance_ratio > 0 ? options->variance_ratio : 1,
                                &draft[PLM_STAT_DEMING_SLOPE], &draft[PLM_STAT_DEMING_INTERCEPT], error);
        if (status == PLM_OK)
            status = plm_passing_bablok(manual, p, n, &draft[PLM_STAT_PASSING_BABLOK_SLOPE],
                                        &draft[PLM_STAT_PASSING_BABLOK_INTERCEPT], error);
        plm_statistic booted[3] = {draft[PLM_STAT_R2], draft[PLM_STAT_RMSE], draft[PLM_STAT_MAPE]};
        if (status == PLM_OK)
            status = plm_bootstrap_agreement(d, manual, cluster, n, options->resamples ? options->resamples : 2000,
                                             options->seed, booted, error);
        draft[PLM_STAT_R2] = booted[0], draft[PLM_STAT_RMSE] = booted[1], draft[PLM_STAT_MAPE] = booted[2];
    }
    if (status == PLM_OK) memcpy(out, draft, sizeof draft);
    plm_free(p);
    plm_free(d);
    return status;
}
