/* The way up the stem that ran on into a petiole leaves it again: at a turn before leaflets that stand on it like leaves without
 * petioles of their own, and at a fork whose other branch is thicker. It does not end before the last internode, nor above a gap. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/stem_fit.h"
#include "segment/stem_rachis.h"
#include "support/virtual_plant.h"

#include <math.h>
#include <string.h>

static void check_soybean(const plm_scan_options *options, double stem)
{
    virtual_plant_assert_stem("soybean", stem, options);
}

static void leaflets_at_the_end_of_the_way_are_no_leaves(void **unused)
{
    (void)unused;
    check_soybean(
        &(plm_scan_options){
            .scanner = PLM_SCANNER_RGBD, .seed = 9101, .points = 45000, .noise = 5e-4, .views = 12, .outliers = 0.005},
        0.9);
}

/* The topmost leaf is young: its petiole is short, but the internode below it is as thick as the stem. */
static void the_last_internode_is_no_petiole_of_a_young_leaf(void **unused)
{
    (void)unused;
    check_soybean(
        &(plm_scan_options){
            .scanner = PLM_SCANNER_RGBD, .seed = 20001, .points = 45000, .noise = 5e-4, .views = 12, .outliers = 0.005},
        0.92);
}

/* The way up turned into the petiole of a leaf, which is longer than the rest of the stem: that bears two leaves. */
static void a_way_into_a_rachis_goes_back_to_the_stem(void **unused)
{
    (void)unused;
    check_soybean(
        &(plm_scan_options){
            .scanner = PLM_SCANNER_SPLAT, .seed = 21005, .points = 45000, .noise = 5e-4, .views = 60, .outliers = 0.01},
        0.9);
}

/* The topmost leaf's petiole goes on where the stem ends; its leaflets' own tubes are long for leaflets. */
static void the_stem_ends_below_the_leaflets_of_its_topmost_leaf(void **unused)
{
    (void)unused;
    check_soybean(
        &(plm_scan_options){
            .scanner = PLM_SCANNER_RGBD, .seed = 21001, .points = 45000, .noise = 5e-4, .views = 12, .outliers = 0.005},
        0.9);
}

/* The foot of a leaf bends the way to and fro: the turn back passed for one into a petiole, and the stem went on into that leaf's. */
static void a_turn_that_is_undone_leaves_no_stem(void **unused)
{
    (void)unused;
    check_soybean(
        &(plm_scan_options){
            .scanner = PLM_SCANNER_SPLAT, .seed = 59002, .points = 60000, .noise = 5e-4, .views = 60, .outliers = 0.01},
        0.9);
}

/* The way up led through a leaflet that touches, down to another leaf's petiole and up that one. */
static void a_way_that_turns_down_has_left_the_stem(void **unused)
{
    (void)unused;
    check_soybean(&(plm_scan_options){.scanner = PLM_SCANNER_RGBD,
                                      .seed = 25005,
                                      .points = 45000,
                                      .noise = 5e-4,
                                      .views = 12,
                                      .outliers = 0.005,
                                      .image_width = 1760},
                  0.9);
}

/* Noise makes rags of tube of a leaflet that the way ran into: single blades with long tubes, together, twice as far beyond the last
 * leaf as leaves are from each other. */
static void blades_together_far_beyond_the_leaves_are_leaflets(void **unused)
{
    (void)unused;
    check_soybean(&(plm_scan_options){.scanner = PLM_SCANNER_RGBD, .seed = 77006, .noise = 5e-4}, 0.9);
}

/* The way was right; a turn before the last leaf's foot was not. */
static void a_turn_taken_into_a_rachis_is_taken_back(void **unused)
{
    (void)unused;
    check_soybean(&(plm_scan_options){.scanner = PLM_SCANNER_RGBD, .seed = 78023, .noise = 9e-4}, 0.9);
}

/* Above the first leaves the scan has a gap, so that what is below is a piece of tube of its own. */
static void a_stem_goes_on_below_a_gap(void **unused)
{
    (void)unused;
    check_soybean(
        &(plm_scan_options){
            .scanner = PLM_SCANNER_SPLAT, .seed = 20002, .points = 45000, .noise = 5e-4, .views = 60, .outliers = 0.01},
        0.92);
}

enum { MOST = 6000, NODES = 200 };

/* A stem of radius 2 mm up to a fork at 60 mm; one branch goes straight on, the other leaves it by 0.4 radians; 60 mm each. */
typedef struct fork {
    float xyz[MOST][3];
    plm_tube_point point[MOST];
    bool is_tube[MOST];
    plm_sketch sketch;
} fork;

static void add_tube(fork *f, const double from[3], const double along[3], double length, double radius)
{
    double u[3], v[3];
    plm_frame_of_axis(along, u, v);
    for (double s = 0; s < length; s += 5e-4)
        for (int i = 0; i < 12; i++) {
            const size_t k = f->sketch.working.count++;
            const double turn = 2 * PLM_PI * (i + 0.5 * (double)(k / 12 % 2)) / 12;
            assert_true(k < MOST);
            for (int a = 0; a < 3; a++)
                f->xyz[k][a] = (float)(from[a] + s * along[a] + radius * (cos(turn) * u[a] + sin(turn) * v[a]));
            f->is_tube[k] = true;
            f->point[k].radius = (float)radius;
        }
}

static void add_nodes(plm_stem_path *stem, const double from[3], const double along[3], double length, double radius)
{
    for (double s = 0; s < length; s += 1e-3) {
        for (int a = 0; a < 3; a++) stem->node[stem->count][a] = from[a] + s * along[a];
        stem->radius[stem->count++] = radius;
    }
    plm_stem_measure_along(stem);
}

/* Radii of the branches; the way goes up the one that leaves the line. */
static fork *make_fork(double straight, double aside)
{
    static fork f;
    static const double base[3] = {0, 0, 0}, up[3] = {0, 0, 1}, node[3] = {0, 0, 0.06};
    const double out[3] = {sin(0.4), 0, cos(0.4)};
    plm_error error = {0};
    memset(&f, 0, sizeof f);
    f.sketch.working.xyz = f.xyz;
    f.sketch.point = f.point;
    f.sketch.is_tube = f.is_tube;
    f.sketch.scale = (plm_scale){.radius = 4e-3, .stem_radius = 2e-3, .noise = 2e-4};
    plm_stem_path *stem = &f.sketch.stem;
    stem->node = plm_alloc(NODES, sizeof *stem->node, &error);
    stem->radius = plm_alloc(NODES, sizeof *stem->radius, &error);
    stem->along = plm_alloc(NODES, sizeof *stem->along, &error);
    assert_true(stem->node && stem->radius && stem->along);
    add_tube(&f, base, up, 0.06, 2e-3);
    add_tube(&f, node, up, straight > 0 ? 0.06 : 0, straight);
    add_tube(&f, node, out, 0.06, aside);
    add_nodes(stem, base, up, 0.06, 2e-3);
    add_nodes(stem, node, out, 0.06, aside);
    return &f;
}

/* Gives how far beside the line the way ends. */
static double end_beside(fork *f)
{
    const plm_stem_path *stem = &f->sketch.stem;
    const double beside = stem->node[stem->count - 1][0];
    plm_stem_path_free(&f->sketch.stem);
    return beside;
}

static double leave_fork(double straight, double aside, bool *done)
{
    plm_error error = {0};
    fork *f = make_fork(straight, aside);
    assert_ok(plm_stem_leave_thin(&f->sketch, 8e-3, done, &error));
    return end_beside(f);
}

static void the_way_leaves_the_thinner_branch_of_a_fork(void **unused)
{
    (void)unused;
    bool done;
    assert_true(fabs(leave_fork(1.9e-3, 1.1e-3, &done)) < 1e-3);
    assert_true(done);
    assert_true(fabs(leave_fork(1.9e-3, 1.58e-3, &done)) < 1e-3); /* noise makes petioles of soybeans seem as thick */
    assert_true(done);
    assert_true(leave_fork(1.96e-3, 1.68e-3, &done) > 0.02);
    assert_false(done);
    assert_true(leave_fork(1.1e-3, 1.9e-3, &done) > 0.02); /* the stem turns there, and a petiole goes on */
    assert_false(done);
    assert_true(leave_fork(1.1e-3, 1.1e-3, &done) > 0.02); /* nothing tells */
    assert_false(done);
    assert_true(leave_fork(0, 1.1e-3, &done) > 0.02); /* a stem that thins has no other branch */
    assert_false(done);
}

/* A way that turns aside by so much, so far up a stem of 160 mm, for so long; gives how far beside the stem it ends. */
static double leave_turn(double up_to, double angle, double aside, bool *done)
{
    static const double base[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    const double node[3] = {0, 0, up_to}, out[3] = {sin(angle), 0, cos(angle)};
    plm_error error = {0};
    fork *f = make_fork(0, 1.1e-3);
    plm_stem_path *stem = &f->sketch.stem;
    f->sketch.working.count = stem->count = 0;
    add_tube(f, base, up, 0.16, 2e-3);
    add_tube(f, node, out, aside, 2e-3);
    add_nodes(stem, base, up, up_to, 2e-3);
    add_nodes(stem, node, out, aside, 2e-3);
    assert_ok(plm_stem_leave_turn(&f->sketch, done, &error));
    const double top = stem->node[stem->count - 1][2];
    if (*done) assert_true(fabs(top - 0.16) < 2e-3);
    return end_beside(f);
}

static void a_way_that_turns_sharply_into_the_topmost_leaf_goes_straight_on(void **unused)
{
    (void)unused;
    bool done;
    assert_true(fabs(leave_turn(0.15, 1.2, 0.022, &done)) < 1e-3);
    assert_true(done);
    assert_true(leave_turn(0.15, 0.5, 0.022, &done) > 8e-3); /* as a stem may */
    assert_false(done);
    assert_true(leave_turn(0.1, 1.2, 0.022, &done) > 8e-3); /* other rules tell what is lower */
    assert_false(done);
    assert_true(leave_turn(0.15, 1.2, 0.015, &done) > 8e-3); /* a leaflet of a leaf that the way has run into before */
    assert_false(done);
}

/* What hangs on the way, in mm: its foot, its tube and its blades. */
typedef struct hanging {
    double along, tube;
    size_t blades;
} hanging;

/* Whether a way that turns aside at 60 mm, above leaves of three leaflets at three places, leaves that branch for what hangs there. */
static bool leaves_rachis(const double leaf[3], const hanging *top, size_t count)
{
    plm_error error = {0};
    plm_side_group group[8] = {{0}};
    const plm_side_groups groups = {.count = 3 + count, .group = group};
    for (size_t g = 0; g < groups.count; g++) {
        const hanging it = g < 3 ? (hanging){leaf[g], 50, 3} : top[g - 3];
        group[g] = (plm_side_group){
            .has_foot = true, .along = 1e-3 * it.along, .blades = it.blades, .tube_length = 1e-3 * it.tube};
    }
    fork *f = make_fork(2e-3, 2e-3);
    bool done;
    assert_ok(plm_stem_leave_rachis(&f->sketch, &groups, 0.112, 3e-3, &done, &error));
    assert_true(done == (end_beside(f) < 1e-3));
    return done;
}

static void leaflets_are_told_by_short_tubes_or_by_their_place(void **unused)
{
    (void)unused;
    static const double leaf[3] = {20, 30, 40}, apart[3] = {10, 30, 50};
    assert_true(leaves_rachis(leaf, (const hanging[]){{100, 5, 1}, {105, 5, 1}}, 2));
    assert_false(
        leaves_rachis(leaf, (const hanging[]){{30, 5, 1}, {100, 5, 1}, {105, 5, 1}}, 3)); /* one among leaves */
    assert_true(leaves_rachis(leaf, (const hanging[]){{95, 15, 1}, {100, 17, 1}, {105, 10, 2}}, 3));
    assert_false(leaves_rachis(leaf, (const hanging[]){{100, 15, 3}}, 1));               /* a young leaf */
    assert_false(leaves_rachis(leaf, (const hanging[]){{75, 15, 1}, {105, 15, 1}}, 2));  /* two */
    assert_false(leaves_rachis(apart, (const hanging[]){{75, 15, 1}, {80, 15, 1}}, 2));  /* as far as others */
    assert_false(leaves_rachis(leaf, (const hanging[]){{100, 25, 1}, {105, 25, 1}}, 2)); /* with petioles */
}

/* Beyond the stem's end the way runs on in the petiole of the topmost leaf, and turns into a leaflet of that more sharply than it left the
 * stem. */
static void a_turn_into_a_leaflet_is_not_where_the_way_leaves_the_stem(void **unused)
{
    (void)unused;
    plm_error error = {0};
    fork *f = make_fork(0, 1.4e-3);
    plm_stem_path *stem = &f->sketch.stem;
    const double *end = stem->node[stem->count - 1], turned[3] = {sin(1.4), 0, cos(1.4)};
    const double from[3] = {end[0], end[1], end[2]};
    add_tube(f, from, turned, 0.015, 1.4e-3);
    add_nodes(stem, from, turned, 0.015, 1.4e-3);
    static const hanging hangs[] = {{20, 50, 3}, {35, 50, 3}, {50, 50, 3}, {121, 2, 1}, {124, 1, 2}};
    plm_side_group group[5] = {{0}};
    const plm_side_groups groups = {.count = 5, .group = group};
    for (size_t g = 0; g < 5; g++)
        group[g] = (plm_side_group){.has_foot = true,
                                    .along = 1e-3 * hangs[g].along,
                                    .blades = hangs[g].blades,
                                    .tube_length = 1e-3 * hangs[g].tube};
    bool done;
    assert_ok(plm_stem_leave_rachis(&f->sketch, &groups, 0.135, 3e-3, &done, &error));
    assert_true(done);
    print_message("the stem ends at %.1f mm\n", 1e3 * stem->along[stem->count - 1]);
    assert_true(stem->along[stem->count - 1] < 0.066);
    assert_true(end_beside(f) < 3e-3);
}

/* A way that turns aside for 4 mm, and then back (out: false) or on. */
static bool is_zigzag(bool back, size_t n)
{
    static const double up[3] = {0, 0, 1}, aside[3] = {0.38, 0, 0.92};
    double node[NODES][3], radius[NODES], along[NODES], from[3] = {0};
    plm_stem_path stem = {.node = node, .radius = radius, .along = along};
    const double *leg[] = {up, aside, back ? up : aside};
    const double length[] = {0.03, 0.004, 0.03};
    for (int k = 0; k < 3; k++) {
        add_nodes(&stem, from, leg[k], length[k], 2e-3);
        for (int a = 0; a < 3; a++) from[a] += length[k] * leg[k][a];
    }
    return plm_stem_zigzag(&stem, n ? n : stem.count - 10);
}

static void a_turn_that_is_undone_is_told(void **unused)
{
    (void)unused;
    assert_true(is_zigzag(true, 30));
    assert_false(is_zigzag(false, 30));
    assert_false(is_zigzag(true, 9)); /* too near to an end to tell */
    assert_false(is_zigzag(true, 0));
}

enum { UP, BENT, DOWN, ASIDE };

/* Arc length, in mm, at which a path of three legs of 40 mm turns down sharply; 0: it does not. */
static double hairpin_of(int first, int second, int third)
{
    static const double out[4][3] = {{0, 0, 1}, {0.6, 0, 0.8}, {0.6, 0, -0.8}, {1, 0, 0}};
    static double node[NODES][3], radius[NODES], along[NODES];
    const int leg[3] = {first, second, third};
    plm_stem_path stem = {.node = node, .radius = radius, .along = along};
    double from[3] = {0};
    for (int k = 0; k < 3; k++) {
        add_nodes(&stem, from, out[leg[k]], 0.04, 2e-3);
        for (int a = 0; a < 3; a++) from[a] += 0.04 * out[leg[k]][a];
    }
    const double at = plm_stem_hairpin(&stem);
    return isfinite(at) ? 1e3 * at : 0;
}

static void only_a_sharp_turn_down_in_the_upper_half_is_a_hairpin(void **unused)
{
    (void)unused;
    const double at = hairpin_of(UP, BENT, DOWN);
    assert_true(at > 70 && at < 82);
    assert_true(hairpin_of(UP, BENT, ASIDE) == 0);
    assert_true(hairpin_of(UP, DOWN, DOWN) == 0);
    assert_true(hairpin_of(DOWN, DOWN, ASIDE) == 0); /* a hanging stem that turns aside, ... */
    assert_true(hairpin_of(DOWN, DOWN, UP) == 0);    /* ... or up */
}

/* A cucumber with a stem of 79 mm among leaves 350 mm wide is taken for a rosette, but the user knows better. */
static void who_says_simple_gets_a_low_stem(void **unused)
{
    (void)unused;
    const plm_scan_options options = {.scanner = PLM_SCANNER_RGBD,
                                      .seed = 39004,
                                      .points = 45000,
                                      .noise = 5.207e-4,
                                      .outliers = 0.005,
                                      .image_width = 1110};
    virtual_plant made = virtual_plant_make("cucumber", 0, &options);
    const plm_cloud *cloud = &made.scan.cloud;
    plm_segmentation found = virtual_plant_as(&made, PLM_HABIT_SIMPLE);
    size_t stem = 0, seen = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        stem += cloud->label[i] == PLM_LABEL_STEM;
        seen += cloud->label[i] == PLM_LABEL_STEM && found.label[i] == PLM_LABEL_STEM;
    }
    print_message("%zu of %zu points of the stem, %zu leaves of %zu\n", seen, stem, found.leaf_count,
                  made.plant.leaf_count);
    assert_true(10 * seen > 9 * stem);
    assert_int_equal(found.leaf_count, made.plant.leaf_count);
    plm_segmentation_free(&found);
    virtual_plant_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        plant_case(leaflets_at_the_end_of_the_way_are_no_leaves),
        plant_case(the_last_internode_is_no_petiole_of_a_young_leaf),
        plant_case(a_way_into_a_rachis_goes_back_to_the_stem),
        plant_case(the_stem_ends_below_the_leaflets_of_its_topmost_leaf),
        plant_case(a_turn_that_is_undone_leaves_no_stem),
        plant_case(a_way_that_turns_down_has_left_the_stem),
        plant_case(blades_together_far_beyond_the_leaves_are_leaflets),
        plant_case(a_turn_taken_into_a_rachis_is_taken_back),
        plant_case(a_stem_goes_on_below_a_gap),
        cmocka_unit_test(only_a_sharp_turn_down_in_the_upper_half_is_a_hairpin),
        cmocka_unit_test(the_way_leaves_the_thinner_branch_of_a_fork),
        cmocka_unit_test(a_way_that_turns_sharply_into_the_topmost_leaf_goes_straight_on),
        cmocka_unit_test(leaflets_are_told_by_short_tubes_or_by_their_place),
        cmocka_unit_test(a_turn_into_a_leaflet_is_not_where_the_way_leaves_the_stem),
        cmocka_unit_test(a_turn_that_is_undone_is_told),
        plant_case(who_says_simple_gets_a_low_stem),
    };
    return run_cases(tests);
}
