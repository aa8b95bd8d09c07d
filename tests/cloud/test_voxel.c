/* Voxel thinning: members share their cell, means are means, and neither rows' order nor threads leave a trace. */
#include "support/test.h"

#include "cloud/morton.h"
#include "cloud/voxel.h"

#include <omp.h>

enum { POINTS = 40000 };

static void fill(float xyz[][3], size_t count, uint64_t *state)
{
    for (size_t i = 0; i < count; i++) {
        xyz[i][0] = (float)(test_uniform(state) * 2 - 1);
        xyz[i][1] = (float)(test_uniform(state) * 0.5 - 3);
        xyz[i][2] = (float)(0.1 * xyz[i][0] + 0.01 * test_normal(state));
    }
}

static bool same_cell(const float a[3], const float b[3], double cell)
{
    for (int axis = 0; axis < 3; axis++)
        if (floor(a[axis] / cell) != floor(b[axis] / cell)) return false;
    return true;
}

static void members_share_their_cell_and_voxels_do_not(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 5;
    static float xyz[POINTS][3];
    fill(xyz, POINTS, &state);
    const double cell = 0.03;
    plm_voxels voxels;
    assert_ok(plm_voxel_thin((const float(*)[3])xyz, POINTS, cell, &voxels, &error));
    assert_true(voxels.count > 1000 && voxels.count < POINTS);
    assert_int_equal(voxels.first[voxels.count], POINTS);
    for (size_t v = 0; v < voxels.count; v++) {
        double mean[3] = {0, 0, 0};
        const uint32_t *member = voxels.member + voxels.first[v];
        assert_int_equal(voxels.size[v], voxels.first[v + 1] - voxels.first[v]);
        assert_true(voxels.size[v] > 0);
        for (uint32_t j = 0; j < voxels.size[v]; j++) {
            assert_int_equal(voxels.owner[member[j]], v);
            assert_true(j == 0 || member[j] > member[j - 1]);
            assert_true(same_cell(xyz[member[j]], xyz[member[0]], cell));
            for (int axis = 0; axis < 3; axis++) mean[axis] += xyz[member[j]][axis] / (double)voxels.size[v];
        }
        for (int axis = 0; axis < 3; axis++)
            assert_near(voxels.xyz[v][axis], mean[axis], 1e-7 * (1 + fabs(mean[axis]))); /* float */
        for (size_t w = v + 1; w < voxels.count && w < v + 100;
             w++) /* cells are near in order where they are near in space */
            assert_false(same_cell(xyz[member[0]], xyz[voxels.member[voxels.first[w]]], cell));
    }
    plm_voxels_free(&voxels);
}

static void order_of_rows_and_threads_leave_no_trace(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 6;
    static float xyz[POINTS][3];
    static uint32_t origin[POINTS];
    fill(xyz, POINTS, &state);
    for (uint32_t i = 0; i < POINTS; i++) origin[i] = i;
    plm_voxels first, second;
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    assert_ok(plm_voxel_thin((const float(*)[3])xyz, POINTS, 0.05, &first, &error));
    for (size_t i = POINTS - 1; i > 0; i--) {
        const size_t j = (size_t)(test_uniform(&state) * (double)(i + 1));
        const uint32_t row = origin[i];
        float other[3];
        memcpy(other, xyz[i], sizeof other);
        memcpy(xyz[i], xyz[j], sizeof other);
        memcpy(xyz[j], other, sizeof other);
        origin[i] = origin[j];
        origin[j] = row;
    }
    omp_set_num_threads(3);
    assert_ok(plm_voxel_thin((const float(*)[3])xyz, POINTS, 0.05, &second, &error));
    omp_set_num_threads(threads);
    assert_int_equal(first.count, second.count);
    assert_memory_equal(first.xyz, second.xyz, first.count * sizeof *first.xyz);
    assert_memory_equal(first.size, second.size, first.count * sizeof *first.size);
    for (size_t i = 0; i < POINTS; i++) assert_int_equal(second.owner[i], first.owner[origin[i]]);
    plm_voxels_free(&first);
    plm_voxels_free(&second);
}

static void odd_input_gives_voxels_or_a_status(void **unused)
{
    (void)unused;
    plm_error error = {0};
    float xyz[3][3] = {{-1e6f, 0, 0}, {1e6f, 0, 0}, {1e6f, 0, 0}};
    plm_voxels voxels;
    assert_ok(plm_voxel_thin((const float(*)[3])xyz, 0, 1, &voxels, &error));
    assert_int_equal(voxels.count, 0);
    plm_voxels_free(&voxels);
    assert_ok(plm_voxel_thin((const float(*)[3])xyz, 3, 1, &voxels, &error));
    assert_int_equal(voxels.count, 2);
    assert_true(voxels.xyz[1][0] == 1e6f && voxels.size[1] == 2);
    plm_voxels_free(&voxels);
    assert_ok(plm_voxel_thin((const float(*)[3])xyz, 3, 1e30, &voxels, &error)); /* two cells: either side of 0 */
    assert_int_equal(voxels.count, 2);
    plm_voxels_free(&voxels);
    assert_int_equal(plm_voxel_thin((const float(*)[3])xyz, 3, 0.5, &voxels, &error), PLM_E_ARGUMENT);
    assert_non_null(strstr(error.message, "cells"));
    assert_int_equal(plm_voxel_thin((const float(*)[3])xyz, 3, 0, &voxels, &error), PLM_E_ARGUMENT);
    assert_int_equal(plm_voxel_thin((const float(*)[3])xyz, 3, NAN, &voxels, &error), PLM_E_ARGUMENT);
    assert_int_equal(plm_voxel_thin((const float(*)[3])xyz, 3, 1e-310, &voxels, &error), PLM_E_ARGUMENT);
}

static void keys_are_sorted_and_equal_ones_keep_their_order(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 7;
    const unsigned bits[] = {1, 7, 11, 12, 33, 63};
    const size_t counts[] = {0, 1, 2, 1000, POINTS};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(3);
    for (size_t b = 0; b < COUNT(bits); b++)
        for (size_t c = 0; c < COUNT(counts); c++) {
            plm_keys keys;
            assert_ok(plm_keys_create(counts[c], &keys, &error));
            for (size_t i = 0; i < counts[c]; i++) {
                keys.key[i] = (uint64_t)(test_uniform(&state) * 0x1p53) << 10 & (((uint64_t)1 << bits[b]) - 1);
                if (i % 3 == 0 && i) keys.key[i] = keys.key[i - 1];
                keys.row[i] = (uint32_t)i;
            }
            assert_ok(plm_keys_sort(&keys, bits[b], &error));
            for (size_t i = 1; i < counts[c]; i++)
                assert_true(keys.key[i - 1] < keys.key[i] ||
                            (keys.key[i - 1] == keys.key[i] && keys.row[i - 1] < keys.row[i]));
            plm_keys_free(&keys);
        }
    omp_set_num_threads(threads);
    for (int i = 0; i < 1000; i++) {
        const uint64_t x = (uint64_t)(test_uniform(&state) * 0x1p21), y = 0x1fffff - x, z = x ^ 0x155555;
        const uint64_t key = plm_morton_key(x, y, z);
        assert_true(plm_morton_squeeze(key) == x && plm_morton_squeeze(key >> 1) == y &&
                    plm_morton_squeeze(key >> 2) == z);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(members_share_their_cell_and_voxels_do_not),
        cmocka_unit_test(order_of_rows_and_threads_leave_no_trace),
        cmocka_unit_test(odd_input_gives_voxels_or_a_status),
        cmocka_unit_test(keys_are_sorted_and_equal_ones_keep_their_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
