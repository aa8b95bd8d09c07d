/* The stem of a strap plant is its closed tube, whatever the rough path took for its radius. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/stem_fit.h"
#include "segment/strap_stem.h"

enum { NODES = 90, ROWS = 20000 };
static const double RADIUS = 4e-3, HEIGHT = 0.12, STEP = 1.5e-3;

typedef struct drawing {
    plm_sketch sketch;
    float xyz[ROWS][3];
    int32_t leaf[ROWS];
    bool is_stem[ROWS], is_tube[ROWS];
} drawing;

static size_t add_point(drawing *d, double x, double y, double z, int32_t leaf)
{
    const size_t i = d->sketch.working.count++;
    assert_true(i < ROWS);
    d->xyz[i][0] = (float)x;
    d->xyz[i][1] = (float)y;
    d->xyz[i][2] = (float)z;
    d->leaf[i] = leaf;
    d->is_stem[i] = d->is_tube[i] = leaf < 0;
    return i;
}

static void start(drawing *d, double radius)
{
    plm_sketch *s = &d->sketch;
    memset(d, 0, sizeof *d);
    s->leaf = d->leaf;
    s->is_stem = d->is_stem;
    s->is_tube = d->is_tube;
    s->working.xyz = d->xyz;
    s->working.cell = 6e-4;
    s->scale = (plm_scale){.radius = 6e-3, .stem_radius = radius, .noise = 1e-4, .size = 0.3, .spacing = 6e-4};
    s->stem.count = NODES;
    s->stem.node = calloc(NODES, sizeof *s->stem.node);
    s->stem.radius = calloc(NODES, sizeof *s->stem.radius);
    s->stem.along = calloc(NODES, sizeof *s->stem.along);
    assert_true(s->stem.node && s->stem.radius && s->stem.along);
    for (size_t n = 0; n < NODES; n++) s->stem.radius[n] = radius;
}

/* A stem, half of which a leaf has for its own, and that leaf; the rough path runs up on the stem's surface, with such a radius. */
static void draw(drawing *d, double radius)
{
    plm_sketch *s = &d->sketch;
    uint64_t state = 11;
    start(d, radius);
    for (size_t k = 0; k < 6000; k++) {
        const double way = 2 * PLM_PI * test_uniform(&state), z = HEIGHT * test_uniform(&state);
        const double r = RADIUS * (1 + 0.08 * cos(3 * way)) + 4e-4 * (test_uniform(&state) - 0.5);
        add_point(d, r * cos(way), r * sin(way), z, cos(way) > 0.2 ? 0 : -1);
    }
    for (size_t k = 0; k < 8000; k++) {
        const double along = 0.15 * test_uniform(&state), side = 0.02 * (test_uniform(&state) - 0.5);
        add_point(d, 0.012 + along, side, 0.09 + 0.6 * along, 0);
    }
    for (size_t n = 0; n < NODES; n++) {
        s->stem.node[n][0] = -0.9 * RADIUS + 5e-4 * sin(0.7 * (double)n);
        s->stem.node[n][1] = 5e-4 * cos(0.4 * (double)n);
        s->stem.node[n][2] = STEP * (double)n;
    }
    plm_stem_measure_along(&s->stem);
}

/* So much of the stem, from z on, leaning by so much towards x. */
static void add_tube(drawing *d, double z, double length, double lean, size_t count, int32_t leaf, uint64_t *state)
{
    for (size_t k = 0; k < count; k++) {
        const double way = 2 * PLM_PI * test_uniform(state), along = length * test_uniform(state);
        const double r = RADIUS + 4e-4 * (test_uniform(state) - 0.5), out = r * cos(way);
        add_point(d, along * sin(lean) + out * cos(lean), r * sin(way), z + along * cos(lean) - out * sin(lean), leaf);
    }
}

static void add_blade(drawing *d, double x, double z, double lean, double length, size_t count, int32_t leaf,
                      uint64_t *state)
{
    for (size_t k = 0; k < count; k++) {
        const double along = length * test_uniform(state), side = 0.016 * (test_uniform(state) - 0.5);
        add_point(d, x + along * sin(lean), side, z + along * cos(lean), leaf);
    }
}

/* The rough path goes straight up to half of the stem, and then leans. */
static void set_path(drawing *d, double lean)
{
    plm_stem_path *stem = &d->sketch.stem;
    for (size_t n = 0; n < NODES; n++) {
        const double s = STEP * (double)n, beyond = fmax(s - HEIGHT / 2, 0);
        stem->node[n][0] = beyond * sin(lean);
        stem->node[n][2] = fmin(s, HEIGHT / 2) + beyond * cos(lean);
    }
    plm_stem_measure_along(stem);
}

static void assert_is_tube(double radius)
{
    static drawing d;
    plm_error error = {0};
    double shape;
    draw(&d, radius);
    assert_ok(plm_strap_stem(&d.sketch, 1, &shape, &error));
    size_t missed = 0, taken = 0;
    for (size_t i = 0; i < d.sketch.working.count; i++) {
        const bool is_tube = hypot(d.xyz[i][0], d.xyz[i][1]) < 1.2 * RADIUS;
        missed += is_tube && !d.is_stem[i];
        taken += !is_tube && d.is_stem[i];
    }
    const double found = d.sketch.stem.radius[d.sketch.stem.count / 2];
    print_message("from %.2f to %.2f mm: %zu points of the tube missed, %zu of the leaf taken\n", 1e3 * radius,
                  1e3 * found, missed, taken);
    assert_true(missed < 60 && taken < 10);
    assert_true(fabs(found - RADIUS) < 0.03 * RADIUS);
    plm_stem_path_free(&d.sketch.stem);
}

static void a_radius_about_right_stays(void **unused)
{
    (void)unused;
    assert_is_tube(3.6e-3);
}

/* Balls that see curled leaves best are too small for the stem. */
static void a_stem_wider_than_the_leaves_curls_is_found(void **unused)
{
    (void)unused;
    assert_is_tube(1.2e-3);
}

/* Share of the points [first, end) that are stem. */
static double share_stem(const drawing *d, size_t first, size_t end)
{
    size_t stem = 0;
    for (size_t i = first; i < end; i++) stem += d->is_stem[i];
    return (double)stem / (double)(end - first);
}

/* The lower half of a stem is drawn, and a leaf; the rough path leans beyond the half. */
static void start_halves(drawing *d, double lean, double leaf_x, double leaf_lean, uint64_t *state)
{
    start(d, RADIUS);
    add_tube(d, 0, HEIGHT / 2, 0, 3000, -1, state);
    add_blade(d, leaf_x, HEIGHT, leaf_lean, 0.15, 8000, 0, state);
    set_path(d, lean);
}

/* The upper half is a leaf's as yet, and of another one the lower part is taken for trunk: into that the rough path turns. */
static void a_way_into_a_blade_gives_way_to_the_tube(void **unused)
{
    (void)unused;
    static drawing d;
    plm_error error = {0};
    double shape;
    uint64_t state = 12;
    start_halves(&d, 0.5, 0.03, 0.6, &state);
    const size_t upper = d.sketch.working.count;
    add_tube(&d, HEIGHT / 2, HEIGHT / 2, 0, 3000, 0, &state);
    const size_t blade = d.sketch.working.count;
    add_blade(&d, RADIUS, HEIGHT / 2, 0.5, 0.07, 2500, -1, &state);
    assert_ok(plm_strap_stem(&d.sketch, 1, &shape, &error));
    const double found = share_stem(&d, upper, blade), taken = share_stem(&d, blade, d.sketch.working.count);
    print_message("stem: %.3f of its upper half, %.3f of the blade\n", found, taken);
    assert_true(found > 0.9 && taken < 0.15);
    plm_stem_path_free(&d.sketch.stem);
}

/* A stem that bends is the tube on its way. Straight on there is a tube as closed, but short: the foot of a leaf. */
static void a_bent_stem_stays(void **unused)
{
    (void)unused;
    static drawing d;
    plm_error error = {0};
    double shape;
    uint64_t state = 13;
    start_halves(&d, 0.6, -0.03, -0.6, &state);
    add_tube(&d, HEIGHT / 2, 0.018, 0, 900, 0, &state);
    const size_t upper = d.sketch.working.count;
    add_tube(&d, HEIGHT / 2, HEIGHT / 2, 0.6, 3000, -1, &state);
    assert_ok(plm_strap_stem(&d.sketch, 1, &shape, &error));
    const double found = share_stem(&d, upper, d.sketch.working.count);
    print_message("stem: %.3f of its upper half\n", found);
    assert_true(found > 0.8);
    plm_stem_path_free(&d.sketch.stem);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_radius_about_right_stays),
        cmocka_unit_test(a_stem_wider_than_the_leaves_curls_is_found),
        cmocka_unit_test(a_way_into_a_blade_gives_way_to_the_tube),
        cmocka_unit_test(a_bent_stem_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
