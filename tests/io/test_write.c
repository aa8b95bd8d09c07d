/* What is written comes back: the same cloud, and the same bytes from a second write. Nothing half-written is left. */
#include "support/test.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/io.h"

enum { POINTS = 300 };

/* A cloud of size 1 with all attributes at the given place. */
static plm_cloud make_cloud(unsigned attributes, const double origin[3])
{
    plm_error error = {0};
    plm_cloud cloud;
    uint64_t state = 11;
    assert_ok(plm_cloud_create(POINTS, attributes, &cloud, &error));
    memcpy(cloud.origin, origin, sizeof cloud.origin);
    for (int i = 0; i < POINTS; i++) {
        double normal[3], length = 0;
        for (int k = 0; k < 3; k++) {
            cloud.xyz[i][k] = (float)(test_uniform(&state) - 0.5);
            if (cloud.rgb) cloud.rgb[i][k] = (uint8_t)(test_uniform(&state) * 256);
            normal[k] = test_normal(&state);
            length += normal[k] * normal[k];
        }
        for (int k = 0; k < 3 && cloud.normal; k++) cloud.normal[i][k] = (float)(normal[k] / sqrt(length));
        for (int k = 0; k < 2 && cloud.extent; k++) cloud.extent[i][k] = (float)test_uniform(&state);
        if (cloud.opacity) cloud.opacity[i] = (float)test_uniform(&state);
        if (cloud.label) cloud.label[i] = (uint8_t)(i % PLM_LABEL_COUNT);
        if (cloud.organ) cloud.organ[i] = i % 7 - 1;
        if (cloud.leaflet) cloud.leaflet[i] = i % 5 - 1;
    }
    return cloud;
}

static size_t read_file(const char *path, char *to, size_t room)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(to, 1, room, file);
    fclose(file);
    assert_true(size < room);
    return size;
}

static void assert_same_attributes(const plm_cloud *a, const plm_cloud *b)
{
    assert_int_equal(plm_cloud_attributes(a), plm_cloud_attributes(b));
    if (a->rgb) assert_memory_equal(a->rgb, b->rgb, POINTS * sizeof *a->rgb);
    for (int i = 0; i < POINTS && a->normal; i++)
        for (int k = 0; k < 3; k++) /* normals are made unit again */
            assert_near((double)a->normal[i][k], (double)b->normal[i][k], 1.2e-7);
    if (a->extent) assert_memory_equal(a->extent, b->extent, POINTS * sizeof *a->extent);
    if (a->opacity) assert_memory_equal(a->opacity, b->opacity, POINTS * sizeof *a->opacity);
    if (a->label) assert_memory_equal(a->label, b->label, POINTS * sizeof *a->label);
    if (a->organ) assert_memory_equal(a->organ, b->organ, POINTS * sizeof *a->organ);
}

static void every_format_brings_back_every_attribute_and_the_same_bytes(void **unused)
{
    (void)unused;
    static const char *const endings[] = {"ply", "pcd", "xyz", "txt", "csv", "PLY"};
    static const unsigned attributes[] = {0, PLM_HAS_RGB | PLM_HAS_NORMAL | PLM_HAS_LABEL | PLM_HAS_ORGAN,
                                          PLM_HAS_RGB | PLM_HAS_NORMAL | PLM_HAS_EXTENT | PLM_HAS_OPACITY};
    static const double origins[][3] = {{0, 0, 0}, {0.1, -0.2, 0.3}, {478751.296, 5427032.945, 318.9}, {-3, 750, 0}};
    static char first[1 << 20], second[1 << 20];
    char path[8192], *folder = test_make_folder();
    plm_error error = {0};
    for (size_t e = 0; e < COUNT(endings); e++)
        for (size_t a = 0; a < COUNT(attributes); a++)
            for (size_t o = 0; o < COUNT(origins); o++) {
                plm_cloud cloud = make_cloud(attributes[a], origins[o]), again, third;
                const plm_read_options options = {.label_field = cloud.label ? "label" : NULL};
                snprintf(path, sizeof path, "%s/cloud.%s", folder, endings[e]);
                assert_ok(plm_cloud_write(path, &cloud, &error));
                assert_ok(plm_cloud_read(path, &options, &again, NULL, &error));
                for (int i = 0; i < POINTS; i++)
                    for (int k = 0; k < 3; k++) /* the header's promise: 1e-7 of the cloud's size of 1 */
                        assert_near(again.origin[k] + (double)again.xyz[i][k],
                                    cloud.origin[k] + (double)cloud.xyz[i][k], 1e-7);
                assert_same_attributes(&cloud, &again);
                assert_ok(plm_cloud_write(path, &again, &error)); /* normals may have turned in the last digit */
                const size_t size = read_file(path, first, sizeof first);
                assert_ok(plm_cloud_read(path, &options, &third, NULL, &error));
                assert_memory_equal(third.origin, again.origin, sizeof again.origin);
                assert_memory_equal(third.xyz, again.xyz, POINTS * sizeof *again.xyz);
                if (!cloud.normal) {
                    assert_ok(plm_cloud_write(path, &third, &error));
                    assert_int_equal(read_file(path, second, sizeof second), size);
                    assert_memory_equal(first, second, size);
                }
                plm_cloud_free(&cloud);
                plm_cloud_free(&again);
                plm_cloud_free(&third);
            }
    test_remove_folder(folder);
}

static void labelled_ply_says_what_its_numbers_mean(void **unused)
{
    (void)unused;
    static const char expected[] = "ply\nformat binary_little_endian 1.0\n"
                                   "comment label 0 other, 1 stem, 2 petiole, 3 leaf, 4 ground\n"
                                   "comment organ is the number of the organ within its class, -1 for none\n"
                                   "element vertex 300\nproperty float x\nproperty float y\nproperty float z\n"
                                   "property uchar label\nproperty int organ\nend_header\n";
    static char file[1 << 16];
    char path[8192], *folder = test_make_folder();
    plm_error error = {0};
    plm_cloud cloud = make_cloud(PLM_HAS_LABEL | PLM_HAS_ORGAN, (const double[3]){0, 0, 0});
    snprintf(path, sizeof path, "%s/cloud.ply", folder);
    assert_ok(plm_cloud_write(path, &cloud, &error));
    assert_int_equal(read_file(path, file, sizeof file), sizeof expected - 1 + POINTS * 17);
    assert_memory_equal(file, expected, sizeof expected - 1);
    plm_cloud_free(&cloud);
    test_remove_folder(folder);
}

static void leaflets_are_written_behind_organs(void **unused)
{
    (void)unused;
    static const char end[] = "comment leaflet is the number of the leaflet within its compound leaf, -1 for none\n"
                              "element vertex 300\nproperty float x\nproperty float y\nproperty float z\n"
                              "property uchar label\nproperty int organ\nproperty int leaflet\nend_header\n";
    static char file[1 << 16];
    char path[8192], *folder = test_make_folder();
    plm_error error = {0};
    plm_cloud cloud = make_cloud(PLM_HAS_LABEL | PLM_HAS_ORGAN | PLM_HAS_LEAFLET, (const double[3]){0, 0, 0});
    snprintf(path, sizeof path, "%s/cloud.ply", folder);
    assert_ok(plm_cloud_write(path, &cloud, &error));
    const size_t row = 21, size = read_file(path, file, sizeof file), header = size - POINTS * row;
    assert_true(size > POINTS * row + sizeof end);
    assert_memory_equal(file + header - (sizeof end - 1), end, sizeof end - 1);
    for (size_t i = 0; i < POINTS; i++) {
        assert_memory_equal(file + header + i * row + 13, &cloud.organ[i], sizeof *cloud.organ);
        assert_memory_equal(file + header + i * row + 17, &cloud.leaflet[i], sizeof *cloud.leaflet);
    }
    static const char *const others[][2] = {{"pcd", "FIELDS x y z label organ leaflet\n"},
                                            {"csv", "x,y,z,label,organ,leaflet\n"},
                                            {"txt", "x y z label organ leaflet\n"}};
    for (size_t k = 0; k < COUNT(others); k++) {
        snprintf(path, sizeof path, "%s/cloud.%s", folder, others[k][0]);
        assert_ok(plm_cloud_write(path, &cloud, &error));
        file[read_file(path, file, sizeof file - 1)] = 0;
        assert_non_null(strstr(file, others[k][1]));
    }
    plm_cloud_free(&cloud);
    test_remove_folder(folder);
}

static size_t files_in(const char *folder)
{
    size_t count = 0;
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory));) count += entry->d_name[0] != '.';
    closedir(directory);
    return count;
}

static void files_that_cannot_be_written_leave_nothing(void **unused)
{
    (void)unused;
    char path[8192], *folder = test_make_folder();
    plm_error error = {0};
    plm_cloud cloud = make_cloud(0, (const double[3]){0, 0, 0});
    assert_int_equal(plm_cloud_write("cloud.stl", &cloud, &error), PLM_E_ARGUMENT);
    assert_non_null(strstr(error.message, "cloud.stl"));
    snprintf(path, sizeof path, "%s/no/cloud.ply", folder);
    assert_int_equal(plm_cloud_write(path, &cloud, &error), PLM_E_WRITE);
    assert_non_null(strstr(error.message, path));
    snprintf(path, sizeof path, "%s/cloud.ply", folder);
    assert_int_equal(mkdir(path, 0700), 0); /* renaming onto a folder fails */
    assert_int_equal(plm_cloud_write(path, &cloud, &error), PLM_E_WRITE);
    assert_int_equal(files_in(folder), 1);
    plm_output *output;
    snprintf(path, sizeof path, "%s/table.csv", folder);
    assert_ok(plm_output_open(path, &output, &error));
    assert_ok(plm_output_print(output, &error, "%d,%g\n", 1, 2.5));
    assert_ok(plm_output_close(output, false, &error)); /* given up */
    assert_int_equal(files_in(folder), 1);
    plm_cloud_free(&cloud);
    test_remove_folder(folder);
}

static void digests_are_those_of_the_standard(void **unused)
{
    (void)unused;
    /* FIPS 180-4 examples: "", "abc", two blocks, and a million letters a. */
    static const struct {
        const char *text, *digest;
        size_t repeat;
    } cases[] = {
        {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855", 1},
        {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad", 1},
        {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
         "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1", 1},
        {"a", "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0", 1000000},
    };
    char path[8192], digest[65], *folder = test_make_folder();
    plm_error error = {0};
    snprintf(path, sizeof path, "%s/bytes", folder);
    for (size_t i = 0; i < COUNT(cases); i++) {
        plm_output *output;
        assert_ok(plm_output_open(path, &output, &error));
        for (size_t k = 0; k < cases[i].repeat; k++) assert_ok(plm_output_print(output, &error, "%s", cases[i].text));
        assert_ok(plm_output_close(output, true, &error));
        assert_ok(plm_file_sha256(path, digest, &error));
        assert_string_equal(digest, cases[i].digest);
    }
    assert_int_equal(plm_file_sha256(folder, digest, &error), PLM_E_READ);
    test_remove_folder(folder);
}

static plm_mesh make_mesh(const double origin[3])
{
    static const double corner[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
    static const uint32_t triangle[3][3] = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}; /* three at one edge */
    plm_error error = {0};
    plm_mesh mesh;
    assert_ok(plm_mesh_create(5, 3, &mesh, &error));
    memcpy(mesh.vertex, corner, sizeof corner);
    memcpy(mesh.triangle, triangle, sizeof triangle);
    memcpy(mesh.origin, origin, sizeof mesh.origin);
    mesh.face_organ = plm_alloc(3, sizeof *mesh.face_organ, &error);
    assert_non_null(mesh.face_organ);
    for (int i = 0; i < 3; i++) mesh.face_organ[i] = i - 1;
    return mesh;
}

static void meshes_are_written_with_all_their_triangles_and_organs(void **unused)
{
    (void)unused;
    static char file[1 << 16];
    char path[8192], *folder = test_make_folder();
    plm_error error = {0};
    plm_mesh mesh = make_mesh((const double[3]){2, 0, 0});
    plm_cloud vertices;
    snprintf(path, sizeof path, "%s/mesh.ply", folder);
    assert_ok(plm_mesh_write(path, &mesh, &error));
    const size_t size = read_file(path, file, sizeof file - 1);
    assert_non_null(strstr(file, "element face 3\n"));
    assert_non_null(strstr(file, "property uchar red\n"));
    assert_non_null(strstr(file, "property int organ\n"));
    const size_t row = 1 + 3 * 4 + 3 + 4; /* of a face: count, vertices, colour, organ */
    for (int i = 0; i < 3; i++) {
        int32_t organ;
        memcpy(&organ, file + size - (size_t)(3 - i) * row + row - 4, sizeof organ);
        assert_int_equal(organ, i - 1);
    }
    assert_ok(plm_cloud_read(path, NULL, &vertices, NULL, &error)); /* the vertices are a cloud */
    assert_int_equal(vertices.count, 5);
    assert_near(vertices.origin[0] + (double)vertices.xyz[1][0], 3, 0);
    plm_cloud_free(&vertices);

    snprintf(path, sizeof path, "%s/mesh.obj", folder);
    assert_ok(plm_mesh_write(path, &mesh, &error));
    file[read_file(path, file, sizeof file - 1)] = 0;
    assert_non_null(strstr(file, "v 3 0 0\n"));
    assert_non_null(strstr(file, "f 1 2 5\n"));
    snprintf(path, sizeof path, "%s/mesh.stl", folder);
    assert_ok(plm_mesh_write(path, &mesh, &error));
    assert_int_equal(read_file(path, file, sizeof file), 84 + 3 * 50);

    mesh.origin[1] = 5427032.9; /* a float would lose 0.2 m there: the file is relative to the origin */
    snprintf(path, sizeof path, "%s/mesh.obj", folder);
    assert_ok(plm_mesh_write(path, &mesh, &error));
    file[read_file(path, file, sizeof file - 1)] = 0;
    assert_non_null(strstr(file, "v 1 0 0\n"));
    mesh.triangle[2][1] = 5;
    assert_int_equal(plm_mesh_write(path, &mesh, &error), PLM_E_ARGUMENT);
    plm_mesh_free(&mesh);
    test_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_brings_back_every_attribute_and_the_same_bytes),
        cmocka_unit_test(labelled_ply_says_what_its_numbers_mean),
        cmocka_unit_test(leaflets_are_written_behind_organs),
        cmocka_unit_test(files_that_cannot_be_written_leave_nothing),
        cmocka_unit_test(digests_are_those_of_the_standard),
        cmocka_unit_test(meshes_are_written_with_all_their_triangles_and_organs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
