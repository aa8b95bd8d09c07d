/* Pairing by number, by position, by rank; units. */
#include "support/test.h"

#include "reports/pairing.h"

static plm_reading reading(const char *plant, const char *id, double value, double x)
{
    return (plm_reading){.plant_id = plant,
                         .organ = "leaf",
                         .organ_id = id,
                         .trait = "leaf_area",
                         .unit = "cm2",
                         .value = value,
                         .has_position = true,
                         .position = {x, 0, 0},
                         .group = "",
                         .repeat_count = 1};
}

/* Partner of manual row j, or -1. */
static int partner(const plm_match_pair *pair, size_t count, size_t manual)
{
    for (size_t i = 0; i < count; i++)
        if (pair[i].manual == manual) return (int)pair[i].estimate;
    return -1;
}

static void numbers_pair_and_the_rest_is_left(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const plm_reading estimate[] = {reading("p", "1", 5, 0), reading("p", "0", 4, 0), reading("q", "0", 9, 0)};
    const plm_reading manual[] = {reading("p", "0", 4.1, 0), reading("p", "7", 3, 0), reading("q", "0", 9, 0)};
    plm_match_pair pair[3];
    bool used_e[3], used_m[3];
    size_t count;
    assert_ok(plm_match_readings(estimate, 3, manual, 3, PLM_MATCH_AUTO, pair, &count, used_e, used_m, &error));
    assert_int_equal(count, 2);
    assert_int_equal(partner(pair, count, 0), 1);
    assert_int_equal(partner(pair, count, 1), -1);
    assert_false(used_e[0]);
    assert_false(used_m[1]);
}

static void positions_pair_with_the_least_total_distance(void **unused)
{
    (void)unused;
    plm_error error = {0};
    /* Greedy would take 1.0 for 0.9 and leave 2.0 for 0.0: total 2.1; the best is 0.9 + 1.1 = 2.0 crossing not */
    const plm_reading estimate[] = {reading("p", "", 1, 1.0), reading("p", "", 2, 2.0), reading("p", "", 3, 50)};
    const plm_reading manual[] = {reading("p", "", 1, 0.0), reading("p", "", 2, 0.9)};
    plm_match_pair pair[2];
    bool used_e[3], used_m[2];
    size_t count;
    assert_ok(plm_match_readings(estimate, 3, manual, 2, PLM_MATCH_AUTO, pair, &count, used_e, used_m, &error));
    assert_int_equal(count, 2);
    assert_int_equal(partner(pair, count, 0) + partner(pair, count, 1), 1);
    assert_false(used_e[2]);
}

static void rank_pairs_order_statistics_only_when_asked(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_reading estimate[] = {reading("p", "", 9, 0), reading("p", "", 1, 0), reading("p", "", 5, 0)};
    plm_reading manual[] = {reading("p", "", 5.2, 0), reading("p", "", 8.8, 0)};
    for (size_t i = 0; i < 3; i++) estimate[i].has_position = false;
    plm_match_pair pair[2];
    bool used_e[3], used_m[2];
    size_t count;
    assert_ok(plm_match_readings(estimate, 3, manual, 2, PLM_MATCH_AUTO, pair, &count, used_e, used_m, &error));
    assert_int_equal(count, 0);
    assert_ok(plm_match_readings(estimate, 3, manual, 2, PLM_MATCH_RANK, pair, &count, used_e, used_m, &error));
    assert_int_equal(count, 2);
    assert_int_equal(partner(pair, count, 0), 2);
    assert_int_equal(partner(pair, count, 1), 0);
}

/* Against all permutations. */
static double best_of_all(const double *cost, size_t rows, size_t columns, size_t row, unsigned taken)
{
    if (row == rows) return 0;
    double best = INFINITY;
    for (size_t j = 0; j < columns; j++)
        if (!(taken >> j & 1))
            best = fmin(best, cost[row * columns + j] + best_of_all(cost, rows, columns, row + 1, taken | 1u << j));
    return best;
}

static void assignment_is_the_best_of_all_permutations(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 11;
    for (int trial = 0; trial < 200; trial++) {
        const size_t rows = (size_t)(1 + trial % 5), columns = rows + (size_t)(trial % 3);
        double cost[64];
        for (size_t i = 0; i < rows * columns; i++)
            cost[i] = trial % 4 ? test_uniform(&state) : floor(3 * test_uniform(&state));
        size_t column[8];
        assert_ok(plm_assign(cost, rows, columns, column, &error));
        double total = 0;
        for (size_t i = 0; i < rows; i++) total += cost[i * columns + column[i]];
        assert_near(total, best_of_all(cost, rows, columns, 0, 0), 1e-12);
    }
}

static void units_convert_within_their_kind_only(void **unused)
{
    (void)unused;
    assert_near(plm_unit_conversion("mm", "cm"), 0.1, 1e-15);
    assert_near(plm_unit_conversion("m2", "cm2"), 1e4, 1e-9);
    assert_near(plm_unit_conversion("rad", "deg"), 57.29577951308232, 1e-12);
    assert_true(plm_unit_conversion("mm", "cm2") == 0);
    assert_true(plm_unit_conversion("furlong", "mm") == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_pair_and_the_rest_is_left),
        cmocka_unit_test(positions_pair_with_the_least_total_distance),
        cmocka_unit_test(rank_pairs_order_statistics_only_when_asked),
        cmocka_unit_test(assignment_is_the_best_of_all_permutations),
        cmocka_unit_test(units_convert_within_their_kind_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
