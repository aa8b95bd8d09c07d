/* The way up the stem that ran on into a petiole with leaflets leaves it again at the turn, though the leaflets stand on it like
 * leaves without petioles of their own. */
#include "support/test.h"

#include "support/label_score.h"
#include "support/virtual_plant.h"

static void leaflets_at_the_end_of_the_way_are_no_leaves(void **unused)
{
    (void)unused;
    plm_error error = {0};
    label_score score;
    const plm_scan_options options = {
        .scanner = PLM_SCANNER_RGBD, .seed = 9101, .points = 45000, .noise = 5e-4, .views = 12, .outliers = 0.005};
    virtual_plant made = virtual_plant_make("soybean", 0, &options);
    const plm_cloud *cloud = &made.scan.cloud;
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, made.found.label, made.found.organ, &score,
                                  &error));
    print_message("leaves %zu of %zu, F1 %.3f, stem IoU %.3f\n", score.leaves_found, score.leaves, score.f1,
                  score.iou[PLM_LABEL_STEM]);
    assert_int_equal(made.found.leaf_count, made.plant.leaf_count);
    assert_true(score.f1 == 1);
    assert_true(score.iou[PLM_LABEL_STEM] > 0.9);
    virtual_plant_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(leaflets_at_the_end_of_the_way_are_no_leaves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
