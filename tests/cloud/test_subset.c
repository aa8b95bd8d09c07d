/* Thinnings by a hash of coordinates: their size, the same in any order of rows, and a thinning of a thinning. */
#include "support/test.h"

#include "cloud/subset.h"

enum { COUNT = 40000 };

static float (*make_points(void))[3]
{
    float(*xyz)[3] = malloc(COUNT * sizeof *xyz);
    assert_non_null(xyz);
    uint64_t state = 5;
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++) xyz[i][k] = (float)test_uniform(&state);
    return xyz;
}

/* Sum of the coordinates: which points they are, but for their order. */
static double sum_of(const float (*xyz)[3], size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) sum += (double)xyz[i][k];
    return sum;
}

static size_t take(const float (*xyz)[3], size_t count, double share, plm_subset *taken, plm_index **index)
{
    plm_error error = {0};
    assert_ok(plm_index_build(xyz, count, index, &error));
    assert_ok(plm_subset_take(*index, xyz, count, share, taken, &error));
    /* How many there are says the index. */
    uint32_t *row = malloc(count * sizeof *row);
    float *squared = malloc(count * sizeof *squared);
    assert_true(row && squared);
    const size_t size = plm_index_ball(taken->index, xyz[0], 10, count, row, squared);
    free(row);
    free(squared);
    return size;
}

static void a_share_is_taken_whatever_the_order(void **unused)
{
    (void)unused;
    float(*xyz)[3] = make_points(), (*turned)[3] = malloc(COUNT * sizeof *turned);
    assert_non_null(turned);
    for (int i = 0; i < COUNT; i++) memcpy(turned[i], xyz[COUNT - 1 - i], sizeof *turned);
    plm_subset first = {0}, second = {0};
    plm_index *index[2] = {NULL};
    const size_t size = take((const float(*)[3])xyz, COUNT, 0.1, &first, &index[0]);
    assert_in_range(size, COUNT / 10 - 300, COUNT / 10 + 300); /* 5 SD */
    assert_int_equal(take((const float(*)[3])turned, COUNT, 0.1, &second, &index[1]), size);
    const double sum = sum_of(first.xyz, size);
    assert_true(fabs(sum - sum_of(second.xyz, size)) < 1e-9 * sum);
    assert_true(fabs(sum / (3 * (double)size) - 0.5) < 0.02);
    plm_subset_free(&first);
    plm_subset_free(&second);
    for (int i = 0; i < 2; i++) plm_index_free(index[i]);
    free(xyz);
    free(turned);
}

/* Points with low hashes are what a thinned cloud consists of: chosen by the same hash again, all of them would be taken. */
static void what_was_thinned_is_thinned_again(void **unused)
{
    (void)unused;
    float(*xyz)[3] = make_points();
    uint32_t *row = malloc(COUNT * sizeof *row);
    assert_non_null(row);
    const size_t size = plm_sample_rows((const float(*)[3])xyz, COUNT, COUNT / 10, row);
    for (size_t i = 0; i < size; i++) memcpy(xyz[i], xyz[row[i]], sizeof *xyz);
    plm_subset taken = {0};
    plm_index *index = NULL;
    const size_t few = take((const float(*)[3])xyz, size, 0.1, &taken, &index);
    assert_in_range(few, size / 10 - 100, size / 10 + 100);
    plm_subset_free(&taken);
    plm_index_free(index);
    free(xyz);
    free(row);
}

static void most_or_none_of_the_points_are_all_of_them(void **unused)
{
    (void)unused;
    float(*xyz)[3] = make_points();
    plm_subset taken = {0};
    plm_index *index = NULL;
    assert_int_equal(take((const float(*)[3])xyz, COUNT, 0.9, &taken, &index), COUNT);
    assert_ptr_equal(taken.index, index);
    plm_subset_free(&taken);
    plm_index_free(index);
    plm_error error = {0};
    assert_ok(plm_subset_take(NULL, NULL, 0, 0.1, &taken, &error));
    assert_null(taken.few);
    plm_subset_free(&taken);
    free(xyz);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_share_is_taken_whatever_the_order),
        cmocka_unit_test(what_was_thinned_is_thinned_again),
        cmocka_unit_test(most_or_none_of_the_points_are_all_of_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
