/* A tassel is no leaf: neither that of virtual maize, nor one that a scan joined with the uppermost leaf. */
#include "support/test.h"

#include "segment/tassel.h"
#include "support/virtual_plant.h"

enum { ROWS = 9000 };
static const double STEP = 2e-3;

static void a_virtual_maize_has_its_leaves_and_no_more(void **unused)
{
    (void)unused;
    static const struct {
        plm_scanner scanner;
        size_t points;
        double noise;
    } scan[] = {{PLM_SCANNER_UNIFORM, 25000, 0}, {PLM_SCANNER_SPLAT, 40000, 5e-4}};
    for (size_t k = 0; k < sizeof scan / sizeof *scan; k++) {
        const plm_scan_options options = {
            .scanner = scan[k].scanner, .seed = 7101, .points = scan[k].points, .noise = scan[k].noise};
        virtual_plant_assert_leaves("maize_large", &options, 14);
    }
}

typedef struct drawing {
    plm_sketch sketch;
    float xyz[ROWS][3], distance[ROWS];
    int32_t leaf[ROWS];
    bool is_strand[ROWS];
} drawing;

/* A strip from (x, 0, z), so many steps long and points wide, that leans by slope; its foot is at z of the stem. */
static void add_strip(drawing *d, double x, double z, int length, int width, double slope, int32_t leaf, bool is_strand)
{
    for (int k = 0; k < length; k++)
        for (int j = 0; j < width; j++) {
            const size_t i = d->sketch.working.count++;
            assert_true(i < ROWS);
            d->xyz[i][0] = (float)(x + slope * k * STEP);
            d->xyz[i][1] = (float)((j - width / 2) * STEP);
            d->xyz[i][2] = (float)(z + k * STEP);
            d->distance[i] = (float)(z + k * STEP * sqrt(1 + slope * slope));
            d->leaf[i] = leaf;
            d->is_strand[i] = is_strand;
        }
}

enum { TASSEL = 1 };

static void link_all(drawing *d)
{
    plm_error error = {0};
    plm_graph_free(&d->sketch.graph);
    assert_ok(
        plm_graph_build((const float(*)[3])d->xyz, d->sketch.working.count, 10, 1.8 * STEP, &d->sketch.graph, &error));
}

/* So many leaves of such a width at the stem's side, and strands at its top, joined by a stalk; top_width: and with what is seen of the
 * uppermost leaf, 0 for nothing. */
static void draw_widths(drawing *d, int leaves, int width, int strands, int top_width)
{
    memset(d, 0, sizeof *d);
    d->sketch.leaf = d->leaf;
    d->sketch.working.xyz = d->xyz;
    d->sketch.working.cell = STEP;
    for (int k = 0; k < leaves; k++)
        add_strip(d, 0.1 + 0.05 * k, 0.1 + 0.1 * k, 60, width, 1, k < TASSEL ? k : k + 1, false);
    add_strip(d, -1e-3, 0.5, 10, 2, 0, TASSEL, !top_width);
    if (top_width) add_strip(d, -1e-3 - STEP, 0.5, 25, top_width, -1.4, TASSEL, false);
    for (int k = 0; k < strands; k++)
        add_strip(d, 0.002 * k - 0.004, 0.52 + 1e-4 * k, 30, 2, 0.5 * k - 1, TASSEL, true);
    link_all(d);
}

static void draw(drawing *d, int leaves, int strands, bool with_leaf)
{
    draw_widths(d, leaves, 12, strands, with_leaf ? 12 : 0);
}

/* How many leaves are left, and how many points have not what they should. at: where the strands' foot is. */
static size_t take_off(drawing *d, size_t leaves, double at, size_t *wrong)
{
    plm_error error = {0};
    static int32_t was[ROWS];
    double foot[4] = {0.1, at, 0.2, 0.3};
    const double left[3] = {0.1, 0.2, 0.3};
    const size_t before = leaves;
    memcpy(was, d->leaf, sizeof was);
    assert_ok(plm_strap_tassel(&d->sketch, d->distance, foot, &leaves, &error));
    *wrong = 0;
    for (size_t i = 0; i < d->sketch.working.count; i++) {
        const int32_t number = leaves < before && was[i] > TASSEL ? was[i] - 1 : was[i];
        *wrong += d->leaf[i] != (d->is_strand[i] ? -1 : number);
    }
    for (size_t k = 0; k < leaves && leaves < before; k++) assert_true(foot[k] == left[k]);
    plm_graph_free(&d->sketch.graph);
    return leaves;
}

static void strands_at_the_top_are_a_tassel(void **unused)
{
    (void)unused;
    static drawing d;
    size_t wrong;
    draw(&d, 3, 5, false);
    assert_int_equal(take_off(&d, 4, 0.5, &wrong), 3);
    assert_int_equal(wrong, 0);
    draw(&d, 3, 5, true);
    assert_int_equal(take_off(&d, 4, 0.5, &wrong), 4);
    print_message("with a leaf: %zu of %zu points are on the wrong side\n", wrong, d.sketch.working.count);
    assert_true(wrong <= 20); /* the stalk */
}

/* The uppermost leaf is a third as wide as the others, and many times as wide as the strands that it is joined with. */
static void a_narrow_leaf_beside_a_tassel_stays(void **unused)
{
    (void)unused;
    static drawing d;
    size_t wrong;
    draw_widths(&d, 3, 36, 6, 12);
    assert_int_equal(take_off(&d, 4, 0.5, &wrong), 4);
    print_message("narrow leaf: %zu of %zu points are on the wrong side\n", wrong, d.sketch.working.count);
    assert_true(wrong <= 20); /* the stalk */
}

static void assert_stays(drawing *d, size_t leaves, double at)
{
    size_t wrong;
    assert_int_equal(take_off(d, leaves, at, &wrong), leaves);
    for (size_t i = 0; i < d->sketch.working.count; i++) assert_true(d->leaf[i] >= 0);
}

/* A narrow leaf, whose tip is torn in two and that has fringes at its rims: thin strands, but few points are theirs. */
static void a_narrow_leaf_with_fringes_is_a_leaf(void **unused)
{
    (void)unused;
    static drawing d;
    draw(&d, 3, 0, false);
    add_strip(&d, -1e-3, 0.52, 60, 4, 0, TASSEL, false);
    for (int side = -1; side <= 1; side += 2) {
        add_strip(&d, -1e-3, 0.64, 14, 1, side, TASSEL, false);
        add_strip(&d, -1e-3, 0.58, 14, 1, side, TASSEL, false);
    }
    link_all(&d);
    assert_stays(&d, 4, 0.5);
}

/* Torn in three, fringed at its rim, low on the stem, on a plant whose other leaves are too few to tell how wide leaves are, or narrow
 * and with scraps beside it. */
static void a_torn_leaf_is_a_leaf(void **unused)
{
    (void)unused;
    static drawing d;
    draw(&d, 3, 3, false);
    assert_stays(&d, 4, 0.5);
    draw(&d, 3, 5, false);
    add_strip(&d, -0.011, 0.45, 40, 30, 0, TASSEL, false);
    link_all(&d);
    assert_stays(&d, 4, 0.5);
    draw(&d, 3, 5, false);
    assert_stays(&d, 4, 0.2);
    draw(&d, 2, 5, false);
    assert_stays(&d, 3, 0.5);
    draw(&d, 3, 1, false);
    for (int k = 0; k < 4; k++) add_strip(&d, 0.02 + 0.008 * k, 0.53 + 0.01 * k, 3, 2, 0, TASSEL, false);
    link_all(&d);
    assert_stays(&d, 4, 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_virtual_maize_has_its_leaves_and_no_more), cmocka_unit_test(strands_at_the_top_are_a_tassel),
        cmocka_unit_test(a_narrow_leaf_beside_a_tassel_stays),        cmocka_unit_test(a_torn_leaf_is_a_leaf),
        cmocka_unit_test(a_narrow_leaf_with_fringes_is_a_leaf),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
