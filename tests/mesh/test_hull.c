/* Convex hull: equal to CGAL's of all points, whatever lies inside, in a plane, on a line or twice; the same from any
 * order of rows. */
#include "support/test.h"

#include "cloud/linear.h"
#include "mesh/hull_cgal.h"
#include "mesh/mesh.h"

#include <omp.h>

enum { POINTS = 30000 };

static const char *const kinds[] = {"ball",       "sphere",  "normal", "cube",   "grid",
                                    "duplicates", "ellipse", "flat",   "tilted", "plant"};

static void fill(size_t kind, float xyz[][3], size_t count, uint64_t *state)
{
    for (size_t i = 0; i < count; i++) {
        const double gauss[3] = {test_normal(state), test_normal(state), test_normal(state)};
        const double u[3] = {test_uniform(state), test_uniform(state), test_uniform(state)};
        const double length = plm_norm(gauss), ball = cbrt(u[0]) / length, row = (double)(i % 8) * 0.01;
        const double kind_of_point[][3] = {
            {gauss[0] * ball, gauss[1] * ball, gauss[2] * ball},
            {gauss[0] / length, gauss[1] / length, gauss[2] / length},
            {gauss[0], gauss[1], gauss[2]},
            {u[0], u[1], u[2]},
            {floor(u[0] * 30), floor(u[1] * 30), floor(u[2] * 30)},
            {floor(u[0] * 3) * 0.1, floor(u[1] * 3) * 0.1, floor(u[2] * 3) * 0.1},
            {gauss[0] * ball, gauss[1] * ball * 0.01, gauss[2] * ball * 100},
            {u[0], u[1], 0.25},
            {u[0], u[1], u[0] + u[1]}, /* flat but for float rounding */
            {(0.1 * u[0] + row) * u[2], (0.1 * u[1] + row) * u[2], u[2]},
        };
        for (int axis = 0; axis < 3; axis++) xyz[i][axis] = (float)kind_of_point[kind][axis];
    }
}

static void hull_of_all_points(float xyz[][3], size_t count, double *volume, double *area, plm_error *error)
{
    double(*point)[3] = malloc(count * sizeof *point);
    assert_non_null(point);
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) point[i][axis] = xyz[i][axis];
    plm_mesh hull;
    int dimension;
    test_ok(plm_hull_cgal((const double(*)[3])point, count, &hull, &dimension, error), error, "cgal", __FILE__,
            __LINE__);
    assert_true(dimension >= 2);
    *volume = 0;
    for (size_t t = 0; dimension == 3 && t < hull.triangle_count; t++) {
        double corner[3][3], across[3];
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                corner[i][axis] = hull.vertex[hull.triangle[t][i]][axis] - hull.vertex[0][axis];
        plm_cross(corner[1], corner[2], across);
        *volume += plm_dot(corner[0], across) / 6;
    }
    test_ok(plm_mesh_area(&hull, area, error), error, "area", __FILE__, __LINE__);
    plm_mesh_free(&hull);
    free(point);
}

static void hull_equals_that_of_all_points(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 11;
    static float xyz[POINTS][3];
    for (size_t kind = 0; kind < COUNT(kinds); kind++) {
        /* cospherical points are all corners, and take CGAL long */
        const size_t count = kind == 1 ? POINTS / 10 : POINTS;
        fill(kind, xyz, count, &state);
        double volume, area, expected_volume, expected_area;
        assert_ok(plm_convex_hull((const float(*)[3])xyz, count, &volume, &area, NULL, &error));
        hull_of_all_points(xyz, count, &expected_volume, &expected_area, &error);
        print_message("%-10s volume %.9g area %.9g\n", kinds[kind], volume, area);
        /* the volume's digits are those of the extent times the area: flat hulls have few */
        assert_near(volume, expected_volume, 1e-12 * expected_volume + 1e-16 * pow(expected_area, 1.5));
        assert_near(area, expected_area, 1e-12 * expected_area);
        assert_true(kind == 7 ? volume == 0 : volume > 0);
    }
}

static void check_closed(const plm_mesh *hull)
{
    /* every edge stands once in each direction; weights that tell edges apart then cancel */
    double sum = 0;
    for (size_t t = 0; t < hull->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t a = hull->triangle[t][i], b = hull->triangle[t][(i + 1) % 3];
            const double weight = (double)(a < b ? a * 7919u + b : b * 7919u + a);
            sum += a < b ? weight : -weight;
        }
    assert_true(sum == 0);
    assert_int_equal(hull->triangle_count, 2 * hull->vertex_count - 4); /* Euler */
}

static void hull_is_closed_and_the_same_from_any_order_and_any_threads(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 12;
    static float xyz[POINTS][3];
    for (size_t kind = 0; kind < COUNT(kinds); kind++) {
        const size_t count = kind == 1 ? POINTS / 10 : POINTS;
        fill(kind, xyz, count, &state);
        plm_mesh hull[2];
        double volume[2], area[2];
        const int threads = omp_get_max_threads();
        for (int turn = 0; turn < 2; turn++) {
            omp_set_num_threads(turn + 1);
            assert_ok(plm_convex_hull((const float(*)[3])xyz, count, &volume[turn], &area[turn], &hull[turn], &error));
            check_closed(&hull[turn]);
            for (size_t i = count - 1; i > 0; i--) { /* shuffle for the second turn */
                const size_t j = (size_t)(test_uniform(&state) * (double)(i + 1));
                float other[3];
                memcpy(other, xyz[i], sizeof other);
                memcpy(xyz[i], xyz[j], sizeof other);
                memcpy(xyz[j], other, sizeof other);
            }
        }
        omp_set_num_threads(threads);
        assert_true(volume[0] == volume[1] && area[0] == area[1]);
        assert_int_equal(hull[0].vertex_count, hull[1].vertex_count);
        assert_memory_equal(hull[0].vertex, hull[1].vertex, hull[0].vertex_count * sizeof *hull[0].vertex);
        assert_memory_equal(hull[0].triangle, hull[1].triangle, hull[0].triangle_count * sizeof *hull[0].triangle);
        for (int turn = 0; turn < 2; turn++) plm_mesh_free(&hull[turn]);
    }
}

static void cube_has_its_volume_at_any_scale_and_place(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const float scales[] = {1e-6f, 1e-3f, 1, 1e3f, 1e6f};
    for (size_t s = 0; s < COUNT(scales); s++)
        for (int far = 0; far < 2; far++) {
            float xyz[27][3];
            const float place = far ? 8 * scales[s] : 0;
            for (int i = 0; i < 27; i++) {
                const int digit[3] = {i % 3, i / 3 % 3, i / 9};
                for (int axis = 0; axis < 3; axis++) xyz[i][axis] = place + (float)digit[axis] * scales[s];
            }
            double volume, area;
            plm_mesh hull;
            assert_ok(plm_convex_hull((const float(*)[3])xyz, 27, &volume, &area, &hull, &error));
            const double side = 2 * (double)scales[s];
            assert_near(volume / (side * side * side), 1, far ? 1e-5 : 1e-6); /* float rounding of the corners */
            assert_near(area / (6 * side * side), 1, far ? 1e-5 : 1e-6);
            plm_mesh_free(&hull);
        }
}

static void few_flat_and_collinear_points_give_faces_or_a_status(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const float square[5][3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5f, 0.5f, 1}};
    double volume = -1, area = -1;
    plm_mesh hull;
    assert_ok(plm_convex_hull(square, 5, &volume, &area, &hull, &error));
    assert_true(volume == 0 && area == 2 && hull.vertex_count == 4 && hull.triangle_count == 4);
    plm_mesh_free(&hull);
    assert_ok(plm_convex_hull(square, 3, &volume, &area, NULL, &error));
    assert_true(volume == 0 && area == 1);

    float line[2000][3];
    for (int i = 0; i < 2000; i++)
        for (int axis = 0; axis < 3; axis++) line[i][axis] = (float)(i * (axis + 1));
    area = -1;
    const size_t counts[] = {0, 1, 2, 3, 4, 1000, 2000};
    for (size_t i = 0; i < COUNT(counts); i++)
        assert_int_equal(plm_convex_hull((const float(*)[3])line, counts[i], &volume, &area, NULL, &error),
                         PLM_E_DEGENERATE);
    assert_true(area == -1);
    for (int i = 0; i < 2000; i++) memcpy(line[i], line[7], sizeof *line);
    assert_int_equal(plm_convex_hull((const float(*)[3])line, 2000, &volume, &area, NULL, &error), PLM_E_DEGENERATE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hull_equals_that_of_all_points),
        cmocka_unit_test(hull_is_closed_and_the_same_from_any_order_and_any_threads),
        cmocka_unit_test(cube_has_its_volume_at_any_scale_and_place),
        cmocka_unit_test(few_flat_and_collinear_points_give_faces_or_a_status),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
