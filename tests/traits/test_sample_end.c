/* tests/traits/test_sample_end.c: where a surface ends behind its outermost points. */
#include "support/test.h"

#include "traits/sample_end.h"

#include <math.h>
#include <stdlib.h>

enum { POINTS = 4000, TRIALS = 300 };

static uint64_t state;

static double uniform(void)
{
    state += 0x9e3779b97f4a7c15u;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return ((double)((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
}

static double normal(void)
{
    const double radius = sqrt(-2 * log(uniform()));
    return radius * cos(2 * 3.14159265358979323846 * uniform());
}

/* Ends of samples whose density grows as a power of the depth below 0: bias of the ends, in root mean square errors, and
 * the share of 95 % intervals that hold 0. rims: what a third of the points have of the spread of the others. */
static void try_power(double power, double spread, double rims, double *bias, double *cover)
{
    plm_height *height = malloc(POINTS * sizeof *height);
    double sum = 0, squares = 0, end, error, depth;
    int held = 0;
    assert_non_null(height);
    for (int trial = 0; trial < TRIALS; trial++) {
        for (int i = 0; i < POINTS; i++) {
            const double own = i % 3 ? spread : rims * spread;
            height[i] = (plm_height){-pow(uniform(), 1 / power) + own * normal(), own, 0};
        }
        plm_end_of_sample(height, POINTS, &end, &error, &depth);
        sum += end;
        squares += end * end;
        held += fabs(end) <= 1.96 * error;
    }
    free(height);
    *bias = sum / TRIALS / sqrt(squares / TRIALS);
    *cover = (double)held / TRIALS;
}

/* 300 trials know a coverage of 0.95 to 0.013; the prior favours no power: edges are covered too often, tips too seldom, and all together as they should be. */
static void an_interval_holds_the_end_of_edges_rims_and_tips(void **unused)
{
    (void)unused;
    static const double power[] = {1.0, 1.5, 2.0, 2.5};
    double mean = 0;
    for (size_t p = 0; p < COUNT(power); p++) {
        double bias, cover;
        state = 7 + p;
        try_power(power[p], 0, 1, &bias, &cover);
        assert_true(fabs(bias) < 0.8);
        assert_true(cover > 0.82);
        mean += cover / COUNT(power);
    }
    assert_true(mean > 0.92 && mean < 0.985);
}

static void noise_in_the_heights_does_not_move_the_end(void **unused)
{
    (void)unused;
    static const double power[] = {1.0, 1.5, 2.0};
    for (size_t p = 0; p < COUNT(power); p++) {
        double bias, cover;
        state = 70 + p;
        try_power(power[p], 0.01, 1, &bias, &cover);
        assert_true(fabs(bias) < 0.9);
        assert_true(cover > 0.85);
    }
}

/* Heights at a rim keep more noise than those within a leaf. */
static void each_height_has_its_own_noise(void **unused)
{
    (void)unused;
    static const double power[] = {1.0, 1.5, 2.0};
    for (size_t p = 0; p < COUNT(power); p++) {
        double bias, cover;
        state = 170 + p;
        try_power(power[p], 0.01, 4, &bias, &cover);
        assert_true(fabs(bias) < 0.9);
        assert_true(cover > 0.85);
    }
}

/* A cut end is blurred by a quarter to the whole of the noise. Of the whole of it the heights within 3 SD tell too little to set it
 * apart from a tip with less: it comes out too far (further down they stand for other parts of a plant). */
static void the_part_of_the_noise_that_blurs_an_end_is_found(void **unused)
{
    (void)unused;
    static const double part[] = {0.25, 0.5, 1}, within[] = {0.1, 0.2, 1};
    enum { DENSE = 3000 }; /* over 20 SD of the noise */
    plm_height *height = malloc(DENSE * sizeof *height);
    assert_non_null(height);
    for (size_t p = 0; p < COUNT(part); p++) {
        double mean = 0, end, error, depth;
        state = 270 + p;
        for (int trial = 0; trial < TRIALS / 6; trial++) {
            for (int i = 0; i < DENSE; i++) height[i] = (plm_height){-20 * uniform() + part[p] * normal(), 0, 1};
            plm_end_of_sample(height, DENSE, &end, &error, &depth);
            mean += end * 6 / TRIALS;
        }
        print_message("part %.2f: %.3f\n", part[p], mean);
        assert_true(fabs(mean) < within[p]);
    }
    free(height);
}

static void heights_that_are_all_alike_have_their_end_there(void **unused)
{
    (void)unused;
    plm_height height[5] = {{2, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 0, 0}}, noisy = {2, 0.5, 0};
    double end, error, depth;
    assert_int_equal(plm_end_of_sample(height, 5, &end, &error, &depth), 5);
    assert_true(end == 2 && error == 0 && depth == 0);
    assert_int_equal(plm_end_of_sample(&noisy, 1, &end, &error, &depth), 1);
    assert_true(end == 2 && error == 0.5);
}

static void the_order_of_the_heights_leaves_no_trace(void **unused)
{
    (void)unused;
    plm_height one[200], other[200];
    double end[2], error[2], depth;
    state = 5;
    for (int i = 0; i < 200; i++) one[i] = other[199 - i] = (plm_height){-uniform(), 0.001, 0};
    plm_end_of_sample(one, 200, &end[0], &error[0], &depth);
    plm_end_of_sample(other, 200, &end[1], &error[1], &depth);
    assert_true(end[0] == end[1] && error[0] == error[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_interval_holds_the_end_of_edges_rims_and_tips),
        cmocka_unit_test(noise_in_the_heights_does_not_move_the_end),
        cmocka_unit_test(each_height_has_its_own_noise),
        cmocka_unit_test(the_part_of_the_noise_that_blurs_an_end_is_found),
        cmocka_unit_test(heights_that_are_all_alike_have_their_end_there),
        cmocka_unit_test(the_order_of_the_heights_leaves_no_trace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
