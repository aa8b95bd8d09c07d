/* PCD and LAS in all their forms give the same points, colours and classes. */
#include "support/test.h"

#include "io/io.h"

static plm_read_report report;

static plm_cloud parse(const void *data, size_t size, const plm_read_options *options)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_parse(data, size, "file", options, &cloud, &report, &error));
    return cloud;
}

#define PCD_HEADER                                                                                                     \
    "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z _ rgb label\nSIZE 4 4 8 1 4 2\n"            \
    "TYPE F F F U F I\nCOUNT 1 1 1 3 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"

enum { PCD_ROW = 25 };

static void pcd_rows(unsigned char rows[2][PCD_ROW])
{
    for (int i = 0; i < 2; i++) {
        const float x = (float)i + 0.5f, y = -2.25f;
        const double z = 1.0 + 1e-7 * i;
        const uint32_t colour = 0x0a141e + (uint32_t)i;
        const int16_t label = (int16_t)(3 - i);
        unsigned char *at = rows[i];
        memcpy(at, &x, 4);
        memcpy(at + 4, &y, 4);
        memcpy(at + 8, &z, 8);
        memset(at + 16, 9, 3);
        memcpy(at + 19, &colour, 4);
        memcpy(at + 23, &label, 2);
    }
}

/* Fields one after the other, as literals, but for the padding, which is a back reference. */
static size_t pcd_compressed(unsigned char rows[2][PCD_ROW], unsigned char *to)
{
    static const int field[][2] = {{0, 4}, {4, 4}, {8, 8}, {16, 3}, {19, 4}, {23, 2}};
    size_t used = 8;
    for (size_t k = 0; k < COUNT(field); k++) {
        if (k == 3) { /* 9, then five more of the byte before */
            const unsigned char run[] = {0, 9, 3 << 5, 0};
            memcpy(to + used, run, sizeof run);
            used += sizeof run;
            continue;
        }
        to[used++] = (unsigned char)(2 * field[k][1] - 1);
        for (int i = 0; i < 2; i++, used += (size_t)field[k][1])
            memcpy(to + used, rows[i] + field[k][0], (size_t)field[k][1]);
    }
    const uint32_t sizes[2] = {(uint32_t)used - 8, 2 * PCD_ROW};
    memcpy(to, sizes, sizeof sizes);
    return used;
}

static void three_bodies_of_pcd_give_the_same_cloud(void **unused)
{
    (void)unused;
    unsigned char file[2048], rows[2][PCD_ROW];
    const plm_read_options options = {.label_field = "label"};
    pcd_rows(rows);
    for (int kind = 0; kind < 4; kind++) {
        size_t size = (size_t)sprintf((char *)file, PCD_HEADER "DATA %s\n",
                                      (const char *[]){"ascii", "ascii", "binary", "binary_compressed"}[kind]);
        if (kind == 0) /* the colour as PCL prints it: the float that has its bits */
            size += (size_t)sprintf((char *)file + size, "0.5 -2.25 1 9 9 9 %.9g 3\n1.5 -2.25 1.0000001 9 9 9 %.9g 2\n",
                                    660510 * 0x1p-149, 660511 * 0x1p-149);
        if (kind == 1)
            size += (size_t)sprintf((char *)file + size,
                                    "0.5 -2.25 1 9 9 9 660510 3\n1.5 -2.25 1.0000001 9 9 9 660511 2\n");
        if (kind == 2) {
            memcpy(file + size, rows, sizeof rows);
            size += sizeof rows;
        }
        if (kind == 3) size += pcd_compressed(rows, file + size);
        plm_cloud cloud = parse(file, size, &options);
        assert_int_equal(report.format, PLM_FORMAT_PCD);
        assert_int_equal(cloud.count, 2);
        for (int i = 0; i < 2; i++) {
            assert_near(cloud.origin[0] + (double)cloud.xyz[i][0], i + 0.5, 1e-7);
            assert_near(cloud.origin[1] + (double)cloud.xyz[i][1], -2.25, 0);
            assert_near(cloud.origin[2] + (double)cloud.xyz[i][2], 1 + 1e-7 * i, 1e-13);
            assert_int_equal(cloud.rgb[i][0], 10);
            assert_int_equal(cloud.rgb[i][1], 20);
            assert_int_equal(cloud.rgb[i][2], 30 + i);
            assert_int_equal(cloud.label[i], 3 - i);
        }
        plm_cloud_free(&cloud);
    }
}

static void put(unsigned char *to, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++) to[i] = (unsigned char)(value >> (8 * i));
}

static void put_double(unsigned char *to, double value)
{
    memcpy(to, &value, sizeof value);
}

/* Two points at UTM coordinates, the third marked as deleted. */
static size_t las_file(int minor, unsigned format, unsigned char *file)
{
    static const size_t sizes[] = {20, 28, 26, 34, 0, 0, 30, 36, 38}, colours[] = {0, 0, 20, 28, 0, 0, 0, 30, 30};
    const size_t begin = minor == 4 ? 375 : 227, record = sizes[format] + 2; /* two bytes of the user's own */
    memset(file, 0, begin + 3 * record);
    memcpy(file, "LASF", 4);
    file[24] = 1;
    file[25] = (unsigned char)minor;
    put(file + 94, begin, 2);
    put(file + 96, begin, 4);
    file[104] = (unsigned char)format;
    put(file + 105, record, 2);
    if (minor == 4)
        put(file + 247, 3, 8);
    else
        put(file + 107, 3, 4);
    for (int axis = 0; axis < 3; axis++) {
        put_double(file + 131 + 8 * axis, 1e-4);
        put_double(file + 155 + 8 * axis, (const double[]){478000, 5427000, 0}[axis]);
    }
    for (int i = 0; i < 3; i++) {
        unsigned char *at = file + begin + (size_t)i * record;
        put(at, (uint64_t)(7510000 + i), 4);
        put(at + 4, (uint64_t)(int64_t)(-320000 - i), 4);
        put(at + 8, (uint64_t)(3180000 + 2 * i), 4);
        const unsigned class = i == 0 ? PLM_LABEL_STEM : PLM_LABEL_LEAF;
        if (format < 6)
            at[15] = (unsigned char)(class | 0x20 | (i == 2 ? 0x80 : 0)); /* 0x20: synthetic */
        else
            at[16] = (unsigned char)class;
        if (format >= 6) at[15] = i == 2 ? 0x04 : 0x01;
        for (size_t k = 0; k < 3 && colours[format]; k++) put(at + colours[format] + 2 * k, (k + 1) * 257 * 20, 2);
    }
    return begin + 3 * record;
}

static void las_versions_and_point_formats_give_the_same_cloud(void **unused)
{
    (void)unused;
    static const struct {
        int minor;
        unsigned format;
    } cases[] = {{2, 0}, {2, 1}, {2, 2}, {2, 3}, {3, 3}, {4, 1}, {4, 6}, {4, 7}, {4, 8}};
    unsigned char file[1024];
    const plm_read_options options = {.label_field = "classification"};
    for (size_t k = 0; k < COUNT(cases); k++) {
        plm_cloud cloud = parse(file, las_file(cases[k].minor, cases[k].format, file), &options);
        assert_int_equal(report.format, PLM_FORMAT_LAS);
        assert_int_equal(report.rows, 3);
        assert_int_equal(report.dropped_withheld, 1);
        assert_string_equal(report.label_field, "classification");
        assert_int_equal(cloud.count, 2);
        for (int i = 0; i < 2; i++) { /* 1e-4 of a step at 5 million metres: the rounding of a double is 1e-9 */
            assert_near(cloud.origin[0] + (double)cloud.xyz[i][0], 478751 + 1e-4 * i, 2e-9);
            assert_near(cloud.origin[1] + (double)cloud.xyz[i][1], 5426968 - 1e-4 * i, 2e-9);
            assert_near(cloud.origin[2] + (double)cloud.xyz[i][2], 318 + 2e-4 * i, 2e-9);
            assert_int_equal(cloud.label[i], i ? PLM_LABEL_LEAF : PLM_LABEL_STEM);
            for (int axis = 0; cloud.rgb && axis < 3; axis++) assert_int_equal(cloud.rgb[i][axis], 20 * (axis + 1));
        }
        assert_int_equal(cloud.rgb != NULL, cases[k].format == 2 || cases[k].format == 3 || cases[k].format >= 7);
        plm_cloud_free(&cloud);
    }
}

static void three_readers_of_one_real_tree_give_one_cloud(void **unused)
{
    (void)unused;
    const char *data = test_data_folder();
    if (!data) skip();
    static const char *const names[] = {"las", "ply", "txt"};
    plm_cloud clouds[3];
    plm_error error = {0};
    for (int i = 0; i < 3; i++) {
        char path[8192];
        snprintf(path, sizeof path, "%s/real/tree_las/pc_tree.%s", data, names[i]);
        assert_ok(plm_cloud_read(path, NULL, &clouds[i], NULL, &error));
        assert_int_equal(clouds[i].count, clouds[0].count);
    }
    for (int i = 1; i < 3; i++)
        for (size_t k = 0; k < clouds[0].count; k++)
            for (int axis = 0; axis < 3; axis++)
                assert_near(clouds[i].origin[axis] + (double)clouds[i].xyz[k][axis],
                            clouds[0].origin[axis] + (double)clouds[0].xyz[k][axis],
                            5.1e-4); /* the LAS file has steps of 1e-3 */
    for (int i = 0; i < 3; i++) plm_cloud_free(&clouds[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_bodies_of_pcd_give_the_same_cloud),
        cmocka_unit_test(las_versions_and_point_formats_give_the_same_cloud),
        cmocka_unit_test(three_readers_of_one_real_tree_give_one_cloud),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
