/* Virtual plants by virtual sensors, with the true label of every point, wrong ones included: ghosts of depth cameras and
 * floaters of splats become other, the plant's own points do not. */
#include "support/test.h"

#include "segment/segment.h"
#include "simulate/simulate.h"

typedef struct ghost_case {
    const char *kind;
    uint64_t seed;
    plm_scan_options scan;
    double wrong, good; /* per cent of wrong points dropped at least, of good points at most */
    double iou; /* mean over stem + petiole and leaf, at least; wrong points that got a label count against it */
} ghost_case;

static double intersection_over_union(const plm_cloud *cloud, const uint8_t *found, bool leaf)
{
    size_t both = 0, any = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        const bool is_true = leaf ? cloud->label[i] == PLM_LABEL_LEAF
                                  : cloud->label[i] == PLM_LABEL_STEM || cloud->label[i] == PLM_LABEL_PETIOLE;
        const bool is_found =
            leaf ? found[i] == PLM_LABEL_LEAF : found[i] == PLM_LABEL_STEM || found[i] == PLM_LABEL_PETIOLE;
        both += is_true && is_found;
        any += is_true || is_found;
    }
    return (double)both / (double)any;
}

static void check(const ghost_case *known)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_segmentation found;
    assert_ok(
        plm_plant_grow(known->kind, &(plm_plant_options){.seed = known->seed, .resolution = 0.4}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &known->scan, &scan, &error));
    const plm_cloud *cloud = &scan.cloud;
    bool *keep = malloc(cloud->count);
    assert_non_null(keep);
    assert_ok(plm_clean(cloud, NULL, keep, NULL, &error));
    size_t all[2] = {0}, dropped[2] = {0};
    for (size_t i = 0; i < cloud->count; i++) {
        all[cloud->label[i] != PLM_LABEL_OTHER]++;
        dropped[cloud->label[i] != PLM_LABEL_OTHER] += !keep[i];
    }
    const double wrong = all[0] ? 100 * (double)dropped[0] / (double)all[0] : 100,
                 good = 100 * (double)dropped[1] / (double)all[1];
    assert_ok(plm_segment(cloud, NULL, keep, NULL, &found, &error));
    const double iou =
        0.5 * (intersection_over_union(cloud, found.label, true) + intersection_over_union(cloud, found.label, false));
    print_message(
        "%-10s %6zu points, %5zu wrong: %5.1f %% of these dropped, %.2f %% of the good; IoU %.3f, leaves %zu\n",
        known->kind, cloud->count, all[0], wrong, good, iou, found.leaf_count);
    if (wrong < known->wrong) fail_msg("only %.1f %% of the wrong points dropped", wrong);
    if (good > known->good) fail_msg("%.2f %% of the good points dropped", good);
    if (iou < known->iou) fail_msg("IoU %.3f", iou);
    plm_segmentation_free(&found);
    free(keep);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
}

static void ghosts_of_depth_cameras_become_other(void **unused)
{
    (void)unused;
    static const ghost_case known[] = {
        {"eggplant", 31, {.scanner = PLM_SCANNER_RGBD, .seed = 31, .noise = 5e-4, .image_width = 640}, 70, 1, 0.935},
        {"soybean", 32, {.scanner = PLM_SCANNER_RGBD, .seed = 32, .noise = 5e-4, .image_width = 640}, 35, 1.2, 0.88},
        {"cucumber", 33, {.scanner = PLM_SCANNER_RGBD, .seed = 33, .noise = 4e-4, .image_width = 640}, 70, 1, 0.945},
    };
    for (size_t i = 0; i < COUNT(known); i++) check(&known[i]);
}

static void other_scanners_lose_nothing_by_it(void **unused)
{
    (void)unused;
    static const ghost_case known[] = {
        {"pepper", 34, {.scanner = PLM_SCANNER_DOME, .seed = 34, .points = 20000}, 100, 0.1, 0.95},
        {"eggplant",
         35,
         {.scanner = PLM_SCANNER_SPLAT, .seed = 35, .points = 20000, .noise = 4e-4, .outliers = 0.01},
         70,
         0.5,
         0.95},
        {"cucumber", 36, {.scanner = PLM_SCANNER_DOME, .seed = 36, .points = 8000}, 100, 0.3, 0.95},
    };
    for (size_t i = 0; i < COUNT(known); i++) check(&known[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ghosts_of_depth_cameras_become_other),
        cmocka_unit_test(other_scanners_lose_nothing_by_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
