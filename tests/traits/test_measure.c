/* Measuring a plant: order of the values, labels that come with the cloud, rows in any order, reasons. */
#include "support/test.h"

#include "traits/traits.h"

enum { STEM = 200, LEAF = 300, LEAVES = 3, POINTS = STEM + LEAVES * LEAF };

/* A stem along z and three square leaves round it, labelled; leaf numbers 0, 1 and 7: gaps are allowed. */
static plm_cloud labelled_plant(void)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(POINTS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    uint64_t state = 11;
    for (size_t i = 0; i < POINTS; i++) {
        const bool is_stem = i < STEM;
        const size_t leaf = is_stem ? 0 : (i - STEM) / LEAF;
        const double u = test_uniform(&state), v = test_uniform(&state), turn = 2.0 * (double)leaf + 0.3;
        const double x = is_stem ? 0.002 * cos(6.3 * u) : 0.02 + 0.03 * u,
                     y = is_stem ? 0.002 * sin(6.3 * u) : 0.02 * v;
        cloud.xyz[i][0] = (float)(x * cos(turn) - y * sin(turn));
        cloud.xyz[i][1] = (float)(x * sin(turn) + y * cos(turn));
        cloud.xyz[i][2] = (float)(is_stem ? 0.1 * v : 0.03 + 0.02 * (double)leaf);
        cloud.label[i] = is_stem ? PLM_LABEL_STEM : PLM_LABEL_LEAF;
        cloud.organ[i] = is_stem ? 0 : leaf == 2 ? 7 : (int32_t)leaf;
    }
    return cloud;
}

static plm_measurement measure(plm_cloud *cloud, const char *traits)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    plm_measurement measurement;
    assert_ok(plm_measure(cloud, &options, &measurement, &error));
    return measurement;
}

static void labels_that_come_with_the_cloud_are_counted_as_they_are(void **unused)
{
    (void)unused;
    plm_cloud cloud = labelled_plant();
    plm_measurement plant = measure(&cloud, "leaf_count");
    assert_int_equal(cloud.count, 0);
    assert_int_equal(plant.value_count, 1);
    assert_near(plant.value[0].estimate.value, LEAVES, 0);
    assert_int_equal(plant.value[0].organ_id, -1);
    assert_int_equal(plant.segmentation.leaf_count, LEAVES);
    assert_int_equal(plant.cloud.count, POINTS);
    for (size_t i = 0; i < POINTS; i++) {
        const bool is_stem = i < STEM;
        assert_int_equal(plant.cloud.label[i], is_stem ? PLM_LABEL_STEM : PLM_LABEL_LEAF);
        assert_int_equal(plant.segmentation.organ[i], is_stem ? 0 : (i - STEM) / LEAF == 2 ? 7 : (i - STEM) / LEAF);
    }
    plm_measurement_free(&plant);
}

static void every_value_is_finite_or_has_a_reason(void **unused)
{
    (void)unused;
    plm_cloud cloud = labelled_plant();
    plm_measurement plant = measure(&cloud, NULL);
    for (size_t i = 0; i < plant.value_count; i++) {
        const plm_estimate *estimate = &plant.value[i].estimate;
        if (estimate->state == PLM_STATE_OK)
            assert_true(isfinite(estimate->value));
        else
            assert_true(isnan(estimate->value) && estimate->reason[0]);
        assert_non_null(estimate->method);
        if (i > 0) assert_true(plant.value[i].trait->level >= plant.value[i - 1].trait->level);
    }
    plm_measurement_free(&plant);
}

static void one_point_and_coincident_points_give_reasons_and_no_failure(void **unused)
{
    (void)unused;
    plm_error error = {0};
    for (size_t count = 1; count <= 64; count *= 4) {
        plm_cloud cloud;
        assert_ok(plm_cloud_create(count, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
        memset(cloud.xyz, 0, count * sizeof *cloud.xyz);
        memset(cloud.organ, 0, count * sizeof *cloud.organ);
        memset(cloud.label, PLM_LABEL_LEAF, count);
        plm_measurement plant = measure(&cloud, NULL);
        for (size_t i = 0; i < plant.value_count; i++)
            assert_true(plant.value[i].estimate.state == PLM_STATE_OK || plant.value[i].estimate.reason[0]);
        plm_measurement_free(&plant);
    }
}

static void an_empty_cloud_is_refused(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    plm_cloud cloud = {0};
    plm_measurement measurement;
    assert_int_equal(plm_measure(&cloud, &options, &measurement, &error), PLM_E_DEGENERATE);
    assert_string_equal(error.message, "the cloud has no points");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_that_come_with_the_cloud_are_counted_as_they_are),
        cmocka_unit_test(every_value_is_finite_or_has_a_reason),
        cmocka_unit_test(one_point_and_coincident_points_give_reasons_and_no_failure),
        cmocka_unit_test(an_empty_cloud_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
