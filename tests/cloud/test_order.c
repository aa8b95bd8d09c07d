/* Order statistics equal those of the sorted array, for ties, sorted and reversed input. */
#include "support/test.h"

#include "cloud/order.h"

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void selection_equals_sorting(void **unused)
{
    (void)unused;
    uint64_t state = 11;
    for (int trial = 0; trial < 3000; trial++) {
        double values[64], sorted[64];
        const size_t count = 1 + (size_t)(test_uniform(&state) * 64);
        const double kinds = trial % 3 == 0 ? 4 : 1e6; /* a third of the trials is full of ties */
        for (size_t i = 0; i < count; i++) values[i] = floor(test_uniform(&state) * kinds);
        if (trial % 5 == 1) qsort(values, count, sizeof *values, compare);
        memcpy(sorted, values, sizeof sorted);
        qsort(sorted, count, sizeof *sorted, compare);
        const size_t place = (size_t)(test_uniform(&state) * (double)count);
        assert_near(plm_order_select(values, count, place), sorted[place], 0);
        for (size_t i = 0; i < count; i++)
            assert_true(i < place ? values[i] <= values[place] : values[i] >= values[place]);
        qsort(values, count, sizeof *values, compare);
        assert_memory_equal(values, sorted, count * sizeof *values); /* nothing lost, nothing made up */
        const double middle = count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
        assert_near(plm_order_median(values, count), middle, 1e-9);
        assert_near(plm_order_quantile(values, count, 1), sorted[count - 1], 0);
        assert_near(plm_order_quantile(values, count, 0), sorted[0], 0);
    }
    assert_true(isnan(plm_order_median(NULL, 0)));
}

static void the_robust_sd_is_the_sd_of_normal_values_and_ignores_outliers(void **unused)
{
    (void)unused;
    enum { COUNT_ALL = 20000 };
    double *values = malloc(COUNT_ALL * sizeof *values);
    assert_non_null(values);
    uint64_t state = 5;
    for (int i = 0; i < COUNT_ALL; i++) values[i] = i % 100 ? 2 + 3 * test_normal(&state) : 1e9;
    assert_near(plm_order_robust_sd(values, COUNT_ALL, 2), 3,
                0.15); /* 1 % outliers lift it by 1.3 %, the sample by 1 % */
    free(values);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(selection_equals_sorting),
        cmocka_unit_test(the_robust_sd_is_the_sd_of_normal_values_and_ignores_outliers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
