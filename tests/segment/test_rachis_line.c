/* The rachis between leaflets that are joined at its sides, and blades that are none. */
#include "support/test.h"

#include "cloud/random.h"
#include "segment/rachis_line.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 8000, STATIONS = 100 };
static const double TUBE = 0.001, NOISE = 0.0003, STEP = 0.001, DENSITY = 2e6; /* points a square metre */
static const double CELL = 0.0007;                                             /* as dense as that */

typedef struct leaf {
    size_t count, trail_count;
    float xyz[MOST][3];
    uint32_t order[MOST], trail[STATIONS];
    float distance[MOST];
    plm_station station[STATIONS];
    plm_random random;
} leaf;

static void add(leaf *l, double x, double y, double z)
{
    assert_true(l->count < MOST);
    const double place[3] = {x, y, z};
    for (int a = 0; a < 3; a++) l->xyz[l->count][a] = (float)(place[a] + NOISE * plm_draw_normal(&l->random));
    l->distance[l->count] = fmaxf(l->xyz[l->count][0], 0); /* the foot is at 0 */
    l->count++;
}

static void add_tube(leaf *l, double from, double to)
{
    const size_t count = (size_t)(DENSITY * (to - from) * 2 * 3.14159 * TUBE);
    for (size_t i = 0; i < count; i++) {
        const double angle = 2 * 3.14159 * plm_draw(&l->random);
        add(l, from + (to - from) * plm_draw(&l->random), TUBE * cos(angle), TUBE * sin(angle));
    }
}

static void add_sheet(leaf *l, double x0, double x1, double y0, double y1)
{
    const size_t count = (size_t)(DENSITY * (x1 - x0) * (y1 - y0));
    for (size_t i = 0; i < count; i++)
        add(l, x0 + (x1 - x0) * plm_draw(&l->random), y0 + (y1 - y0) * plm_draw(&l->random), 0);
}

static const leaf *sorted;

static int by_distance(const void *a, const void *b)
{
    const uint32_t i = *(const uint32_t *)a, k = *(const uint32_t *)b;
    if (sorted->distance[i] != sorted->distance[k]) return sorted->distance[i] < sorted->distance[k] ? -1 : 1;
    return i < k ? -1 : 1;
}

/* Stations take in all that lies at their distance: everything is joined. */
static void make_way(leaf *l, const plm_sketch *sketch, plm_leaf_way *way)
{
    for (size_t i = 0; i < l->count; i++) l->order[i] = (uint32_t)i;
    sorted = l;
    qsort(l->order, l->count, sizeof *l->order, by_distance);
    *way = (plm_leaf_way){.sketch = sketch,
                          .count = l->count,
                          .order = l->order,
                          .distance = l->distance,
                          .station_count = (size_t)((double)l->distance[l->order[l->count - 1]] / STEP) + 1,
                          .station = l->station,
                          .step = STEP,
                          .window = 3 * STEP,
                          .tube = 0.9 * TUBE};
    assert_true(way->station_count <= STATIONS);
    l->trail_count = 0;
    for (size_t k = 0; k < way->station_count; k++) {
        const double low = ((double)k - 1.5) * STEP, high = ((double)k + 1.5) * STEP;
        size_t begin = 0, end, middle = MOST;
        while (begin < l->count && l->distance[l->order[begin]] < low) begin++;
        for (end = begin; end < l->count && l->distance[l->order[end]] < high; end++) {
            const uint32_t i = l->order[end];
            if (middle == MOST || fabsf(l->xyz[i][1]) < fabsf(l->xyz[middle][1])) middle = i;
        }
        plm_station_measure(sketch, l->order + begin, end - begin, &l->station[k]);
        if (middle < MOST) l->trail[l->trail_count++] = (uint32_t)middle;
    }
}

static void find_clear(leaf *l, bool *clear, bool *beside, plm_leaf_way *way)
{
    bool *is_tube = calloc(MOST, sizeof *is_tube);
    assert_non_null(is_tube);
    plm_sketch sketch = {.working = {.count = l->count, .xyz = l->xyz, .cell = CELL}, .is_tube = is_tube};
    sketch.scale.radius = 0.003;
    plm_error error = {0};
    assert_ok(plm_graph_build((const float(*)[3])l->xyz, l->count, 10, 3 * STEP, &sketch.graph, &error));
    make_way(l, &sketch, way);
    assert_ok(plm_rachis_clear(way, l->trail, l->trail_count, clear, beside, &error));
    plm_graph_free(&sketch.graph);
    free(is_tube);
}

/* Leaflets 2.5 mm beside the rachis, from 20 to 40 mm, joined with it by their distance; the last one begins at 60 mm. */
static void rachis_between_leaflets_is_clear_of_them(void **state)
{
    (void)state;
    static leaf l;
    static bool clear[STATIONS], beside[STATIONS];
    plm_leaf_way way;
    l = (leaf){.random = {.key = plm_key(1, 0)}};
    add_tube(&l, 0, 0.060);
    add_sheet(&l, 0.020, 0.040, 0.0045, 0.015);
    add_sheet(&l, 0.020, 0.040, -0.015, -0.0045);
    add_sheet(&l, 0.060, 0.085, -0.012, 0.012);
    find_clear(&l, clear, beside, &way);
    for (size_t k = 10; k < 57; k++) assert_true(clear[k]);
    for (size_t k = 24; k < 37; k++) {
        assert_true(beside[k]);
        assert_true(way.station[k].width < 0.0018); /* 6 mm and more with the leaflets */
    }
    for (size_t k = 44; k < 56; k++) assert_false(beside[k]);
    for (size_t k = 64; k < way.station_count; k++) assert_false(clear[k]);
}

/* A sheet to both sides of the line, from y0 to y1 off it. */
static void add_pair(leaf *l, double x0, double x1, double y0, double y1)
{
    add_sheet(l, x0, x1, y0, y1);
    add_sheet(l, x0, x1, -y1, -y0);
}

/* Leaflets that lie as near to the rachis as a blade does, for 10 mm, and end a gap before the last one. */
static void check_touching_leaflets(uint64_t seed, double gap)
{
    static leaf l;
    static bool clear[STATIONS], beside[STATIONS];
    plm_leaf_way way;
    l = (leaf){.random = {.key = plm_key(seed, 0)}};
    add_tube(&l, 0, 0.060);
    add_pair(&l, 0.043, 0.053, 0.0018, 0.006);
    add_pair(&l, 0.038, 0.060 - gap, 0.006, 0.020);
    add_sheet(&l, 0.060, 0.085, -0.012, 0.012);
    find_clear(&l, clear, beside, &way);
    for (size_t k = 10; k < 57; k++) assert_true(clear[k]);
    for (size_t k = 64; k < way.station_count; k++) assert_false(clear[k]);
}

static void rachis_is_clear_among_leaflets_that_touch_it(void **state)
{
    (void)state;
    check_touching_leaflets(3, 0.004);
    check_touching_leaflets(4, 0.0016); /* near enough that the graph joins them with the last one */
}

/* Leaflets that hold together with the last one for 3 mm, as dense there as anywhere: it alone is wider beyond. Of so wide a
 * contact noise tells 18 of 20 apart; without hills it was 6. */
static void rachis_is_clear_among_leaflets_that_touch_the_last(void **state)
{
    (void)state;
    static leaf l;
    static bool clear[STATIONS], beside[STATIONS];
    plm_leaf_way way;
    size_t right = 0;
    for (uint64_t seed = 5; seed < 25; seed++) {
        l = (leaf){.random = {.key = plm_key(seed, 0)}};
        add_tube(&l, 0, 0.060);
        add_pair(&l, 0.043, 0.053, 0.0018, 0.006);
        add_pair(&l, 0.038, 0.060, 0.006, 0.020);
        add_sheet(&l, 0.060, 0.068, -0.009, 0.009);
        add_sheet(&l, 0.068, 0.088, -0.014, 0.014);
        find_clear(&l, clear, beside, &way);
        bool good = true;
        for (size_t k = 10; k < 57; k++) good &= clear[k];
        for (size_t k = 66; k < way.station_count; k++) good &= !clear[k];
        right += good;
    }
    assert_true(right >= 17);
}

/* Teeth at the sides of a blade are none: it is parted along no line. */
static void teeth_of_a_blade_are_no_leaflets(void **state)
{
    (void)state;
    static leaf l;
    static bool clear[STATIONS], beside[STATIONS];
    plm_leaf_way way;
    l = (leaf){.random = {.key = plm_key(10, 0)}};
    add_tube(&l, 0, 0.040);
    add_sheet(&l, 0.040, 0.085, -0.010, 0.010);
    add_pair(&l, 0.042, 0.050, 0.010, 0.0135);
    add_pair(&l, 0.054, 0.062, 0.010, 0.0135);
    find_clear(&l, clear, beside, &way);
    for (size_t k = 10; k < 37; k++) assert_true(clear[k]);
    for (size_t k = 44; k < way.station_count; k++) assert_false(clear[k]);
}

/* A blade that is sparse along its middle is a blade all the same. */
static void thin_place_amid_a_blade_is_no_rachis(void **state)
{
    (void)state;
    static leaf l;
    static bool clear[STATIONS], beside[STATIONS];
    plm_leaf_way way;
    l = (leaf){.random = {.key = plm_key(2, 0)}};
    add_tube(&l, 0, 0.030);
    add_sheet(&l, 0.030, 0.090, -0.0017, 0.0017);
    add_sheet(&l, 0.030, 0.055, -0.015, -0.0017);
    add_sheet(&l, 0.030, 0.055, 0.0017, 0.015);
    add_sheet(&l, 0.055, 0.065, 0.0045, 0.015);
    add_sheet(&l, 0.055, 0.065, -0.015, -0.0045);
    add_sheet(&l, 0.065, 0.090, 0.0017, 0.015);
    add_sheet(&l, 0.065, 0.090, -0.015, -0.0017);
    find_clear(&l, clear, beside, &way);
    for (size_t k = 34; k < way.station_count; k++) assert_false(clear[k]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rachis_between_leaflets_is_clear_of_them),
        cmocka_unit_test(rachis_is_clear_among_leaflets_that_touch_it),
        cmocka_unit_test(rachis_is_clear_among_leaflets_that_touch_the_last),
        cmocka_unit_test(teeth_of_a_blade_are_no_leaflets),
        cmocka_unit_test(thin_place_amid_a_blade_is_no_rachis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
