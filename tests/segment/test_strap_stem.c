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

/* A stem, half of which a leaf has for its own, and that leaf; the rough path runs up on the stem's surface, with such a radius. */
static void draw(drawing *d, double radius)
{
    plm_sketch *s = &d->sketch;
    uint64_t state = 11;
    memset(d, 0, sizeof *d);
    s->leaf = d->leaf;
    s->is_stem = d->is_stem;
    s->is_tube = d->is_tube;
    s->working.xyz = d->xyz;
    s->working.cell = 6e-4;
    s->scale = (plm_scale){.radius = 6e-3, .stem_radius = radius, .noise = 1e-4, .size = 0.3, .spacing = 6e-4};
    for (size_t k = 0; k < 6000; k++) {
        const double way = 2 * PLM_PI * test_uniform(&state), z = HEIGHT * test_uniform(&state);
        const double r = RADIUS * (1 + 0.08 * cos(3 * way)) + 4e-4 * (test_uniform(&state) - 0.5);
        add_point(d, r * cos(way), r * sin(way), z, cos(way) > 0.2 ? 0 : -1);
    }
    for (size_t k = 0; k < 8000; k++) {
        const double along = 0.15 * test_uniform(&state), side = 0.02 * (test_uniform(&state) - 0.5);
        add_point(d, 0.012 + along, side, 0.09 + 0.6 * along, 0);
    }
    s->stem.count = NODES;
    s->stem.node = calloc(NODES, sizeof *s->stem.node);
    s->stem.radius = calloc(NODES, sizeof *s->stem.radius);
    s->stem.along = calloc(NODES, sizeof *s->stem.along);
    assert_true(s->stem.node && s->stem.radius && s->stem.along);
    for (size_t n = 0; n < NODES; n++) {
        s->stem.node[n][0] = -0.9 * RADIUS + 5e-4 * sin(0.7 * (double)n);
        s->stem.node[n][1] = 5e-4 * cos(0.4 * (double)n);
        s->stem.node[n][2] = STEP * (double)n;
        s->stem.radius[n] = radius;
    }
    plm_stem_measure_along(&s->stem);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_radius_about_right_stays),
        cmocka_unit_test(a_stem_wider_than_the_leaves_curls_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
