/* tests/traits/test_stem_foot.c: the base of plants that stand on a stem that is cut off. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/stem_foot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIALS = 40, MOST = 6000 };

static const double down[3] = {0, 0, -1};

/** A stem that leans by an angle towards x, whose lower rim has its lowest place at height 0. */
typedef struct stem {
    double radius, length, lean; /* radians */
    double level;                /* the rim: 0 across the stem, 1 level */
    double noise, along;         /* across the surface and along the stem */
    size_t points;
} stem;

static void put_stem(const stem *s, uint64_t *seed, float (*xyz)[3])
{
    const double axis[3] = {sin(s->lean), 0, cos(s->lean)}, side[3] = {cos(s->lean), 0, -sin(s->lean)};
    const double slope = s->level * tan(s->lean); /* of the rim along the stem, per width towards side */
    const double rise = s->radius * (side[2] + slope * axis[2]);
    for (size_t i = 0; i < s->points;) {
        const double turn = 2 * PLM_PI * test_uniform(seed), run = s->length * test_uniform(seed) - s->radius;
        const double x = s->radius * cos(turn), y = s->radius * sin(turn);
        if (run < slope * x) continue;
        const double out = 1 + s->noise * test_normal(seed) / s->radius, place = run + s->along * test_normal(seed);
        for (int k = 0; k < 3; k++) xyz[i][k] = (float)(out * x * side[k] + place * axis[k]);
        xyz[i][1] = (float)(out * y);
        xyz[i++][2] += (float)fabs(rise);
    }
}

static plm_extreme lowest(const float (*xyz)[3], size_t count)
{
    plm_extreme base;
    plm_error error = {0};
    assert_ok(plm_extreme_along(xyz, count, down, &(plm_extreme_options){.cut = true}, &base, &error));
    return base;
}

/* Mean and root mean square of how much too high the base is, by the stem's end and by heights alone. */
static void check_bases(const stem *s, double most_mean, double most_rms, double gain)
{
    float(*xyz)[3] = malloc(s->points * sizeof *xyz);
    uint64_t seed = 5;
    double mean = 0, squares = 0, seen = 0, sure = 0;
    assert_non_null(xyz);
    for (int trial = 0; trial < TRIALS; trial++) {
        plm_error error = {0};
        bool changed;
        put_stem(s, &seed, xyz);
        plm_extreme base = lowest((const float(*)[3])xyz, s->points);
        seen += pow(base.value, 2) / TRIALS;
        assert_ok(plm_stem_foot((const float(*)[3])xyz, s->points, &base, &changed, &error));
        assert_true(changed);
        mean -= base.value / TRIALS;
        squares += pow(base.value, 2) / TRIALS;
        sure += pow(base.value / base.std_error, 2) / TRIALS;
    }
    free(xyz);
    print_message("%.3f mm too high, RMS %.3f (%.3f by heights), %.2f standard errors\n", 1e3 * mean,
                  1e3 * sqrt(squares), 1e3 * sqrt(seen), sqrt(sure));
    assert_near(mean, 0, most_mean);
    assert_true(sqrt(squares) < most_rms);
    assert_true(sqrt(squares) < gain * sqrt(seen));
    assert_true(sqrt(sure) < 1.5);
}

/* By heights alone the rim of a leaning stem looks like an end that narrows: RMS 0.135 mm here. */
static void a_leaning_stem_ends_at_its_rim(void **unused)
{
    (void)unused;
    check_bases(&(stem){.radius = 1.5e-3, .length = 0.05, .lean = 0.17, .points = 1500}, 0.06e-3, 0.1e-3, 0.7);
}

static void a_stem_that_is_cut_level_ends_there(void **unused)
{
    (void)unused;
    check_bases(&(stem){.radius = 1.5e-3, .length = 0.05, .lean = 0.17, .level = 1, .points = 1500}, 0.06e-3, 0.1e-3,
                0.8);
}

static void noise_is_told_by_all_of_the_foot(void **unused)
{
    (void)unused;
    check_bases(&(stem){1.5e-3, 0.05, 0.17, 0, 4e-4, 2e-4, 1500}, 0.12e-3, 0.16e-3, 0.8);
}

/* The base after plm_stem_foot, and whether it changed. */
static double base_of(const float (*xyz)[3], size_t count, bool *changed)
{
    plm_error error = {0};
    plm_extreme base = lowest(xyz, count);
    assert_ok(plm_stem_foot(xyz, count, &base, changed, &error));
    return base.value;
}

static const stem clean = {.radius = 1.5e-3, .length = 0.05, .lean = 0.17, .points = 2000};

static void order_and_a_floater_do_not_matter(void **unused)
{
    (void)unused;
    static float xyz[MOST][3], turned[MOST][3];
    uint64_t seed = 3;
    bool changed;
    put_stem(&clean, &seed, xyz);
    const double base = base_of((const float(*)[3])xyz, clean.points, &changed);
    assert_true(changed);
    for (size_t i = 0; i < clean.points; i++) memcpy(turned[i], xyz[clean.points - 1 - i], sizeof xyz[i]);
    assert_true(base_of((const float(*)[3])turned, clean.points, &changed) == base);
    const float floater[3] = {0.02f, 0.01f, -0.003f};
    memcpy(xyz[clean.points], floater, sizeof floater);
    assert_near(base_of((const float(*)[3])xyz, clean.points + 1, &changed), base, 0.05e-3);
}

/* What lies lower than the tube's end, or a foot that is no tube, is not told by it. */
static void what_is_no_foot_keeps_its_base(void **unused)
{
    (void)unused;
    static float xyz[MOST][3];
    uint64_t seed = 9;
    bool changed;
    put_stem(&clean, &seed, xyz);
    size_t count = clean.points;
    for (int i = 0; i < 40; i++, count++) { /* the tip of a leaf that hangs beside the foot */
        xyz[count][0] = (float)(0.008 + 1e-3 * test_uniform(&seed));
        xyz[count][1] = (float)(1e-3 * test_uniform(&seed));
        xyz[count][2] = (float)(-2e-3 + 3e-3 * test_uniform(&seed));
    }
    const plm_extreme seen = lowest((const float(*)[3])xyz, count);
    assert_true(base_of((const float(*)[3])xyz, count, &changed) == seen.value);
    assert_false(changed);
    for (count = 0; count < 2000; count++) { /* a blade on its edge */
        xyz[count][0] = (float)(0.05 * test_uniform(&seed));
        xyz[count][1] = 0;
        xyz[count][2] = (float)(0.05 * test_uniform(&seed));
    }
    base_of((const float(*)[3])xyz, count, &changed);
    assert_false(changed);
    base_of((const float(*)[3])xyz, 20, &changed);
    assert_false(changed);
    memset(xyz, 0, sizeof xyz);
    base_of((const float(*)[3])xyz, 200, &changed);
    assert_false(changed);
    for (count = 0; count < 200; count++) xyz[count][2] = (float)count; /* a line */
    base_of((const float(*)[3])xyz, count, &changed);
    assert_false(changed);
    for (count = 0; count < 4000; count++) { /* three stems */
        put_stem(&(stem){.radius = 1.5e-3, .length = 0.05, .points = 1}, &seed, &xyz[count]);
        xyz[count][0] += (float)(0.04 * (double)(count % 3));
    }
    base_of((const float(*)[3])xyz, count, &changed);
    assert_false(changed);
}

/* Where points lie so close that the lowest is the end, the end that a few hundred of them tell is not better. */
static void a_dense_end_is_where_it_was_seen(void **unused)
{
    (void)unused;
    enum { DENSE = 400000 };
    float(*xyz)[3] = malloc(DENSE * sizeof *xyz);
    uint64_t seed = 4;
    bool changed;
    assert_non_null(xyz);
    put_stem(&(stem){.radius = 0.01, .length = 0.05, .points = DENSE}, &seed, xyz);
    assert_near(base_of((const float(*)[3])xyz, DENSE, &changed), 0, 0.02e-3);
    free(xyz);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_leaning_stem_ends_at_its_rim),   cmocka_unit_test(a_stem_that_is_cut_level_ends_there),
        cmocka_unit_test(noise_is_told_by_all_of_the_foot), cmocka_unit_test(order_and_a_floater_do_not_matter),
        cmocka_unit_test(what_is_no_foot_keeps_its_base),   cmocka_unit_test(a_dense_end_is_where_it_was_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
