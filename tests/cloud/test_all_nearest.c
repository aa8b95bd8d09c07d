/* All nearest neighbours: equal to FLANN's exact search on every kind of cloud and for every k, ties to the smaller row,
 * the same from any number of threads; and what is measured from them. */
#include "support/test.h"

#include "cloud/all_nearest.h"
#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "cloud/smoothness.h"

#include <flann/flann.h>
#include <omp.h>

enum { POINTS = 12000 };

enum { UNIFORM, LATTICE, DUPLICATES, LINE, PLANE, DENSITIES, SURFACES, FAR_POINT, ONE_PLACE, KINDS };

static void fill(int kind, float xyz[][3], size_t count, uint64_t *state)
{
    for (size_t i = 0; i < count; i++) {
        const double u[3] = {test_uniform(state), test_uniform(state), test_uniform(state)};
        const double gauss = test_normal(state), dense = i % 2 ? 0.1 : 1; /* 1000 to 1 in space */
        const double far = i == count / 2 ? 1e9 : 0;
        const double kind_of_point[KINDS][3] = {
            [UNIFORM] = {u[0], u[1], u[2]},
            [LATTICE] = {floor(u[0] * 20), floor(u[1] * 20), floor(u[2] * 20)},
            [DUPLICATES] = {floor(u[0] * 2), floor(u[1] * 2) * 0.1,
                            floor(u[2] * 3) * 0.01}, /* 1000 at each of 12 places */
            [LINE] = {u[0] * 3 - 1, u[0] * 2, u[0]},
            [PLANE] = {u[0], u[1], 0.5},
            [DENSITIES] = {u[0] * dense, u[1] * dense, u[2] * dense},
            [SURFACES] = {u[0], u[1], 0.2 * floor(u[2] * 3) + 0.3 * u[0] * u[0] + 0.001 * gauss},
            [FAR_POINT] = {u[0] + far, u[1] - far, u[2] + far},
            [ONE_PLACE] = {0.1, 0.2, 0.3},
        };
        for (int axis = 0; axis < 3; axis++) xyz[i][axis] = (float)kind_of_point[kind][axis];
    }
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Squared distances of the k + 1 nearest by FLANN, the point itself (0) among them. */
static void ask_flann(float xyz[][3], size_t count, size_t k, float *squared)
{
    struct FLANNParameters parameters = DEFAULT_FLANN_PARAMETERS;
    parameters.algorithm = FLANN_INDEX_KDTREE_SINGLE;
    parameters.leaf_max_size = 32;
    parameters.eps = 0;
    parameters.cores = 1;
    float speedup;
    flann_index_t index = flann_build_index(&xyz[0][0], (int)count, 3, &speedup, &parameters);
    int *row = malloc(count * (k + 1) * sizeof *row);
    assert_non_null(row);
    assert_int_equal(
        flann_find_nearest_neighbors_index(index, &xyz[0][0], (int)count, row, squared, (int)(k + 1), &parameters), 0);
    flann_free_index(index, &parameters);
    free(row);
    for (size_t i = 0; i < count; i++) /* FLANN leaves more than 250 neighbours unsorted */
        qsort(squared + i * (k + 1), k + 1, sizeof *squared, compare_floats);
}

static float squared_distance(const float a[3], const float b[3])
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

static void check_kind(int kind, size_t count, size_t k, uint64_t *state)
{
    static float xyz[POINTS][3];
    plm_error error = {0};
    fill(kind, xyz, count, state);
    float *expected = malloc(count * (k + 1) * sizeof *expected), *squared = malloc(count * k * sizeof *squared);
    uint32_t *row = malloc(count * k * sizeof *row);
    assert_true(expected && squared && row);
    plm_index *index;
    assert_ok(plm_index_build((const float(*)[3])xyz, count, &index, &error));
    assert_ok(plm_index_table(index, k, row, squared, &error));
    ask_flann(xyz, count, k, expected);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < k; j++) {
            const size_t at = i * k + j;
            assert_true(squared[at] == expected[i * (k + 1) + j + 1]);
            assert_true(row[at] < count && row[at] != i && squared_distance(xyz[i], xyz[row[at]]) == squared[at]);
            assert_true(j == 0 || squared[at - 1] < squared[at] || row[at - 1] < row[at]);
        }
    /* the tree's answers have the same rows: of equally far points the smaller rows */
    uint32_t *by_tree = malloc(k * sizeof *by_tree);
    for (size_t i = 0; i < count; i += 97) {
        plm_index_neighbours(index, (uint32_t)i, k, by_tree, NULL);
        assert_memory_equal(by_tree, row + i * k, k * sizeof *by_tree);
    }
    free(by_tree);
    plm_index_free(index);
    free(expected);
    free(squared);
    free(row);
}

static void distances_equal_flann_on_every_kind_of_cloud(void **unused)
{
    (void)unused;
    uint64_t state = 21;
    for (int kind = 0; kind < KINDS; kind++) {
        check_kind(kind, kind == ONE_PLACE ? 1500 : POINTS, 16, &state);
        check_kind(kind, 900, 1, &state);
        check_kind(kind, 900, 5, &state);
    }
}

static void distances_equal_flann_for_every_k(void **unused)
{
    (void)unused;
    uint64_t state = 22;
    const size_t ks[] = {2, 3, 8, 33, 64, 200};
    for (size_t i = 0; i < COUNT(ks); i++)
        for (int kind = 0; kind < KINDS; kind++) check_kind(kind, 1500, ks[i], &state);
    for (int kind = 0; kind < KINDS; kind += 3) check_kind(kind, 1100, 1024, &state);
    check_kind(SURFACES, 65, 64, &state); /* all others */
    check_kind(SURFACES, 66, 64, &state);
}

static void same_bits_from_one_and_more_threads(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 23;
    static float xyz[POINTS][3];
    static float smoothness[2][POINTS], distance[2][POINTS], normal[2][POINTS][3], curvature[2][POINTS];
    const int threads = omp_get_max_threads();
    for (int kind = 0; kind < KINDS; kind++) {
        const size_t count = kind == FAR_POINT ? POINTS / 4 : POINTS;
        fill(kind, xyz, count, &state);
        for (int turn = 0; turn < 2; turn++) {
            omp_set_num_threads(1 + 2 * turn);
            const plm_neighbour_measures out = {smoothness[turn], distance[turn], normal[turn], curvature[turn]};
            assert_ok(plm_neighbour_pass((const float(*)[3])xyz, count, 16, &out, &error));
        }
        omp_set_num_threads(threads);
        assert_memory_equal(smoothness[0], smoothness[1], count * sizeof(float));
        assert_memory_equal(distance[0], distance[1], count * sizeof(float));
        assert_memory_equal(normal[0], normal[1], count * sizeof *normal[0]);
        assert_memory_equal(curvature[0], curvature[1], count * sizeof(float));
    }
}

static void order_of_rows_does_not_change_measures(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 24;
    static float xyz[POINTS][3], shuffled[POINTS][3];
    static float smoothness[2][POINTS], normal[2][POINTS][3];
    static uint32_t from[POINTS];
    fill(SURFACES, xyz, POINTS, &state); /* no ties: with ties, neighbours are chosen by row */
    for (uint32_t i = 0; i < POINTS; i++) from[i] = i;
    for (size_t i = POINTS - 1; i > 0; i--) {
        const size_t j = (size_t)(test_uniform(&state) * (double)(i + 1));
        const uint32_t other = from[i];
        from[i] = from[j];
        from[j] = other;
    }
    for (size_t i = 0; i < POINTS; i++) memcpy(shuffled[i], xyz[from[i]], sizeof *xyz);
    const plm_neighbour_measures out = {.smoothness = smoothness[0], .normal = normal[0]};
    const plm_neighbour_measures shuffled_out = {.smoothness = smoothness[1], .normal = normal[1]};
    assert_ok(plm_neighbour_pass((const float(*)[3])xyz, POINTS, 16, &out, &error));
    assert_ok(plm_neighbour_pass((const float(*)[3])shuffled, POINTS, 16, &shuffled_out, &error));
    for (size_t i = 0; i < POINTS; i++) {
        assert_near(smoothness[1][i], smoothness[0][from[i]], 2e-7);
        for (int axis = 0; axis < 3; axis++) assert_near(normal[1][i][axis], normal[0][from[i]][axis], 1e-6);
    }
}

/* The definitions, in double, from the table. */
static void measures_follow_their_definitions(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 25;
    const int kinds[] = {UNIFORM, LATTICE, LINE, PLANE, SURFACES, DUPLICATES};
    const size_t count = 3000, k = 16;
    static float xyz[POINTS][3], smoothness[POINTS], distance[POINTS], normal[POINTS][3], curvature[POINTS];
    static uint32_t row[POINTS * 16];
    for (size_t kind = 0; kind < COUNT(kinds); kind++) {
        fill(kinds[kind], xyz, count, &state);
        plm_index *index;
        assert_ok(plm_index_build((const float(*)[3])xyz, count, &index, &error));
        assert_ok(plm_index_table(index, k, row, NULL, &error));
        const plm_neighbour_measures out = {smoothness, distance, normal, curvature};
        assert_ok(plm_neighbour_pass((const float(*)[3])xyz, count, k, &out, &error));
        for (size_t i = 0; i < count; i++) {
            double sum[3] = {0, 0, 0}, distances = 0, mean[3] = {0, 0, 0}, moment[6] = {0};
            int apart = 0;
            for (size_t j = 0; j < k; j++) {
                double d[3];
                for (int axis = 0; axis < 3; axis++) d[axis] = (double)xyz[row[i * k + j]][axis] - xyz[i][axis];
                for (int axis = 0; axis < 3; axis++) mean[axis] += d[axis] / (double)(k + 1);
                const double length = plm_normalise(d);
                for (int axis = 0; axis < 3; axis++) sum[axis] += d[axis];
                distances += length / (double)k;
                apart += length > 0;
            }
            assert_near(smoothness[i], apart ? plm_norm(sum) / apart : 0, 1e-6); /* float */
            assert_near(distance[i], distances, 1e-6 * (1 + distances));
            for (size_t j = 0; j <= k; j++) {
                double d[3];
                for (int axis = 0; axis < 3; axis++)
                    d[axis] = (j < k ? (double)xyz[row[i * k + j]][axis] - xyz[i][axis] : 0) - mean[axis];
                for (int a = 0, entry = 0; a < 3; a++)
                    for (int b = a; b < 3; b++) moment[entry++] += d[a] * d[b];
            }
            double value[3], vector[3][3];
            plm_eigen3(moment, value, vector);
            const double trace = value[0] + value[1] + value[2];
            assert_near(curvature[i], trace > 0 ? value[2] / trace : 0, 1e-6);
            const double n[3] = {normal[i][0], normal[i][1], normal[i][2]};
            assert_near(plm_norm(n), 1, 1e-6);
            assert_true(n[2] >= 0);
            if (value[1] - value[2] > 1e-3 * trace) assert_near(fabs(plm_dot(n, vector[2])), 1, 1e-6);
        }
        plm_index_free(index);
    }
}

static void flat_leaf_is_smooth_inside_and_rough_at_its_edge(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static float xyz[81 * 81][3], smoothness[81 * 81], normal[81 * 81][3], curvature[81 * 81];
    for (int i = 0; i < 81 * 81; i++) {
        const float x = (float)(i % 81), y = (float)(i / 81);
        const float point[3] = {x, y, 0.5f * x};
        memcpy(xyz[i], point, sizeof point);
    }
    const plm_neighbour_measures out = {.smoothness = smoothness, .normal = normal, .curvature = curvature};
    /* in x, y, x / 2 the 8 cells around are the nearest 8 */
    assert_ok(plm_neighbour_pass((const float(*)[3])xyz, COUNT(xyz), 8, &out, &error));
    const size_t middle = 40 * 81 + 40, edge = 40 * 81;
    assert_near(smoothness[middle], 0, 1e-6);
    assert_true(smoothness[edge] > 0.4);
    assert_near(normal[middle][0], -0.5 / sqrt(1.25), 1e-6);
    assert_near(normal[middle][2], 1 / sqrt(1.25), 1e-6);
    assert_near(curvature[middle], 0, 1e-12);
}

static void few_points_and_wrong_k_are_answered(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const float xyz[3][3] = {{0, 0, 0}, {3, 4, 0}, {3, 4, 0}};
    float smoothness[3] = {-1, -1, -1}, distance[3] = {-1, -1, -1}, normal[3][3], curvature[3];
    const plm_neighbour_measures out = {smoothness, distance, normal, curvature};
    assert_ok(plm_neighbour_pass(xyz, 0, 16, &out, &error));
    assert_true(smoothness[0] == -1);
    assert_ok(plm_neighbour_pass(xyz, 1, 16, &out, &error));
    assert_true(smoothness[0] == 0 && distance[0] == 0 && normal[0][2] == 1 && curvature[0] == 0);
    assert_ok(plm_neighbour_pass(xyz, 3, 16, &out, &error));
    assert_near(smoothness[0], 1, 1e-7); /* both neighbours lie in one direction */
    assert_near(smoothness[1], 1, 1e-7); /* the coincident one does not count */
    assert_near(distance[0], 5, 1e-6);
    assert_near(distance[1], 2.5, 1e-6);
    assert_int_equal(plm_neighbour_pass(xyz, 3, 0, &out, &error), PLM_E_ARGUMENT);
    assert_int_equal(plm_neighbour_pass(xyz, 3, 1025, &out, &error), PLM_E_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_equal_flann_on_every_kind_of_cloud),
        cmocka_unit_test(distances_equal_flann_for_every_k),
        cmocka_unit_test(same_bits_from_one_and_more_threads),
        cmocka_unit_test(order_of_rows_does_not_change_measures),
        cmocka_unit_test(measures_follow_their_definitions),
        cmocka_unit_test(flat_leaf_is_smooth_inside_and_rough_at_its_edge),
        cmocka_unit_test(few_points_and_wrong_k_are_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
