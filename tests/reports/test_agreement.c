/* The statistics of agreement equal R's (tests/reports/agreement_reference.R) to 1e-9, and what cannot be computed comes
 * with a reason. */
#include "support/test.h"

#include "reports/agreement.h"

enum { ROWS = 400 };

/** The rows of one set of agreement_data.csv. */
typedef struct data_set {
    double estimate[ROWS], manual[ROWS];
    uint32_t cluster[ROWS];
    size_t n;
} data_set;

static FILE *open_table(const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/tests/reports/%s", TEST_SOURCE_DIR, name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    char header[256];
    assert_non_null(fgets(header, sizeof header, file));
    return file;
}

static data_set load(const char *set)
{
    data_set data = {.n = 0};
    FILE *file = open_table("agreement_data.csv");
    char name[64];
    unsigned cluster;
    double estimate, manual;
    while (fscanf(file, "%63[^,],%u,%lf,%lf\n", name, &cluster, &estimate, &manual) == 4)
        if (!strcmp(name, set)) {
            data.cluster[data.n] = cluster;
            data.estimate[data.n] = estimate;
            data.manual[data.n++] = manual;
        }
    fclose(file);
    assert_true(data.n > 0);
    return data;
}

static void near_relative(const char *set, const char *name, const char *part, double value, const char *expected,
                          double tolerance, double scale)
{
    if (!strcmp(expected, "NA")) return; /* R gives no interval there, or ours is by another method */
    const double wanted = strtod(expected, NULL);
    if (fabs(value - wanted) <= tolerance * fmax(fmax(fabs(wanted), fabs(scale)), 1e-6)) return;
    print_error("%s %s %s is %.17g, R says %.17g\n", set, name, part, value, wanted);
    fail();
}

static const plm_statistic *find(const plm_statistic all[PLM_STAT_COUNT], const char *name)
{
    for (int id = 0; id < PLM_STAT_COUNT; id++)
        if (!strcmp(plm_statistic_describe((plm_statistic_id)id)->name, name)) return &all[id];
    return NULL;
}

/* A row of the expected table: what is named there, from the right options. */
static plm_statistic compute(const char *set, const char *name)
{
    plm_error error = {0};
    static data_set data;
    data = load(set);
    plm_statistic all[PLM_STAT_COUNT];
    const bool half = !strncmp(name, "deming_2.5_", 11), bca = strstr(name, "_bca");
    const plm_agreement_options options = {
        .tolerance = 1.5, .variance_ratio = half ? 2.5 : 1, .resamples = bca ? 20000 : 200, .seed = 5};
    assert_ok(plm_agreement(data.estimate, data.manual, data.cluster, data.n, &options, all, &error));
    if (!strcmp(name, "sd_within") || !strcmp(name, "icc")) {
        plm_repeatability repeatability;
        assert_ok(plm_repeatability_measure(data.manual, data.cluster, data.n, &repeatability, &error));
        return (plm_statistic){name[0] == 's' ? repeatability.sd_within : repeatability.icc, NAN, NAN, data.n, ""};
    }
    char plain[96];
    snprintf(plain, sizeof plain, "%s%s", half ? "deming_" : "", half ? name + 11 : name);
    if (bca) *strstr(plain, "_bca") = 0;
    const plm_statistic *found = find(all, plain);
    assert_non_null(found);
    return *found;
}

static void every_statistic_equals_r(void **unused)
{
    (void)unused;
    FILE *file = open_table("agreement_expected.csv");
    char set[64], name[64], value[64], low[64], high[64];
    int checked = 0;
    while (fscanf(file, "%63[^,],%63[^,],%63[^,],%63[^,],%63[^\n]\n", set, name, value, low, high) == 5) {
        const bool bca = strstr(name, "_bca");
        /* 1e-9 is the bar; intercepts at 1e9 are differences of numbers whose rounding alone is 1e-7 of the result, and
         * so are the digits of values that are printed as 1e9 + small */
        const bool far = !strcmp(set, "offset");
        const double tolerance = far ? 1e-6 : 1e-9;
        const plm_statistic found = compute(set, name);
        assert_string_equal(found.reason, "");
        near_relative(set, name, "value", found.value, value, tolerance, 0);
        if (bca) { /* Monte Carlo error of 20 000 resamples on each side */
            near_relative(set, name, "low", found.low, low, 0.05, 0);
            near_relative(set, name, "high", found.high, high, 0.05, 0);
        } else {
            near_relative(set, name, "low", found.low, low, tolerance, far ? found.value : 0);
            near_relative(set, name, "high", found.high, high, tolerance, far ? found.value : 0);
        }
        checked++;
    }
    fclose(file);
    assert_true(checked > 150);
}

static void few_or_constant_pairs_give_reasons_and_no_nan_without_one(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double constant[4] = {3, 3, 3, 3}, varied[4] = {1, 2, 3, 5}, zero[4] = {0};
    const double *estimates[] = {varied, constant, varied, constant, zero, varied};
    const double *manuals[] = {varied, varied, constant, constant, zero, zero};
    for (size_t kind = 0; kind < COUNT(estimates); kind++)
        for (size_t n = 0; n <= 4; n++) {
            plm_statistic all[PLM_STAT_COUNT];
            assert_ok(plm_agreement(estimates[kind], manuals[kind], NULL, n, NULL, all, &error));
            for (int id = 0; id < PLM_STAT_COUNT; id++) {
                assert_true(isnan(all[id].value) ? all[id].reason[0] != 0 : all[id].reason[0] == 0);
                assert_true(!isinf(all[id].value));
            }
            if (n == 0) assert_string_equal(all[PLM_STAT_RMSE].reason, "no pairs");
            if (n > 0)
                assert_near(all[PLM_STAT_BIAS].value, plm_mean(estimates[kind], n) - plm_mean(manuals[kind], n), 1e-15);
        }
    const double bad[2] = {1, NAN};
    plm_statistic all[PLM_STAT_COUNT];
    assert_int_equal(plm_agreement(varied, bad, NULL, 2, NULL, all, &error), PLM_E_ARGUMENT);
}

static void azimuths_wrap(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double estimate[3] = {359, 1, 180}, manual[3] = {1, 359, 181};
    plm_statistic all[PLM_STAT_COUNT];
    const plm_agreement_options options = {.circular = true};
    assert_ok(plm_agreement(estimate, manual, NULL, 3, &options, all, &error));
    assert_near(all[PLM_STAT_MAE].value, 5.0 / 3, 1e-14);
    assert_near(all[PLM_STAT_BIAS].value, -1.0 / 3, 1e-14);
}

/* The fast selection among slopes equals the listing of all of them, with ties in x and y. */
static int by_number(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void passing_bablok_selects_as_if_all_slopes_were_listed(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 9;
    enum { N = 301 };
    static double x[N], y[N], slope[N * N / 2];
    for (int trial = 0; trial < 6; trial++) {
        const double scale = pow(10, trial * 3 - 6);
        for (int i = 0; i < N; i++) {
            x[i] = scale * floor(test_uniform(&state) * (trial % 2 ? 50 : 1e6));
            y[i] = 1.1 * x[i] + scale * floor(test_normal(&state) * 6);
        }
        size_t count = 0, below = 0;
        for (int i = 0; i < N; i++)
            for (int j = i + 1; j < N; j++) {
                const double dx = x[j] - x[i], dy = y[j] - y[i];
                if (dx == 0 && dy == 0) continue;
                slope[count] = dx == 0 ? INFINITY : dy / dx;
                if (slope[count] == -1) continue;
                below += slope[count++] < -1;
            }
        qsort(slope, count, sizeof *slope, by_number);
        const double expected =
            count % 2 ? slope[count / 2 + below] : (slope[count / 2 - 1 + below] + slope[count / 2 + below]) / 2;
        plm_statistic b, a;
        assert_ok(plm_passing_bablok(x, y, N, &b, &a, &error));
        assert_near(b.value, expected, 1e-12 * fabs(expected));
    }
}

static void a_hundred_thousand_pairs_take_seconds(void **unused)
{
    (void)unused;
    plm_error error = {0};
    enum { N = 100000 };
    double *estimate = malloc(N * sizeof *estimate), *manual = malloc(N * sizeof *manual);
    uint32_t *cluster = malloc(N * sizeof *cluster);
    assert_true(estimate && manual && cluster);
    uint64_t state = 4;
    for (uint32_t i = 0; i < N; i++) {
        manual[i] = 10 + 20 * test_uniform(&state);
        estimate[i] = 0.98 * manual[i] + 0.3 * test_normal(&state);
        cluster[i] = i / 8;
    }
    plm_statistic all[PLM_STAT_COUNT];
    assert_ok(plm_agreement(estimate, manual, cluster, N, NULL, all, &error));
    assert_near(all[PLM_STAT_PASSING_BABLOK_SLOPE].value, 0.98, 0.002); /* 4 standard errors */
    assert_near(all[PLM_STAT_DEMING_SLOPE].value, 0.98, 0.002);
    assert_true(all[PLM_STAT_RMSE].low < all[PLM_STAT_RMSE].value &&
                all[PLM_STAT_RMSE].value < all[PLM_STAT_RMSE].high);
    free(estimate);
    free(manual);
    free(cluster);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_statistic_equals_r),
        cmocka_unit_test(few_or_constant_pairs_give_reasons_and_no_nan_without_one),
        cmocka_unit_test(azimuths_wrap),
        cmocka_unit_test(passing_bablok_selects_as_if_all_slopes_were_listed),
        cmocka_unit_test(a_hundred_thousand_pairs_take_seconds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
