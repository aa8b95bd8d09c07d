/* What hangs on a stem: a foot whose blades are too small each, but not together, bears a young leaf. */
#include "support/test.h"

#include "segment/side_groups.h"

enum { ROWS = 4000, NODES = 2 };
static const double STEP = 5e-4, R = 3e-3;

static float xyz[ROWS][3];
static bool is_tube[ROWS], is_stem[ROWS];
static int32_t group[ROWS];
static plm_tube_point point[ROWS];

static void add_row(plm_sketch *sketch, double x, double y, double z, bool stem, bool tube)
{
    const size_t i = sketch->working.count++;
    assert_true(i < ROWS);
    xyz[i][0] = (float)x, xyz[i][1] = (float)y, xyz[i][2] = (float)z;
    is_stem[i] = stem, is_tube[i] = tube;
    point[i] = (plm_tube_point){.axis = {0, 0, 1}, .radius = (float)STEP};
}

static void add_sheet(plm_sketch *sketch, double x, double y, double length, double width)
{
    for (double u = 0; u < length; u += STEP)
        for (double v = 0; v < width; v += STEP) add_row(sketch, x + u, y + v, 0.03, false, false);
}

/* What the one group on a stem is like: a petiole of 14 mm, two leaflets of such a width, 6 mm long, at its sides, or one.
 * footed: false: a gap of 3 R before the stem. */
static plm_side_group group_of(double width, bool two, bool footed, bool compound)
{
    plm_error error = {0};
    static double node[NODES][3] = {{0, 0, 0}, {0, 0, 0.06}}, radius[NODES] = {1e-3, 1e-3}, along[NODES] = {0, 0.06};
    plm_sketch sketch = {.is_tube = is_tube, .is_stem = is_stem, .group = group, .point = point};
    sketch.working.xyz = xyz;
    sketch.working.cell = STEP;
    sketch.scale = (plm_scale){.radius = R, .stem_radius = 1e-3, .size = 0.06, .has_tubes = true};
    sketch.stem = (plm_stem_path){.count = NODES, .node = node, .radius = radius, .along = along};
    for (double z = 0; z < 0.06; z += STEP) add_row(&sketch, 0, 0, z, true, true);
    const double gap = footed ? STEP : 3 * R;
    for (double x = gap; x < gap + 14e-3; x += STEP)
        for (int j = -1; j <= 1; j++) add_row(&sketch, x, j * STEP, 0.03, false, true);
    add_sheet(&sketch, gap + 4e-3, 2 * STEP, 6e-3, width);
    if (two) add_sheet(&sketch, gap + 4e-3, -STEP - width, 6e-3, width);
    plm_side_groups groups = {0};
    assert_ok(plm_graph_build((const float(*)[3])xyz, sketch.working.count, 10, 2.3 * STEP, &sketch.graph, &error));
    assert_ok(plm_side_groups_find(&sketch, compound ? 2 : 1, &groups, &error));
    assert_int_equal(groups.count, 1);
    const plm_side_group one = groups.group[0];
    plm_side_groups_free(&groups);
    plm_graph_free(&sketch.graph);
    return one;
}

/* Blades of half of R squared are leaves: 4.5 mm2. */
static void small_leaflets_are_a_leaf_together(void **unused)
{
    (void)unused;
    const plm_side_group large = group_of(1.5e-3, true, true, true), young = group_of(0.5e-3, true, true, true);
    assert_int_equal(large.blades, 2);
    assert_near(large.blade_area, 18e-6, 4e-6);
    assert_true(young.has_foot);
    assert_int_equal(young.blades, 1);
    assert_near(young.blade_area, 6e-6, 1.5e-6);
}

static void a_speck_is_no_leaf_and_what_is_apart_none_together(void **unused)
{
    (void)unused;
    assert_int_equal(group_of(0.5e-3, false, true, true).blades, 0);
    assert_int_equal(group_of(0.5e-3, true, true, false).blades, 0); /* simple leaves have no leaflets */
    const plm_side_group apart = group_of(0.5e-3, true, false, true);
    assert_false(apart.has_foot);
    assert_int_equal(apart.blades, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(small_leaflets_are_a_leaf_together),
                                       cmocka_unit_test(a_speck_is_no_leaf_and_what_is_apart_none_together)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
