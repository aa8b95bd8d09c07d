/* The scale of plants in noise, and of those whose stem is thick beside the length of all their thin rachises: in balls that fit the
 * rachises, the stem's surface is flat, and pieces of it are taken for leaves. */
#include "support/test.h"

#include "segment/scale.h"
#include "support/virtual_plant.h"

static void a_thick_stem_is_seen_as_a_tube(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_scale scale;
    const plm_scan_options options = {.scanner = PLM_SCANNER_DOME, .seed = 9002, .points = 60000};
    virtual_plant made = virtual_plant_make("tomato", 0, &options);
    const double diameter = made.plant.stem->diameter;
    assert_ok(plm_find_scale((const float(*)[3])made.scan.cloud.xyz, made.scan.cloud.count, &scale, &error));
    print_message("R %.2f mm, stem's radius %.2f mm\n", 1e3 * scale.radius, 0.5e3 * diameter);
    assert_true(scale.radius >= diameter);
    assert_int_equal(made.found.leaf_count, made.plant.leaf_count);
    virtual_plant_free(&made);
}

/* Balls of a few sigmas are round whatever they hold. They are as wide as is looked for at most: this share of the size. */
static void balls_are_wide_against_the_noise(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double widest = 0.075;
    for (uint64_t seed = 67003; seed <= 67005; seed++) {
        plm_scale scale;
        const plm_scan_options options = {
            .scanner = PLM_SCANNER_SPLAT, .seed = seed, .points = 30000, .noise = 5e-4, .outliers = 0.01};
        virtual_plant made = virtual_plant_make("arabidopsis", 0, &options);
        assert_ok(plm_find_scale((const float(*)[3])made.scan.cloud.xyz, made.scan.cloud.count, &scale, &error));
        print_message("R %.2f mm, noise %.2f mm, size %.1f mm\n", 1e3 * scale.radius, 1e3 * scale.noise,
                      1e3 * scale.size);
        assert_true(scale.radius >= 0.999 * fmin(6 * scale.noise, widest * scale.size));
        virtual_plant_free(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_thick_stem_is_seen_as_a_tube),
                                       cmocka_unit_test(balls_are_wide_against_the_noise)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
