/* Blades that touch: each foot goes on in the tip that lies on its arc, and a strip that was not seen makes no leaf of a part of a blade. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/merge_tree.h"
#include "segment/stem_fit.h"
#include "segment/strap_feet.h"
#include "segment/strap_match.h"
#include "segment/strap_trunk.h"

enum { ROWS = 20000, NODES = 40 };
static const double STEP = 3e-3, SIZE = 1, STEM = 8e-3, HEIGHT = 0.34;

typedef struct drawing {
    plm_sketch sketch;
    float xyz[ROWS][3], distance[ROWS];
    int32_t leaf[ROWS], branch[ROWS], truth[ROWS];
    bool is_stem[ROWS], is_tube[ROWS], beyond[ROWS];
    uint64_t state;
} drawing;

static void add_point(drawing *d, double x, double y, double z, int32_t leaf)
{
    const size_t i = d->sketch.working.count++;
    assert_true(i < ROWS);
    d->xyz[i][0] = (float)(x + 0.3 * STEP * (test_uniform(&d->state) - 0.5));
    d->xyz[i][1] = (float)(y + 0.3 * STEP * (test_uniform(&d->state) - 0.5));
    d->xyz[i][2] = (float)(z + 0.3 * STEP * (test_uniform(&d->state) - 0.5));
    d->truth[i] = leaf;
    d->is_stem[i] = d->is_tube[i] = leaf < 0;
}

static void start(drawing *d)
{
    memset(d, 0, sizeof *d);
    plm_sketch *s = &d->sketch;
    d->state = 3;
    s->leaf = d->leaf;
    s->is_stem = d->is_stem;
    s->is_tube = d->is_tube;
    s->working.xyz = d->xyz;
    s->working.cell = STEP;
    s->scale = (plm_scale){.radius = 0.03, .stem_radius = STEM, .noise = 1e-4, .size = SIZE, .spacing = STEP};
    s->stem.count = NODES;
    s->stem.node = calloc(NODES, sizeof *s->stem.node);
    s->stem.radius = calloc(NODES, sizeof *s->stem.radius);
    s->stem.along = calloc(NODES, sizeof *s->stem.along);
    assert_true(s->stem.node && s->stem.radius && s->stem.along);
    for (size_t n = 0; n < NODES; n++) {
        s->stem.node[n][2] = HEIGHT * (double)n / (NODES - 1);
        s->stem.radius[n] = STEM;
    }
    plm_stem_measure_along(&s->stem);
    for (double z = 0; z < HEIGHT; z += STEP)
        for (int k = 0; k < 18; k++) add_point(d, STEM * cos(k * PLM_PI / 9), STEM * sin(k * PLM_PI / 9), z, -1);
}

/* A blade from the stem at z, that rises by rise[0] x + rise[1] x^2 and runs aside by side x, x up to reach; slit: up to there its middle
 * was not seen. */
static void add_blade(drawing *d, double z, double reach, const double rise[2], double side, double slit, int32_t leaf)
{
    const double half = 0.024;
    for (double x = STEM; x < reach; x += 0.6 * STEP / hypot(1, rise[0] + 2 * rise[1] * x))
        for (double y = -half; y <= half; y += STEP)
            if (x > slit || x < 2 * STEM || fabs(y) > 0.8 * half)
                add_point(d, x, y + side * (x - STEM), z + rise[0] * x + rise[1] * x * x, leaf);
}

static void finish(drawing *d)
{
    plm_error error = {0};
    plm_sketch *s = &d->sketch;
    static uint32_t source[ROWS];
    plm_walk walk = {.source = source, .distance = d->distance};
    assert_ok(plm_graph_build((const float(*)[3])d->xyz, s->working.count, 10, 2.2 * STEP, &s->graph, &error));
    for (uint32_t i = 0; i < s->working.count; i++)
        if (d->is_stem[i] && d->xyz[i][2] < STEP) source[walk.source_count++] = i;
    assert_ok(plm_graph_walk(&s->graph, &walk, &error));
}

static void free_drawing(drawing *d)
{
    plm_graph_free(&d->sketch.graph);
    plm_stem_path_free(&d->sketch.stem);
}

/* Share of the blades' points that are of the leaf that most of their own blade's tip is of. */
static double share_right(const drawing *d, size_t blades)
{
    size_t right = 0, all = 0;
    for (size_t b = 0; b < blades; b++) {
        int32_t own = -1;
        float far = 0;
        for (size_t i = 0; i < d->sketch.working.count; i++)
            if (d->truth[i] == (int32_t)b && isfinite(d->distance[i]) && d->distance[i] > far)
                far = d->distance[i], own = d->leaf[i];
        for (size_t i = 0; i < d->sketch.working.count; i++)
            if (d->truth[i] == (int32_t)b) right += own >= 0 && d->leaf[i] == own, all++;
    }
    return (double)right / (double)all;
}

/* Two blades from 0.22 and 0.3 touch; the one with the longer tip was given all that lies below. */
static void assert_legs_go_on(const double low[2], const double high[2], double most_before, double least_after)
{
    static drawing d;
    plm_error error = {0};
    start(&d);
    add_blade(&d, 0.22, 0.6, low, 0, 0, 0);
    add_blade(&d, 0.3, 0.55, high, 0.05, 0, 1);
    finish(&d);
    size_t leaves = 0;
    assert_ok(plm_merge_tree(&d.sketch.graph, d.distance, 0.08 * SIZE, 80, d.branch, &leaves, &error));
    assert_int_equal(leaves, 2);
    double foot[2 + PLM_STRAP_FEET_MOST] = {INFINITY, INFINITY};
    bool apart = false;
    for (size_t i = 0; i < d.sketch.working.count; i++)
        d.leaf[i] = d.truth[i] < 0 ? -1 : d.branch[i] >= 0 ? d.branch[i] : 0;
    const double before = share_right(&d, 2);
    assert_ok(plm_strap_feet(&d.sketch, d.distance, d.branch, d.beyond, foot, &leaves, &apart, &error));
    assert_true(apart);
    assert_int_equal(leaves, 2);
    assert_ok(plm_strap_beyond(&d.sketch, d.beyond, &error));
    const double after = share_right(&d, 2);
    print_message("%.3f of the blades right before, %.3f after\n", before, after);
    assert_true(before < most_before && after > least_after);
    assert_true(fabs(foot[0] - foot[1]) > 0.05 && fmax(foot[0], foot[1]) < 0.5);
    free_drawing(&d);
}

static void legs_go_on_in_their_own_tips(void **unused)
{
    (void)unused;
    assert_legs_go_on((const double[]){0.81, -0.6}, (const double[]){0.75, -1.1}, 0.75, 0.93);
}

/* They cross so near to the stem that the upper foot is a leg of 0.05 only. */
static void a_tip_beyond_a_low_touch_finds_its_foot(void **unused)
{
    (void)unused;
    assert_legs_go_on((const double[]){1.9, -0.9}, (const double[]){0.6, -0.4}, 0.96, 0.98);
}

/* The middle of a blade was not seen near its foot: two legs, of which neither is as wide as a leaf. */
static void a_slit_makes_no_two_leaves(void **unused)
{
    (void)unused;
    static drawing d;
    plm_error error = {0};
    start(&d);
    add_blade(&d, 0.1, 0.6, (const double[]){1.2, -0.75}, 0, 0.24, 0);
    add_blade(&d, 0.3, 0.5, (const double[]){1.3, -0.5}, 0, 0, 1); /* tells how wide leaves are */
    finish(&d);
    size_t leaves = 2;
    double foot[2 + PLM_STRAP_FEET_MOST] = {INFINITY, INFINITY};
    bool apart = true;
    /* its margins begin at different heights */
    for (size_t i = 0; i < d.sketch.working.count; i++) {
        const bool is_low = d.truth[i] == 0 && d.xyz[i][1] > 0 && d.xyz[i][0] < 0.1;
        d.leaf[i] = d.branch[i] = is_low ? -1 : d.truth[i];
    }
    assert_ok(plm_strap_feet(&d.sketch, d.distance, d.branch, d.beyond, foot, &leaves, &apart, &error));
    assert_false(apart);
    assert_int_equal(leaves, 2);
    free_drawing(&d);
}

/* Nothing else tells how wide leaves are. */
static void two_legs_of_an_only_leaf_come_apart(void **unused)
{
    (void)unused;
    static drawing d;
    plm_error error = {0};
    start(&d);
    add_blade(&d, 0.22, 0.6, (const double[]){0.81, -0.6}, 0, 0, 0);
    add_blade(&d, 0.3, 0.55, (const double[]){0.75, -1.1}, 0.05, 0, 0);
    finish(&d);
    size_t leaves = 1;
    double foot[1 + PLM_STRAP_FEET_MOST] = {INFINITY};
    bool apart = false;
    for (size_t i = 0; i < d.sketch.working.count; i++) d.leaf[i] = d.branch[i] = d.truth[i];
    assert_ok(plm_strap_feet(&d.sketch, d.distance, d.branch, d.beyond, foot, &leaves, &apart, &error));
    assert_true(apart);
    assert_int_equal(leaves, 2);
    size_t points[2] = {0};
    for (size_t i = 0; i < d.sketch.working.count; i++)
        if (d.leaf[i] >= 0) points[d.leaf[i]]++;
    assert_true(points[0] > 500 && points[1] > 500);
    leaves = 0; /* no leaf at all */
    for (size_t i = 0; i < d.sketch.working.count; i++) d.leaf[i] = d.branch[i] = -1;
    assert_ok(plm_strap_feet(&d.sketch, d.distance, d.branch, d.beyond, foot, &leaves, &apart, &error));
    assert_false(apart);
    assert_int_equal(leaves, 0);
    free_drawing(&d);
}

/* Points of an arc from way to way, in a band about it. */
static plm_strap_piece piece_of(const double gain[3][3], double from, double to)
{
    plm_strap_piece piece = {0};
    for (int k = 0; k <= 200; k++) {
        const double way = from + (to - from) * k / 200;
        double place[3];
        for (int axis = 0; axis < 3; axis++) place[axis] = gain[axis][0] + way * (gain[axis][1] + way * gain[axis][2]);
        place[1] += 0.02 * (k % 5 - 2);
        plm_strap_piece_add(&piece, way, place);
    }
    return piece;
}

static const double ARCS[3][3][3] = {{{0, 0.8, 0}, {0, 0, 0}, {0.1, 0.9, -0.8}},
                                     {{0, 0.8, 0}, {0, 0.1, 0}, {0.25, 0.6, -1}},
                                     {{0, 0.7, 0}, {0, -0.1, 0}, {0.3, 0.9, -0.4}}};

static void feet_and_tips_of_arcs_are_matched(void **unused)
{
    (void)unused;
    plm_strap_piece leg[3], tip[3];
    int tip_of_leg[3];
    for (int k = 0; k < 3; k++) {
        leg[k] = piece_of(ARCS[k], 0, 0.3);
        tip[k] = piece_of(ARCS[(k + 1) % 3], 0.5, 0.8);
    }
    plm_strap_match(leg, 3, tip, 3, tip_of_leg);
    for (int k = 0; k < 3; k++) assert_int_equal(tip_of_leg[k], (k + 2) % 3);
    plm_strap_match(leg, 3, tip, 2, tip_of_leg); /* of blades 1 and 2 */
    assert_int_equal(tip_of_leg[0], -1);
    assert_int_equal(tip_of_leg[1], 0);
    assert_int_equal(tip_of_leg[2], 1);
    plm_strap_match(leg, 1, tip, 3, tip_of_leg);
    assert_int_equal(tip_of_leg[0], 2);
    plm_strap_arc arc;
    assert_true(plm_strap_find_arc(&leg[0], &tip[2], &arc));
    const double on[3] = {0.32, 0, 0.1 + 0.9 * 0.4 - 0.8 * 0.16}, off[3] = {0.32, 0.1, on[2]};
    assert_true(plm_strap_arc_distance(&arc, 0.43, on) < 5e-3);
    assert_true(fabs(plm_strap_arc_distance(&arc, 0.43, off) - 0.1) < 5e-3);
}

/* A piece of one point or none lies on every arc and tells none. */
static void pieces_without_points_match_nothing(void **unused)
{
    (void)unused;
    plm_strap_piece leg[2] = {{.squares = 0}, {.squares = 0}}, tip[2] = {{.squares = 0}, {.squares = 0}};
    int tip_of_leg[2];
    plm_strap_arc arc;
    plm_strap_match(leg, 2, tip, 2, tip_of_leg);
    assert_int_equal(tip_of_leg[0], -1);
    assert_int_equal(tip_of_leg[1], -1);
    assert_false(plm_strap_find_arc(&leg[0], NULL, &arc));
    plm_strap_piece_add(&leg[0], 0.1, (const double[]){1, 2, 3});
    assert_false(plm_strap_find_arc(&leg[0], &tip[0], &arc));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(legs_go_on_in_their_own_tips),      cmocka_unit_test(a_tip_beyond_a_low_touch_finds_its_foot),
        cmocka_unit_test(a_slit_makes_no_two_leaves),        cmocka_unit_test(two_legs_of_an_only_leaf_come_apart),
        cmocka_unit_test(feet_and_tips_of_arcs_are_matched), cmocka_unit_test(pieces_without_points_match_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
