/* tests/traits/test_hull_corners.c: what the hull of points on a surface lacks of the surface's own. */
#include "support/test.h"

#include "cloud/linear.h"
#include "mesh/mesh.h"
#include "traits/hull_corners.h"

#include <math.h>
#include <stdlib.h>

enum { TRIALS = 24, POINTS = 4000 };

/** Puts a point on a surface. */
typedef void (*surface)(uint64_t *seed, float point[3]);

static void on_ball(uint64_t *seed, float point[3])
{
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = test_normal(seed);
    plm_normalise(p);
    for (int k = 0; k < 3; k++) point[k] = (float)(0.05 * p[k]);
}

/* Two leaves, crossed: ellipses with axes of 0.2 x 0.08 m on their tips. */
static void on_leaves(uint64_t *seed, float point[3])
{
    double x, z;
    do x = 2 * test_uniform(seed) - 1, z = 2 * test_uniform(seed) - 1;
    while (x * x + z * z > 1);
    const bool other = test_uniform(seed) < 0.5;
    point[0] = (float)(other ? 0 : 0.04 * x);
    point[1] = (float)(other ? 0.04 * x : 0);
    point[2] = (float)(0.1 * z);
}

/* Errors of the hull's volume over many samples: as it is, and with what its corners lack. */
static void check_volumes(surface put, double volume, double most_mean, double gain)
{
    static float xyz[POINTS][3];
    uint64_t seed = 2;
    double mean = 0, squares = 0, raw = 0, sure = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        plm_error error = {0};
        plm_mesh hull;
        plm_index *index;
        double found, area, lacking, std_error;
        for (int i = 0; i < POINTS; i++) put(&seed, xyz[i]);
        assert_ok(plm_convex_hull((const float(*)[3])xyz, POINTS, &found, &area, &hull, &error));
        assert_ok(plm_index_build((const float(*)[3])xyz, POINTS, &index, &error));
        assert_ok(plm_hull_corners(&hull, index, (const float(*)[3])xyz, &lacking, &std_error, &error));
        raw += pow(found / volume - 1, 2) / TRIALS;
        const double off = (found + lacking) / volume - 1;
        mean += off / TRIALS, squares += off * off / TRIALS;
        sure += pow(off * volume / std_error, 2) / TRIALS;
        plm_mesh_free(&hull);
        plm_index_free(index);
    }
    print_message("%.3f %% too large, RMS %.3f (%.3f as it is), %.2f standard errors\n", 100 * mean,
                  100 * sqrt(squares), 100 * sqrt(raw), sqrt(sure));
    assert_near(mean, 0, most_mean);
    assert_true(sqrt(squares) < gain * sqrt(raw));
    assert_true(sqrt(sure) < 2);
}

static void a_ball_is_rounder_than_its_points(void **unused)
{
    (void)unused;
    check_volumes(on_ball, 4 * PLM_PI / 3 * pow(0.05, 3), 0.001, 0.5);
}

/* Each height's section is the square between the leaves. */
static void rims_go_on_behind_their_points(void **unused)
{
    (void)unused;
    check_volumes(on_leaves, 8.0 / 3 * 0.04 * 0.04 * 0.1, 0.006, 0.25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_is_rounder_than_its_points),
        cmocka_unit_test(rims_go_on_behind_their_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
