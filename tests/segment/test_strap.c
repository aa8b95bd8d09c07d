/* Strap leaves: virtual maize by virtual sensors. Leaves whose feet wrap the stem are told apart, every one of them. */
#include "support/test.h"

#include "segment/segment.h"
#include "simulate/simulate.h"
#include "support/label_score.h"

static void check(uint64_t seed, const plm_scan_options *options, double iou)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_segmentation found;
    label_score score;
    assert_ok(plm_plant_grow("maize", &(plm_plant_options){.seed = seed, .resolution = 0.5}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, options, &scan, &error));
    const plm_cloud *cloud = &scan.cloud;
    bool *keep = malloc(cloud->count);
    assert_non_null(keep);
    assert_ok(plm_clean(cloud, NULL, keep, NULL, &error));
    assert_ok(plm_segment(cloud, NULL, keep, NULL, &found, &error));
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, found.label, found.organ, &score, &error));
    print_message("maize %d: habit %s, %zu leaves of %zu, F1 %.3f, stem %.3f, leaf %.3f\n", (int)seed,
                  plm_habit_name(found.habit), score.leaves_found, score.leaves, score.f1, score.iou[PLM_LABEL_STEM],
                  score.iou[PLM_LABEL_LEAF]);
    assert_int_equal(found.habit, PLM_HABIT_STRAP);
    assert_int_equal(score.leaves_found, score.leaves);
    assert_true(score.f1 >= 0.95);
    assert_true(score.iou_mean >= iou);
    plm_segmentation_free(&found);
    free(keep);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
}

static void every_leaf_of_maize_is_found(void **unused)
{
    (void)unused;
    check(102, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = 102, .points = 30000}, 0.7);
    check(102, &(plm_scan_options){.scanner = PLM_SCANNER_SPLAT, .seed = 102, .points = 30000, .noise = 5e-4}, 0.7);
    check(101, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = 101, .points = 30000}, 0.85);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_leaf_of_maize_is_found)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
