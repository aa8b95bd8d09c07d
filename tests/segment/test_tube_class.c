/* Tubes and blades of plants that were seen by a few thousand points are told by the trees of segment/sparse_tube_forest.h. */
#include "support/test.h"

#include "segment/forest.h"
#include "segment/sketch.h"
#include "support/virtual_plant.h"

#include <math.h>

static bool is_tube(uint8_t label)
{
    return label == PLM_LABEL_STEM || label == PLM_LABEL_PETIOLE;
}

/* Mean of the shares of tubes and of blades that are told right, before what is told is smoothed. by_trees: grows by the share of points that
 * the trees tell. */
static double told_right(const char *kind, uint64_t seed, double noise, double *by_trees)
{
    plm_error error = {0};
    virtual_plant made = virtual_plant_make(
        kind, 0, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = seed, .points = 3000, .noise = noise});
    const plm_cloud *cloud = &made.scan.cloud;
    plm_sketch sketch = {0};
    assert_ok(plm_sketch_make((const float(*)[3])cloud->xyz, cloud->count, 0, PLM_TUBES_ANY, &sketch, &error));
    double right[2] = {0}, all[2] = {0}, sparse = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        if (cloud->label[i] == PLM_LABEL_OTHER) continue;
        const bool tube = is_tube(cloud->label[i]);
        const plm_tube_point *point = &sketch.point[sketch.working.voxels.owner[sketch.base.voxels.owner[i]]];
        right[tube] += (plm_tube_probability(point) > 0.5f) == tube;
        all[tube]++;
        sparse += point->count < PLM_TUBE_SPARSE;
    }
    plm_sketch_free(&sketch);
    virtual_plant_free(&made);
    sparse /= all[0] + all[1];
    *by_trees += sparse;
    const double share = 0.5 * (right[0] / all[0] + right[1] / all[1]);
    print_message("%s %.0f: told right %.3f, %.3f by trees\n", kind, (double)seed, share, sparse);
    return share;
}

static void few_points_tell_tubes(void **unused)
{
    (void)unused;
    static const char *const kind[] = {"eggplant", "okra", "cucumber", "soybean", "cucumber_large", "tomato"};
    enum { KINDS = sizeof kind / sizeof *kind };
    double sum = 0, by_trees = 0;
    for (size_t k = 0; k < KINDS; k++) {
        const double share = told_right(kind[k], 9600 + k, 5e-4, &by_trees);
        assert_true(share > 0.8);
        sum += share;
    }
    print_message("in the mean %.3f\n", sum / KINDS);
    assert_true(sum > 0.9 * KINDS && by_trees > 0.5 * KINDS);
}

/* Each level has its own feature, and each node its own threshold, so that only the right way down gives the right leaf. */
static void trees_go_where_features_say(void **unused)
{
    (void)unused;
    enum { DEPTH = 5 };
    plm_tree tree[2] = {0};
    size_t level = 0;
    for (size_t n = 0; n < PLM_TREE_NODES; n++) {
        while (n + 2 > (size_t)2 << level) level++;
        tree[0].feature[n] = (uint8_t)level;
        tree[0].threshold[n] = (float)n;
        tree[1].threshold[n] = INFINITY; /* always to the first child */
    }
    for (size_t k = 0; k <= PLM_TREE_NODES; k++) tree[0].leaf[k] = (float)k;
    tree[1].leaf[0] = -0.25f;
    for (size_t way = 0; way <= PLM_TREE_NODES; way++) {
        float feature[DEPTH];
        size_t node = 0;
        for (int k = 0; k < DEPTH; k++) {
            const bool second = way >> (DEPTH - 1 - k) & 1;
            feature[k] = (float)node + (second ? 0.5f : 0); /* no more than the threshold goes to the first */
            node = 2 * node + 1 + second;
        }
        const double told = plm_forest_probability(-15, tree, 2, feature);
        assert_near(log(told / (1 - told)), (double)way - 15.25, 1e-6);
    }
}

/* With the same features, the count of points decides who is asked. */
static void few_points_ask_the_trees(void **unused)
{
    (void)unused;
    plm_tube_point point = {.count = PLM_TUBE_SPARSE};
    for (int k = 0; k < PLM_TUBE_SCALES; k++)
        for (int f = 0; f < PLM_TUBE_FEATURES; f++) point.feature[k][f] = 0.3f;
    const float formula = plm_tube_probability(&point);
    point.count--;
    const float trees = plm_tube_probability(&point);
    assert_true(fabsf(formula - trees) > 1e-3f);
    point.count = 0;
    assert_true(plm_tube_probability(&point) == trees);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(few_points_tell_tubes),
                                       cmocka_unit_test(trees_go_where_features_say),
                                       cmocka_unit_test(few_points_ask_the_trees)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
