/* A rosette's leaf that is a piece of another's petiole becomes part of it; what may be a leaf stays one. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/rosette_links.h"
#include "support/failing.h"
#include "support/segmented.h"

enum { ROWS = 12000, BLADE = 2000 };
static const double TUBE = 0.5e-3;

static struct {
    float xyz[ROWS][3];
    uint32_t row[ROWS];
    uint8_t label[ROWS];
    int32_t organ[ROWS];
    size_t count, leaves;
} made;

static void add(double x, double y, double z, plm_label label, int32_t leaf)
{
    assert_true(made.count < ROWS);
    const size_t i = made.count++;
    made.xyz[i][0] = (float)x, made.xyz[i][1] = (float)y, made.xyz[i][2] = (float)z;
    made.row[i] = (uint32_t)i, made.label[i] = (uint8_t)label, made.organ[i] = leaf;
}

/* A tube from one distance from the core to another, along a direction in the plane; thin: how flat it is (1: round). */
static void add_tube(double from, double to, double azimuth, double thin, plm_label label, int32_t leaf)
{
    const size_t points = (size_t)((to - from) * 20e3);
    for (size_t i = 0; i < points; i++) {
        const double along = from + (to - from) * ((double)i + 0.5) / (double)points, turn = 2.4 * (double)i;
        const double aside = TUBE * cos(turn);
        add(along * cos(azimuth) - aside * sin(azimuth), along * sin(azimuth) + aside * cos(azimuth),
            thin * TUBE * sin(turn), label, leaf);
    }
}

/* A level blade of a radius whose middle is so far from the core. */
static void add_blade(double middle, double radius, double azimuth, int32_t leaf)
{
    for (size_t i = 0; i < BLADE; i++) {
        const double off = radius * sqrt(((double)i + 0.5) / BLADE), turn = 2.4 * (double)i;
        add(middle * cos(azimuth) + off * cos(turn), middle * sin(azimuth) + off * sin(turn), 0, PLM_LABEL_LEAF, leaf);
    }
}

static size_t find(plm_error *error, plm_status *status)
{
    const double core[3] = {0};
    plm_segmentation out = {.count = made.count, .label = made.label, .organ = made.organ, .leaf_count = made.leaves};
    *status = plm_rosette_links((const float(*)[3])made.xyz, made.row, made.count, core, &out, error);
    return out.leaf_count;
}

static void assert_leaves(size_t leaves)
{
    plm_error error = {0};
    plm_status status;
    const size_t found = find(&error, &status);
    assert_ok(status);
    assert_int_equal(found, leaves);
}

/* Leaf `leaf` with a petiole from 2 mm on, whose piece from 8 mm up to where the blade or the rest of the petiole begins is leaf `link`. */
static void start(int32_t link, int32_t leaf, double until)
{
    made.count = 0, made.leaves = 2;
    add_tube(0.002, 0.008, 0, 1, PLM_LABEL_PETIOLE, link);
    add_tube(0.008, until, 0, 1, PLM_LABEL_LEAF, link);
    if (until < 0.02) add_tube(until, 0.02, 0, 1, PLM_LABEL_PETIOLE, leaf);
}

static void a_link_is_the_petiole_of_what_goes_on(void **unused)
{
    (void)unused;
    for (int reaches_blade = 0; reaches_blade < 2; reaches_blade++)
        for (int32_t link = 0; link < 2; link++) {
            start(link, 1 - link, reaches_blade ? 0.02 : 0.017);
            const size_t tube = made.count;
            add_blade(0.028, 0.0085, 0, 1 - link);
            assert_leaves(1);
            for (size_t i = 0; i < made.count; i++) {
                assert_int_equal(made.organ[i], 0);
                assert_int_equal(made.label[i], i < tube ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF);
            }
        }
}

/* Two links one behind the other, and other leaves, which keep their order and their labels. */
static void links_of_links_are_the_last_ones(void **unused)
{
    (void)unused;
    for (int k = 0; k < 2; k++) { /* a short one before a long one, and after */
        made.count = 0, made.leaves = 5;
        const double between = k ? 0.013 : 0.01;
        add_tube(0.002, between, 0, 1, PLM_LABEL_LEAF, 3);
        add_tube(between, 0.02, 0, 1, PLM_LABEL_LEAF, 1);
        const size_t tube = made.count;
        add_blade(0.028, 0.0085, 0, 2);
        const size_t whole = made.count;
        add_blade(0.028, 0.0085, 2, 0);
        add_blade(0.028, 0.0085, 4, 4);
        add(0, 0, -0.01, PLM_LABEL_OTHER, -1);
        assert_leaves(3);
        for (size_t i = 0; i < whole; i++) {
            assert_int_equal(made.organ[i], 1);
            assert_int_equal(made.label[i], i < tube ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF);
        }
        for (size_t i = whole; i < whole + 2 * BLADE; i++) {
            assert_int_equal(made.organ[i], i < whole + BLADE ? 0 : 2);
            assert_int_equal(made.label[i], PLM_LABEL_LEAF);
        }
        assert_int_equal(made.label[made.count - 1], PLM_LABEL_OTHER);
        assert_int_equal(made.organ[made.count - 1], -1);
    }
}

/* A young leaf is as thick as wide at times, but nothing goes on at its tip, or another leaf's tip that it touches is near. A narrow
 * blade before another leaf is flat. A round piece that is not long may be a bud. */
static void what_may_be_a_leaf_stays_one(void **unused)
{
    (void)unused;
    start(0, 1, 0.02);
    add_blade(0.028, 0.0085, 2, 1); /* elsewhere */
    assert_leaves(2);
    start(0, 1, 0.02);
    add_blade(0.0225, 0.003, 0, 1); /* goes on by half of the length */
    assert_leaves(2);
    made.count = 0;
    add_tube(0.008, 0.02, 0, 0.3, PLM_LABEL_LEAF, 0); /* flat */
    add_blade(0.028, 0.0085, 0, 1);
    assert_leaves(2);
    made.count = 0;
    add_tube(0.0185, 0.02, 0, 1, PLM_LABEL_LEAF, 0); /* short */
    add_blade(0.028, 0.0085, 0, 1);
    assert_leaves(2);
    for (size_t i = 0; i < made.count; i++) assert_int_equal(made.label[i], PLM_LABEL_LEAF);
}

/* In all of the search: these had one, one and three leaves too many, of pieces of petioles. */
static void pieces_of_petioles_are_no_leaves(void **unused)
{
    (void)unused;
    static const uint64_t seed[] = {311005, 311009, 311004};
    for (size_t k = 0; k < COUNT(seed); k++) {
        const plm_scan_options scan = {.scanner = PLM_SCANNER_UNIFORM, .seed = seed[k], .points = 14000, .noise = 2e-4};
        plm_habit habit;
        const label_score score = segmented("arabidopsis_large", seed[k], &scan, &habit);
        assert_int_equal(habit, PLM_HABIT_ROSETTE);
        assert_true(score.leaves_found - score.leaves <= k / 2 && score.f1 > (k < 2 ? 0.99 : 0.95));
    }
}

static void memory_may_be_short(void **unused)
{
    (void)unused;
    test_failing failing;
    const plm_allocator allocator = test_failing_allocator(&failing);
    plm_status status = PLM_E_MEMORY;
    for (long at = 0; status != PLM_OK; at++) {
        plm_error error = {0};
        start(0, 1, 0.02);
        add_blade(0.028, 0.0085, 0, 1);
        failing = (test_failing){.fail_at = at};
        plm_set_allocator(&allocator);
        const size_t leaves = find(&error, &status);
        plm_set_allocator(NULL);
        assert_int_equal(failing.alive, 0);
        assert_int_equal(status, at < failing.calls ? PLM_E_MEMORY : PLM_OK);
        assert_int_equal(leaves, status == PLM_OK ? 1 : 2);
        assert_true(status == PLM_E_MEMORY || at > 4);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_link_is_the_petiole_of_what_goes_on),
        cmocka_unit_test(links_of_links_are_the_last_ones),
        cmocka_unit_test(what_may_be_a_leaf_stays_one),
        plant_case(pieces_of_petioles_are_no_leaves),
        cmocka_unit_test(memory_may_be_short),
    };
    return run_cases(tests);
}
