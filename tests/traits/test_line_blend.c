/* The mean of the line through a tube's points and of a fitted tube's axis. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/line_blend.h"

#include <string.h>

enum { POINTS = 160, TRIALS = 100 };

static const double LENGTH = 0.025, RADIUS = 0.0009, SAG = 0.0012, NOISE = 0.00033;

/* An arched petiole of 25 mm that is seen from above: of the side turned away, fewer points towards its end. */
static void make(uint64_t seed, double (*xyz)[3])
{
    uint64_t state = seed;
    for (size_t i = 0; i < POINTS;) {
        const double t = test_uniform(&state), turn = 2 * PLM_PI * test_uniform(&state);
        if (sin(turn) < -0.2 && test_uniform(&state) < 0.3 + 0.6 * t) continue;
        const double at[3] = {LENGTH * t, RADIUS * cos(turn), 4 * SAG * t * (1 - t) + RADIUS * sin(turn)};
        for (int k = 0; k < 3; k++) xyz[i][k] = at[k] + NOISE * test_normal(&state);
        i++;
    }
}

/* Slope of the chord between the ends of a line; its truth is 0. */
static double slope_of(const plm_curve *curve)
{
    double from[3], to[3];
    plm_curve_point(curve, -1, from);
    plm_curve_point(curve, 1, to);
    return (to[2] - from[2]) / (to[0] - from[0]);
}

static void fit(uint64_t seed, plm_centre_line *line, plm_tube *tube)
{
    static const double base[3] = {0}, end[3] = {0.025, 0, 0};
    double xyz[POINTS][3];
    plm_error error = {0};
    make(seed, xyz);
    assert_ok(plm_centre_line_fit((const double(*)[3])xyz, POINTS, base, end, (plm_line_shape){3, 1, 0}, line, &error));
    assert_ok(plm_tube_fit((const double(*)[3])xyz, POINTS, &line->curve, PLM_TUBE_TAPERED, tube, &error));
}

static void the_tube_tells_where_one_side_is_seen_better(void **unused)
{
    (void)unused;
    double before = 0, after = 0;
    size_t blended = 0;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        plm_centre_line line;
        plm_tube tube;
        fit(trial + 3, &line, &tube);
        const double slope = slope_of(&line.curve);
        before += slope * slope / TRIALS;
        blended += plm_line_blend(&line, &tube);
        after += slope_of(&line.curve) * slope_of(&line.curve) / TRIALS;
    }
    const double degrees = 180 / PLM_PI;
    print_message("%zu of %d: %.2f and %.2f degrees\n", blended, TRIALS, degrees * sqrt(before), degrees * sqrt(after));
    assert_true(blended > 3 * TRIALS / 4);
    assert_true(after < 0.9 * 0.9 * before);
}

static void a_tube_that_lies_elsewhere_tells_nothing(void **unused)
{
    (void)unused;
    plm_centre_line line;
    plm_tube tube;
    fit(2, &line, &tube);
    const plm_curve as_it_was = line.curve;
    for (int a = 0; a < plm_curve_basis_count(&line.curve); a++)
        tube.axis.offset[0][a] = line.curve.offset[0][a] + (a % 2 ? 1 : -1) * RADIUS;
    assert_false(plm_line_blend(&line, &tube));
    assert_memory_equal(&line.curve, &as_it_was, sizeof as_it_was);
}

static void set_covariance(plm_tube *tube, double variance)
{
    memset(tube->covariance, 0, sizeof tube->covariance);
    for (int a = 0; a < PLM_TUBE_PARAMETERS; a++) tube->covariance[a][a] = variance;
}

static void who_knows_more_weighs_more(void **unused)
{
    (void)unused;
    plm_centre_line line, sure, unsure;
    plm_tube tube;
    fit(3, &line, &tube);
    const int n = plm_curve_basis_count(&line.curve);
    sure = unsure = line;
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < n; a++) tube.axis.offset[c][a] = line.curve.offset[c][a] + 5e-5;
    set_covariance(&tube, 1e-18);
    assert_true(plm_line_blend(&sure, &tube));
    set_covariance(&tube, 1);
    assert_true(plm_line_blend(&unsure, &tube));
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < n; a++) {
            assert_near(sure.curve.offset[c][a], tube.axis.offset[c][a], 1e-9);
            assert_near(unsure.curve.offset[c][a], line.curve.offset[c][a], 1e-9);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tube_tells_where_one_side_is_seen_better),
        cmocka_unit_test(a_tube_that_lies_elsewhere_tells_nothing),
        cmocka_unit_test(who_knows_more_weighs_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
