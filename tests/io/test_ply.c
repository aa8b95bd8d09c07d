/* PLY in all its forms gives the same cloud; gaussians become surface points; what is wrong is named with its place. */
#include "support/test.h"

#include "io/io.h"

#define HEADER(format, rest) "ply\nformat " format " 1.0\n" rest "end_header\n"

static void parse(const void *data, size_t size, const plm_read_options *options, plm_cloud *cloud,
                  plm_read_report *report)
{
    plm_error error = {0};
    assert_ok(plm_cloud_parse(data, size, "test.ply", options, cloud, report, &error));
}

/* Adds the bytes of a number, in the order asked for. */
static size_t put(unsigned char *to, const void *number, size_t size, bool is_big)
{
    const unsigned char *from = number;
    for (size_t i = 0; i < size; i++) to[i] = from[is_big ? size - 1 - i : i];
    return size;
}

static void three_body_formats_with_lists_and_any_order_give_the_same_cloud(void **unused)
{
    (void)unused;
    static const char rest[] =
        "comment a camera before the points\n"
        "element camera 2\nproperty list uchar float row\nproperty int id\n"
        "element vertex 3\nproperty uchar blue\nproperty double z\nproperty list ushort short seen\n"
        "property float x\nproperty uchar green\nproperty float y\nproperty uchar red\n"
        "element face 1\nproperty list uchar int vertex_indices\n";
    for (int kind = 0; kind < 3; kind++) {
        unsigned char file[2048];
        size_t size =
            (size_t)snprintf((char *)file, sizeof file, "ply\nformat %s 1.0\n%send_header\n",
                             (const char *[]){"ascii", "binary_little_endian", "binary_big_endian"}[kind], rest);
        if (kind == 0) {
            size += (size_t)snprintf((char *)file + size, sizeof file - size,
                                     "2 1.5 2.5 7\n0 8\n\n30 0.125 1 9 1 20 4 10\r\n31 -0.25 0 2e0 21 5.5 11\n"
                                     "32 0.5 2 9 9 3 22 6 12\n3 0 1 2\n");
        } else {
            const bool big = kind == 2;
            for (int camera = 0; camera < 2; camera++) {
                const unsigned char count = camera ? 0 : 2;
                const float number = 1.5f;
                const int32_t id = 7 + camera;
                size += put(file + size, &count, 1, big);
                for (int i = 0; i < count; i++) size += put(file + size, &number, 4, big);
                size += put(file + size, &id, 4, big);
            }
            for (int i = 0; i < 3; i++) {
                const unsigned char blue = (unsigned char)(30 + i), green = (unsigned char)(20 + i);
                const unsigned char red = (unsigned char)(10 + i);
                const double z = (const double[]){0.125, -0.25, 0.5}[i];
                const float x = (float)(i + 1), y = (const float[]){4, 5.5, 6}[i];
                const uint16_t count = (const uint16_t[]){1, 0, 2}[i];
                const int16_t seen = 9;
                size += put(file + size, &blue, 1, big);
                size += put(file + size, &z, 8, big);
                size += put(file + size, &count, 2, big);
                for (int j = 0; j < count; j++) size += put(file + size, &seen, 2, big);
                size += put(file + size, &x, 4, big);
                size += put(file + size, &green, 1, big);
                size += put(file + size, &y, 4, big);
                size += put(file + size, &red, 1, big);
            }
        }
        plm_cloud cloud;
        plm_read_report report;
        parse(file, size, NULL, &cloud, &report);
        assert_int_equal(cloud.count, 3);
        assert_int_equal(report.rows, 3);
        assert_int_equal(report.format, PLM_FORMAT_PLY);
        const float expected[3][3] = {{1, 4, 0.125f}, {2, 5.5f, -0.25f}, {3, 6, 0.5f}};
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                assert_true(cloud.origin[k] + (double)cloud.xyz[i][k] == (double)expected[i][k]);
                assert_int_equal(cloud.rgb[i][k], 10 * (k + 1) + i);
            }
        assert_null(cloud.normal);
        assert_null(cloud.source);
        plm_cloud_free(&cloud);
    }
}

static void colours_of_unit_floats_are_bytes_and_normals_are_unit(void **unused)
{
    (void)unused;
    static const char file[] =
        HEADER("ascii", "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                        "property float nx\nproperty float ny\nproperty float nz\n"
                        "property float red\nproperty float green\nproperty float blue\n") //
        "0 0 0 0 0 2 0 0.5 1\n1 1 1 nan 0 0 0.2 0.4 0.6\n";
    plm_cloud cloud;
    parse(file, sizeof file - 1, NULL, &cloud, NULL);
    const uint8_t rgb[2][3] = {{0, 128, 255}, {51, 102, 153}};
    assert_memory_equal(cloud.rgb, rgb, sizeof rgb);
    assert_true(cloud.normal[0][2] == 1.0f);
    assert_true(cloud.normal[1][0] == 0.0f); /* not a number: no normal */
    plm_cloud_free(&cloud);
}

static void rows_that_are_not_finite_are_dropped_counted_and_remembered(void **unused)
{
    (void)unused;
    static const char file[] =
        HEADER("ascii", "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n") //
        "0 0 0\nnan 0 0\n1 inf 0\n1e30 0 0\n1 1 1\n";
    plm_cloud cloud;
    plm_read_report report;
    parse(file, sizeof file - 1, NULL, &cloud, &report);
    assert_int_equal(cloud.count, 2);
    assert_int_equal(report.rows, 5);
    assert_int_equal(report.dropped_not_finite, 3);
    assert_int_equal(cloud.source[0], 0);
    assert_int_equal(cloud.source[1], 4);
    plm_cloud_free(&cloud);
}

#define SPLAT                                                                                                          \
    "element vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty float f_dc_0\n"                  \
    "property float f_dc_1\nproperty float f_dc_2\nproperty float opacity\nproperty float scale_0\n"                   \
    "property float scale_1\nproperty float scale_2\nproperty float rot_0\nproperty float rot_1\n"                     \
    "property float rot_2\nproperty float rot_3\n"

static void gaussians_become_points_with_axes_colour_and_opacity(void **unused)
{
    (void)unused;
    /* Turned by 90 degrees about x: y goes to z, z to -y. Shortest axis: the file's second. The other is transparent.
     */
    static const char file[] = HEADER("ascii", SPLAT) "1 2 3 0 1 -9 0 -3 -6 -2 5 5 0 0\n0 0 0 0 0 0 -6 0 0 0 1 0 0 0\n";
    plm_cloud cloud;
    plm_read_report report;
    parse(file, sizeof file - 1, NULL, &cloud, &report);
    assert_int_equal(report.format, PLM_FORMAT_SPLAT);
    assert_int_equal(cloud.count, 1);
    assert_int_equal(report.dropped_transparent, 1);
    assert_near(cloud.opacity[0], 0.5, 1e-7);
    assert_near(cloud.extent[0][0], exp(-2), 1e-8);
    assert_near(cloud.extent[0][1], exp(-3), 1e-8);
    assert_near(fabs((double)cloud.normal[0][2]), 1, 1e-7);
    assert_int_equal(cloud.rgb[0][0], 128);
    assert_int_equal(cloud.rgb[0][1], (int)(255 * (0.5 + 0.28209479177387814) + 0.5));
    assert_int_equal(cloud.rgb[0][2], 0);
    plm_cloud_free(&cloud);

    const plm_read_options five = {.splat_points = 5, .minimum_opacity = 0.001};
    parse(file, sizeof file - 1, &five, &cloud, &report);
    assert_int_equal(cloud.count, 10);
    double low[3] = {9, 9, 9}, high[3] = {-9, -9, -9};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], cloud.origin[k] + (double)cloud.xyz[i][k]);
            high[k] = fmax(high[k], cloud.origin[k] + (double)cloud.xyz[i][k]);
            assert_int_equal(cloud.source[i], 0);
        }
    const double reach[3] = {exp(-3), exp(-2), 0}; /* x stays; the file's z, the longest, lies along y now */
    for (int k = 0; k < 3; k++) {
        assert_near(low[k], k + 1 - reach[k], 1e-6);
        assert_near(high[k], k + 1 + reach[k], 1e-6);
    }
    plm_cloud_free(&cloud);
}

#define LABELLED                                                                                                       \
    HEADER("ascii", "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"                         \
                    "property float scalar_label\nproperty int organ\n")                                               \
    "0 0 0 1 0\n1 0 0 3 4\n2 0 0 3 -1\n3 0 0 7 2\n"

static void labels_are_read_when_asked_for_in_either_scheme(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud = {.count = 77};
    plm_read_report report;
    parse(LABELLED, sizeof LABELLED - 1, NULL, &cloud, &report);
    assert_null(cloud.label);
    assert_string_equal(report.label_field, "scalar_label");
    assert_string_equal(report.fields, "x,y,z,scalar_label,organ");
    plm_cloud_free(&cloud);

    const plm_read_options instances = {.label_field = "label", .label_scheme = PLM_LABELS_INSTANCES, .stem_label = 3};
    parse(LABELLED, sizeof LABELLED - 1, &instances, &cloud, &report);
    const uint8_t label[] = {PLM_LABEL_LEAF, PLM_LABEL_STEM, PLM_LABEL_STEM, PLM_LABEL_LEAF};
    const int32_t organ[] = {0, 0, 0, 1};
    assert_memory_equal(cloud.label, label, sizeof label);
    assert_memory_equal(cloud.organ, organ, sizeof organ);
    plm_cloud_free(&cloud);

    const plm_read_options classes = {.label_field = "4"};
    cloud.count = 77;
    assert_int_equal(plm_cloud_parse(LABELLED, sizeof LABELLED - 1, "a.ply", &classes, &cloud, &report, &error),
                     PLM_E_FORMAT);
    assert_int_equal(cloud.count, 77);
    assert_non_null(strstr(error.message, "a.ply: point 4: label 7"));

    const plm_read_options absent = {.label_field = "class"};
    assert_int_equal(plm_cloud_parse(LABELLED, sizeof LABELLED - 1, "a.ply", &absent, &cloud, &report, &error),
                     PLM_E_ARGUMENT);
    assert_non_null(strstr(error.message, "\"class\""));
}

/* A list has no number a point: by its number or by no name it was taken for labels, and its missing numbers were read. */
static void lists_are_no_field(void **unused)
{
    (void)unused;
    static const char *const bodies[] = {"ascii", "binary_little_endian"};
    static const char *const fields[] = {"4", "", "seen", "scalar_"};
    for (int kind = 0; kind < 2; kind++)
        for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
            char file[512] = "";
            int head = snprintf(file, sizeof file,
                                "ply\nformat %s 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                                "property float z\nproperty list uchar uchar seen\nend_header\n%s",
                                bodies[kind], kind ? "" : "1 2 3 2 4 5\n");
            if (kind) head += 14; /* three floats of 0, a length of 0, and one byte more */
            const plm_read_options options = {.label_field = fields[i]};
            plm_error error = {0};
            plm_cloud cloud = {0};
            assert_int_equal(plm_cloud_parse(file, (size_t)head, "a.ply", &options, &cloud, NULL, &error),
                             PLM_E_ARGUMENT);
            assert_non_null(strstr(error.message, "no field"));
        }
}

static void labelled_clouds_of_the_data_folder_are_read_and_written_the_same(void **unused)
{
    (void)unused;
    const char *data = test_data_folder();
    if (!data) skip();
    plm_error error = {0};
    char path[8192], *folder = test_make_folder();
    const plm_read_options options = {.label_field = "label"};
    plm_cloud cloud, again;
    plm_read_report report;
    snprintf(path, sizeof path, "%s/dev/pepper_12_clean.labelled.ply", data);
    assert_ok(plm_cloud_read(path, &options, &cloud, &report, &error));
    assert_int_equal(cloud.count, 70000);
    snprintf(path, sizeof path, "%s/again.ply", folder);
    assert_ok(plm_cloud_write(path, &cloud, &error));
    assert_ok(plm_cloud_read(path, &options, &again, NULL, &error));
    assert_memory_equal(cloud.xyz, again.xyz, cloud.count * sizeof *cloud.xyz);
    assert_memory_equal(cloud.rgb, again.rgb, cloud.count * sizeof *cloud.rgb);
    assert_memory_equal(cloud.label, again.label, cloud.count * sizeof *cloud.label);
    assert_memory_equal(cloud.organ, again.organ, cloud.count * sizeof *cloud.organ);
    plm_cloud_free(&cloud);
    plm_cloud_free(&again);
    test_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_body_formats_with_lists_and_any_order_give_the_same_cloud),
        cmocka_unit_test(colours_of_unit_floats_are_bytes_and_normals_are_unit),
        cmocka_unit_test(rows_that_are_not_finite_are_dropped_counted_and_remembered),
        cmocka_unit_test(gaussians_become_points_with_axes_colour_and_opacity),
        cmocka_unit_test(labels_are_read_when_asked_for_in_either_scheme),
        cmocka_unit_test(lists_are_no_field),
        cmocka_unit_test(labelled_clouds_of_the_data_folder_are_read_and_written_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
