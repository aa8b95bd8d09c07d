/* What a cloud's sampling is like: spacing, noise and voxel means on sheets where all three are known. */
#include "support/test.h"

#include "cloud/linear.h"
#include "cloud/sampling.h"

/* A curved sheet of count points over a square of the given side, density falling by gradient along x, with noise of
 * the given SD in all directions. */
static float (*make_sheet(size_t count, double side, double gradient, double noise, uint64_t seed))[3]
{
    float(*xyz)[3] = malloc(count * sizeof *xyz);
    assert_non_null(xyz);
    for (size_t i = 0; i < count;) {
        const double x = test_uniform(&seed), y = test_uniform(&seed);
        if (test_uniform(&seed) > 1 / (1 + (gradient - 1) * x)) continue;
        const double z = 0.1 * x * x - 0.1 * x * y + 0.05 * sin(3 * y);
        xyz[i][0] = (float)(side * x + noise * test_normal(&seed));
        xyz[i][1] = (float)(side * y + noise * test_normal(&seed));
        xyz[i][2] = (float)(side * z + noise * test_normal(&seed));
        i++;
    }
    return xyz;
}

static plm_sampling measure(float (*points)[3], size_t count)
{
    const float(*xyz)[3] = (const float(*)[3])points;
    plm_error error;
    plm_index *index = NULL;
    plm_sampling sampling;
    assert_ok(plm_index_build(xyz, count, &index, &error));
    assert_ok(plm_sampling_measure(index, xyz, count, NULL, &sampling, &error));
    plm_index_free(index);
    return sampling;
}

/* Keeps one mean point a cube of the given side; gives how many there are. Quadratic in nothing: cells are sorted. */
typedef struct voxel {
    int64_t key;
    float point[3];
} voxel;

static int compare_voxels(const void *a, const void *b)
{
    const voxel *x = a, *y = b;
    return (x->key > y->key) - (x->key < y->key);
}

static size_t fuse(float (*xyz)[3], size_t count, double side)
{
    voxel *cell = malloc(count * sizeof *cell);
    assert_non_null(cell);
    for (size_t i = 0; i < count; i++) {
        cell[i].key = 0;
        for (int axis = 0; axis < 3; axis++)
            cell[i].key = cell[i].key * 100000 + (int64_t)floor(xyz[i][axis] / side) + 50000;
        memcpy(cell[i].point, xyz[i], sizeof cell[i].point);
    }
    qsort(cell, count, sizeof *cell, compare_voxels);
    size_t kept = 0;
    for (size_t i = 0; i < count;) {
        size_t end = i;
        double sum[3] = {0, 0, 0};
        for (; end < count && cell[end].key == cell[i].key; end++)
            for (int axis = 0; axis < 3; axis++) sum[axis] += cell[end].point[axis];
        for (int axis = 0; axis < 3; axis++) xyz[kept][axis] = (float)(sum[axis] / (double)(end - i));
        kept++;
        i = end;
    }
    free(cell);
    return kept;
}

static void spacing_and_noise_are_those_of_the_sheet(void **unused)
{
    (void)unused;
    const double side = 0.1;
    const size_t count = 20000;
    const double s = side / sqrt((double)count); /* of the projection; the slopes add 1 % */
    for (int i = 0; i <= 2; i++) {
        const double noise = 0.25 * i * s;
        float(*xyz)[3] = make_sheet(count, side, 1, noise, 11);
        const plm_sampling found = measure(xyz, count);
        assert_near(found.spacing / s, 1, 0.10); /* noise pushes neighbours off the plane of eight */
        assert_near(found.noise, noise, 0.06 * noise + 0.002 * s);
        assert_false(found.fused);
        free(xyz);
    }
}

static void quantiles_of_the_spacing_follow_a_tenfold_gradient(void **unused)
{
    (void)unused;
    enum { N = 60000 };
    plm_error error;
    float(*xyz)[3] = make_sheet(N, 0.1, 10, 0, 5);
    plm_index *index = NULL;
    assert_ok(plm_index_build((const float(*)[3])xyz, N, &index, &error));
    double low, high, again;
    assert_ok(plm_spacing_quantile(index, (const float(*)[3])xyz, N, 0.1, &low, &error));
    assert_ok(plm_spacing_quantile(index, (const float(*)[3])xyz, N, 0.9, &high, &error));
    /* Density at x (of 1) is 1 / (1 + 9 x): a share of points lies below x where log(1 + 9 x) is that share of log 10. The
     * rim reads high, and 9 neighbours scatter. */
    assert_near(high / low, sqrt(pow(10, 0.9) / pow(10, 0.1)), 0.25);
    assert_ok(plm_spacing_quantile(index, (const float(*)[3])xyz, N, 1, &again, &error));
    assert_true(again > high);
    assert_int_equal(plm_spacing_quantile(index, (const float(*)[3])xyz, 1, 0.5, &again, &error), PLM_E_DEGENERATE);
    plm_index_free(index);
    free(xyz);
}

static void voxel_means_are_told_from_scans_and_splats(void **unused)
{
    (void)unused;
    for (int i = 0; i < 3; i++) {
        const double noise = 0.00025 * i;
        size_t count = 40000;
        float(*xyz)[3] = make_sheet(count, 0.1, 1, noise, 7);
        assert_false(measure(xyz, count).fused);
        count = fuse(xyz, count, 0.0012);
        assert_true(count < 20000);
        assert_true(measure(xyz, count).fused);
        free(xyz);
    }
}

static void the_order_of_rows_does_not_matter(void **unused)
{
    (void)unused;
    const size_t count = 30000; /* more than the sample */
    float(*xyz)[3] = make_sheet(count, 0.1, 4, 0.0003, 9);
    const plm_sampling first = measure(xyz, count);
    for (size_t i = 0; i < count / 2; i++)
        for (int axis = 0; axis < 3; axis++) {
            const float other = xyz[i][axis];
            xyz[i][axis] = xyz[count - 1 - i][axis];
            xyz[count - 1 - i][axis] = other;
        }
    const plm_sampling second = measure(xyz, count);
    assert_near(second.spacing, first.spacing, 1e-6 * first.spacing);
    assert_near(second.noise, first.noise, 1e-6 * first.noise);
    free(xyz);
}

static void odd_input_gives_a_status_or_zero_but_no_nan(void **unused)
{
    (void)unused;
    plm_error error;
    float same[40][3] = {{0}}, line[40][3] = {{0}};
    for (int i = 0; i < 40; i++) line[i][0] = (float)i;
    float(*clouds[])[3] = {same, line};
    for (size_t c = 0; c < COUNT(clouds); c++) {
        const plm_sampling found = measure(clouds[c], 40);
        assert_true(isfinite(found.spacing) && isfinite(found.noise));
        assert_near(found.noise, 0, 1e-6);
    }
    plm_index *index = NULL;
    plm_sampling sampling;
    assert_ok(plm_index_build((const float(*)[3])line, 11, &index, &error));
    assert_int_equal(plm_sampling_measure(index, (const float(*)[3])line, 11, NULL, &sampling, &error),
                     PLM_E_DEGENERATE);
    plm_index_free(index);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spacing_and_noise_are_those_of_the_sheet),
        cmocka_unit_test(quantiles_of_the_spacing_follow_a_tenfold_gradient),
        cmocka_unit_test(voxel_means_are_told_from_scans_and_splats),
        cmocka_unit_test(the_order_of_rows_does_not_matter),
        cmocka_unit_test(odd_input_gives_a_status_or_zero_but_no_nan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
