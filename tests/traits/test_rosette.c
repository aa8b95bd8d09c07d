/* Rosettes seen by depth cameras, at default options: their lowest points are thin petioles that meet a little above the
 * soil, on which noise and voxel means bear hardest. */
#include "support/test.h"

#include "simulate/simulate.h"
#include "traits/traits.h"

#include <math.h>

/* Height of a virtual rosette, as measured without the scan's labels; *built: the true one, m. */
static plm_estimate height_of(uint64_t seed, bool potted, double *built)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_cloud cloud;
    plm_measure_options options;
    plm_measurement measurement;
    const plm_scan_options depth_camera = {.scanner = PLM_SCANNER_RGBD,
                                           .seed = seed,
                                           .points = 45000,
                                           .noise = 5e-4,
                                           .outliers = potted ? 0 : 0.005,
                                           .has_pot = potted};
    assert_ok(plm_plant_grow("arabidopsis", &(plm_plant_options){.seed = seed}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &depth_camera, &scan, &error));
    assert_ok(plm_cloud_create(scan.cloud.count, PLM_HAS_RGB, &cloud, &error));
    memcpy(cloud.xyz, scan.cloud.xyz, cloud.count * sizeof *cloud.xyz);
    memcpy(cloud.rgb, scan.cloud.rgb, cloud.count * sizeof *cloud.rgb);
    memcpy(cloud.origin, scan.cloud.origin, sizeof cloud.origin);
    *built = plant.whole.highest - plant.whole.lowest;
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
    plm_measure_defaults(&options);
    options.up = PLM_UP_Z;
    options.traits = "plant_height";
    assert_ok(plm_measure(&cloud, &options, &measurement, &error));
    assert_int_equal(measurement.value_count, 1);
    const plm_estimate height = measurement.value[0].estimate;
    print_message("%d: %.2f mm, %.2f too high, standard error %.2f\n", (int)seed, 1e3 * height.value,
                  1e3 * (height.value - *built), 1e3 * height.std_error);
    plm_measurement_free(&measurement);
    return height;
}

/* Surfaces through the petioles' meeting place drew its lowest points up by a millimetre. */
static void the_foot_is_as_low_as_it_was_seen(void **unused)
{
    (void)unused;
    for (uint64_t seed = 302; seed < 304; seed++) {
        double built;
        const plm_estimate height = height_of(seed, false, &built);
        assert_near(height.value, built, 0.7e-3);
        assert_near(height.value, built, 2 * height.std_error);
    }
}

/* Petioles hang over the soil but do not stand in it: what lies below them is no foot of a stem. */
static void soil_under_a_rosette_is_no_foot(void **unused)
{
    (void)unused;
    double built;
    const plm_estimate height = height_of(501, true, &built);
    assert_near(height.value, built, 0.7e-3);
    assert_near(height.value, built, 2 * height.std_error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_foot_is_as_low_as_it_was_seen),
        cmocka_unit_test(soil_under_a_rosette_is_no_foot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
