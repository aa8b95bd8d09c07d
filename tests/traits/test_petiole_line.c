/* The line of a petiole whose tube noise hides: as stiff as what is known of petioles. */
#include "support/test.h"

#include "cloud/linear.h"
#include "support/tubes.h"
#include "traits/axis.h"

#include <math.h>
#include <string.h>

enum { POINTS = 250, CROWD = 45, STEM = 2000, STRIP = 60, TRIALS = 40 };

static const double LENGTH = 0.03, RADIUS = 0.0007, NOISE = 0.0005;

/* Degrees between the fitted chord and the direction from base to end; the points are a petiole without stem. */
static double fitted_off(double (*xyz)[3], size_t count, plm_habit habit, const double base[3], const double end[3])
{
    static float near[POINTS + CROWD][3];
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) near[i][k] = (float)xyz[i][k];
    plm_error error = {0};
    plm_cloud cloud = {.count = count};
    plm_organ organ = {.label = PLM_LABEL_PETIOLE, .count = count, .xyz = near};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) organ.centroid[k] += xyz[i][k] / (double)count;
    const plm_scene scene = {.cloud = &cloud, .habit = habit, .organ = &organ, .organ_count = 1};
    plm_axis axis;
    assert_ok(plm_petiole_axis_fit(&scene, &organ, &axis, &error));
    double chord[3], cross[3];
    for (int k = 0; k < 3; k++) chord[k] = end[k] - base[k];
    plm_normalise(chord);
    plm_cross(chord, axis.direction, cross);
    return plm_degrees(atan2(plm_norm(cross), plm_dot(chord, axis.direction)));
}

static double root_mean_square(double squares)
{
    return sqrt(squares / TRIALS);
}

/* A spline through a noisy arch swings at its ends, by which the direction goes: 0.98 degrees with it, 0.65 with a parabola, 0.71 where
 * its skewness has a prior. */
static void the_line_of_a_noisy_arch_is_steady_at_its_ends(void **unused)
{
    (void)unused;
    double squares = 0;
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        static double xyz[POINTS][3];
        uint64_t state = trial;
        const test_tube tube = {.end = {0.6 * LENGTH, 0, 0.8 * LENGTH},
                                .bow = 0.05 * LENGTH,
                                .radius = {RADIUS, RADIUS},
                                .arc = {0, 2 * PLM_PI},
                                .noise = NOISE};
        test_tube_points(&tube, POINTS, &state, xyz);
        const double off = fitted_off(xyz, POINTS, PLM_HABIT_SIMPLE, tube.base, tube.end);
        squares += off * off;
    }
    print_message("%.2f degrees\n", root_mean_square(squares));
    assert_true(root_mean_square(squares) < 0.8);
}

/* Petioles that droop under their blade bend most near it: 2.7 degrees with a parabola. */
static void a_petiole_may_bend_most_near_its_blade(void **unused)
{
    (void)unused;
    double squares = 0;
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        static double xyz[POINTS][3];
        uint64_t state = trial;
        const test_tube tube = {
            .end = {0.6 * LENGTH, 0, 0.8 * LENGTH}, .radius = {RADIUS, RADIUS}, .arc = {0, 2 * PLM_PI}, .noise = NOISE};
        test_tube_points(&tube, POINTS, &state, xyz);
        for (size_t i = 0; i < POINTS; i++) {
            const double t = (0.6 * xyz[i][0] + 0.8 * xyz[i][2]) / LENGTH,
                         up = 0.08 * LENGTH * 27 / 4 * t * t * (1 - t);
            xyz[i][0] -= 0.8 * up, xyz[i][2] += 0.6 * up;
        }
        const double off = fitted_off(xyz, POINTS, PLM_HABIT_SIMPLE, tube.base, tube.end);
        squares += off * off;
    }
    print_message("%.2f degrees\n", root_mean_square(squares));
    assert_true(root_mean_square(squares) < 1.6);
}

/* Two thirds of it straight, the rest bent off by 70 degrees: 2.5 degrees with a spline, 4.2 with a parabola, 3.9 where the prior of
 * the skewness is normal, 2.4 with long tails. */
static void a_hooked_petiole_is_no_parabola(void **unused)
{
    (void)unused;
    double squares = 0;
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        static double xyz[POINTS][3];
        uint64_t state = trial;
        const double bent = plm_radians(70), end[3] = {LENGTH * sin(bent) / 3, 0, LENGTH * (2 + cos(bent)) / 3};
        const test_tube shaft = {
            .end = {0, 0, 2 * LENGTH / 3}, .radius = {RADIUS, RADIUS}, .arc = {0, 2 * PLM_PI}, .noise = NOISE};
        test_tube hook = shaft;
        for (int k = 0; k < 3; k++) hook.base[k] = shaft.end[k], hook.end[k] = end[k];
        test_tube_points(&shaft, 2 * POINTS / 3, &state, xyz);
        test_tube_points(&hook, POINTS - 2 * POINTS / 3, &state, xyz + 2 * POINTS / 3);
        const double off = fitted_off(xyz, POINTS, PLM_HABIT_SIMPLE, shaft.base, end);
        squares += off * off;
    }
    print_message("%.2f degrees\n", root_mean_square(squares));
    assert_true(root_mean_square(squares) < 3);
}

/* The first 2 mm of a rosette's lowest petioles lie under the feet of the others, and have points of those: 4.2
 * degrees with a spline through all, 3.2 with a straight line through what is clear of them. */
static void what_lies_on_the_feet_does_not_lift_them(void **unused)
{
    (void)unused;
    double squares = 0;
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        static double xyz[POINTS + CROWD][3];
        uint64_t state = trial;
        const test_tube petiole = {.end = {LENGTH / 3, 0, 0.25 * LENGTH / 3},
                                   .radius = {RADIUS, RADIUS},
                                   .arc = {0, 2 * PLM_PI},
                                   .noise = NOISE};
        const test_tube above = {.base = {0.0002, 0, 0.0005},
                                 .end = {0.0012, 0, 0.0025},
                                 .radius = {RADIUS, RADIUS},
                                 .arc = {0, 2 * PLM_PI},
                                 .noise = NOISE};
        test_tube_points(&petiole, POINTS, &state, xyz);
        test_tube_points(&above, CROWD, &state, xyz + POINTS);
        const double off = fitted_off(xyz, POINTS + CROWD, PLM_HABIT_ROSETTE, petiole.base, petiole.end);
        squares += off * off;
    }
    print_message("%.2f degrees\n", root_mean_square(squares));
    assert_true(root_mean_square(squares) < 3.6);
}

/* An arch whose foot flares, sharply seen, its upper side from later on: 0.59 degrees where the flare is not told. */
static void a_flared_foot_leaves_the_line_where_it_is(void **unused)
{
    (void)unused;
    double squares = 0;
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        static double xyz[POINTS][3];
        uint64_t state = trial;
        const test_tube tube = {.end = {0.6 * LENGTH, 0, 0.8 * LENGTH},
                                .bow = 0.08 * LENGTH,
                                .radius = {1.1 * RADIUS, 0.9 * RADIUS},
                                .flare = 0.7 * RADIUS,
                                .flare_length = 4 * RADIUS,
                                .arc = {0, 2 * PLM_PI},
                                .noise = 0.01 * RADIUS};
        test_tube_points(&tube, POINTS, &state, xyz);
        size_t count = 0;
        for (size_t i = 0; i < POINTS; i++)
            if (xyz[i][2] < xyz[i][0] * 4 / 3 + RADIUS || xyz[i][0] > 2 * RADIUS)
                memmove(xyz[count++], xyz[i], sizeof *xyz);
        const double off = fitted_off(xyz, count, PLM_HABIT_SIMPLE, tube.base, tube.end);
        squares += off * off;
    }
    print_message("%.2f degrees\n", root_mean_square(squares));
    assert_true(root_mean_square(squares) < 0.2);
}

/* A petiole leaves its stem at 25 degrees, and a strip of the stem below its foot is called petiole, too: the petiole begins where it comes
 * clear of the stem. By the first of its points it was 1.4 mm too long; behind the stem its line is clear as well. */
static void a_strip_of_the_stem_is_no_foot(void **unused)
{
    (void)unused;
    const double width = 0.0012, tilt = plm_radians(25);
    double squares = 0, long_by = 0;
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        static double xyz[STEM + STRIP + POINTS][3];
        static float near[STEM + STRIP + POINTS][3];
        uint64_t state = trial;
        const test_tube stem = {.base = {0, 0, -0.04},
                                .end = {0, 0, 0.04},
                                .radius = {width, width},
                                .arc = {0, 2 * PLM_PI},
                                .noise = 0.6 * NOISE};
        const test_tube petiole = {.base = {width, 0, 0},
                                   .end = {width + LENGTH * sin(tilt), 0, LENGTH * cos(tilt)},
                                   .radius = {RADIUS, RADIUS},
                                   .arc = {0, 2 * PLM_PI},
                                   .noise = 0.6 * NOISE};
        test_tube_points(&stem, STEM, &state, xyz);
        test_tube_points(&petiole, POINTS, &state, xyz + STEM);
        size_t count = STEM;
        for (size_t i = STEM; i < STEM + POINTS; i++) /* none is seen within the stem */
            if (hypot(xyz[i][0], xyz[i][1]) > width) memmove(xyz[count++], xyz[i], sizeof *xyz);
        const size_t most = count + STRIP;
        for (size_t i = 0; i < STEM && count < most; i++)
            if (xyz[i][0] > 0.6 * width && xyz[i][2] > -0.008 && xyz[i][2] < 0)
                memcpy(xyz[count++], xyz[i], sizeof *xyz);
        for (size_t i = 0; i < count; i++)
            for (int k = 0; k < 3; k++) near[i][k] = (float)xyz[i][k];
        plm_error error = {0};
        plm_cloud cloud = {.count = count};
        plm_organ organ[2] = {{.label = PLM_LABEL_STEM, .count = STEM, .xyz = near},
                              {.label = PLM_LABEL_PETIOLE, .count = count - STEM, .xyz = near + STEM}};
        const plm_scene scene = {.cloud = &cloud, .habit = PLM_HABIT_SIMPLE, .organ = organ, .organ_count = 2};
        plm_axis up, axis;
        assert_ok(plm_stem_axis_fit(&scene, &organ[0], &up, &error));
        organ[0].axis = &up;
        assert_ok(plm_petiole_axis_fit(&scene, &organ[1], &axis, &error));
        const double off = plm_degrees(acos(axis.direction[2])) - plm_degrees(tilt);
        squares += off * off;
        long_by += (axis.length - LENGTH) / TRIALS;
    }
    print_message("%.2f degrees, %.2f mm too long\n", root_mean_square(squares), 1e3 * long_by);
    assert_true(root_mean_square(squares) < 0.6);
    assert_true(fabs(long_by) < 0.0005);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_line_of_a_noisy_arch_is_steady_at_its_ends),
        cmocka_unit_test(a_petiole_may_bend_most_near_its_blade),
        cmocka_unit_test(a_hooked_petiole_is_no_parabola),
        cmocka_unit_test(a_flared_foot_leaves_the_line_where_it_is),
        cmocka_unit_test(what_lies_on_the_feet_does_not_lift_them),
        cmocka_unit_test(a_strip_of_the_stem_is_no_foot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
