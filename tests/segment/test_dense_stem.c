/* Plants whose stem has far more points than their leaves, as splats have where photographs saw it best: the leaves are leaves, and
 * their petioles end where the blades begin. */
#include "support/test.h"

#include "segment/segment.h"
#include "simulate/simulate.h"
#include "support/label_score.h"

/* Keeps of the leaves and petioles one point in every so many. */
static size_t thin_leaves(const plm_cloud *cloud, size_t every, bool *keep)
{
    size_t leaf = 0, kept = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        const uint8_t label = cloud->label[i];
        keep[i] =
            label == PLM_LABEL_STEM || ((label == PLM_LABEL_LEAF || label == PLM_LABEL_PETIOLE) && leaf++ % every == 0);
        kept += keep[i] && label != PLM_LABEL_STEM;
    }
    return kept;
}

/* A seedling as splats of 0.6 mm of noise. score: of the kept points. */
static void segment_thinned(const char *kind, uint64_t seed, size_t points, size_t every, plm_habit *habit,
                            label_score *score)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    const plm_scan_options options = {
        .scanner = PLM_SCANNER_SPLAT, .seed = seed, .points = points, .noise = 6e-4, .unevenness = 1.01};
    assert_ok(plm_plant_grow(kind, &(plm_plant_options){.seed = seed, .is_arched = true}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
    bool *keep = calloc(scan.cloud.count, sizeof *keep);
    assert_non_null(keep);
    const size_t leaves = thin_leaves(&scan.cloud, every, keep);
    plm_segmentation found;
    assert_ok(plm_segment(&scan.cloud, NULL, keep, NULL, &found, &error));
    for (size_t i = 0; i < scan.cloud.count; i++)
        if (!keep[i]) scan.cloud.label[i] = PLM_LABEL_OTHER;
    assert_ok(label_score_compute(scan.cloud.count, scan.cloud.label, scan.cloud.organ, found.label, found.organ, score,
                                  &error));
    print_message("%s: %zu points of leaves, %s, %zu of %zu leaves, IoU of leaves %.3f, of petioles %.3f\n", kind,
                  leaves, plm_habit_name(found.habit), score->leaves_found, score->leaves, score->iou[PLM_LABEL_LEAF],
                  score->iou[PLM_LABEL_PETIOLE]);
    *habit = found.habit;
    plm_segmentation_free(&found);
    free(keep);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
}

/* All of it was a bare stem. */
static void small_leaves_on_a_dense_stem_are_leaves(void **unused)
{
    (void)unused;
    plm_habit habit;
    label_score score;
    segment_thinned("eggplant", 57021, 60000, 3, &habit, &score);
    assert_int_equal(habit, PLM_HABIT_SIMPLE);
    assert_int_equal(score.leaves_found, score.leaves);
    assert_true(score.f1 == 1);
}

/* Specks of blade were petiole (IoU 0.39), as distances along a graph whose links were too short say little. */
static void petioles_of_sparse_leaves_end_at_the_blade(void **unused)
{
    (void)unused;
    plm_habit habit;
    label_score score;
    segment_thinned("pepper", 57021, 120000, 16, &habit, &score);
    assert_int_equal(habit, PLM_HABIT_SIMPLE);
    assert_true(score.iou[PLM_LABEL_LEAF] > 0.99 && score.iou[PLM_LABEL_PETIOLE] > 0.7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_leaves_on_a_dense_stem_are_leaves),
        cmocka_unit_test(petioles_of_sparse_leaves_end_at_the_blade),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
