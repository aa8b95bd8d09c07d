/* Labels that are set right once the organs are known: strays of a blade on a stem, and the rachis among its leaflets. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/junction.h"
#include "segment/segment.h"
#include "segment/sketch.h"
#include "simulate/simulate.h"

#include <math.h>

enum { STEM = 600, BLADE = 3000, ROWS = 4000 };

static float xyz[ROWS][3];
static bool is_tube[ROWS], is_stem[ROWS];
static int32_t leaf[ROWS], leaflet[ROWS];

static double random_share(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 40) / 0x1p24;
}

static plm_sketch empty_sketch(size_t leaves)
{
    plm_sketch sketch = {
        .is_tube = is_tube, .is_stem = is_stem, .leaf = leaf, .leaflet = leaflet, .leaf_count = leaves};
    sketch.working.xyz = xyz;
    return sketch;
}

static void add(plm_sketch *sketch, double x, double y, double z, bool stem, bool tube, int32_t leaf_of)
{
    const size_t i = sketch->working.count++;
    assert_true(i < ROWS);
    xyz[i][0] = (float)x, xyz[i][1] = (float)y, xyz[i][2] = (float)z;
    is_stem[i] = stem, is_tube[i] = tube, leaf[i] = leaf_of, leaflet[i] = stem || tube ? -1 : 0;
}

/* A stem of radius 4 mm along z, 200 mm, and a blade that leaves it to the right at the upper end. */
static plm_sketch stem_and_blade(uint64_t *state)
{
    plm_sketch sketch = empty_sketch(1);
    for (int i = 0; i < STEM; i++) {
        const double turn = 2 * PLM_PI * random_share(state);
        add(&sketch, 0.004 * cos(turn), 0.004 * sin(turn), 0.2 * random_share(state), true, true, -1);
    }
    for (int i = 0; i < BLADE; i++)
        add(&sketch, 0.005 + 0.2 * random_share(state), 0.02 * (random_share(state) - 0.5), 0.2, false, false, 0);
    return sketch;
}

static void strays_of_a_blade_on_the_stem_are_stem(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 7;
    plm_sketch sketch = stem_and_blade(&state);
    const size_t before = sketch.working.count;
    for (int i = 0; i < 10; i++) add(&sketch, 0.0045 * cos(i), 0.0045 * sin(i), 0.01 + 0.015 * i, false, false, 0);
    assert_ok(plm_sketch_strays(&sketch, &error));
    for (size_t i = before; i < sketch.working.count; i++) {
        assert_true(is_stem[i] && is_tube[i]);
        assert_int_equal(leaf[i], -1);
        assert_int_equal(leaflet[i], -1);
    }
    for (size_t i = 0; i < before; i++) assert_int_equal(is_stem[i], i < STEM);
}

/* A piece of the blade that stands free, and stem points within the blade, are what they were called. */
static void what_lies_amid_a_blade_stays(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 8;
    plm_sketch sketch = stem_and_blade(&state);
    const size_t before = sketch.working.count;
    for (int i = 0; i < 15; i++) add(&sketch, 0.3 + 0.001 * i, 0, 0.2, false, false, 0);
    for (int i = 0; i < 4; i++) add(&sketch, 0.1 + 0.02 * i, 0, 0.2, true, true, -1);
    assert_ok(plm_sketch_strays(&sketch, &error));
    for (size_t i = before; i < before + 15; i++) assert_int_equal(leaf[i], 0);
    for (size_t i = before + 15; i < sketch.working.count; i++) assert_true(is_stem[i]);
}

/* A rachis of radius 1 mm along x, 60 mm; a leaflet to both sides at 25 to 35 mm, where its points were called blade. */
static void the_rachis_goes_on_among_leaflets(void **unused)
{
    (void)unused;
    enum { STEPS = 60 };
    static uint32_t order[ROWS];
    static float distance[ROWS];
    plm_station station[STEPS] = {{0}};
    plm_sketch sketch = empty_sketch(1);
    for (int k = 0; k < STEPS; k++) {
        const bool wide = k >= 25 && k < 35;
        for (int i = 0; i < 12; i++) add(&sketch, 1e-3 * k, 1e-3 * cos(i), 1e-3 * sin(i), false, !wide, 0);
        for (int i = 0; wide && i < 30; i++)
            add(&sketch, 1e-3 * k, 1e-3 * (i < 15 ? i - 19 : i - 10), 0, false, false, 0);
        /* Leaflets of which one is seen better draw the middle aside. */
        station[k] =
            (plm_station){.width = wide ? 9e-3 : 0.7e-3, .middle = {1e-3 * k, wide ? 4e-3 : 0, 0}, .count = 12};
    }
    for (uint32_t i = 0; i < sketch.working.count; i++) {
        order[i] = i;
        distance[i] = xyz[i][0];
    }
    sketch.scale.radius = 5e-3;
    plm_leaf_way way = {.sketch = &sketch,
                        .count = sketch.working.count,
                        .order = order,
                        .distance = distance,
                        .station_count = STEPS,
                        .station = station,
                        .step = 1e-3,
                        .window = 3e-3,
                        .tube = 0.7e-3,
                        .junction = 58e-3};
    plm_leaf_rachis(&sketch, &way);
    for (size_t i = 0; i < sketch.working.count; i++) {
        const bool on_rachis = hypot(xyz[i][1], xyz[i][2]) < 1.1e-3;
        assert_int_equal(is_tube[i], on_rachis);
    }
    for (size_t i = 0; i < sketch.working.count; i++)
        is_tube[i] = hypot(xyz[i][1], xyz[i][2]) < 1.1e-3 && leaflet[i] < 0;
    sketch.scale.radius = 1e-3; /* ten radii of the stem among leaflets: it may bend there */
    for (size_t i = 0; i < sketch.working.count; i++) is_tube[i] = !(xyz[i][0] > 24.5e-3 && xyz[i][0] < 34.5e-3);
    plm_leaf_rachis(&sketch, &way);
    for (size_t i = 0; i < sketch.working.count; i++)
        assert_int_equal(is_tube[i], !(xyz[i][0] > 24.5e-3 && xyz[i][0] < 34.5e-3));
}

/* Share of the points of petioles and rachises that are called so. */
static double petiole_recall(const char *kind, uint64_t seed)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    plm_segmentation found;
    size_t all = 0, right = 0;
    assert_ok(plm_plant_grow(kind, &(plm_plant_options){.seed = seed, .resolution = 0.5}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .seed = seed, .points = 30000},
                             &scan, &error));
    assert_ok(plm_segment(&scan.cloud, NULL, NULL, NULL, &found, &error));
    for (size_t i = 0; i < scan.cloud.count; i++) {
        if (scan.cloud.label[i] != PLM_LABEL_PETIOLE) continue;
        all++;
        right += found.label[i] == PLM_LABEL_PETIOLE;
    }
    plm_segmentation_free(&found);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
    print_message("%s %d: %.3f of the petioles' points\n", kind, (int)seed, (double)right / (double)all);
    return (double)right / (double)all;
}

static void rachises_of_virtual_plants_are_found(void **unused)
{
    (void)unused;
    assert_true(petiole_recall("tomato", 611) >= 0.9);
    assert_true(petiole_recall("tomato", 612) >= 0.9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strays_of_a_blade_on_the_stem_are_stem),
        cmocka_unit_test(what_lies_amid_a_blade_stays),
        cmocka_unit_test(the_rachis_goes_on_among_leaflets),
        cmocka_unit_test(rachises_of_virtual_plants_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
