/* The way up the stem that ran on into a petiole with leaflets leaves it again at the turn, though the leaflets stand on it like
 * leaves without petioles of their own. */
#include "support/test.h"

#include "segment/segment.h"
#include "simulate/simulate.h"
#include "support/label_score.h"

static void leaflets_at_the_end_of_the_way_are_no_leaves(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_segmentation found;
    label_score score;
    const plm_scan_options options = {
        .scanner = PLM_SCANNER_RGBD, .seed = 9101, .points = 45000, .noise = 5e-4, .views = 12, .outliers = 0.005};
    assert_ok(plm_plant_grow("soybean", &(plm_plant_options){.seed = 9101}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
    bool *keep = calloc(scan.cloud.count, sizeof *keep);
    assert_non_null(keep);
    assert_ok(plm_clean(&scan.cloud, NULL, keep, NULL, &error));
    assert_ok(plm_segment(&scan.cloud, NULL, keep, NULL, &found, &error));
    assert_ok(label_score_compute(scan.cloud.count, scan.cloud.label, scan.cloud.organ, found.label, found.organ,
                                  &score, &error));
    print_message("leaves %zu of %zu, F1 %.3f, stem IoU %.3f\n", score.leaves_found, score.leaves, score.f1,
                  score.iou[PLM_LABEL_STEM]);
    assert_int_equal(found.leaf_count, plant.leaf_count);
    assert_true(score.f1 == 1);
    assert_true(score.iou[PLM_LABEL_STEM] > 0.9);
    free(keep);
    plm_segmentation_free(&found);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(leaflets_at_the_end_of_the_way_are_no_leaves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
