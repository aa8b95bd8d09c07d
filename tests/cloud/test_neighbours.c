/* Neighbours: equal to brute force on every cloud, with duplicates and ties. */
#include "support/test.h"

#include "cloud/neighbours.h"

enum { POINTS = 700 };

/* Kinds: uniform, a grid (ties everywhere), all duplicates of few places, a line. */
static void fill(int kind, float xyz[][3], size_t count, uint64_t *state)
{
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double u = test_uniform(state);
            xyz[i][axis] = kind == 0   ? (float)u
                           : kind == 1 ? (float)floor(u * 8)
                           : kind == 2 ? (float)(i % 5)
                                       : (axis ? 0.0f : (float)u);
        }
}

static float squared_distance(const float a[3], const float b[3])
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

static void table_equals_brute_force_with_ties_to_the_smaller_row(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 1;
    static float xyz[POINTS][3];
    static uint32_t row[POINTS * 9];
    static float squared[POINTS * 9];
    for (int kind = 0; kind < 4; kind++) {
        fill(kind, xyz, POINTS, &state);
        plm_index *index;
        assert_ok(plm_index_build((const float(*)[3])xyz, POINTS, &index, &error));
        assert_ok(plm_index_table(index, 9, row, squared, &error));
        for (uint32_t i = 0; i < POINTS; i++) {
            bool used[POINTS] = {false};
            used[i] = true;
            for (size_t j = 0; j < 9; j++) {
                uint32_t best = PLM_NO_ROW;
                for (uint32_t c = 0; c < POINTS; c++)
                    if (!used[c] &&
                        (best == PLM_NO_ROW || squared_distance(xyz[i], xyz[c]) < squared_distance(xyz[i], xyz[best])))
                        best = c;
                used[best] = true;
                assert_int_equal(row[i * 9 + j], best);
                assert_true(squared[i * 9 + j] == squared_distance(xyz[i], xyz[best]));
            }
        }
        plm_index_free(index);
    }
}

static void ball_finds_all_points_within_the_radius(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 2;
    static float xyz[POINTS][3];
    static uint32_t row[POINTS];
    static float squared[POINTS];
    for (int kind = 0; kind < 4; kind++) {
        fill(kind, xyz, POINTS, &state);
        plm_index *index;
        assert_ok(plm_index_build((const float(*)[3])xyz, POINTS, &index, &error));
        for (size_t i = 0; i < POINTS; i += 7) {
            const float radius = kind == 1 ? 2.0f : 0.3f;
            const size_t found = plm_index_ball(index, xyz[i], radius, POINTS, row, squared);
            size_t expected = 0;
            for (size_t c = 0; c < POINTS; c++) expected += squared_distance(xyz[i], xyz[c]) <= radius * radius;
            assert_int_equal(found, expected);
            for (size_t j = 1; j < found; j++)
                assert_true(squared[j - 1] < squared[j] || (squared[j - 1] == squared[j] && row[j - 1] < row[j]));
        }
        plm_index_free(index);
    }
}

static void fewer_points_than_asked_for_leave_empty_places(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const float xyz[2][3] = {{0, 0, 0}, {1, 0, 0}};
    for (size_t count = 0; count <= 2; count++) {
        plm_index *index;
        assert_ok(plm_index_build(xyz, count, &index, &error));
        uint32_t row[3];
        float squared[3];
        assert_int_equal(plm_index_nearest(index, (const float[3]){0.1f, 0, 0}, 3, row, squared), count);
        assert_int_equal(row[2], PLM_NO_ROW);
        assert_true(isinf(squared[2]));
        plm_index_free(index);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_equals_brute_force_with_ties_to_the_smaller_row),
        cmocka_unit_test(ball_finds_all_points_within_the_radius),
        cmocka_unit_test(fewer_points_than_asked_for_leave_empty_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
