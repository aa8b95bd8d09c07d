/* What noise scatters far off a plant is told by how thin it is there, and belongs to the nearest that stays. */
#include "support/test.h"

#include "cloud/random.h"
#include "segment/halo.h"

enum { POINTS = 20000 };
static const double SIGMA = 5e-4, HALF = 0.005;

static float xyz[POINTS][3];

/* A level sheet, blurred across by noise of a deviation. */
static void make_sheet(double sigma)
{
    const uint64_t key = plm_key(11, 0), across = plm_key(11, 1);
    for (size_t i = 0; i < POINTS; i++) {
        xyz[i][0] = (float)(HALF * (2 * plm_uniform_at(key, 2 * i) - 1));
        xyz[i][1] = (float)(HALF * (2 * plm_uniform_at(key, 2 * i + 1) - 1));
        xyz[i][2] = (float)(sigma * plm_normal_at(across, i));
    }
}

static plm_thinned thin(double cell)
{
    plm_error error = {0};
    plm_thinned base;
    assert_ok(plm_thin((const float(*)[3])xyz, POINTS, cell, &base, &error));
    return base;
}

/* Every point has a voxel, and is in that one's list alone. */
static void check_lists(const plm_thinned *base)
{
    const plm_voxels *voxels = &base->voxels;
    assert_int_equal(voxels->count, base->count);
    assert_int_equal(voxels->first[0], 0);
    assert_int_equal(voxels->first[base->count], POINTS);
    for (size_t v = 0; v < base->count; v++) {
        assert_int_equal(voxels->first[v + 1] - voxels->first[v], voxels->size[v]);
        for (uint32_t m = voxels->first[v]; m < voxels->first[v + 1]; m++) {
            assert_int_equal(voxels->owner[voxels->member[m]], v);
            if (m > voxels->first[v]) assert_true(voxels->member[m] > voxels->member[m - 1]);
        }
    }
}

/* Of the voxels between two distances from the sheet. */
static size_t count_between(const plm_thinned *base, double from, double to)
{
    size_t count = 0;
    for (size_t v = 0; v < base->count; v++) count += fabs(base->xyz[v][2]) >= from && fabs(base->xyz[v][2]) < to;
    return count;
}

static void far_scatter_goes_to_the_nearest_that_stays(void **unused)
{
    (void)unused;
    plm_error error = {0};
    make_sheet(SIGMA);
    plm_thinned base = thin(1e-4);
    const size_t near = count_between(&base, 0, 1.2 * SIGMA), far = count_between(&base, 2.4 * SIGMA, 9 * SIGMA),
                 all = base.count;
    assert_true(far > 100);
    const plm_scale scale = {.noise = SIGMA, .spacing = 2e-4, .radius = 3e-3};
    assert_true(plm_has_halo(&scale));
    assert_ok(plm_halo_drop(&base, &scale, &error));
    const size_t near_left = count_between(&base, 0, 1.2 * SIGMA),
                 far_left = count_between(&base, 2.4 * SIGMA, 9 * SIGMA);
    print_message("near %zu of %zu, far %zu of %zu, all %zu of %zu\n", near_left, near, far_left, far, base.count, all);
    assert_true(100 * near_left >= 98 * near);
    assert_true(10 * far_left <= far);
    assert_true(10 * base.count > 8 * all);
    check_lists(&base);
    /* No other voxel is nearer than its own by more than what voxels are wide. */
    for (size_t i = 0; i < POINTS; i += 97) {
        const float *own = base.xyz[base.voxels.owner[i]];
        double nearest = INFINITY;
        for (size_t v = 0; v < base.count; v++)
            nearest = fmin(nearest, hypot(hypot(base.xyz[v][0] - xyz[i][0], base.xyz[v][1] - xyz[i][1]),
                                          base.xyz[v][2] - xyz[i][2]));
        assert_true(hypot(hypot(own[0] - xyz[i][0], own[1] - xyz[i][1]), own[2] - xyz[i][2]) <= nearest + 3.5e-4);
    }
    plm_thinned_free(&base);
}

/* What counts is how many points the voxels stand for: the same sheet in coarse voxels. */
static void voxels_weigh_as_their_points(void **unused)
{
    (void)unused;
    plm_error error = {0};
    make_sheet(SIGMA);
    plm_thinned base = thin(4e-4);
    const size_t far = count_between(&base, 2.4 * SIGMA, 9 * SIGMA);
    assert_true(far > 100);
    assert_ok(plm_halo_drop(&base, &(plm_scale){.noise = SIGMA, .spacing = 3e-4, .radius = 3e-3}, &error));
    const size_t left = count_between(&base, 2.4 * SIGMA, 9 * SIGMA);
    print_message("far %zu of %zu\n", left, far);
    assert_true(4 * left <= far);
    check_lists(&base);
    plm_thinned_free(&base);
}

static void an_even_sheet_stays(void **unused)
{
    (void)unused;
    plm_error error = {0};
    make_sheet(0);
    plm_thinned base = thin(1e-5);
    const size_t all = base.count;
    assert_ok(plm_halo_drop(&base, &(plm_scale){.noise = SIGMA, .spacing = 2e-4, .radius = 3e-3}, &error));
    assert_true(1000 * base.count >= 999 * all);
    check_lists(&base);
    plm_thinned_free(&base);
}

static void all_stay_where_none_is_to(void **unused)
{
    (void)unused;
    plm_error error = {0};
    make_sheet(SIGMA);
    plm_thinned base = thin(1e-3);
    const size_t all = base.count;
    bool *keep = calloc(all, sizeof *keep);
    assert_non_null(keep);
    assert_ok(plm_thinned_keep(&base, keep, &error));
    assert_int_equal(base.count, all);
    keep[all / 2] = true;
    assert_ok(plm_thinned_keep(&base, keep, &error));
    assert_int_equal(base.count, 1);
    check_lists(&base);
    free(keep);
    plm_thinned_free(&base);
}

/* Few voxels, and balls that hold much of the plant: a point off it stays, and else goes. */
static void what_has_no_profile_stays(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const plm_scale scale = {.noise = 2e-3, .spacing = 2e-4, .radius = 6e-3};
    const double cell[] = {3e-3, 4e-4, 5e-5};
    for (int k = 0; k < 3; k++) {
        make_sheet(0);
        xyz[0][0] = xyz[0][1] = 0, xyz[0][2] = 3.5e-3f;
        plm_thinned base = thin(cell[k]);
        const size_t all = base.count;
        print_message("%zu voxels\n", all);
        assert_ok(plm_halo_drop(&base, &scale, &error));
        assert_int_equal(base.count, k == 1 ? all - 1 : all);
        check_lists(&base);
        plm_thinned_free(&base);
    }
}

/* A layer of voxels of many points between two of few: those are half of the voxels, or fewer by one. */
static void half_of_the_voxels_is_no_halo(void **unused)
{
    (void)unused;
    plm_error error = {0};
    enum { SIDE = 20, LAYERS = 4, DENSE = 23, SPARSE = 2 };
    const double cell = 5e-4;
    for (int fewer = 0; fewer < 2; fewer++) {
        size_t count = 0;
        for (int v = 0; v < SIDE * SIDE * LAYERS; v++) {
            const int layer = v / (SIDE * SIDE), place = v % (SIDE * SIDE);
            const bool sparse = layer == 0 || layer == LAYERS - 1;
            for (int k = 0; k < (sparse ? SPARSE : DENSE); k++, count++) {
                xyz[count][0] = (float)(cell * (place % SIDE + 0.5));
                xyz[count][1] = (float)(cell * (place / SIDE + 0.5));
                xyz[count][2] = (float)(cell * ((v == 0 && fewer ? 1 : layer) + 0.5));
            }
        }
        assert_int_equal(count, POINTS);
        plm_thinned base = thin(cell);
        assert_int_equal(base.count, SIDE * SIDE * LAYERS - fewer);
        assert_ok(plm_halo_drop(&base, &(plm_scale){.noise = SIGMA, .spacing = 2e-4, .radius = 3e-3}, &error));
        assert_int_equal(base.count, fewer ? SIDE * SIDE * LAYERS / 2 : SIDE * SIDE * LAYERS);
        check_lists(&base);
        plm_thinned_free(&base);
    }
}

static void little_noise_has_no_halo(void **unused)
{
    (void)unused;
    assert_false(plm_has_halo(&(plm_scale){.noise = SIGMA, .spacing = 2e-4, .radius = 5e-3}));
    assert_false(plm_has_halo(&(plm_scale){0}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(far_scatter_goes_to_the_nearest_that_stays),
        cmocka_unit_test(voxels_weigh_as_their_points),
        cmocka_unit_test(an_even_sheet_stays),
        cmocka_unit_test(all_stay_where_none_is_to),
        cmocka_unit_test(what_has_no_profile_stays),
        cmocka_unit_test(half_of_the_voxels_is_no_halo),
        cmocka_unit_test(little_noise_has_no_halo),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
