/* Meshes read from files: what was written comes back, polygons become fans, and what is no mesh is refused with its place. */
#include "support/failing.h"
#include "support/test.h"

#include "io/io.h"

static plm_mesh mesh_of(const void *data, size_t size)
{
    plm_error error = {0};
    plm_mesh mesh;
    assert_ok(plm_mesh_parse(data, size, "mesh", &mesh, NULL, &error));
    return mesh;
}

/* A box of 2 x 3 x 5 without its lid, far from the coordinates' origin. */
static plm_mesh box(void)
{
    static const uint32_t triangle[10][3] = {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {1, 2, 6},
                                             {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    plm_error error = {0};
    plm_mesh mesh;
    assert_ok(plm_mesh_create(8, 10, &mesh, &error));
    for (int k = 0; k < 8; k++) {
        mesh.vertex[k][0] = (k % 4 == 1 || k % 4 == 2) ? 2 : 0;
        mesh.vertex[k][1] = k % 4 >= 2 ? 3 : 0;
        mesh.vertex[k][2] = k >= 4 ? 5 : 0;
    }
    memcpy(mesh.triangle, triangle, sizeof triangle);
    mesh.origin[0] = 1000;
    mesh.face_organ = plm_alloc(10, sizeof *mesh.face_organ, &error);
    for (int k = 0; k < 10; k++) mesh.face_organ[k] = k / 2;
    return mesh;
}

static void what_is_written_comes_back(void **state)
{
    (void)state;
    static const char *const names[] = {"box.ply", "box.obj"};
    plm_error error = {0};
    char *folder = test_make_folder(), path[8192];
    for (int k = 0; k < 2; k++) {
        plm_mesh written = box(), found;
        snprintf(path, sizeof path, "%s/%s", folder, names[k]);
        assert_ok(plm_mesh_write(path, &written, &error));
        assert_ok(plm_mesh_read(path, &found, NULL, &error));
        assert_int_equal(found.vertex_count, 8);
        assert_int_equal(found.triangle_count, 10);
        assert_memory_equal(found.triangle, written.triangle, 10 * sizeof *found.triangle);
        for (int v = 0; v < 8; v++)
            for (int i = 0; i < 3; i++) /* the writers keep floats: 1e-7 of 1000 */
                assert_near(found.origin[i] + found.vertex[v][i], written.origin[i] + written.vertex[v][i], 1e-4);
        assert_near(found.origin[0], 1001, 1e-4);
        if (k == 0) assert_memory_equal(found.face_organ, written.face_organ, 10 * sizeof *found.face_organ);
        plm_mesh_free(&found);
        plm_mesh_free(&written);
    }
    test_remove_folder(folder);
}

static const char ascii[] =
    "ply\nformat ascii 1.0\ncomment a square and a pentagon\nelement vertex 5\nproperty float x\n"
    "property float y\nproperty float z\nproperty uchar red\nelement face 2\n"
    "property list uchar int vertex_index\nproperty uchar label\nproperty int organ\n"
    "property list uchar float other\nend_header\n0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n-1 0.5 0 9\n"
    "4 0 1 2 3 3 7 2 0.5 0.5\n5 0 1 2 3 4 1 0 0\n";

static void polygons_become_fans_with_the_label_and_organ_of_their_face(void **state)
{
    (void)state;
    static const uint32_t expected[5][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
    plm_error error = {0};
    plm_mesh mesh;
    uint8_t *label;
    assert_ok(plm_mesh_parse(ascii, sizeof ascii - 1, "x", &mesh, &label, &error));
    assert_int_equal(mesh.triangle_count, 5);
    assert_memory_equal(mesh.triangle, expected, sizeof expected);
    for (int k = 0; k < 5; k++) {
        assert_int_equal(label[k], k < 2 ? PLM_LABEL_LEAF : PLM_LABEL_STEM);
        assert_int_equal(mesh.face_organ[k], k < 2 ? 7 : 0);
    }
    plm_free(label);
    plm_mesh_free(&mesh);
}

/* The same triangle in all bodies that PLY has. */
static void bodies_of_both_byte_orders_are_read(void **state)
{
    (void)state;
    for (int is_big = 0; is_big < 2; is_big++) {
        unsigned char bytes[512];
        int size = snprintf((char *)bytes, sizeof bytes,
                            "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty double x\nproperty short y\n"
                            "property short z\nelement face 1\nproperty list ushort uint vertex_indices\nend_header\n",
                            is_big ? "big" : "little");
        const short y[3] = {0, 0, 300};
        const unsigned corner[3] = {2, 0, 1};
        const unsigned short corners = 3;
        const double x[3] = {0, 4, 0};
        unsigned char *at = bytes + size;
        for (int k = 0; k < 3; k++) {
            const short z = -2;
            const void *part[3] = {&x[k], &y[k], &z};
            const size_t room[3] = {8, 2, 2};
            for (int p = 0; p < 3; p++)
                for (size_t b = 0; b < room[p]; b++)
                    *at++ = ((const unsigned char *)part[p])[is_big ? room[p] - 1 - b : b];
        }
        for (size_t b = 0; b < 2; b++) *at++ = ((const unsigned char *)&corners)[is_big ? 1 - b : b];
        for (int k = 0; k < 3; k++)
            for (size_t b = 0; b < 4; b++) *at++ = ((const unsigned char *)&corner[k])[is_big ? 3 - b : b];
        plm_mesh mesh = mesh_of(bytes, (size_t)(at - bytes));
        assert_memory_equal(mesh.triangle[0], corner, sizeof corner);
        assert_near(mesh.origin[0] + mesh.vertex[1][0], 4, 0);
        assert_near(mesh.origin[1] + mesh.vertex[2][1], 300, 0);
        assert_near(mesh.origin[2] + mesh.vertex[0][2], -2, 0);
        assert_null(mesh.face_organ);
        plm_mesh_free(&mesh);
    }
}

static void obj_counts_from_one_and_back_from_the_end(void **state)
{
    (void)state;
    static const char text[] =
        "# a comment\nmtllib x.mtl\no stem\nv 0 0 0\nv 1 0 0\nv 1 1 0\r\nvt 0 0\nf 1/1 2/1/1 3//1\n"
        "g leaf\nv 0 1 0\nf -4 -2 -1\n";
    static const uint32_t expected[2][3] = {{0, 1, 2}, {0, 2, 3}};
    plm_mesh mesh = mesh_of(text, sizeof text - 1);
    assert_int_equal(mesh.triangle_count, 2);
    assert_memory_equal(mesh.triangle, expected, sizeof expected);
    assert_int_equal(mesh.face_organ[0], 0);
    assert_int_equal(mesh.face_organ[1], 1);
    plm_mesh_free(&mesh);
}

#define PLY(vertices, faces, list)                                                                                     \
    "ply\nformat ascii 1.0\nelement vertex " vertices "\nproperty float x\nproperty float y\nproperty float z\n"       \
    "element face " faces "\nproperty list " list " vertex_indices\nend_header\n"

static void what_is_no_mesh_is_refused_with_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "x: is empty, a mesh was expected"},
        {"hello\n", "x: byte 0: begins with \"hello?\"; a mesh as PLY or OBJ was expected"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 "
         "0 0\n",
         "x: has points but no element face; a mesh was expected"},
        {PLY("3", "0", "uchar int") "0 0 0\n1 0 0\n0 1 0\n", "x: has no faces, a mesh was expected"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
         "x: byte 172: a face names vertex 3 (from 0 on) of 3"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
         "x: byte 172: a face names vertex -1 (from 0 on) of 3"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
         "x: byte 172: a face of 2 corners; at least 3 were expected"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "x: byte 160: vertex 1 has the coordinate nan"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n",
         "x: byte 170: found \"zero\", a number was expected"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 0\n0 1 0\n99 0 1 2\n",
         "x: byte 172: a list of 99 entries; 7 bytes are left"},
        {PLY("3", "1", "uchar int") "0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n",
         "x: byte 180: the file ends within the numbers that its header tells of"},
        {PLY("9999999999", "1", "uchar int") "0 0 0\n", NULL},
        {PLY("3", "9999999999", "uchar int") "0 0 0\n1 0 0\n0 1 0\n", NULL},
        {"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "x: line 3: a face names vertex 2 (from 0 on) of 2"},
        {"v 0 0 0\nv 1 0 0\nv 1 1 1\nf 1 2 0\n", "x: line 4: found \"0\", the number of a vertex was expected"},
        {"v 0 0 0\nv 1 0 0\nf 1 2\n", "x: line 3: a face of 2 corners; at least 3 were expected"},
        {"v 0 0\n", "x: line 1: found \"v 0 0\", v and three coordinates was expected"},
        {"v 0 0 here\n", "x: line 1: found \"here\", a coordinate was expected"},
        {"v 0 0 0\n", "x: has no faces, a mesh was expected"},
    };
    for (size_t k = 0; k < COUNT(cases); k++) {
        plm_error error = {0};
        plm_mesh mesh = {.vertex_count = 77};
        uint8_t *label = (uint8_t *)&mesh;
        assert_int_equal(plm_mesh_parse(cases[k].text, strlen(cases[k].text), "x", &mesh, &label, &error),
                         PLM_E_FORMAT);
        if (cases[k].message) assert_string_equal(error.message, cases[k].message);
        assert_int_equal(mesh.vertex_count, 77); /* outputs are untouched */
        assert_ptr_equal(label, &mesh);
    }
}

static void every_cut_of_a_good_file_is_refused(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_mesh mesh;
    for (size_t cut = 0; cut + 2 < sizeof ascii - 1; cut++) { /* the last number and its line's end */
        char *exact = malloc(cut ? cut : 1);                  /* a block of its own, so that a sanitizer sees its end */
        assert_non_null(exact);
        memcpy(exact, ascii, cut);
        const plm_status status = plm_mesh_parse(exact, cut, "cut", &mesh, NULL, &error);
        free(exact);
        assert_int_equal(status, PLM_E_FORMAT);
    }
}

static void every_allocation_may_fail(void **unused)
{
    (void)unused;
    plm_status status = PLM_E_MEMORY;
    for (long at = 0; status != PLM_OK; at++) {
        plm_error error = {0};
        plm_mesh mesh;
        uint8_t *label;
        test_failing state = {.fail_at = at};
        const plm_allocator allocator = test_failing_allocator(&state);
        plm_set_allocator(&allocator);
        status = plm_mesh_parse(ascii, sizeof ascii - 1, "x", &mesh, &label, &error);
        if (status == PLM_OK) {
            plm_mesh_free(&mesh);
            plm_free(label);
        }
        plm_set_allocator(NULL);
        assert_int_equal(state.alive, 0);
        if (status == PLM_OK)
            assert_true(at > 4);
        else
            assert_int_equal(status, PLM_E_MEMORY);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_comes_back),
        cmocka_unit_test(polygons_become_fans_with_the_label_and_organ_of_their_face),
        cmocka_unit_test(bodies_of_both_byte_orders_are_read),
        cmocka_unit_test(obj_counts_from_one_and_back_from_the_end),
        cmocka_unit_test(what_is_no_mesh_is_refused_with_its_place),
        cmocka_unit_test(every_cut_of_a_good_file_is_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
