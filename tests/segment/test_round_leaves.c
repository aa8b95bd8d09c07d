/* Leaves all of which noise makes round: they are no branches where they are half as large as the others and not surely tubes. */
#include "support/test.h"

#include "segment/round_leaves.h"
#include "support/label_score.h"
#include "support/virtual_plant.h"

enum { ROWS = 1500, LEAVES = 3 };

static const double R = 3e-3;
static bool is_tube[ROWS];
static int32_t group[ROWS];
static float tube[ROWS], distance[ROWS];

/* What hangs on a stem beside three leaves of 20, 200 and 240 points: a group without a blade. */
typedef struct bare {
    size_t points;
    double noise; /* over the stem's radius */
    double share; /* of points that are tubes with a probability of 0.7; the others are surely tubes */
    double far;   /* from the trunk, in R */
    bool has_foot, others_have_blades;
} bare;

static void add_group(plm_sketch *sketch, int32_t g, size_t count, double share, double far)
{
    for (size_t k = 0; k < count; k++) {
        const size_t i = sketch->working.count++;
        assert_true(i < ROWS);
        group[i] = g, is_tube[i] = true, distance[i] = (float)(far * R);
        tube[i] = (double)k < share * (double)count ? 0.7F : 0.95F;
    }
}

/* Points of it that become blade. */
static size_t blade_of(bare it)
{
    static const size_t points[LEAVES] = {20, 200, 240};
    plm_error error = {0};
    plm_sketch sketch = {.is_tube = is_tube, .group = group, .tube = tube};
    sketch.scale = (plm_scale){.radius = R, .stem_radius = R / 3, .noise = it.noise * R / 3};
    plm_side_group one[LEAVES + 1] = {{.has_foot = false}};
    const plm_side_groups groups = {.count = LEAVES + 1, .group = one, .distance = distance};
    add_group(&sketch, -1, 100, 1, 0);
    for (int32_t g = 0; g < LEAVES; g++) {
        one[g] = (plm_side_group){.has_foot = true, .blades = it.others_have_blades};
        add_group(&sketch, g, points[g], 0.5, 3);
    }
    one[LEAVES].has_foot = it.has_foot;
    add_group(&sketch, LEAVES, it.points, it.share, it.far);
    bool found;
    assert_ok(plm_round_leaves(&sketch, &groups, &found, &error));
    size_t blade = 0;
    for (size_t i = 0; i < sketch.working.count; i++) {
        assert_true(is_tube[i] || group[i] == LEAVES);
        blade += !is_tube[i];
    }
    assert_true(found == (blade > 0));
    return blade;
}

static void what_is_half_as_large_as_leaves_is_one(void **unused)
{
    (void)unused;
    assert_int_equal(blade_of((bare){120, 0.3, 0.5, 3, true, true}), 60);
    assert_int_equal(blade_of((bare){80, 0.3, 0.5, 3, true, true}), 0);   /* a branch, or a leaf that lost most of it */
    assert_int_equal(blade_of((bare){120, 0.3, 0.2, 3, true, true}), 0);  /* surely a tube */
    assert_int_equal(blade_of((bare){120, 0.1, 0.5, 3, true, true}), 0);  /* noise that makes no leaf round */
    assert_int_equal(blade_of((bare){120, 0.3, 0.5, 1, true, true}), 0);  /* a foot only */
    assert_int_equal(blade_of((bare){120, 0.3, 0.5, 3, false, true}), 0); /* hangs on nothing */
    assert_int_equal(blade_of((bare){120, 0.3, 0.5, 3, true, false}), 0); /* a bare plant */
}

/* From a depth camera in noise of 0.29 of the stem's radius: the lowest leaf was stem (IoU 0.78). */
static void a_tomatos_lowest_leaf_is_no_branch(void **unused)
{
    (void)unused;
    plm_error error = {0};
    label_score score;
    virtual_plant made =
        virtual_plant_make("tomato", 0, &(plm_scan_options){.scanner = PLM_SCANNER_RGBD, .seed = 57092, .noise = 5e-4});
    const plm_cloud *cloud = &made.scan.cloud;
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, made.found.label, made.found.organ, &score,
                                  &error));
    print_message("%zu of %zu leaves, F1 %.3f, IoU %.3f\n", score.leaves_found, score.leaves, score.f1, score.iou_mean);
    assert_true(score.f1 == 1 && score.iou_mean > 0.85);
    virtual_plant_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_half_as_large_as_leaves_is_one),
                                       cmocka_unit_test(a_tomatos_lowest_leaf_is_no_branch)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
