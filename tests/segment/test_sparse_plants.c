/* Plants of which the stem was seen by some hundred points: their balls reach from one sparse point to the next, the stem goes up to where its
 * leaves are, and tubes that are too short in sum to be sure are a plant's if a straight stem bears leaves with petioles. */
#include "support/test.h"

#include "segment/ball_shape.h"
#include "segment/judge_tubes.h"
#include "segment/stem_top.h"
#include "support/virtual_plant.h"

#include <math.h>
#include <string.h>

/* Was one leaf on a short stem, all the others its leaflets: the way up ended at the first node. */
static void the_stem_goes_up_to_the_last_leaf(void **unused)
{
    (void)unused;
    assert_int_equal(
        virtual_plant_assert_stem(
            "eggplant", 0.85,
            &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = 277024, .points = 5087, .noise = 3.3e-4}),
        PLM_HABIT_SIMPLE);
}

/* Was a head: its tubes are too short in sum. */
static void few_tubes_are_a_stem_and_petioles(void **unused)
{
    (void)unused;
    assert_int_equal(
        virtual_plant_assert_stem(
            "okra", 0.6, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = 43, .points = 4500, .noise = 2e-4}),
        PLM_HABIT_SIMPLE);
}

enum { MOST = 4000 };

/* A sketch of points by hand. */
typedef struct drawing {
    float xyz[MOST][3];
    plm_tube_point point[MOST];
    bool is_tube[MOST];
    int32_t leaf[MOST];
    double node[2][3], along[2];
    plm_sketch sketch;
} drawing;

static drawing *draw(void)
{
    static drawing d;
    memset(&d, 0, sizeof d);
    d.sketch.working.xyz = d.xyz;
    d.sketch.point = d.point;
    d.sketch.is_tube = d.is_tube;
    d.sketch.leaf = d.leaf;
    d.sketch.scale = (plm_scale){.radius = 4, .stem_radius = 1, .size = 100};
    return &d;
}

static uint32_t add_point(drawing *d, double x, double z, double radius, int32_t leaf)
{
    const size_t k = d->sketch.working.count++;
    assert_true(k < MOST);
    d->xyz[k][0] = (float)x, d->xyz[k][2] = (float)z;
    d->is_tube[k] = radius > 0;
    d->point[k].radius = (float)radius;
    d->leaf[k] = leaf;
    return (uint32_t)k;
}

/* A stem of 60 up, whose radius is `upper` from 30 on (few points scatter), and a petiole of 20 that leaves it there, as thick as the stem
 * below; so many points of blades at their ends. Gives the height of the stem's top. */
static double height_of_top(double upper, int blades_on_stem, int blades_aside)
{
    plm_error error = {0};
    drawing *d = draw();
    static float distance[MOST];
    static uint32_t parent[MOST], order[MOST];
    for (int z = 0; z <= 60; z++) add_point(d, 0, z, z < 30 ? 1 : upper, -1);
    uint32_t top = (uint32_t)(d->sketch.working.count - 1);
    for (int i = 1; i <= blades_on_stem; i++) add_point(d, 0, 60 + i, 0, 0);
    for (int i = 1; i <= 20; i++) add_point(d, i, 30 - 0.2 * i, 1, -1);
    for (int i = 1; i <= blades_aside; i++) add_point(d, 20 + i, 26, 0, 1);
    plm_sketch *s = &d->sketch;
    assert_ok(plm_graph_build((const float(*)[3])d->xyz, s->working.count, 4, 1.5, &s->graph, &error));
    const uint32_t base = 0;
    plm_tube_ways ways = {.distance = distance, .parent = parent, .order = order};
    const plm_walk walk = {.source = &base,
                           .source_count = 1,
                           .distance = distance,
                           .parent = parent,
                           .order = order,
                           .reached = &ways.reached};
    assert_ok(plm_graph_walk(&s->graph, &walk, &error));
    assert_int_equal(ways.reached, s->working.count);
    assert_ok(plm_stem_top(s, &ways, &top, &error));
    plm_graph_free(&s->graph);
    return s->working.xyz[top][2];
}

static void most_blades_hang_on_the_stem(void **unused)
{
    (void)unused;
    assert_near(height_of_top(0.9, 40, 60), 60, 1e-6);  /* the thickest way is the longest, */
    assert_near(height_of_top(0.9, 20, 80), 60, 1e-6);  /* though the leaf aside is large */
    assert_near(height_of_top(0.62, 50, 50), 26, 1e-6); /* scatter makes the way aside the better one: */
    assert_near(height_of_top(0.62, 95, 5), 60, 1e-6);  /* it is not, as hardly anything hangs there */
    assert_near(height_of_top(0.62, 200, 0), 60, 1e-6);
    assert_near(height_of_top(0.62, 20, 0), 26, 1e-6); /* specks on bare branches */
    assert_near(height_of_top(0.62, 80, 20), 26, 1e-6);
    assert_near(height_of_top(0.3, 95, 5), 26, 1e-6); /* what is too thin for a stem is none */
}

/* A sketch of 2000 points, so many of them tubes, in `petioles` of ten leaves; on a stem that is so straight (0: none). */
static drawing *draw_leaves(plm_habit habit, int tubes, int petioles, double straight)
{
    drawing *d = draw();
    for (int i = 0; i < 2000; i++) add_point(d, i, 0, i < tubes, i < tubes ? (petioles ? i % petioles : -1) : i % 10);
    d->node[1][2] = straight, d->along[1] = 1;
    d->sketch.habit = habit;
    d->sketch.leaf_count = 10;
    if (straight > 0) d->sketch.stem = (plm_stem_path){.count = 2, .node = d->node, .along = d->along};
    return d;
}

static bool judge(const drawing *d, bool is_told)
{
    plm_error error = {0};
    bool believed = false;
    assert_ok(plm_judge_tubes(&d->sketch, is_told, &believed, &error));
    return believed;
}

/* Whether doubtful tubes are believed; so many of 1000. */
static bool is_believed(plm_habit habit, int tubes, int petioles, double straight, bool is_told)
{
    drawing *d = draw_leaves(habit, 2 * tubes, petioles, straight);
    d->sketch.scale.is_doubtful = true;
    return judge(d, is_told);
}

/* The same of a rosette's sure ones. */
static bool is_sure(int tubes, int petioles)
{
    return judge(draw_leaves(PLM_HABIT_ROSETTE, tubes, petioles, 0), false);
}

static void a_straight_stem_with_petioles_is_believed(void **unused)
{
    (void)unused;
    assert_true(is_believed(PLM_HABIT_SIMPLE, 60, 6, 0.97, false));
    assert_true(is_believed(PLM_HABIT_COMPOUND, 110, 4, 0.91, false));
    assert_false(is_believed(PLM_HABIT_SIMPLE, 60, 6, 0.84, false));  /* turns as ways through heads do */
    assert_false(is_believed(PLM_HABIT_SIMPLE, 130, 6, 0.97, false)); /* rims look like tubes */
    assert_false(is_believed(PLM_HABIT_SIMPLE, 60, 3, 0.97, false));
    assert_false(is_believed(PLM_HABIT_SIMPLE, 60, 6, 0, false));
    assert_false(is_believed(PLM_HABIT_STRAP, 60, 6, 0.97, false));
    assert_false(is_believed(PLM_HABIT_HEAD, 60, 6, 0.97, false));
}

static void a_rosette_is_told_by_its_petioles(void **unused)
{
    (void)unused;
    assert_true(is_believed(PLM_HABIT_ROSETTE, 70, 8, 0, false));
    assert_false(is_believed(PLM_HABIT_ROSETTE, 70, 5, 0, false));
    assert_true(is_believed(PLM_HABIT_ROSETTE, 70, 5, 0, true));
    assert_true(is_sure(40, 4));
    assert_false(is_sure(40, 3));
    assert_true(is_sure(30, 5));
    assert_false(is_sure(15, 5)); /* a few points of noise on a single leaf */
}

/* A tube of radius 1, up which points wind in steps of 1.6 and 2.1 radians, beside a dense sheet; gives the radius that a ball tells. */
static double ball_value_on_tube(bool wide)
{
    plm_error error = {0};
    static float xyz[MOST][3];
    static plm_ball_shape shape[MOST];
    size_t count = 0;
    plm_graph graph = {0};
    for (int i = 0; i < 50; i++)
        for (int j = 0; j < 50; j++, count++) xyz[count][0] = 50 + (float)i, xyz[count][1] = (float)j;
    const size_t tube = count;
    for (int k = 0; k < 120; k++, count++) {
        xyz[count][0] = (float)cos(2.1 * k);
        xyz[count][1] = (float)sin(2.1 * k);
        xyz[count][2] = 1.6f * (float)k;
    }
    assert_ok(plm_ball_graph((const float(*)[3])xyz, count, 1, &graph, &error));
    if (wide) assert_ok(plm_graph_widen(&graph, &error));
    assert_ok(plm_ball_shapes(&graph, 6, shape, &error));
    plm_graph_free(&graph);
    const float *value = shape[tube + 60].value;
    return sqrt(value[1] + value[2]);
}

static void balls_reach_from_one_sparse_point_to_the_next(void **unused)
{
    (void)unused;
    assert_near(ball_value_on_tube(false), 0, 1e-6); /* a point by itself */
    assert_near(ball_value_on_tube(true), 1, 0.15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_stem_goes_up_to_the_last_leaf),
        cmocka_unit_test(few_tubes_are_a_stem_and_petioles),
        cmocka_unit_test(most_blades_hang_on_the_stem),
        cmocka_unit_test(a_straight_stem_with_petioles_is_believed),
        cmocka_unit_test(a_rosette_is_told_by_its_petioles),
        cmocka_unit_test(balls_reach_from_one_sparse_point_to_the_next),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
