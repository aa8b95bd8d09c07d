/* Links beyond those of near neighbours: between the pieces of what a scan left sparse. */
#include "support/failing.h"
#include "support/segmented.h"

#include "segment/graph.h"

#include "support/test.h"

#include <math.h>
#include <omp.h>

enum { SIDE = 12, PIECES = SIDE * SIDE, DENSE = 24, MOST = DENSE * DENSE + PIECES };

/* Points of a square grid that is shifted a little from point to point. Gives the number. */
static size_t make_grid(float (*xyz)[3], int side, double step, double x)
{
    for (int i = 0; i < side * side; i++) {
        const int row = i / side, column = i % side;
        xyz[i][0] = (float)(x + step * (column + 0.08 * sin(3.7 * i)));
        xyz[i][1] = (float)(step * (row + 0.08 * cos(5.3 * i)));
        xyz[i][2] = 0;
    }
    return (size_t)side * (size_t)side;
}

/* The longest way from a point to those of its grid that it reaches, over the straight line. */
static double greatest_turn(const plm_graph *graph, uint32_t from, size_t count)
{
    plm_error error = {0};
    float *distance = calloc(graph->count, sizeof *distance);
    assert_non_null(distance);
    const plm_walk walk = {.source = &from, .source_count = 1, .distance = distance};
    assert_ok(plm_graph_walk(graph, &walk, &error));
    double most = 0;
    for (uint32_t i = from + 1; i < from + count; i++)
        if (isfinite(distance[i])) most = fmax(most, (double)distance[i] / plm_graph_length(graph, from, i));
    free(distance);
    return most;
}

static size_t edges(const plm_graph *graph)
{
    return graph->first[graph->count];
}

static size_t components(const plm_graph *graph)
{
    static int32_t component[MOST];
    static uint32_t stack[MOST];
    assert_true(graph->count <= MOST);
    return plm_graph_components(graph, NULL, component, stack);
}

static void ways_across_a_blade_in_pieces_are_nearly_straight(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static float xyz[2 * PIECES][3];
    plm_graph graph;
    const size_t one = make_grid(xyz, SIDE, 1, 0);
    make_grid(xyz + one, SIDE, 1, SIDE + 2);
    assert_ok(plm_graph_build((const float(*)[3])xyz, 2 * one, 6, 0.5, &graph, &error)); /* no links at all */
    assert_int_equal(edges(&graph), 0);
    assert_ok(plm_graph_join(&graph, 0.3, 5, true, &error));
    assert_int_equal(components(&graph), 1);
    assert_true(greatest_turn(&graph, 0, one) < 1.4); /* a tree's: 7 */
    size_t between = 0;
    for (uint32_t i = 0; i < one; i++)
        for (uint32_t e = graph.first[i]; e < graph.first[i + 1]; e++) between += graph.edge[e] >= one;
    assert_int_equal(between, 1); /* two blades meet where they are nearest, as before */
    plm_graph_free(&graph);
    assert_ok(plm_graph_build((const float(*)[3])xyz, 2 * one, 6, 0.5, &graph, &error));
    assert_ok(plm_graph_join(&graph, 0.3, 5, false, &error));
    assert_int_equal(edges(&graph), 2 * (2 * one - 1)); /* a tree */
    assert_int_equal(components(&graph), 1);
    plm_graph_free(&graph);
}

/* A dense blade, and a sparse one of some of its points. Gives the number of all. */
static size_t make_uneven(float (*xyz)[3], int sparse, plm_graph *graph)
{
    plm_error error = {0};
    const size_t dense = make_grid(xyz, DENSE, 1, 0), count = dense + make_grid(xyz + dense, sparse, 2.6, 40);
    assert_ok(plm_graph_build((const float(*)[3])xyz, count, 10, 2.7, graph, &error));
    return count;
}

static void sparse_blades_get_links_as_long_as_their_points_are_apart(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static float xyz[MOST][3];
    plm_graph graph;
    const size_t count = make_uneven(xyz, SIDE, &graph), dense = count - PIECES;
    const size_t before = edges(&graph), in_dense = graph.first[dense];
    const double turn = greatest_turn(&graph, (uint32_t)dense, PIECES);
    assert_true(turn > 2);
    assert_ok(plm_graph_widen(&graph, &error));
    assert_true(edges(&graph) > before + 3 * PIECES);
    assert_int_equal(graph.first[dense], in_dense); /* nothing there, nor between the two */
    assert_int_equal(components(&graph), 2);
    assert_true(greatest_turn(&graph, (uint32_t)dense, PIECES) < 1.35);
    const size_t after = edges(&graph);
    assert_ok(plm_graph_widen(&graph, &error));
    assert_int_equal(edges(&graph), after);
    plm_graph_free(&graph);
}

static void a_few_stray_points_get_none(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static float xyz[MOST][3];
    plm_graph graph;
    make_uneven(xyz, 3, &graph);
    const size_t before = edges(&graph);
    assert_ok(plm_graph_widen(&graph, &error));
    assert_int_equal(edges(&graph), before);
    plm_graph_free(&graph);
    assert_ok(plm_graph_build((const float(*)[3])xyz, 5, 4, 1.5, &graph, &error));
    const size_t few = edges(&graph);
    assert_ok(plm_graph_widen(&graph, &error)); /* fewer points than neighbours */
    assert_int_equal(edges(&graph), few);
    plm_graph_free(&graph);
}

/* Each of these had six to ten leaves too many: pieces of sparse ones. */
static void sparse_leaves_of_splats_stay_whole(void **unused)
{
    (void)unused;
    static const uint64_t seed[] = {428, 435, 433};
    for (size_t k = 0; k < COUNT(seed); k++) {
        const plm_scan_options scan = {
            .scanner = PLM_SCANNER_SPLAT, .seed = seed[k], .points = 9000, .noise = 4e-4, .outliers = 0.01};
        plm_habit habit;
        const label_score score = segmented("arabidopsis_large", seed[k], &scan, &habit);
        assert_int_equal(habit, PLM_HABIT_ROSETTE);
        assert_int_equal(score.leaves, 10);
        assert_int_equal(score.leaves_found, 10);
        assert_true(score.f1 > 0.99);
    }
}

static void memory_may_be_short(void **unused)
{
    (void)unused;
    static float xyz[MOST][3];
    test_failing failing;
    const plm_allocator allocator = test_failing_allocator(&failing);
    plm_graph graph;
    make_uneven(xyz, SIDE, &graph);
    const size_t before = edges(&graph);
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1); /* the allocator's counts are one thread's */
    plm_status status = PLM_E_MEMORY;
    for (long at = 0; status != PLM_OK; at++) {
        plm_error error = {0};
        assert_int_equal(edges(&graph), before);
        failing = (test_failing){.fail_at = at};
        plm_set_allocator(&allocator);
        status = plm_graph_widen(&graph, &error);
        plm_set_allocator(NULL);
        assert_int_equal(status, at < failing.calls ? PLM_E_MEMORY : PLM_OK);
        assert_true(status == PLM_OK || failing.alive == 0);
        assert_true(status == PLM_E_MEMORY || at > 4);
    }
    omp_set_num_threads(threads);
    assert_true(edges(&graph) > before);
    plm_graph_free(&graph);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ways_across_a_blade_in_pieces_are_nearly_straight),
        cmocka_unit_test(sparse_blades_get_links_as_long_as_their_points_are_apart),
        cmocka_unit_test(a_few_stray_points_get_none),
        plant_case(sparse_leaves_of_splats_stay_whole),
        cmocka_unit_test(memory_may_be_short),
    };
    return run_cases(tests);
}
