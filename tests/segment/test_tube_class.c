/* Tubes and blades of plants that were seen by a few thousand points: the trees of segment/sparse_tube_forest.h tell them, where the formula
 * that was fitted to many points does not. */
#include "support/test.h"

#include "segment/forest.h"
#include "segment/sketch.h"
#include "support/virtual_plant.h"

#include <math.h>

static bool is_tube(uint8_t label)
{
    return label == PLM_LABEL_STEM || label == PLM_LABEL_PETIOLE;
}

/* Mean of the shares of tubes and of blades that are told right, before what is told is smoothed. */
static double told_right(const char *kind, uint64_t seed, double noise)
{
    plm_error error = {0};
    virtual_plant made = virtual_plant_make(
        kind, 0, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = seed, .points = 3000, .noise = noise});
    const plm_cloud *cloud = &made.scan.cloud;
    plm_sketch sketch = {0};
    assert_ok(plm_sketch_make((const float(*)[3])cloud->xyz, cloud->count, 0, PLM_TUBES_ANY, &sketch, &error));
    double right[2] = {0}, all[2] = {0};
    for (size_t i = 0; i < cloud->count; i++) {
        if (cloud->label[i] == PLM_LABEL_OTHER) continue;
        const bool tube = is_tube(cloud->label[i]);
        const plm_tube_point *point = &sketch.point[sketch.working.voxels.owner[sketch.base.voxels.owner[i]]];
        right[tube] += (plm_tube_probability(point) > 0.5f) == tube;
        all[tube]++;
    }
    plm_sketch_free(&sketch);
    virtual_plant_free(&made);
    const double share = 0.5 * (right[0] / all[0] + right[1] / all[1]);
    print_message("%s %.0f: told right %.3f\n", kind, (double)seed, share);
    return share;
}

static void few_points_tell_tubes(void **unused)
{
    (void)unused;
    static const char *const kind[] = {"eggplant", "okra", "cucumber", "soybean", "cucumber_large", "tomato"};
    enum { KINDS = sizeof kind / sizeof *kind };
    double sum = 0;
    for (size_t k = 0; k < KINDS; k++) sum += told_right(kind[k], 9600 + k, 5e-4);
    print_message("in the mean %.3f\n", sum / KINDS);
    assert_true(sum > 0.9 * KINDS);
}

/* A tree of one split at each level goes to the leaf that its features say, and leaves add up. */
static void trees_go_where_features_say(void **unused)
{
    (void)unused;
    plm_tree tree[2] = {0};
    for (int t = 0; t < 2; t++)
        for (int n = 0; n < PLM_TREE_NODES; n++) tree[t].feature[n] = (uint8_t)t, tree[t].threshold[n] = 0.5f;
    tree[0].leaf[PLM_TREE_NODES] = 2;
    tree[1].leaf[0] = -3;
    assert_true(fabs(plm_forest_probability(0.5, tree, 2, (const float[]){1, 0}) - 1 / (1 + exp(0.5))) < 1e-12);
    assert_true(fabs(plm_forest_probability(0.5, tree, 2, (const float[]){0.5f, 1}) - 1 / (1 + exp(-0.5))) < 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(few_points_tell_tubes),
                                       cmocka_unit_test(trees_go_where_features_say)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
