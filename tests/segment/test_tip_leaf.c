/* The youngest leaf is told from the stem that it stands on, and a stem's end is no leaf. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/stem_fit.h"
#include "segment/tip_leaf.h"

enum { ROWS = 12000, NODES = 60, LEAF = 1000 };
static const double RADIUS = 1e-3, LAST = 0.02, TOP = 0.032;

/* A stem, two leaves at LAST, and what stands on it beyond. */
typedef struct drawing {
    plm_sketch sketch;
    float xyz[ROWS][3];
    bool is_tube[ROWS], is_stem[ROWS];
    int32_t group[ROWS];
    plm_side_group side[3];
    plm_side_groups groups;
    uint64_t state;
} drawing;

static void add_point(drawing *d, double x, double y, double z, int32_t group)
{
    const size_t i = d->sketch.working.count++;
    assert_true(i < ROWS);
    d->xyz[i][0] = (float)x;
    d->xyz[i][1] = (float)y;
    d->xyz[i][2] = (float)z;
    d->is_tube[i] = z > LAST || group < 0;
    d->is_stem[i] = group < 0;
    d->group[i] = group;
}

static void draw(drawing *d, double top)
{
    static double node[NODES][3], radius[NODES], along[NODES];
    memset(d, 0, sizeof *d);
    plm_sketch *s = &d->sketch;
    s->working.xyz = d->xyz;
    s->working.cell = 4e-4;
    s->is_tube = d->is_tube;
    s->is_stem = d->is_stem;
    s->group = d->group;
    s->scale = (plm_scale){.radius = 3e-3, .stem_radius = RADIUS, .noise = 1e-4, .size = 0.08};
    s->stem = (plm_stem_path){.count = NODES, .node = node, .radius = radius, .along = along};
    d->state = 5;
    for (size_t n = 0; n < NODES; n++) {
        node[n][0] = node[n][1] = 0;
        node[n][2] = top * (double)n / (NODES - 1);
        radius[n] = RADIUS;
    }
    plm_stem_measure_along(&s->stem);
    for (int k = 0; k < 3000; k++) {
        const double way = 2 * PLM_PI * test_uniform(&d->state);
        add_point(d, RADIUS * cos(way), RADIUS * sin(way), LAST * test_uniform(&d->state), -1);
    }
    for (int g = 0; g < 2; g++) {
        for (int k = 0; k < LEAF; k++)
            add_point(d, (g ? -1 : 1) * (2e-3 + 0.03 * test_uniform(&d->state)), 0.01 * test_uniform(&d->state), LAST,
                      g);
        d->side[g] = (plm_side_group){.has_foot = true, .along = LAST, .blades = 1, .blade_area = 3e-4};
    }
    d->side[2] = (plm_side_group){.has_foot = true, .along = LAST + 4 * RADIUS};
    d->groups = (plm_side_groups){.count = 3, .group = d->side};
}

/* Points of a blade that stands upright on the stem, so wide: those near the way pass for stem. */
static void add_upright_blade(drawing *d, int points, double width)
{
    for (int k = 0; k < points; k++) {
        const double y = width * (test_uniform(&d->state) - 0.5),
                     z = LAST + 1e-3 + (TOP - LAST - 1e-3) * test_uniform(&d->state);
        add_point(d, 2e-4 * (test_uniform(&d->state) - 0.5), y, z, fabs(y) < 1.3 * RADIUS ? -1 : 2);
    }
}

static void add_tube(drawing *d, int points)
{
    for (int k = 0; k < points; k++) {
        const double way = 2 * PLM_PI * test_uniform(&d->state);
        add_point(d, RADIUS * cos(way), RADIUS * sin(way), LAST + (TOP - LAST) * test_uniform(&d->state), -1);
    }
}

static bool find(drawing *d)
{
    plm_error error = {0};
    bool found = true;
    assert_ok(plm_tip_leaf(&d->sketch, &d->groups, &found, &error));
    return found;
}

static void a_blade_on_the_tip_is_a_leaf(void **unused)
{
    (void)unused;
    static drawing d;
    draw(&d, TOP);
    add_upright_blade(&d, 300, 5e-3);
    assert_true(find(&d));
    const plm_stem_path *stem = &d.sketch.stem;
    assert_true(stem->along[stem->count - 1] <= LAST + 1.5 * RADIUS && stem->along[stem->count - 1] > LAST);
    for (size_t i = 0; i < d.sketch.working.count; i++) {
        const bool is_stem = d.is_stem[i] && d.xyz[i][2] < LAST + 1.5 * RADIUS;
        if (d.xyz[i][2] > LAST + 2 * RADIUS) assert_false(d.is_tube[i]);
        if (is_stem) assert_true(d.is_tube[i]);
    }
}

static void assert_stays(drawing *d)
{
    const size_t count = d->sketch.stem.count;
    assert_false(find(d));
    assert_int_equal(d->sketch.stem.count, count);
    for (size_t i = 0; i < d->sketch.working.count; i++)
        if (d->xyz[i][2] > LAST) assert_true(d->is_tube[i]);
}

static void the_end_of_a_stem_is_none(void **unused)
{
    (void)unused;
    static drawing d;
    draw(&d, TOP); /* an internode without a leaf */
    add_tube(&d, 600);
    assert_stays(&d);
    draw(&d, LAST + 4 * RADIUS); /* short */
    add_upright_blade(&d, 300, 5e-3);
    assert_stays(&d);
    draw(&d, TOP); /* hardly any points */
    add_upright_blade(&d, 60, 5e-3);
    assert_stays(&d);
    draw(&d, TOP); /* an internode and a bare twig */
    add_tube(&d, 600);
    for (int k = 0; k < 500; k++)
        add_point(&d, RADIUS + 0.02 * test_uniform(&d.state), RADIUS * (test_uniform(&d.state) - 0.5),
                  LAST + 6 * RADIUS, 2);
    assert_stays(&d);
    draw(&d, TOP); /* too small for a leaf of this plant */
    add_upright_blade(&d, 300, 5e-3);
    d.sketch.working.cell = 1e-4;
    assert_stays(&d);
    draw(&d, TOP); /* rags in noise */
    add_upright_blade(&d, 300, 5e-3);
    d.sketch.scale.noise = 0.4 * RADIUS;
    assert_stays(&d);
    draw(&d, TOP); /* one leaf tells nothing */
    add_upright_blade(&d, 300, 5e-3);
    d.side[1].blades = 0;
    d.side[1].has_foot = false;
    assert_stays(&d);
    draw(&d, TOP); /* no leaf at all */
    add_upright_blade(&d, 300, 5e-3);
    d.groups.count = 0;
    for (size_t i = 0; i < d.sketch.working.count; i++) d.group[i] = -1;
    assert_stays(&d);
    draw(&d, TOP); /* no stem */
    d.sketch.stem.count = 0;
    assert_stays(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blade_on_the_tip_is_a_leaf),
        cmocka_unit_test(the_end_of_a_stem_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
