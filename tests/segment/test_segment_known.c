/* Labels and leaves against the development clouds with known truth, ground and noise taken off by their true labels. The
 * bounds are honest floors: a change that goes below them has made segmentation worse. */
#include "support/test.h"

#include "io/io.h"
#include "segment/segment.h"
#include "support/label_score.h"

typedef struct known_cloud {
    const char *name;
    double iou_mean; /* of stem + petiole and of leaf */
    double stem_iou;
} known_cloud;

static void check(const char *folder, const known_cloud *known)
{
    char path[4200];
    plm_error error = {0};
    plm_cloud cloud;
    plm_segmentation found;
    label_score score;
    const plm_read_options options = {.label_field = "label"};
    snprintf(path, sizeof path, "%s/dev/%s.labelled.ply", folder, known->name);
    assert_ok(plm_cloud_read(path, &options, &cloud, NULL, &error));
    uint8_t *label = calloc(cloud.count, sizeof *label);
    bool *keep = calloc(cloud.count, sizeof *keep);
    assert_true(label && keep);
    for (size_t i = 0; i < cloud.count; i++) {
        label[i] = cloud.label[i] == PLM_LABEL_GROUND ? PLM_LABEL_GROUND : PLM_LABEL_OTHER;
        keep[i] = cloud.label[i] != PLM_LABEL_OTHER;
    }
    assert_ok(plm_segment(&cloud, label, keep, NULL, &found, &error));
    assert_ok(label_score_compute(cloud.count, cloud.label, cloud.organ, found.label, found.organ, &score, &error));
    print_message("%-26s stem %.3f petiole %.3f leaf %.3f mean %.3f, leaves %zu of %zu found, F1 %.3f\n", known->name,
                  score.iou[PLM_LABEL_STEM], score.iou[PLM_LABEL_PETIOLE], score.iou[PLM_LABEL_LEAF], score.iou_mean,
                  score.leaves_found, score.leaves, score.f1);
    assert_true(score.iou_mean >= known->iou_mean);
    if (known->stem_iou > 0) assert_true(score.iou[PLM_LABEL_STEM] >= known->stem_iou);
    assert_int_equal(score.leaves_found, score.leaves);
    assert_true(score.f1 == 1);
    free(label);
    free(keep);
    plm_segmentation_free(&found);
    plm_cloud_free(&cloud);
}

static void organs_of_known_plants_are_found(void **unused)
{
    (void)unused;
    const char *folder = test_data_folder();
    if (!folder) skip();
    static const known_cloud known[] = {
        {.name = "arabidopsis_24_rgbd_pot", .iou_mean = 0.93},
        {.name = "okra_32_3dgs", .iou_mean = 0.93, .stem_iou = 0.87},
        {.name = "pepper_22_rgbd_pot", .iou_mean = 0.95, .stem_iou = 0.88},
        {.name = "single_leaf_35_clean", .iou_mean = 0.99},
        {.name = "maize_15_clean", .iou_mean = 0.85, .stem_iou = 0.7},
        {.name = "tomato_16_clean", .iou_mean = 0.93, .stem_iou = 0.93},
        {.name = "soybean_33_splat", .iou_mean = 0.94, .stem_iou = 0.88},
        {.name = "eggplant_11_rgbd", .iou_mean = 0.96, .stem_iou = 0.88},
    };
    for (size_t i = 0; i < COUNT(known); i++) check(folder, &known[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(organs_of_known_plants_are_found)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
