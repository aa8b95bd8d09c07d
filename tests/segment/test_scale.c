/* The scale of plants whose stem is thick beside the length of all their thin rachises: in balls that fit the rachises, the
 * stem's surface is flat, and pieces of it are taken for leaves. */
#include "support/test.h"

#include "segment/scale.h"
#include "segment/segment.h"
#include "simulate/simulate.h"

static void a_thick_stem_is_seen_as_a_tube(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_scale scale;
    plm_segmentation found;
    const plm_scan_options options = {.scanner = PLM_SCANNER_DOME, .seed = 9002, .points = 60000};
    assert_ok(plm_plant_grow("tomato", &(plm_plant_options){.seed = 9002}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
    assert_ok(plm_find_scale((const float(*)[3])scan.cloud.xyz, scan.cloud.count, &scale, &error));
    print_message("R %.2f mm, stem's radius %.2f mm\n", 1e3 * scale.radius, 0.5e3 * plant.stem->diameter);
    assert_true(scale.radius >= plant.stem->diameter);
    assert_ok(plm_segment(&scan.cloud, NULL, NULL, NULL, &found, &error));
    assert_int_equal(found.leaf_count, plant.leaf_count);
    plm_segmentation_free(&found);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_thick_stem_is_seen_as_a_tube)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
