/* Leaflets whose stalks were not seen: one that touches another leaf goes to the rachis at which its base lies. */
#include "support/test.h"

#include "segment/leaflet_shape.h"
#include "segment/leaflet_stalks.h"
#include "support/label_score.h"
#include "support/virtual_plant.h"

enum { ROWS = 6000, STEM = -1, OWN = 0, OTHER = 1, LEAFLET = 2 };
static const double STEP = 5e-4;

static float xyz[ROWS][3];
static bool is_tube[ROWS], is_stem[ROWS];
static int32_t group[ROWS], truth[ROWS];
static plm_tube_point point[ROWS];

static void add(plm_sketch *sketch, double x, double y, bool tube, int32_t organ)
{
    const size_t i = sketch->working.count++;
    assert_true(i < ROWS);
    xyz[i][0] = (float)x, xyz[i][1] = (float)y, xyz[i][2] = 0;
    is_tube[i] = tube, is_stem[i] = organ == STEM, truth[i] = organ;
    point[i].radius = (float)STEP;
}

/* A rectangle from a corner, in mm. */
static void add_patch(plm_sketch *sketch, double x, double y, double wide, double high, bool tube, int32_t organ)
{
    const int columns = (int)(1e-3 * wide / STEP), rows = (int)(1e-3 * high / STEP);
    for (int k = 0; k < columns; k++)
        for (int j = 0; j < rows; j++) add(sketch, 1e-3 * x + k * STEP, 1e-3 * y + j * STEP, tube, organ);
}

/* A rectangle from (0, 0) along x. */
static size_t fill(double wide, double high, double (*piece)[3])
{
    size_t count = 0;
    for (double u = 0; u < wide; u += 0.25)
        for (double v = -high / 2; v < high / 2; v += 0.25, count++)
            piece[count][0] = u, piece[count][1] = v, piece[count][2] = 0;
    assert_true(count <= ROWS);
    return count;
}

static double rectangle[ROWS][3];

static bool hangs(double wide, double high, double x, double y)
{
    const size_t count = fill(wide, high, rectangle);
    const plm_piece_shape shape = plm_piece_shape_of((const double(*)[3])rectangle, count);
    return plm_hangs_at((const double(*)[3])rectangle, count, &shape, (double[3]){x, y, 0});
}

static bool is_at_side(double wide, double high, double x, double y)
{
    const size_t count = fill(wide, high, rectangle);
    const plm_piece_shape shape = plm_piece_shape_of((const double(*)[3])rectangle, count);
    return plm_is_at_side(&shape, (double[3]){x, y, 0});
}

static void a_touch_at_a_side_is_at_no_end(void **unused)
{
    (void)unused;
    assert_true(is_at_side(12, 6, 6, 3));
    assert_true(is_at_side(12, 6, 8, -3));
    assert_false(is_at_side(12, 6, 0, 0));
    assert_false(is_at_side(12, 6, 12, 2));
    assert_false(is_at_side(12, 6, 6, 0.5)); /* the mean of two ends */
}

/* Edges between two colours go, in both directions; points of no colour keep all. */
static void a_graph_is_parted_by_colours(void **unused)
{
    (void)unused;
    const float row[5][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
    const int32_t colour[5] = {0, 0, 7, -1, 0};
    const uint32_t first[6] = {0, 1, 2, 3, 5, 6}, edge[6] = {1, 0, 3, 2, 4, 3};
    plm_error error = {0};
    plm_graph graph;
    assert_ok(plm_graph_build(row, 5, 2, 1.5, &graph, &error));
    plm_graph_part(&graph, colour);
    assert_memory_equal(graph.first, first, sizeof first);
    assert_memory_equal(graph.edge, edge, sizeof edge);
    plm_graph_free(&graph);
}

static void a_leaflet_hangs_at_an_end(void **unused)
{
    (void)unused;
    assert_true(hangs(12, 6, -1, 0));
    assert_true(hangs(12, 6, 13, 1));
    assert_false(hangs(30, 6, 0, 8));   /* off a corner */
    assert_false(hangs(12, 6, 6, 4));   /* at a side */
    assert_false(hangs(12, 6, 1, 0));   /* a twelfth of it is behind */
    assert_false(hangs(12, 10, -1, 0)); /* round */
}

/* A stem along y. A long rachis along x, with a leaflet at its end; another leaf's blade above it. */
static void start_plant(plm_sketch *sketch, plm_stem_path *stem)
{
    *sketch = (plm_sketch){.is_tube = is_tube, .is_stem = is_stem, .group = group, .point = point, .stem = *stem};
    sketch->working.xyz = xyz;
    sketch->working.cell = STEP;
    sketch->scale.radius = 3e-3;
    sketch->scale.has_tubes = true;
    add_patch(sketch, -2, -10, 2, 40, true, STEM);
    add_patch(sketch, 0, -0.5, 30, 1.5, true, OWN);
    add_patch(sketch, 30, -5, 8, 10, false, OWN);
    add_patch(sketch, 0, 14, 8, 1.5, true, OTHER);
    add_patch(sketch, 8, 9, 8, 10, false, OTHER);
}

/* Which leaf has the leaflet: the group of most of its points is that of most of the leaf's. */
static int32_t leaf_of_leaflet(const plm_sketch *sketch)
{
    size_t votes[3][8] = {{0}}, best[3] = {0};
    for (size_t i = 0; i < sketch->working.count; i++)
        if (truth[i] >= 0 && group[i] >= 0 && group[i] < 8) votes[truth[i]][group[i]]++;
    for (int organ = 0; organ < 3; organ++)
        for (size_t g = 0; g < 8; g++)
            if (votes[organ][g] > votes[organ][best[organ]]) best[organ] = g;
    size_t all = 0;
    for (size_t g = 0; g < 8; g++) all += votes[LEAFLET][g];
    assert_true(votes[LEAFLET][best[LEAFLET]] > 0.95 * (double)all);
    return best[LEAFLET] == best[OWN] ? OWN : best[LEAFLET] == best[OTHER] ? OTHER : -1;
}

/* The leaf that has the leaflet before and after stalks are sought. */
static void find_leaf(plm_sketch *sketch, int32_t *before, int32_t *after)
{
    plm_error error = {0};
    plm_side_groups groups;
    assert_ok(plm_graph_build((const float(*)[3])xyz, sketch->working.count, 12, 1.6 * STEP, &sketch->graph, &error));
    const size_t edges = sketch->graph.first[sketch->graph.count];
    assert_ok(plm_side_groups_find(sketch, 2, &groups, &error));
    *before = leaf_of_leaflet(sketch);
    assert_ok(plm_leaflet_stalks(sketch, 2, &groups, &error));
    *after = leaf_of_leaflet(sketch);
    if (*before == *after) assert_int_equal(sketch->graph.first[sketch->graph.count], edges);
    plm_side_groups_free(&groups);
    plm_graph_free(&sketch->graph);
}

/* lobe: corner, width and height of what joins the leaflet with the other leaf. */
static void check(double x, double y, double wide, double high, const double lobe[4], int32_t after)
{
    double node[2][3] = {{-1e-3, -10e-3, 0}, {-1e-3, 30e-3, 0}}, radius[2] = {1e-3, 1e-3}, along[2] = {0, 40e-3};
    plm_stem_path stem = {.count = 2, .node = node, .radius = radius, .along = along};
    plm_sketch sketch;
    int32_t found[2];
    start_plant(&sketch, &stem);
    add_patch(&sketch, x, y, wide, high, false, LEAFLET);
    add_patch(&sketch, lobe[0], lobe[1], lobe[2], lobe[3], false, OTHER);
    find_leaf(&sketch, &found[0], &found[1]);
    assert_int_equal(found[0], OTHER);
    assert_int_equal(found[1], after);
}

/* It stands on the rachis but for a gap of 2 mm, and a lobe of the other leaf touches its side. */
static void a_leaflet_goes_to_the_rachis_at_its_base(void **unused)
{
    (void)unused;
    check(18, 3, 5, 12, (double[4]){16, 11, 2, 1.5}, OWN);
}

/* The same leaflet, turned: it lies along the rachis and hangs on the other leaf by its end. */
static void a_leaflet_beside_a_rachis_stays(void **unused)
{
    (void)unused;
    check(17, 3, 12, 5, (double[4]){14, 5, 3, 4}, OTHER);
}

static void a_leaflet_far_from_the_rachis_stays(void **unused)
{
    (void)unused;
    check(18, 5, 5, 12, (double[4]){16, 11, 2, 1.5}, OTHER);
}

static void a_round_leaflet_stays(void **unused)
{
    (void)unused;
    check(18, 3, 9, 9, (double[4]){16, 10, 2, 1.5}, OTHER);
}

/* A leaflet at the side of a clean soybean's leaf lies on another leaf; one stands on the petiole of another. */
static void leaflets_of_virtual_soybeans_keep_their_leaf(void **unused)
{
    (void)unused;
    for (uint64_t seed = 74002; seed <= 74006; seed += 4) {
        plm_error error = {0};
        label_score score;
        const plm_scan_options options = {.scanner = PLM_SCANNER_DOME, .seed = seed, .points = 60000};
        virtual_plant made = virtual_plant_make("soybean", 0, &options);
        const plm_cloud *cloud = &made.scan.cloud;
        assert_ok(label_score_compute(cloud->count, cloud->label, cloud->organ, made.found.label, made.found.organ,
                                      &score, &error));
        print_message("soybean %d: leaves %zu of %zu, F1 %.3f, worst %.3f\n", (int)seed, score.leaves_found,
                      score.leaves, score.f1, score.worst_leaf);
        assert_true(score.worst_leaf >= 0.95);
        virtual_plant_free(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_leaflet_hangs_at_an_end),
        cmocka_unit_test(a_touch_at_a_side_is_at_no_end),
        cmocka_unit_test(a_graph_is_parted_by_colours),
        cmocka_unit_test(a_leaflet_goes_to_the_rachis_at_its_base),
        cmocka_unit_test(a_leaflet_beside_a_rachis_stays),
        cmocka_unit_test(a_leaflet_far_from_the_rachis_stays),
        cmocka_unit_test(a_round_leaflet_stays),
        cmocka_unit_test(leaflets_of_virtual_soybeans_keep_their_leaf),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
