#include "support/virtual_plant.h"

#include "support/label_score.h"

#include "support/test.h"

virtual_plant virtual_plant_make(const char *kind, double resolution, const plm_scan_options *options)
{
    plm_error error = {0};
    virtual_plant made;
    const plm_plant_options grown = {.seed = options->seed, .resolution = resolution};
    assert_ok(plm_plant_grow(kind, &grown, &made.plant, &error));
    assert_ok(plm_scan_plant(&made.plant, options, &made.scan, &error));
    bool *keep = calloc(made.scan.cloud.count, sizeof *keep);
    assert_non_null(keep);
    assert_ok(plm_clean(&made.scan.cloud, NULL, keep, NULL, &error));
    assert_ok(plm_segment(&made.scan.cloud, NULL, keep, NULL, &made.found, &error));
    free(keep);
    return made;
}

plm_segmentation virtual_plant_as(const virtual_plant *made, plm_habit habit)
{
    plm_error error = {0};
    plm_segmentation found;
    const plm_segment_options options = {.habit = habit};
    bool *keep = calloc(made->found.count, sizeof *keep);
    assert_non_null(keep);
    for (size_t i = 0; i < made->found.count; i++) keep[i] = made->found.label[i] != PLM_LABEL_OTHER;
    assert_ok(plm_segment(&made->scan.cloud, NULL, keep, &options, &found, &error));
    free(keep);
    return found;
}

void virtual_plant_free(virtual_plant *made)
{
    plm_segmentation_free(&made->found);
    plm_scan_free(&made->scan);
    plm_virtual_plant_free(&made->plant);
}

void virtual_plant_assert_leaves(const char *kind, const plm_scan_options *options, size_t leaves)
{
    plm_error error = {0};
    label_score score;
    virtual_plant made = virtual_plant_make(kind, 0.3, options);
    const plm_cloud *cloud = &made.scan.cloud;
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, made.found.label, made.found.organ, &score,
                                  &error));
    size_t other = 0, leaf = 0, stem = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        const bool is_other = cloud->label[i] == PLM_LABEL_OTHER && made.found.label[i] != PLM_LABEL_GROUND;
        other += is_other;
        leaf += is_other && made.found.label[i] == PLM_LABEL_LEAF;
        stem += is_other && made.found.label[i] == PLM_LABEL_STEM;
    }
    print_message(
        "%s, scanner %d: %zu of %zu leaves, F1 %.3f, of %zu points of no organ %zu in leaves, %zu in the stem\n", kind,
        (int)options->scanner, score.leaves_found, score.leaves, score.f1, other, leaf, stem);
    assert_int_equal(score.leaves, leaves);
    assert_int_equal(score.leaves_found, leaves);
    assert_true(score.f1 >= 0.99);
    assert_int_equal(made.found.leaf_count, leaves);
    assert_true(leaf < other / 10);
    assert_true(stem <= other / 40);
    virtual_plant_free(&made);
}

plm_habit virtual_plant_assert_stem(const char *kind, double stem, const plm_scan_options *options)
{
    plm_error error = {0};
    label_score score;
    virtual_plant made = virtual_plant_make(kind, 0, options);
    const plm_cloud *cloud = &made.scan.cloud;
    const plm_habit habit = made.found.habit;
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, made.found.label, made.found.organ, &score,
                                  &error));
    print_message("%s: habit %s, leaves %zu of %zu, F1 %.3f, stem IoU %.3f\n", kind, plm_habit_name(habit),
                  score.leaves_found, score.leaves, score.f1, score.iou[PLM_LABEL_STEM]);
    assert_int_equal(made.found.leaf_count, made.plant.leaf_count);
    assert_true(score.f1 == 1);
    assert_true(score.iou[PLM_LABEL_STEM] > stem);
    virtual_plant_free(&made);
    return habit;
}
