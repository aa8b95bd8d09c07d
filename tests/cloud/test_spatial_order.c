/* Canonical order: the same sequence of points for every order of the rows. */
#include "support/test.h"

#include "cloud/spatial_order.h"

enum { POINTS = 3000 };

/* Kinds: uniform, a coarse grid with many duplicates, all in one place but for one far point. */
static void fill(int kind, float xyz[][3], uint64_t *state)
{
    for (size_t i = 0; i < POINTS; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double u = test_uniform(state);
            xyz[i][axis] = kind == 0 ? (float)u : kind == 1 ? (float)floor(u * 4) : (float)(i ? u * 1e-9 : 1e3);
        }
}

static void shuffled_rows_give_the_same_sequence_of_points(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 5;
    static float xyz[POINTS][3], shuffled[POINTS][3];
    static uint32_t order[POINTS], shuffled_order[POINTS];
    for (int kind = 0; kind < 3; kind++) {
        fill(kind, xyz, &state);
        memcpy(shuffled, xyz, sizeof xyz);
        for (size_t i = POINTS - 1; i > 0; i--) {
            const size_t j = (size_t)(test_uniform(&state) * (double)(i + 1));
            float other[3];
            memcpy(other, shuffled[i], sizeof other);
            memcpy(shuffled[i], shuffled[j], sizeof other);
            memcpy(shuffled[j], other, sizeof other);
        }
        assert_ok(plm_spatial_order((const float(*)[3])xyz, POINTS, order, &error));
        assert_ok(plm_spatial_order((const float(*)[3])shuffled, POINTS, shuffled_order, &error));
        static bool seen[POINTS];
        memset(seen, 0, sizeof seen);
        for (size_t i = 0; i < POINTS; i++) {
            assert_memory_equal(xyz[order[i]], shuffled[shuffled_order[i]], sizeof *xyz);
            assert_false(seen[order[i]]);
            seen[order[i]] = true;
        }
    }
}

static void neighbours_in_the_order_are_near_in_space(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 6;
    static float xyz[POINTS][3];
    static uint32_t order[POINTS];
    fill(0, xyz, &state);
    assert_ok(plm_spatial_order((const float(*)[3])xyz, POINTS, order, &error));
    double path = 0;
    for (size_t i = 1; i < POINTS; i++) {
        double squared = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double step = (double)xyz[order[i]][axis] - xyz[order[i - 1]][axis];
            squared += step * step;
        }
        path += sqrt(squared);
    }
    /* Random order: 0.66 a step. The curve: about the spacing, 3000^(-1/3) = 0.07, with some jumps. */
    assert_true(path / POINTS < 0.15);
}

static void no_points_are_no_failure(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint32_t order = 7;
    const float one[1][3] = {{1, 2, 3}};
    assert_ok(plm_spatial_order(one, 0, &order, &error));
    assert_int_equal(order, 7);
    assert_ok(plm_spatial_order(one, 1, &order, &error));
    assert_int_equal(order, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shuffled_rows_give_the_same_sequence_of_points),
        cmocka_unit_test(neighbours_in_the_order_are_near_in_space),
        cmocka_unit_test(no_points_are_no_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
