/* The grid behind voxel means: its pitch, how many pixels its voxels had, and clouds that have none. */
#include "support/test.h"

#include "cloud/linear.h"
#include "cloud/voxel.h"
#include "cloud/voxel_pitch.h"

static const double side = 0.1, cell = 0.9e-3, noise = 0.4e-3;

/* Points of a rolling sheet and of a rod that stands on it, with noise in all directions. */
static float (*make_plant(size_t count, uint64_t seed))[3]
{
    float(*xyz)[3] = malloc(count * sizeof *xyz);
    assert_non_null(xyz);
    for (size_t i = 0; i < count; i++) {
        double place[3] = {side * test_uniform(&seed), side * test_uniform(&seed), 0};
        place[2] = 0.01 * sin(40 * place[0]) + 0.2 * place[1];
        if (i % 8 == 0) {
            const double turn = 2 * PLM_PI * test_uniform(&seed);
            place[0] = 0.05 + 1.5e-3 * cos(turn);
            place[2] = place[1] - 0.05;
            place[1] = 0.05 + 1.5e-3 * sin(turn);
        }
        for (int k = 0; k < 3; k++) xyz[i][k] = (float)(place[k] + noise * test_normal(&seed));
    }
    return xyz;
}

static plm_voxels fuse(const float (*xyz)[3], size_t count)
{
    plm_voxels voxels;
    plm_error error;
    assert_ok(plm_voxel_thin(xyz, count, cell, &voxels, &error));
    return voxels;
}

static double pitch_of(const float (*xyz)[3], size_t count)
{
    plm_error error;
    double pitch = -1;
    assert_ok(plm_voxel_pitch_find(xyz, count, 0.8 * cell, &pitch, &error));
    return pitch;
}

static double gathering_of(const float (*xyz)[3], size_t count)
{
    double along[3];
    plm_voxel_gathering(xyz, count, cell, along);
    for (int k = 0; k < 3; k++) assert_true(along[k] >= 0 && along[k] <= 1);
    return (along[0] + along[1]) / 2;
}

static void the_pitch_is_found_and_points_gather_the_more_the_more_pixels_there_are(void **unused)
{
    (void)unused;
    double before = 0;
    for (size_t count = 40000; count <= 640000; count *= 4) {
        float(*xyz)[3] = make_plant(count, 3);
        plm_voxels voxels = fuse((const float(*)[3])xyz, count);
        const float(*mean)[3] = (const float(*)[3])voxels.xyz;
        /* A quarter of a period over the extent: what a line of the spectrum is wide. */
        assert_near(pitch_of(mean, voxels.count), cell, 0.25 * cell * cell / side);
        const double gathering = gathering_of(mean, voxels.count);
        assert_true(gathering > before + 0.05);
        before = gathering;
        /* A part of the points is on the same grid. */
        assert_near(pitch_of(mean, voxels.count / 3), cell, cell * cell / side);
        plm_voxels_free(&voxels);
        free(xyz);
    }
    assert_true(before > 0.4 && before < 0.9);
}

/* A level sheet's place in its voxels is its own along the third axis, not the pixels' mean. */
static void a_level_sheet_shows_its_grid_along_two_axes(void **unused)
{
    (void)unused;
    enum { N = 200000 };
    uint64_t seed = 11;
    float(*xyz)[3] = malloc(N * sizeof *xyz);
    assert_non_null(xyz);
    for (size_t i = 0; i < N; i++) {
        const double x = side * test_uniform(&seed), y = side * test_uniform(&seed);
        xyz[i][0] = (float)x;
        xyz[i][1] = (float)y;
        const double bend = 0.02 * side * sin(30 * x);
        xyz[i][2] = (float)(0.1 * x + 0.06 * y + bend + 0.3 * cell * test_normal(&seed));
    }
    plm_voxels voxels = fuse((const float(*)[3])xyz, N);
    double along[3];
    plm_voxel_gathering((const float(*)[3])voxels.xyz, voxels.count, cell, along);
    assert_true(along[0] > 0.3 && along[1] > 0.3 && along[2] < 0.035);
    assert_near(pitch_of((const float(*)[3])voxels.xyz, voxels.count), cell, 0.25 * cell * cell / side);
    /* Turned by 45 degrees it has another pitch along the same two axes. */
    for (size_t i = 0; i < voxels.count; i++) {
        const double x = voxels.xyz[i][0], y = voxels.xyz[i][1];
        voxels.xyz[i][0] = (float)((x - y) * sqrt(0.5));
        voxels.xyz[i][1] = (float)((x + y) * sqrt(0.5));
    }
    assert_true(pitch_of((const float(*)[3])voxels.xyz, voxels.count) == 0);
    plm_voxels_free(&voxels);
    free(xyz);
}

/* Rows and columns of a depth camera over leaves that lie uneven show along two axes as well, but no voxel stands on another. */
static void a_single_depth_image_has_no_grid(void **unused)
{
    (void)unused;
    enum { SIDE = 100 };
    uint64_t seed = 13;
    float(*xyz)[3] = malloc(SIDE * SIDE * sizeof *xyz);
    assert_non_null(xyz);
    for (int relief = 4; relief <= 32; relief *= 2) {
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            const double u = ((double)(i % SIDE) - 49.5) * 1e-3, v = (floor((double)i / SIDE) - 49.5) * 1e-3;
            const double z = 1 + 1e-3 * relief * sin(60 * u) * cos(60 * v) + 5e-4 * test_normal(&seed);
            const double place[3] = {u * z, v * z, z};
            for (int k = 0; k < 3; k++) xyz[i][k] = (float)place[k];
        }
        assert_true(pitch_of((const float(*)[3])xyz, SIDE * SIDE) == 0);
    }
    free(xyz);
}

/* Around the line of a few small patches it is full of the fringes between them. */
static void a_line_among_fringes_is_found(void **unused)
{
    (void)unused;
    enum { N = 60000, PATCHES = 4, ROUNDS = 6 };
    uint64_t seed = 12;
    float(*xyz)[3] = malloc(N * sizeof *xyz);
    assert_non_null(xyz);
    for (int round = 0; round < ROUNDS; round++) {
        double place[PATCHES][3];
        for (int p = 0; p < PATCHES; p++)
            for (int k = 0; k < 3; k++) place[p][k] = side * test_uniform(&seed);
        for (size_t i = 0; i < N; i++)
            for (int k = 0; k < 3; k++) {
                const double along = k < 2 ? 0.006 * test_uniform(&seed) : 0;
                xyz[i][k] = (float)(place[i % PATCHES][k] + along + noise * test_normal(&seed));
            }
        plm_voxels voxels = fuse((const float(*)[3])xyz, N);
        assert_near(pitch_of((const float(*)[3])voxels.xyz, voxels.count), cell, 0.25 * cell * cell / side);
        plm_voxels_free(&voxels);
    }
    free(xyz);
}

static void a_cloud_without_a_grid_has_no_pitch(void **unused)
{
    (void)unused;
    enum { N = 60000 };
    float(*xyz)[3] = make_plant(N, 4);
    assert_true(pitch_of((const float(*)[3])xyz, N) == 0);
    assert_true(pitch_of((const float(*)[3])xyz, 100) == 0); /* too few to tell */
    assert_true(pitch_of((const float(*)[3])xyz, 0) == 0);
    /* All points of a rod alone: their spectrum is broad along two axes. */
    size_t rod = 0;
    for (size_t i = 0; i < N; i += 8) memcpy(xyz[rod++], xyz[i], sizeof *xyz);
    assert_true(pitch_of((const float(*)[3])xyz, rod) == 0);
    /* One place. */
    for (size_t i = 1; i < N; i++) memcpy(xyz[i], xyz[0], sizeof *xyz);
    assert_true(pitch_of((const float(*)[3])xyz, N) == 0);
    free(xyz);
}

static void a_grid_along_other_axes_is_not_taken_for_one(void **unused)
{
    (void)unused;
    enum { N = 240000 };
    float(*xyz)[3] = make_plant(N, 5);
    plm_voxels voxels = fuse((const float(*)[3])xyz, N);
    assert_true(pitch_of((const float(*)[3])voxels.xyz, voxels.count) > 0);
    /* About one axis a grid along that axis is left, and by 45 degrees one of another pitch along the other two. */
    float(*turned)[3] = malloc(voxels.count * sizeof *turned);
    assert_non_null(turned);
    for (int degrees = 15; degrees <= 75; degrees += 15) {
        const double c = cos(plm_radians(degrees)), s = sin(plm_radians(degrees));
        for (size_t i = 0; i < voxels.count; i++) {
            const double x = voxels.xyz[i][0], y = voxels.xyz[i][1];
            turned[i][0] = (float)(c * x - s * y);
            turned[i][1] = (float)(s * x + c * y);
            turned[i][2] = voxels.xyz[i][2];
        }
        assert_true(pitch_of((const float(*)[3])turned, voxels.count) == 0);
    }
    free(turned);
    for (size_t i = 0; i < voxels.count; i++) { /* turned by some 30 degrees about all axes */
        const double x = voxels.xyz[i][0], y = voxels.xyz[i][1], z = voxels.xyz[i][2];
        const double a = 0.8 * x - 0.6 * y, b = 0.6 * x + 0.8 * y;
        voxels.xyz[i][0] = (float)a;
        voxels.xyz[i][1] = (float)(0.8 * b - 0.6 * z);
        voxels.xyz[i][2] = (float)(0.6 * b + 0.8 * z);
    }
    assert_true(pitch_of((const float(*)[3])voxels.xyz, voxels.count) == 0);
    plm_voxels_free(&voxels);
    free(xyz);
}

/* Without the correction for chance 30 points gather by 0.16. */
static void few_points_without_a_grid_gather_little(void **unused)
{
    (void)unused;
    enum { POINTS = 30, ROUNDS = 400 };
    uint64_t seed = 8;
    float xyz[POINTS][3];
    double sum = 0, along[3];
    for (int round = 0; round < ROUNDS; round++) {
        for (int i = 0; i < POINTS; i++)
            for (int k = 0; k < 3; k++) xyz[i][k] = (float)(side * test_uniform(&seed));
        plm_voxel_gathering((const float(*)[3])xyz, POINTS, cell, along);
        for (int k = 0; k < 3; k++) sum += along[k] * along[k] / (3 * ROUNDS);
    }
    assert_true(sum < 0.018); /* of squares: 1 / 30 with chance, a part of that without, as none is below zero */
    plm_voxel_gathering((const float(*)[3])xyz, 1, cell, along);
    assert_true(along[0] == 0 && along[1] == 0 && along[2] == 0);
}

/* Rounded coordinates and centres of voxels gather fully, and say nothing about pixels. */
static void coordinates_on_a_grid_are_no_voxel_means(void **unused)
{
    (void)unused;
    enum { N = 60000 };
    float(*xyz)[3] = make_plant(N, 6);
    for (size_t i = 0; i < N; i++)
        for (int k = 0; k < 3; k++) xyz[i][k] = (float)(cell * (floor((double)xyz[i][k] / cell) + 0.5));
    assert_true(pitch_of((const float(*)[3])xyz, N) == 0);
    free(xyz);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pitch_is_found_and_points_gather_the_more_the_more_pixels_there_are),
        cmocka_unit_test(a_level_sheet_shows_its_grid_along_two_axes),
        cmocka_unit_test(a_single_depth_image_has_no_grid),
        cmocka_unit_test(a_line_among_fringes_is_found),
        cmocka_unit_test(a_cloud_without_a_grid_has_no_pitch),
        cmocka_unit_test(a_grid_along_other_axes_is_not_taken_for_one),
        cmocka_unit_test(few_points_without_a_grid_gather_little),
        cmocka_unit_test(coordinates_on_a_grid_are_no_voxel_means),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
