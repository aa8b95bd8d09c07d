/* Fruit is no leaf: neither the trusses of a virtual tomato, nor one that a scan joined with a leaf; and no leaf is taken for a fruit. */
#include "support/test.h"

#include "cloud/linear.h"
#include "cloud/random.h"
#include "segment/balls.h"
#include "segment/fruit.h"
#include "support/virtual_plant.h"

enum { ROWS = 20000 };
static const double CELL = 2e-3, R = 0.02;

static void a_virtual_tomato_has_its_leaves_and_no_more(void **unused)
{
    (void)unused;
    static const struct {
        plm_scanner scanner;
        uint64_t seed;
        size_t points;
        double noise;
    } scan[] = {{PLM_SCANNER_UNIFORM, 71001, 60000, 0},
                {PLM_SCANNER_SPLAT, 71001, 60000, 5e-4},
                {PLM_SCANNER_DOME, 73114, 80000, 0}}; /* a leaf of the last one touches a truss */
    for (size_t k = 0; k < sizeof scan / sizeof *scan; k++) {
        const plm_scan_options options = {
            .scanner = scan[k].scanner, .seed = scan[k].seed, .points = scan[k].points, .noise = scan[k].noise};
        virtual_plant_assert_leaves("tomato_large", &options, 21);
    }
}

/* ---- Balls ------------------------------------------------------------------------------------------------------ */

typedef struct drawing {
    plm_sketch sketch;
    size_t count;
    float xyz[ROWS][3];
    bool may_be[ROWS], is_stem[ROWS], is_tube[ROWS], is_fruit[ROWS];
    int32_t leaf[ROWS], leaflet[ROWS], group[ROWS];
    plm_random random;
} drawing;

static void clear(drawing *d)
{
    memset(d, 0, sizeof *d);
    d->random = (plm_random){.key = plm_key(7, 0)};
}

static size_t add_point(drawing *d, double x, double y, double z, int32_t leaf)
{
    const size_t i = d->count++;
    assert_true(i < ROWS);
    d->xyz[i][0] = (float)x, d->xyz[i][1] = (float)y, d->xyz[i][2] = (float)z;
    d->may_be[i] = true;
    d->leaf[i] = leaf;
    d->leaflet[i] = leaf;
    d->group[i] = leaf;
    return i;
}

/* A spheroid about (x, 0, z), a point each square of the cell, as much of its height as is seen, points off by noise. */
static void add_ball(drawing *d, double x, double z, double radius, double flat, double seen, double noise,
                     int32_t leaf)
{
    const int points = (int)(seen * 4 * PLM_PI * radius * radius / (CELL * CELL));
    for (int k = 0; k < points; k++) {
        const double up = 1 - 2 * seen * plm_draw(&d->random), turn = 2 * PLM_PI * plm_draw(&d->random);
        const double r = radius + noise * plm_draw_normal(&d->random), across = r * sqrt(fmax(1 - up * up, 0));
        d->is_fruit[add_point(d, x + across * cos(turn), across * sin(turn), z + flat * r * up, leaf)] = true;
    }
}

/* A sheet from (x, -width / 2, z), curled about its length by so many radians over its width. */
static void add_sheet(drawing *d, double x, double z, double length, double width, double curl, int32_t leaf)
{
    const int points = (int)(length * width / (CELL * CELL));
    for (int k = 0; k < points; k++) {
        const double s = length * plm_draw(&d->random), t = plm_draw(&d->random) - 0.5;
        const double turn = fmax(curl, 1e-3), bend = width / turn;
        add_point(d, x + s, bend * sin(turn * t), z + bend * (1 - cos(turn * t)), leaf);
    }
}

static size_t find(drawing *d, double noise, plm_ball **ball)
{
    plm_error error = {0};
    size_t found = 0;
    const plm_ball_query query = {.xyz = (const float(*)[3])d->xyz,
                                  .count = d->count,
                                  .may_be = d->may_be,
                                  .cell = CELL,
                                  .noise = noise,
                                  .least_radius = 0.008,
                                  .most_radius = 0.04};
    assert_ok(plm_balls_find(&query, ball, &found, &error));
    return found;
}

static void balls_are_found_where_they_are(void **unused)
{
    (void)unused;
    static drawing d;
    static const double noise[] = {0, 5e-4}, x[] = {0, 0.031, 0.3}, radius[] = {0.015, 0.016, 0.025};
    for (size_t n = 0; n < 2; n++) {
        clear(&d);
        for (size_t k = 0; k < 3; k++) add_ball(&d, x[k], 0, radius[k], k == 2 ? 0.9 : 1, 0.75, noise[n], 0);
        plm_ball *ball;
        assert_int_equal(find(&d, noise[n], &ball), 3);
        for (size_t k = 0; k < 3; k++) {
            size_t near = 0;
            for (size_t b = 1; b < 3; b++)
                if (fabs(ball[b].centre[0] - x[k]) < fabs(ball[near].centre[0] - x[k])) near = b;
            print_message("noise %.1f mm, ball %zu: radius %.2f mm for %.2f, off by %.2f mm\n", 1e3 * noise[n], k,
                          1e3 * ball[near].radius, 1e3 * radius[k], 1e3 * fabs(ball[near].centre[0] - x[k]));
            assert_true(fabs(ball[near].centre[0] - x[k]) < 5e-4);
            assert_true(fabs(ball[near].radius - radius[k]) < 0.07 * radius[k]);
        }
        plm_free(ball);
    }
}

/* The rim of a bowl spills into directions beside it, most where points are few: turned as it may be, it is none, nor beside a ball. */
static void a_bowl_is_no_ball(void **unused)
{
    (void)unused;
    static drawing d;
    size_t alone = 0, beside = 0, tried = 0;
    for (int beside_one = 0; beside_one < 2; beside_one++)
        for (int k = 0; k < 30; k++) {
            plm_ball *ball;
            clear(&d);
            d.random = (plm_random){.key = plm_key(7, (uint64_t)k)};
            add_ball(&d, 0, 0, k % 2 ? 0.0085 : 0.012, 1, beside_one ? 0.3 : 0.4, 0, 0);
            const double axis[3] = {plm_draw_normal(&d.random), plm_draw_normal(&d.random), plm_draw_normal(&d.random)};
            double u[3], v[3], w[3];
            memcpy(w, axis, sizeof w);
            plm_normalise(w);
            plm_frame_of_axis(w, u, v);
            for (size_t i = 0; i < d.count; i++) {
                const double p[3] = {d.xyz[i][0], d.xyz[i][1], d.xyz[i][2]};
                for (int a = 0; a < 3; a++) d.xyz[i][a] = (float)(p[0] * u[a] + p[1] * v[a] + p[2] * w[a]);
            }
            if (beside_one) add_ball(&d, 0.026, 0, 0.015, 1, 1, 0, 0);
            const size_t found = find(&d, 0, &ball);
            *(beside_one ? &beside : &alone) += found - (size_t)beside_one;
            tried++;
            plm_free(ball);
        }
    print_message("of %zu bowls %zu pass alone, %zu beside a ball\n", tried, alone, beside);
    assert_int_equal(alone, 0);
    assert_int_equal(beside, 0);
}

/* What is seen from one side passes beside one that tells that there is fruit. */
static void a_half_counts_only_beside_another(void **unused)
{
    (void)unused;
    static drawing d;
    plm_ball *ball;
    clear(&d);
    add_ball(&d, 0, 0, 0.015, 1, 0.44, 0, 0);
    assert_int_equal(find(&d, 0, &ball), 0);
    plm_free(ball);
    add_ball(&d, 0.035, 0, 0.015, 1, 1, 0, 0);
    assert_int_equal(find(&d, 0, &ball), 2);
    plm_free(ball);
    for (size_t i = 0; i < d.count; i++) d.may_be[i] = false;
    assert_int_equal(find(&d, 0, &ball), 0);
    plm_free(ball);
}

static void leaves_are_no_balls(void **unused)
{
    (void)unused;
    static drawing d;
    static const double curl[] = {0, 2, 4, 6};
    plm_ball *ball;
    for (size_t k = 0; k < sizeof curl / sizeof *curl; k++) { /* flat, and rolled to a tube */
        clear(&d);
        add_sheet(&d, 0, 0, 0.1, 0.08, curl[k], 0);
        assert_int_equal(find(&d, 0, &ball), 0);
        plm_free(ball);
    }
    clear(&d); /* a bowl */
    add_ball(&d, 0, 0, 0.02, 1, 0.45, 0, 0);
    assert_int_equal(find(&d, 0, &ball), 0);
    plm_free(ball);
    clear(&d); /* full of leaves: a head, or a bud */
    for (int k = 3; k <= 10; k++) add_ball(&d, 0, 0, 0.003 * k, 1, 1, 0, 0);
    assert_int_equal(find(&d, 0, &ball), 0);
    plm_free(ball);
    clear(&d);
    assert_int_equal(find(&d, 0, &ball), 0);
    plm_free(ball);
}

/* ---- On a plant ------------------------------------------------------------------------------------------------- */

static void add_tube(drawing *d, double x, double z, double length, bool is_stem, int32_t leaf)
{
    for (int k = 0; k < (int)(length / CELL); k++)
        for (int side = -1; side <= 1; side += 2) {
            const double up = is_stem ? k * CELL : 0, out = is_stem ? 0 : k * CELL;
            const size_t i = add_point(d, x + out, side * 1e-3, z + up, leaf);
            d->is_tube[i] = true;
            d->is_stem[i] = is_stem;
        }
}

/* Leaf 0; a truss of balls as leaf 1; leaf 2, with a ball that was joined with it if so. */
static void draw_plant(drawing *d, bool joined)
{
    clear(d);
    add_tube(d, 0, 0, 0.6, true, -1);
    add_tube(d, 0.005, 0.1, 0.05, false, 0);
    add_sheet(d, 0.05, 0.1, 0.1, 0.08, 1, 0);
    const size_t stalk = d->count;
    add_tube(d, 0.005, 0.3, 0.05, false, 1);
    for (size_t i = stalk; i < d->count; i++) d->is_fruit[i] = true;
    for (int k = 0; k < 3; k++) add_ball(d, 0.075 + 0.033 * k, 0.3, 0.015, 1, 0.8, 0, 1);
    add_tube(d, 0.005, 0.5, 0.05, false, 2);
    add_sheet(d, 0.05, 0.5, 0.12, 0.08, 1, 2);
    if (joined) add_ball(d, 0.1, 0.478, 0.015, 1, 0.8, 0, 2);
    d->sketch.leaf_count = 3;
    d->sketch.working = (plm_thinned){.cell = CELL, .count = d->count, .xyz = d->xyz};
    d->sketch.scale = (plm_scale){.radius = R, .size = 0.6};
    d->sketch.stem.count = 2;
    d->sketch.habit = PLM_HABIT_COMPOUND;
    d->sketch.leaf = d->leaf;
    d->sketch.leaflet = d->leaflet;
    d->sketch.group = d->group;
    d->sketch.is_tube = d->is_tube;
    d->sketch.is_stem = d->is_stem;
}

/* As on a plant, but for the leaves, which stay as drawn while fruit is apart. */
static void take_fruit_off(drawing *d)
{
    plm_error error = {0};
    plm_fruit fruit;
    assert_ok(plm_sketch_link(&d->sketch, 3, &d->sketch.graph, &error));
    assert_ok(plm_fruit_find(&d->sketch, &fruit, &error));
    if (fruit.bunches) assert_ok(plm_fruit_part(&d->sketch, &fruit, &error));
    const plm_graph *graph = &d->sketch.graph;
    for (size_t i = 0; fruit.bunches && i < d->count; i++)
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++)
            assert_int_equal(fruit.bunch[i], fruit.bunch[graph->edge[e]]);
    assert_ok(plm_fruit_take_off(&d->sketch, &fruit, &error));
    plm_fruit_free(&fruit);
    plm_graph_free(&d->sketch.graph);
}

static void fruit_is_taken_off_the_leaves(void **unused)
{
    (void)unused;
    static drawing d;
    static const int32_t number[] = {0, -1, 1};
    for (int joined = 0; joined < 2; joined++) {
        draw_plant(&d, joined);
        static int32_t was[ROWS];
        memcpy(was, d.leaf, sizeof was);
        take_fruit_off(&d);
        assert_int_equal(d.sketch.leaf_count, 2);
        size_t wrong = 0;
        for (size_t i = 0; i < d.count; i++) {
            const int32_t right = d.is_fruit[i] || was[i] < 0 ? -1 : number[was[i]];
            wrong += d.leaf[i] != right;
            assert_int_equal(d.is_stem[i], was[i] < 0);
            if (d.leaf[i] < 0 && !d.is_stem[i]) assert_true(!d.is_tube[i] && d.leaflet[i] == -1);
        }
        print_message("%s: %zu of %zu points are on the wrong side\n", joined ? "joined" : "apart", wrong, d.count);
        assert_int_equal(wrong, 0);
    }
}

/* Fruit is more than half of it, and yet it is a leaf. */
static void a_leaf_among_fruit_stays(void **unused)
{
    (void)unused;
    static drawing d;
    draw_plant(&d, false);
    add_ball(&d, 0.174, 0.3, 0.015, 1, 0.8, 0, 1);
    add_sheet(&d, 0.05, 0.27, 0.07, 0.06, 1, 1);
    d.sketch.working.count = d.count;
    take_fruit_off(&d);
    assert_int_equal(d.sketch.leaf_count, 3);
    size_t left = 0;
    for (size_t i = 0; i < d.count; i++) left += d.leaf[i] == 1 && !d.is_tube[i];
    print_message("%zu points of the leaf among fruit are left\n", left);
    assert_int_equal(left, (size_t)(0.07 * 0.06 / (CELL * CELL)));
}

/* A blade that lies against a fruit has no hole for it. */
static void a_leaf_that_touches_fruit_stays_whole(void **unused)
{
    (void)unused;
    static drawing d;
    draw_plant(&d, false);
    const size_t first = d.count;
    add_sheet(&d, 0.05, 0.3165, 0.1, 0.006, 0, 2);
    d.sketch.working.count = d.count;
    take_fruit_off(&d);
    assert_int_equal(d.sketch.leaf_count, 2);
    for (size_t i = first; i < d.count; i++) assert_int_equal(d.leaf[i], 1);
}

/* What has no stem is a rosette or a head; a grass's leaf may be furled to a ball. */
static void other_plants_keep_all(void **unused)
{
    (void)unused;
    static drawing d;
    draw_plant(&d, true);
    d.sketch.stem.count = 0;
    take_fruit_off(&d);
    assert_int_equal(d.sketch.leaf_count, 3);
    d.sketch.stem.count = 2;
    d.sketch.habit = PLM_HABIT_STRAP;
    take_fruit_off(&d);
    assert_int_equal(d.sketch.leaf_count, 3);
}

/* Bunches that touch every leaf: the truss that is left is none, large ones stay. */
static void leaves_stay_though_all_touch_fruit(void **unused)
{
    (void)unused;
    static drawing d;
    static int32_t bunch[ROWS];
    size_t size[] = {5000};
    plm_link touch[3] = {{0}};
    plm_error error = {0};
    draw_plant(&d, false);
    for (size_t i = 0; i < d.count; i++) {
        bunch[i] = d.is_fruit[i] && !d.is_tube[i] ? 0 : -1;
        if (bunch[i] < 0 && d.leaf[i] >= 0) touch[d.leaf[i]].b = (uint32_t)i;
        for (int k = 0; k < 3 && bunch[i] >= 0; k++) touch[k].a = (uint32_t)i;
    }
    const plm_fruit fruit = {.bunches = 1, .bunch = bunch, .size = size, .touches = 3, .touch = touch};
    assert_ok(plm_fruit_take_off(&d.sketch, &fruit, &error));
    assert_int_equal(d.sketch.leaf_count, 2);
    for (size_t i = 0; i < d.count; i++)
        if (d.is_fruit[i]) assert_true(d.leaf[i] < 0 && !d.is_tube[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_virtual_tomato_has_its_leaves_and_no_more),
        cmocka_unit_test(balls_are_found_where_they_are),
        cmocka_unit_test(a_half_counts_only_beside_another),
        cmocka_unit_test(a_bowl_is_no_ball),
        cmocka_unit_test(leaves_are_no_balls),
        cmocka_unit_test(fruit_is_taken_off_the_leaves),
        cmocka_unit_test(leaves_stay_though_all_touch_fruit),
        cmocka_unit_test(a_leaf_among_fruit_stays),
        cmocka_unit_test(a_leaf_that_touches_fruit_stays_whole),
        cmocka_unit_test(other_plants_keep_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
