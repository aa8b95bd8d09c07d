/* Quantiles by selection are those of the sorted values, with ties, runs and all lengths. */
#include "support/test.h"

#include "cloud/selection.h"

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void quantiles_are_those_of_the_sorted_values(void **unused)
{
    (void)unused;
    uint64_t state = 5;
    double values[300], sorted[300], shuffled[300];
    for (int trial = 0; trial < 4000; trial++) {
        const size_t count = 1 + (size_t)(test_uniform(&state) * 299);
        const double kinds = trial % 3 == 0 ? 3 : trial % 3 == 1 ? 40 : 1e9; /* many ties, some, none */
        for (size_t i = 0; i < count; i++) values[i] = floor(test_uniform(&state) * kinds);
        if (trial % 5 == 0) qsort(values, count, sizeof *values, compare);
        memcpy(sorted, values, sizeof values);
        qsort(sorted, count, sizeof *sorted, compare);
        for (int share = 0; share <= 4; share++) {
            memcpy(shuffled, values, sizeof values);
            const double expected = sorted[(size_t)(share / 4.0 * (double)(count - 1))];
            assert_true(plm_select_quantile(shuffled, count, share / 4.0) == expected);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(quantiles_are_those_of_the_sorted_values)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
