/* Heights of a made-up plant on soil: a stem with a leaf across its top. The border between stem and soil is drawn 1.5 mm too
 * high or too low, as it is in noise. */
#include "support/test.h"

#include "support/tubes.h"
#include "traits/traits.h"

#define TALL  0.15
#define NOISE 3e-4
#define OFF   1.5e-3

enum { STEM = 3000, LEAF = 6000, SOIL = 50000, LOW = 8000 };

/* What of the plant is near the soil besides its stem. */
typedef enum low_part { NOTHING, WIDE_LEAF, HANGING_LEAF } low_part;

static void add(plm_cloud *cloud, plm_label label, int32_t organ, double x, double y, double z)
{
    const size_t i = cloud->count++;
    cloud->xyz[i][0] = (float)x, cloud->xyz[i][1] = (float)y, cloud->xyz[i][2] = (float)z;
    cloud->label[i] = (uint8_t)label, cloud->organ[i] = organ;
}

/* Points of a level disc about (x, 0). */
static void add_disc(plm_cloud *cloud, plm_label label, int32_t organ, size_t count, double x, double radius, double z,
                     uint64_t *state)
{
    for (size_t i = 0; i < count; i++) {
        const double r = radius * sqrt(test_uniform(state)), angle = 2 * acos(-1) * test_uniform(state);
        add(cloud, label, organ, x + r * cos(angle), r * sin(angle), z + NOISE * test_normal(state));
    }
}

/* stem_from: height at which what is called stem begins; the soil is at 0. */
static plm_cloud plant_on_soil(double stem_from, low_part low)
{
    plm_error error = {0};
    plm_cloud cloud;
    uint64_t state = 7;
    static double stem[STEM][3];
    const test_tube tube = {.base = {0, 0, stem_from},
                            .end = {0, 0, TALL},
                            .radius = {2e-3, 2e-3},
                            .arc = {0, 2 * acos(-1)},
                            .noise = NOISE};
    assert_ok(plm_cloud_create(STEM + LEAF + SOIL + LOW, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    cloud.count = 0;
    test_tube_points(&tube, STEM, &state, stem);
    for (size_t i = 0; i < STEM; i++) add(&cloud, PLM_LABEL_STEM, 0, stem[i][0], stem[i][1], stem[i][2]);
    add_disc(&cloud, PLM_LABEL_LEAF, 0, LEAF, 0, 0.03, TALL, &state);
    add_disc(&cloud, PLM_LABEL_GROUND, -1, SOIL, 0, 0.16, 0, &state);
    if (low == WIDE_LEAF) add_disc(&cloud, PLM_LABEL_LEAF, 1, LOW, 0, 0.04, 2 * OFF, &state);
    for (int i = 0; low == HANGING_LEAF && i < LOW; i++)
        add(&cloud, PLM_LABEL_LEAF, 1, 0.12 + NOISE * test_normal(&state), 0.02 * test_uniform(&state),
            0.06 * test_uniform(&state) - 0.03);
    return cloud;
}

static plm_estimate height_by(const char *trait, double origin, double stem_from, low_part low, plm_ground_mode ground)
{
    plm_error error = {0};
    plm_cloud cloud = plant_on_soil(stem_from, low);
    cloud.origin[2] = origin;
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = trait;
    options.up = PLM_UP_Z;
    options.ground = ground;
    plm_measurement m;
    assert_ok(plm_measure(&cloud, &options, &m, &error));
    assert_int_equal(m.value_count, 1);
    const plm_estimate height = m.value[0].estimate;
    print_message("stem from %.1f mm: %.2f mm (SE %.2f), %s\n", 1e3 * stem_from, 1e3 * height.value,
                  1e3 * height.std_error, height.method);
    plm_measurement_free(&m);
    return height;
}

static plm_estimate height_of(double stem_from, low_part low, plm_ground_mode ground)
{
    return height_by("plant_height", 0, stem_from, low, ground);
}

static void a_stem_begins_at_the_soil_wherever_it_was_cut(void **unused)
{
    (void)unused;
    for (double from = -OFF; from <= OFF; from += OFF) {
        const plm_estimate height = height_of(from, NOTHING, PLM_GROUND_AUTO);
        assert_near(height.value, TALL, 0.3e-3); /* the top is known to the noise */
        assert_near(height.value, TALL, 2 * height.std_error);
        assert_true(height.std_error < 2 * NOISE);
    }
}

/* The soil's height counts from the origin, and all heights have the same base. */
static void all_heights_stand_on_the_soil_wherever_the_origin_is(void **unused)
{
    (void)unused;
    static const char *const trait[] = {"plant_height", "plant_height_p98", "plant_height_p99"};
    for (size_t i = 0; i < COUNT(trait); i++) {
        const plm_estimate at_zero = height_by(trait[i], 0, OFF, NOTHING, PLM_GROUND_AUTO);
        const plm_estimate far_off = height_by(trait[i], -37.5, OFF, NOTHING, PLM_GROUND_AUTO);
        assert_near(at_zero.value, TALL, 1.1e-3); /* a percentile of a level leaf's noise, in voxels of a millimetre */
        assert_near(far_off.value, at_zero.value, 1e-5);
        assert_non_null(strstr(far_off.method, "above the soil at the foot"));
    }
}

/* Where the soil was not seen, what was cut stays cut. */
static void a_base_without_soil_is_the_lowest_that_was_seen(void **unused)
{
    (void)unused;
    assert_near(height_of(OFF, NOTHING, PLM_GROUND_NONE).value, TALL - OFF, 0.5e-3);
}

static void leaves_that_lie_low_are_no_foot(void **unused)
{
    (void)unused;
    const plm_estimate height = height_of(2 * OFF, WIDE_LEAF, PLM_GROUND_AUTO);
    assert_near(height.value, TALL - 2 * OFF, 3 * NOISE); /* a level sheet may read 2 noise too far */
    assert_string_equal(height.method, "extremes of the surface");
}

static void a_leaf_that_hangs_below_the_soil_is_the_lowest(void **unused)
{
    (void)unused;
    assert_near(height_of(OFF, HANGING_LEAF, PLM_GROUND_AUTO).value, TALL + 0.03, 0.5e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stem_begins_at_the_soil_wherever_it_was_cut),
        cmocka_unit_test(all_heights_stand_on_the_soil_wherever_the_origin_is),
        cmocka_unit_test(a_base_without_soil_is_the_lowest_that_was_seen),
        cmocka_unit_test(leaves_that_lie_low_are_no_foot),
        cmocka_unit_test(a_leaf_that_hangs_below_the_soil_is_the_lowest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
