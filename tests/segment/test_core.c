/* The ends of a stem among leaves that look like tubes: a leaf that hangs below the stem's base is not its base, and one
 * that rises above the top before it bends is not its top. */
#include "support/test.h"

#include "segment/core.h"

enum { STEM = 200, LEAF = 400, LEAVES = 3, FLOATERS = 3, COUNT_ALL = FLOATERS + STEM + LEAVES * LEAF };

/* Floaters first; a stem of height 2, and from it three leaves that arch over and end at -0.5, 0.2 and 0.4. */
static void make(float (*xyz)[3])
{
    static const double foot[LEAVES] = {1.0, 1.3, 1.6}, end[LEAVES] = {-0.5, 0.2, 0.4};
    for (int i = 0; i < FLOATERS; i++, xyz++) xyz[0][0] = (float)(3 + i);
    for (int i = 0; i < STEM; i++) xyz[i][2] = (float)(2.0 * i / (STEM - 1));
    for (int k = 0; k < LEAVES; k++)
        for (int i = 0; i < LEAF; i++) {
            const double t = (double)(i + 1) / LEAF, azimuth = 2.1 * k;
            float *p = xyz[STEM + k * LEAF + i];
            p[0] = (float)(0.6 * t * cos(azimuth));
            p[1] = (float)(0.6 * t * sin(azimuth));
            p[2] = (float)(foot[k] + (end[k] - foot[k]) * t + 3 * t * (1 - t));
        }
}

static void a_hanging_leaf_is_not_the_base(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static float xyz[COUNT_ALL][3];
    static bool is_tube[COUNT_ALL];
    make(xyz);
    for (int i = 0; i < COUNT_ALL; i++) is_tube[i] = true;
    plm_sketch sketch = {.working = {.count = COUNT_ALL, .xyz = xyz}, .is_tube = is_tube};
    assert_ok(plm_graph_build((const float(*)[3])xyz, COUNT_ALL, 6, 0.1, &sketch.graph, &error));
    uint32_t base, top;
    assert_ok(plm_upright_ends(&sketch, &base, &top, &error));
    assert_int_equal(base, FLOATERS);
    assert_int_equal(top, FLOATERS + STEM - 1);
    for (int i = 0; i < COUNT_ALL; i++) is_tube[i] = false;
    assert_ok(plm_upright_ends(&sketch, &base, &top, &error));
    assert_true(base == UINT32_MAX && top == UINT32_MAX);
    plm_graph_free(&sketch.graph);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_hanging_leaf_is_not_the_base)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
