#include "support/segmented.h"

#include "support/test.h"

label_score segmented_grown(const char *kind, const plm_plant_options *growth, const plm_scan_options *options,
                            plm_habit *habit)
{
    const uint64_t seed = growth->seed;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_segmentation found;
    label_score score;
    assert_ok(plm_plant_grow(kind, growth, &plant, &error));
    assert_ok(plm_scan_plant(&plant, options, &scan, &error));
    const plm_cloud *cloud = &scan.cloud;
    bool *keep = malloc(cloud->count);
    assert_non_null(keep);
    assert_ok(plm_clean(cloud, NULL, keep, NULL, &error));
    assert_ok(plm_segment(cloud, NULL, keep, NULL, &found, &error));
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, found.label, found.organ, &score, &error));
    print_message("%s %d: habit %s, %zu leaves of %zu, F1 %.3f, stem %.3f, leaf %.3f, worst %.3f\n", kind, (int)seed,
                  plm_habit_name(found.habit), score.leaves_found, score.leaves, score.f1, score.iou[PLM_LABEL_STEM],
                  score.iou[PLM_LABEL_LEAF], score.worst_leaf);
    if (found.habit == PLM_HABIT_ROSETTE) assert_int_equal(found.stem_count, 0);
    *habit = found.habit;
    plm_segmentation_free(&found);
    free(keep);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
    return score;
}

label_score segmented(const char *kind, uint64_t seed, const plm_scan_options *options, plm_habit *habit)
{
    return segmented_grown(kind, &(plm_plant_options){.seed = seed, .resolution = 0.5}, options, habit);
}

label_score segmented_as(const char *kind, plm_habit habit, uint64_t seed, const plm_scan_options *options, double f1,
                         double iou)
{
    plm_habit found;
    const label_score score = segmented(kind, seed, options, &found);
    assert_int_equal(found, habit);
    assert_int_equal(score.leaves_found, score.leaves);
    assert_true(score.f1 >= f1);
    assert_true(score.iou_mean >= iou);
    return score;
}
