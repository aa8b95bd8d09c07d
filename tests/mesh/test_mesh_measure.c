/* Mesh measures: closed forms, at any scale and place. */
#include "support/test.h"

#include "cloud/linear.h"
#include "mesh/mesh.h"

static const double scales[] = {1e-6, 1e-3, 1, 1e3, 1e6};

/* A rectangle of length x width, tilted about y and turned about z, in columns x rows x 2 triangles. */
static plm_mesh rectangle(double length, double width, double tilt, double heading, const double place[3], int cells)
{
    plm_error error = {0};
    plm_mesh mesh;
    const size_t side = (size_t)cells + 1;
    assert_ok(plm_mesh_create(side * side, 2 * (size_t)cells * (size_t)cells, &mesh, &error));
    for (size_t i = 0; i < side * side; i++) {
        const double u = length * ((double)(i % side) / cells - 0.5), v = width * ((double)(i / side) / cells - 0.5);
        const double x = u * cos(tilt), z = -u * sin(tilt);
        mesh.vertex[i][0] = place[0] + x * cos(heading) - v * sin(heading);
        mesh.vertex[i][1] = place[1] + x * sin(heading) + v * cos(heading);
        mesh.vertex[i][2] = place[2] + z;
    }
    size_t t = 0;
    for (uint32_t row = 0; row < (uint32_t)cells; row++)
        for (uint32_t column = 0; column < (uint32_t)cells; column++) {
            const uint32_t a = row * (uint32_t)side + column, b = a + 1, c = a + (uint32_t)side, d = c + 1;
            memcpy(mesh.triangle[t++], (uint32_t[3]){a, b, d}, sizeof *mesh.triangle);
            memcpy(mesh.triangle[t++], (uint32_t[3]){a, d, c}, sizeof *mesh.triangle);
        }
    return mesh;
}

static void rectangle_has_its_area_and_plane_at_any_scale_tilt_and_place(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double tilts[] = {0, 0.01, 5, 45, 89.99, 90};
    for (size_t s = 0; s < COUNT(scales); s++)
        for (size_t i = 0; i < COUNT(tilts); i++)
            for (int far = 0; far < 2; far++) {
                const double tilt = plm_radians(tilts[i]), heading = 1.1, length = 3 * scales[s], width = scales[s];
                const double place[3] = {far * 5e5, far * 5e6, far * 100};
                /* a coordinate of 5e6 m is known to 1e-9 m: only rectangles that are larger can be measured there */
                const double grain = far ? 5e6 * 0x1p-52 / scales[s] : 0x1p-50;
                if (grain > 1e-4) continue;
                plm_mesh mesh = rectangle(length, width, tilt, heading, place, 8);
                double area;
                plm_plane plane;
                assert_ok(plm_mesh_area(&mesh, &area, &error));
                assert_near(area / (length * width), 1, 10 * grain);
                assert_ok(plm_mesh_plane(&mesh, &plane, &error));
                const double normal[3] = {sin(tilt) * cos(heading), sin(tilt) * sin(heading), cos(tilt)};
                double across[3];
                plm_cross(plane.normal, normal, across);
                assert_near(plm_norm(across), 0, 30 * grain); /* rounding at the corners, over the half width */
                assert_true(plm_dot(plane.normal, normal) > 0);
                for (int axis = 0; axis < 3; axis++)
                    assert_near((plane.centroid[axis] - place[axis]) / scales[s], 0, 10 * grain);
                assert_near(plane.eigenvalue[0] / (length * length / 12), 1, 100 * grain);
                assert_near(plane.eigenvalue[1] / (width * width / 12), 1, 100 * grain);
                assert_near(plane.eigenvalue[2] / (width * width), 0, 100 * grain);
                plm_mesh_free(&mesh);
            }
}

static void needles_keep_their_area(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_mesh mesh;
    assert_ok(plm_mesh_create(3, 1, &mesh, &error));
    memcpy(mesh.triangle[0], (uint32_t[3]){0, 1, 2}, sizeof *mesh.triangle);
    /* corners whose coordinates and differences are exact in double, so that the area is known to the last digit */
    for (int power = 0; power <= 40; power++)
        for (int turn = 0; turn < 3; turn++) {
            const double thin = ldexp(1, -power);
            const double corner[3][3] = {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5 + thin, 0.5 - thin}};
            for (int i = 0; i < 3; i++) memcpy(mesh.vertex[(i + turn) % 3], corner[i], sizeof corner[i]);
            double area;
            assert_ok(plm_mesh_area(&mesh, &area, &error));
            /* |(1, 1, 1) x (0, t, -t)| / 2 = t sqrt(6) / 2 */
            assert_near(area / (thin * sqrt(6) / 2), 1, 1e-15);
        }
    plm_mesh_free(&mesh);
}

static void small_triangles_are_not_lost_beside_large_ones(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_mesh mesh;
    const size_t small = 1000000;
    assert_ok(plm_mesh_create(6, small + 1, &mesh, &error));
    const double corner[6][3] = {{0, 0, 0}, {1e4, 0, 0}, {0, 2e4, 0}, {0, 0, 0}, {1e-4, 0, 0}, {0, 2e-4, 0}};
    memcpy(mesh.vertex, corner, sizeof corner);
    memcpy(mesh.triangle[0], (uint32_t[3]){0, 1, 2}, sizeof *mesh.triangle);
    for (size_t t = 1; t <= small; t++) memcpy(mesh.triangle[t], (uint32_t[3]){3, 4, 5}, sizeof *mesh.triangle);
    double area;
    assert_ok(plm_mesh_area(&mesh, &area, &error));
    assert_true(area == 1e8 + 1e-2); /* the nearest double: plain adding gives 1e8 */
    plm_mesh_free(&mesh);
}

static void sphere_of_triangles_has_equal_moments_and_looks_up(void **unused)
{
    (void)unused;
    plm_error error = {0};
    /* an octahedron: area 4 sqrt(3) r2; second moment per area of each axis r2 / 6 */
    const double corner[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const uint32_t triangle[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    plm_mesh mesh;
    assert_ok(plm_mesh_create(6, 8, &mesh, &error));
    memcpy(mesh.vertex, corner, sizeof corner);
    memcpy(mesh.triangle, triangle, sizeof triangle);
    double area;
    plm_plane plane;
    assert_ok(plm_mesh_area(&mesh, &area, &error));
    assert_near(area, 4 * sqrt(3), 1e-15 * 8);
    assert_ok(plm_mesh_plane(&mesh, &plane, &error));
    for (int i = 0; i < 3; i++) assert_near(plane.eigenvalue[i], 1.0 / 6, 1e-15);
    assert_near(plm_norm(plane.normal), 1, 1e-15);
    assert_true(plane.normal[2] >= 0);
    plm_mesh_free(&mesh);
}

static void meshes_without_area_or_with_wrong_indices_say_so(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_mesh mesh;
    double area = -1;
    plm_plane plane;
    assert_ok(plm_mesh_create(3, 0, &mesh, &error));
    assert_ok(plm_mesh_area(&mesh, &area, &error));
    assert_true(area == 0);
    assert_int_equal(plm_mesh_plane(&mesh, &plane, &error), PLM_E_DEGENERATE);
    plm_mesh_free(&mesh);

    assert_ok(plm_mesh_create(3, 1, &mesh, &error));
    for (int i = 0; i < 3; i++) memcpy(mesh.vertex[i], (double[3]){i, 2 * i, 3 * i}, sizeof *mesh.vertex);
    memcpy(mesh.triangle[0], (uint32_t[3]){0, 1, 2}, sizeof *mesh.triangle);
    assert_ok(plm_mesh_area(&mesh, &area, &error));
    assert_true(area == 0); /* collinear */
    assert_int_equal(plm_mesh_plane(&mesh, &plane, &error), PLM_E_DEGENERATE);

    mesh.triangle[0][2] = 3;
    area = -1;
    assert_int_equal(plm_mesh_area(&mesh, &area, &error), PLM_E_ARGUMENT);
    assert_true(area == -1);
    assert_string_equal(error.message, "triangle 0 names vertex 3; the mesh has 3 vertices");
    plm_mesh_free(&mesh);
}

/* A flat rectangle of 800 triangles needs few: its area stays, and every triangle keeps its organ. Fewer than the rim needs are made
 * as well, from the rim. */
static void decimation_keeps_a_flat_surface_and_its_organs(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double place[3] = {1, 2, 3};
    plm_mesh mesh = rectangle(2, 1, plm_radians(30), 1, place, 20), fewer;
    mesh.face_organ = plm_alloc(mesh.triangle_count, sizeof *mesh.face_organ, &error);
    for (size_t i = 0; i < mesh.triangle_count; i++) mesh.face_organ[i] = 7;
    assert_ok(plm_mesh_decimate(&mesh, 100, &fewer, &error));
    double area = 0;
    assert_ok(plm_mesh_area(&fewer, &area, &error));
    assert_near(area, 2, 1e-9);
    assert_true(fewer.triangle_count <= 100 && fewer.triangle_count >= 2);
    for (size_t i = 0; i < fewer.triangle_count; i++) assert_int_equal(fewer.face_organ[i], 7);
    plm_mesh_free(&fewer);
    assert_ok(plm_mesh_decimate(&mesh, 20, &fewer, &error));
    assert_true(fewer.triangle_count <= 20 && fewer.triangle_count >= 2);
    plm_mesh_free(&fewer);
    /* Three triangles at one edge are no surface; they are shown all the same. */
    memcpy(mesh.triangle[0], (uint32_t[3]){0, 1, 2}, sizeof *mesh.triangle);
    memcpy(mesh.triangle[1], (uint32_t[3]){1, 0, 30}, sizeof *mesh.triangle);
    memcpy(mesh.triangle[2], (uint32_t[3]){0, 1, 50}, sizeof *mesh.triangle);
    mesh.triangle_count = 3;
    assert_ok(plm_mesh_decimate(&mesh, 100, &fewer, &error));
    assert_int_equal(fewer.triangle_count, 3);
    plm_mesh_free(&fewer);
    mesh.triangle[0][0] = 1000000;
    assert_int_equal(plm_mesh_decimate(&mesh, 100, &fewer, &error), PLM_E_ARGUMENT);
    plm_mesh_free(&mesh);
}

/* A mesh far too fine is made coarser first: its area and rim stay to within a cube, and so do its organs. */
static void decimation_of_a_fine_mesh_stays_near_its_shape(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double place[3] = {1, 2, 3};
    plm_mesh mesh = rectangle(2, 1, plm_radians(30), 1, place, 150), fewer;
    mesh.face_organ = plm_alloc(mesh.triangle_count, sizeof *mesh.face_organ, &error);
    for (size_t i = 0; i < mesh.triangle_count; i++) mesh.face_organ[i] = 4;
    assert_true(mesh.triangle_count > 8 * 1000);
    assert_ok(plm_mesh_decimate(&mesh, 1000, &fewer, &error));
    double area = 0;
    assert_ok(plm_mesh_area(&fewer, &area, &error));
    assert_near(area, 2, 0.1); /* half a cube, 0.016, is lost along a rim of 6 */
    assert_true(fewer.triangle_count <= 1000 && fewer.triangle_count >= 500);
    for (size_t i = 0; i < fewer.triangle_count; i++) assert_int_equal(fewer.face_organ[i], 4);
    for (int axis = 0; axis < 3; axis++) assert_true(fewer.origin[axis] == mesh.origin[axis]);
    plm_mesh_free(&fewer);
    plm_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rectangle_has_its_area_and_plane_at_any_scale_tilt_and_place),
        cmocka_unit_test(needles_keep_their_area),
        cmocka_unit_test(small_triangles_are_not_lost_beside_large_ones),
        cmocka_unit_test(sphere_of_triangles_has_equal_moments_and_looks_up),
        cmocka_unit_test(meshes_without_area_or_with_wrong_indices_say_so),
        cmocka_unit_test(decimation_keeps_a_flat_surface_and_its_organs),
        cmocka_unit_test(decimation_of_a_fine_mesh_stays_near_its_shape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
