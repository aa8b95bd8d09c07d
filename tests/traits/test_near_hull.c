/* Points near a hull: the same as by testing every point against every face, which takes points times faces. */
#include "support/test.h"

#include "mesh/mesh.h"
#include "traits/near_hull.h"

enum { COUNT = 20000 };

static double depth_below(const plm_mesh *hull, size_t face, const float point[3])
{
    const double *a = hull->vertex[hull->triangle[face][0]], *b = hull->vertex[hull->triangle[face][1]];
    const double *c = hull->vertex[hull->triangle[face][2]];
    double u[3], v[3], n[3], length = 0, depth = 0;
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    for (int k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (int k = 0; k < 3; k++) length += n[k] * n[k];
    for (int k = 0; k < 3; k++) depth += n[k] / sqrt(length) * (a[k] + hull->origin[k] - (double)point[k]);
    return depth;
}

/* A point is on the edge of being near where two ways to compute its depth may differ. */
static void compare(float (*xyz)[3], const bool *use, double depth)
{
    plm_error error = {0};
    plm_mesh hull = {0};
    double volume, area;
    bool *near = malloc(COUNT * sizeof *near);
    assert_non_null(near);
    size_t found, expected = 0, unsure = 0;
    assert_ok(plm_convex_hull((const float(*)[3])xyz, COUNT, &volume, &area, &hull, &error));
    assert_ok(plm_near_hull(&hull, (const float(*)[3])xyz, use, COUNT, depth, near, &found, &error));
    for (size_t i = 0; i < COUNT; i++) {
        double least = INFINITY;
        for (size_t f = 0; f < hull.triangle_count; f++) least = fmin(least, depth_below(&hull, f, xyz[i]));
        if (fabs(least - depth) < 1e-9 * cbrt(volume)) {
            unsure++;
            continue;
        }
        if (near[i] != (use[i] && least < depth))
            fail_msg("point %zu at depth %g of %g: near is %d", i, least, depth, near[i]);
        expected += near[i];
    }
    assert_true(unsure < COUNT / 100);
    assert_in_range(found, expected, expected + unsure);
    assert_true(found > 0 && found < COUNT);
    plm_mesh_free(&hull);
    free(near);
}

static void boxes_drop_no_point_of_a_ball_or_a_sheet(void **unused)
{
    (void)unused;
    float(*xyz)[3] = malloc(COUNT * sizeof *xyz);
    bool *use = malloc(COUNT * sizeof *use);
    assert_true(xyz && use);
    /* ball; flat disc; far from the origin, where coordinates are coarse */
    static const double flat[] = {1, 0.01, 0.3}, away[] = {0, 0, 1e3};
    for (int shape = 0; shape < 3; shape++) {
        uint64_t state = 3 + (uint64_t)shape;
        for (int i = 0; i < COUNT; i++) {
            double p[3], square;
            do {
                square = 0;
                for (int k = 0; k < 3; k++) p[k] = 2 * test_uniform(&state) - 1, square += p[k] * p[k];
            } while (square > 1);
            p[2] *= flat[shape];
            for (int k = 0; k < 3; k++) xyz[i][k] = (float)(0.1 * p[k] + away[shape]);
            use[i] = i % 7 != 0;
        }
        compare(xyz, use, shape == 1 ? 1e-4 : 2e-3);
    }
    free(xyz);
    free(use);
}

/* All points near, many of them in one place. */
static void nothing_is_lost_where_boxes_cannot_be_halved(void **unused)
{
    (void)unused;
    float(*xyz)[3] = malloc(COUNT * sizeof *xyz);
    bool *use = malloc(COUNT * sizeof *use), *near = malloc(COUNT * sizeof *near);
    assert_true(xyz && use && near);
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) xyz[i][k] = (float)(i % 8 >> k & 1);
        use[i] = true;
    }
    plm_error error = {0};
    plm_mesh hull = {0};
    double volume, area;
    size_t found;
    assert_ok(plm_convex_hull((const float(*)[3])xyz, COUNT, &volume, &area, &hull, &error));
    assert_ok(plm_near_hull(&hull, (const float(*)[3])xyz, use, COUNT, 1e-6, near, &found, &error));
    assert_int_equal(found, COUNT);
    plm_mesh_free(&hull);
    free(xyz);
    free(use);
    free(near);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_drop_no_point_of_a_ball_or_a_sheet),
        cmocka_unit_test(nothing_is_lost_where_boxes_cannot_be_halved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
