/* reports/agreement.h: how well estimates agree with manual measurements. Internal to reports/ and tool/.
 *
 * Conventions: p is the estimate, m the manual value, d = p - m, n pairs. Every statistic comes with a 95 % interval
 * where one is defined; what cannot be computed (too few pairs, constant columns) comes with a reason, never a NaN in a
 * table. Sums run about the mean in two compensated passes, so that values like 1e9 + small keep their digits. */
#ifndef PLANTIMETER_REPORTS_AGREEMENT_H
#define PLANTIMETER_REPORTS_AGREEMENT_H

#include "cloud/cloud.h"

/** One statistic of one group. NAN in value: see reason. NAN in low, high: no interval is defined. */
typedef struct plm_statistic {
    double value, low, high;
    size_t n;           /**< pairs that it rests on */
    const char *reason; /**< why there is no value; "" where there is one. Static text */
} plm_statistic;

/** What a statistic is measured in. */
typedef enum plm_statistic_unit {
    PLM_UNIT_OF_TRAIT,
    PLM_UNIT_PERCENT,
    PLM_UNIT_NONE,
    PLM_UNIT_PER_TRAIT /**< one over the trait's unit */
} plm_statistic_unit;

typedef struct plm_statistic_row {
    const char *name;
    plm_statistic_unit unit;
    const char *definition; /**< with its source */
} plm_statistic_row;

/** The statistics, in the order of the tables. */
typedef enum plm_statistic_id {
    PLM_STAT_R2,
    PLM_STAT_R_PEARSON,
    PLM_STAT_R2_PEARSON,
    PLM_STAT_RMSE,
    PLM_STAT_RRMSE,
    PLM_STAT_NRMSE_RANGE,
    PLM_STAT_MAPE,
    PLM_STAT_MAE,
    PLM_STAT_BIAS,
    PLM_STAT_BIAS_PERCENT,
    PLM_STAT_SD_DIFF,
    PLM_STAT_LOA_LOW,
    PLM_STAT_LOA_HIGH,
    PLM_STAT_PROPORTIONAL_BIAS_SLOPE,
    PLM_STAT_PROPORTIONAL_BIAS_P,
    PLM_STAT_CCC,
    PLM_STAT_CCC_ACCURACY,
    PLM_STAT_OLS_SLOPE,
    PLM_STAT_OLS_INTERCEPT,
    PLM_STAT_DEMING_SLOPE,
    PLM_STAT_DEMING_INTERCEPT,
    PLM_STAT_PASSING_BABLOK_SLOPE,
    PLM_STAT_PASSING_BABLOK_INTERCEPT,
    PLM_STAT_PAIRED_T_P,
    PLM_STAT_WILCOXON_P,
    PLM_STAT_SHAPIRO_P,
    PLM_STAT_TOST_P,
    PLM_STAT_VARIANCE_RATIO,
    PLM_STAT_VARIANCE_P,
    PLM_STAT_COUNT
} plm_statistic_id;

/** The row of a statistic. */
const plm_statistic_row *plm_statistic_describe(plm_statistic_id id);

typedef struct plm_agreement_options {
    double variance_ratio; /**< error variance of the estimate over that of the manual value, for Deming; 0: 1 */
    double tolerance;      /**< of TOST, in the trait's unit; 0: TOST is left out */
    bool circular;         /**< differences of azimuths wrap at 360 */
    size_t resamples;      /**< bootstrap; 0: 2000 */
    uint64_t seed;
} plm_agreement_options;

/** All statistics of n pairs.
 * estimate, manual  n values each, finite, in the trait's unit (degrees for angles).
 * cluster           n numbers of the plant that a pair comes from (any numbers), for the bootstrap; NULL: each pair alone.
 * out               PLM_STAT_COUNT statistics.
 * PLM_E_ARGUMENT for a value that is not finite; PLM_E_MEMORY. n of 0 is allowed. O(n log n + resamples n). */
plm_status plm_agreement(const double *estimate, const double *manual, const uint32_t *cluster, size_t n,
                         const plm_agreement_options *options, plm_statistic out[PLM_STAT_COUNT], plm_error *error);

/** Repeated measurements of the same subjects by one method, one-way random effects: within-subject SD (repeatability)
 * and ICC(1) (Shrout and Fleiss 1979). subject: n numbers. degrees: of freedom of the within-subject variance. */
typedef struct plm_repeatability {
    double sd_within, icc;
    size_t subjects, degrees;
} plm_repeatability;
plm_status plm_repeatability_measure(const double *value, const uint32_t *subject, size_t n,
                                     plm_repeatability *repeatability, plm_error *error);

/* ---- The parts, each usable and tested alone ------------------------------------------------------------------- */

/** Compensated sum (Neumaier 1974) and the mean about the first value. */
double plm_sum(const double *value, size_t n);
double plm_mean(const double *value, size_t n);
/** Sum of (a - mean a)(b - mean b), compensated. */
double plm_sum_products(const double *a, double mean_a, const double *b, double mean_b, size_t n);

/** Wilcoxon signed rank test of the differences, two-sided: exact below 50 pairs without ties or zeros, else normal with
 * continuity correction, zeros left out (as R's wilcox.test). NAN with a reason where it is undefined. */
plm_status plm_wilcoxon(const double *difference, size_t n, plm_statistic *out, plm_error *error);

/** Shapiro-Wilk test of normality (Royston 1995, algorithm AS R94), 3 to 5000 values. */
plm_status plm_shapiro(const double *value, size_t n, plm_statistic *out, plm_error *error);

/** Deming regression of y on x with the ratio of error variances lambda = var(y error) / var(x error); intervals by the
 * jackknife (Linnet 1990), t with n - 2 degrees. */
plm_status plm_deming(const double *x, const double *y, size_t n, double lambda, plm_statistic *slope,
                      plm_statistic *intercept, plm_error *error);

/** Passing-Bablok regression (Passing and Bablok 1983) of y on x with its 95 % intervals. Selects among the n (n - 1) / 2
 * slopes by counting inversions, O(n log n) each, so that 1e5 pairs are no burden. */
plm_status plm_passing_bablok(const double *x, const double *y, size_t n, plm_statistic *slope,
                              plm_statistic *intercept, plm_error *error);

/** BCa bootstrap intervals (Efron 1987) of R2, RMSE and MAPE, clusters drawn whole. difference, manual: n values.
 * statistic[3]: r2, rmse, mape with value set; low and high are filled in. */
plm_status plm_bootstrap_agreement(const double *difference, const double *manual, const uint32_t *cluster, size_t n,
                                   size_t resamples, uint64_t seed, plm_statistic statistic[3], plm_error *error);

#endif
