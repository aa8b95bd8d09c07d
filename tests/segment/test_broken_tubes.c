/* A petiole with a gap, whose leaf touches another one: the graph is one piece without it, so only the gap's own shape tells. */
#include "support/test.h"

#include "segment/broken_tubes.h"
#include "support/label_score.h"
#include "support/made_sketch.h"
#include "support/virtual_plant.h"

#include <math.h>

enum { ROWS = 6000 };
static const double STEP = 5e-4, R = 3e-3;

static float xyz[ROWS][3], distance[ROWS];
static bool is_tube[ROWS], is_stem[ROWS];
static int32_t group[ROWS], truth[ROWS];
static plm_tube_point point[ROWS];

static plm_sketch empty_sketch(void)
{
    plm_sketch sketch = {.is_tube = is_tube, .is_stem = is_stem, .group = group, .point = point};
    sketch.working.xyz = xyz;
    sketch.working.cell = STEP;
    sketch.scale.radius = R;
    return sketch;
}

/* A strip of three rows along x at y, from one x to another. */
static void add_tube(plm_sketch *sketch, double y, double z, double from, double to, int32_t organ)
{
    for (double x = from; x < to; x += STEP)
        for (int j = -1; j <= 1; j++) {
            const size_t i = sketch->working.count++;
            assert_true(i < ROWS);
            xyz[i][0] = (float)x, xyz[i][1] = (float)(y + j * STEP), xyz[i][2] = (float)z;
            is_tube[i] = true, is_stem[i] = x < 0, truth[i] = organ;
            point[i].radius = (float)STEP;
            point[i].axis[0] = 1;
        }
}

static void add_blade(plm_sketch *sketch, double y, double z, double from, double wide, int32_t organ)
{
    for (double u = 0; u < wide; u += STEP)
        for (double v = -0.5 * wide; v < 0.5 * wide; v += STEP) {
            const size_t i = sketch->working.count++;
            assert_true(i < ROWS);
            xyz[i][0] = (float)(from + u), xyz[i][1] = (float)(y + v), xyz[i][2] = (float)z;
            is_tube[i] = is_stem[i] = false, truth[i] = organ;
        }
}

/* Links that are made; bare: out, whether the second foot bears no blade. */
static size_t bridge(plm_sketch *sketch, bool *bare)
{
    plm_error error = {0};
    plm_side_group foot[2] = {{.has_foot = true}, {.has_foot = true}};
    const plm_side_groups groups = {.count = 2, .group = foot, .distance = distance};
    assert_ok(plm_graph_build((const float(*)[3])xyz, sketch->working.count, 10, 3 * STEP, &sketch->graph, &error));
    made_sketch_grow(sketch, is_stem, truth, distance);
    for (size_t i = 0; i < sketch->working.count; i++)
        if (group[i] >= 0 && !is_tube[i]) foot[group[i]].blades = 1;
    *bare = !foot[1].blades;
    size_t links = SIZE_MAX;
    assert_ok(plm_bridge_tubes(sketch, &groups, &links, &error));
    return links;
}

/* Two leaves, one a millimetre above the other's edge; the petiole of the second is whole but for a gap. */
static plm_sketch two_leaves(double gap)
{
    plm_sketch sketch = empty_sketch();
    add_tube(&sketch, 0, 0, -1e-3, 20e-3, 0);
    add_blade(&sketch, 0, 0, 20e-3, 12e-3, 0);
    add_tube(&sketch, 11e-3, 1e-3, -1e-3, 12e-3, 1);
    add_tube(&sketch, 11e-3, 1e-3, 12e-3 + gap, 20e-3, 1);
    add_blade(&sketch, 11e-3, 1e-3, 20e-3, 12e-3, 1);
    return sketch;
}

static void a_gap_before_a_leaf_that_touches_is_bridged(void **unused)
{
    (void)unused;
    plm_sketch sketch = two_leaves(4e-3);
    bool bare;
    assert_int_equal(bridge(&sketch, &bare), 1);
    assert_true(bare);
    made_sketch_grow(&sketch, is_stem, truth, distance);
    size_t wrong = 0;
    for (size_t i = 0; i < sketch.working.count; i++) wrong += group[i] != truth[i];
    assert_true(wrong < 20);
    plm_graph_free(&sketch.graph);
}

static void nothing_is_linked_where_nothing_is_missing(void **unused)
{
    (void)unused;
    plm_sketch sketch = two_leaves(0);
    bool bare;
    assert_int_equal(bridge(&sketch, &bare), 0);
    assert_false(bare);
    plm_graph_free(&sketch.graph);
}

/* 2.5 R: as pieces of a plant. */
static void a_wide_gap_stays(void **unused)
{
    (void)unused;
    plm_sketch sketch = empty_sketch();
    add_tube(&sketch, 0, 0, -1e-3, 24e-3, 0);
    add_blade(&sketch, 0, 0, 24e-3, 12e-3, 0);
    add_tube(&sketch, 11e-3, 1e-3, -1e-3, 10e-3, 1);
    add_tube(&sketch, 11e-3, 1e-3, 10e-3 + 2.7 * R, 24e-3, 1);
    add_blade(&sketch, 11e-3, 1e-3, 24e-3, 12e-3, 1);
    bool bare;
    assert_int_equal(bridge(&sketch, &bare), 0);
    assert_true(bare);
    plm_graph_free(&sketch.graph);
}

/* A petiole without a leaf ends before another leaf's petiole, to which a tube leads from the stem. */
static void a_bare_petiole_takes_no_other_leaf(void **unused)
{
    (void)unused;
    plm_sketch sketch = empty_sketch();
    add_tube(&sketch, 0, 0, -1e-3, 12.5e-3, 0);
    for (double y = 1e-3; y < 6e-3; y += STEP) add_tube(&sketch, y, 0, 11.5e-3, 12.5e-3, 0); /* across, and on */
    add_tube(&sketch, 6e-3, 0, 11.5e-3, 20e-3, 0);
    add_blade(&sketch, 6e-3, 0, 20e-3, 12e-3, 0);
    add_tube(&sketch, 6e-3, 0, -4e-3, 8e-3, 1);
    bool bare;
    assert_int_equal(bridge(&sketch, &bare), 0);
    assert_true(bare);
    plm_graph_free(&sketch.graph);
}

/* The rest of the petiole must lie ahead. */
static void what_lies_beside_the_way_is_no_rest(void **unused)
{
    (void)unused;
    plm_sketch sketch = empty_sketch();
    add_tube(&sketch, 0, 0, -1e-3, 20e-3, 0);
    add_blade(&sketch, 0, 0, 20e-3, 12e-3, 0);
    add_tube(&sketch, 11e-3, 1e-3, -1e-3, 12e-3, 1);
    add_tube(&sketch, 16e-3, 1e-3, 14e-3, 20e-3, 0);
    add_blade(&sketch, 11e-3, 1e-3, 20e-3, 12e-3, 0);
    bool bare;
    assert_int_equal(bridge(&sketch, &bare), 0);
    assert_true(bare);
    plm_graph_free(&sketch.graph);
}

/* A soybean's petiole of 115 mm has a gap of 3 mm, and a leaflet of it touches the leaf above: its petiole was stem, and two leaves one. */
static void a_soybeans_leaf_beyond_a_gap_is_its_own(void **unused)
{
    (void)unused;
    plm_error error = {0};
    label_score score;
    virtual_plant made = virtual_plant_make(
        "soybean", 0, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = 63004, .points = 60000});
    const plm_cloud *cloud = &made.scan.cloud;
    assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, made.found.label, made.found.organ, &score,
                                  &error));
    assert_int_equal(made.found.leaf_count, made.plant.leaf_count);
    assert_true(score.f1 == 1);
    virtual_plant_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gap_before_a_leaf_that_touches_is_bridged),
        cmocka_unit_test(nothing_is_linked_where_nothing_is_missing),
        cmocka_unit_test(a_wide_gap_stays),
        cmocka_unit_test(a_bare_petiole_takes_no_other_leaf),
        cmocka_unit_test(what_lies_beside_the_way_is_no_rest),
        cmocka_unit_test(a_soybeans_leaf_beyond_a_gap_is_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
