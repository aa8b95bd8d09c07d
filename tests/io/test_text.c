/* Rows of text in the many ways in which programs write them give the points that a person would read there. */
#include "support/test.h"

#include <locale.h>

#include "io/io.h"
#include "io/number.h"

static plm_read_report report;

static plm_cloud parse(const char *text, const plm_read_options *options)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_parse(text, strlen(text), "rows.txt", options, &cloud, &report, &error));
    assert_int_equal(report.format, PLM_FORMAT_TEXT);
    return cloud;
}

static void assert_place(const plm_cloud *cloud, size_t i, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int k = 0; k < 3; k++) {
        const double tolerance = 1e-6 * (1 + fabs(expected[k] - cloud->origin[k])); /* float offsets */
        assert_near(cloud->origin[k] + (double)cloud->xyz[i][k], expected[k], tolerance);
    }
}

static void separators_and_decimal_signs_are_found_out(void **unused)
{
    (void)unused;
    static const char *const files[] = {
        "1.5 -2 3e1\n4 5.25 6\n",
        "  1.5\t-2  3e1  \r\n\r\n 4 \t5.25 6\r\n",
        "1.5,-2,3e1\n4,5.25,6",
        "1.5, -2, 30.0\n4 , 5.25 , 6\n",
        "1.5;-2;3e1\n4;5.25;6\n",
        "1,5;-2;30\n4;5,25;6\n",
        "1,5 -2 3e1\n4 5,25 6\n",
        "x,y,z\n1.5,-2,3e1\n4,5.25,6\n",
        "X;Y;Z\n1,5;-2;30\n4;5,25;6\n",
        "# x y z\n1.5 -2 30\n# in between\n4 5.25 6\n",
        "//X,Y,Z\n1.5 -2 30\n4 5.25 6\n",
        "2\n1.5 -2 30\n4 5.25 6\n",
        "\xef\xbb\xbfx [m],y [m],z [m]\n1.5,-2,30\n4,5.25,6\n",
        "\"\",\"x\",\"y\",\"z\"\n\"1\",1.5,-2,30\n\"2\",4,5.25,6\n",
        "z,name,x,y\n30,a b,1.5,-2\n6,\"c,d\",4,5.25\n",
        "1.5,-2,30,\n4,5.25,6,\n",
        "Easting Northing Height\n1.5 -2 30\n4 5.25 6\n",
    };
    for (size_t i = 0; i < COUNT(files); i++) {
        plm_cloud cloud = parse(files[i], NULL);
        assert_int_equal(cloud.count, 2);
        assert_place(&cloud, 0, 1.5, -2, 30);
        assert_place(&cloud, 1, 4, 5.25, 6);
        plm_cloud_free(&cloud);
    }
}

static void columns_without_a_header_are_guessed_from_their_numbers(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *fields, *label_field;
        unsigned attributes;
    } cases[] = {
        {"0 0 0 255 128 0\n1 1 1 0 10 20\n", "x,y,z,red,green,blue", "", PLM_HAS_RGB},
        {"0 0 0 1 0.5 0\n1 1 1 0.2 0.1 0.3\n", "x,y,z,red,green,blue", "", PLM_HAS_RGB},
        {"0 0 0 3\n1 1 1 1\n", "x,y,z,label", "label", 0},
        {"0 0 0 3.000\n1 1 1 1.000\n", "x,y,z,label", "label", 0},
        {"0 0 0 0.3\n1 1 1 1.5\n", "x,y,z,column4", "", 0},
        {"0,0,0,0.6,0.8,0,1,0,0,0.5\n1,1,1,0,0,-1,0,0.5,0,0.1\n", "x,y,z,nx,ny,nz,red,green,blue,column10", "",
         PLM_HAS_RGB | PLM_HAS_NORMAL},
        {"0 0 0 9 8 7 2\n1 1 1 200 10 20 4\n", "x,y,z,red,green,blue,label", "label", PLM_HAS_RGB},
        {"2\n0 0 0 -5 9 8 7\n1 1 1 20 200 10 20\n", "x,y,z,intensity,red,green,blue", "", PLM_HAS_RGB},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        plm_cloud cloud = parse(cases[i].text, NULL);
        assert_string_equal(report.fields, cases[i].fields);
        assert_string_equal(report.label_field, cases[i].label_field);
        assert_int_equal(plm_cloud_attributes(&cloud), cases[i].attributes);
        plm_cloud_free(&cloud);
    }
}

static void options_name_columns_and_labels(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const plm_read_options named = {.columns = "z,-,x,y,kind", .label_field = "kind"};
    plm_cloud cloud = parse("30 9 1.5 -2 3\n6 9 4 5.25 1\n", &named);
    assert_place(&cloud, 0, 1.5, -2, 30);
    assert_int_equal(cloud.label[0], PLM_LABEL_LEAF);
    assert_int_equal(cloud.label[1], PLM_LABEL_STEM);
    assert_null(cloud.organ);
    plm_cloud_free(&cloud);

    const plm_read_options by_number = {.label_field = "4", .label_scheme = PLM_LABELS_INSTANCES, .stem_label = 1};
    cloud = parse("0 0 0 7\n1 0 0 1\n2 0 0 5\n3 0 0 -1\n4 0 0 7\n", &by_number);
    const int32_t organ[] = {1, 0, 0, -1, 1};
    const uint8_t label[] = {3, 1, 3, 0, 3};
    assert_memory_equal(cloud.organ, organ, sizeof organ);
    assert_memory_equal(cloud.label, label, sizeof label);
    plm_cloud_free(&cloud);

    const plm_read_options tabs = {.separator = '\t'};
    cloud = parse("1\t2\t3\t\t5\n4\t5\t\t6\t7\n", &tabs); /* an empty item is no number: the second row has no z */
    assert_int_equal(cloud.count, 1);
    assert_int_equal(report.dropped_not_finite, 1);
    plm_cloud_free(&cloud);

    const plm_read_options many = {.columns = "x,y,z,label"};
    assert_int_equal(plm_cloud_parse("1 2 3\n", 6, "a", &many, &cloud, &report, &error), PLM_E_ARGUMENT);
}

static void numbers_are_read_to_the_last_bit_under_any_locale(void **unused)
{
    (void)unused;
    static const char *const texts[] = {"0.1",
                                        "-0",
                                        "1e22",
                                        "1e23",
                                        "9007199254740993",
                                        "123456789012345678901234567890",
                                        "4.9e-324",
                                        "1.7976931348623157e308",
                                        "1e400",
                                        "0.000000000000000000000000000000000000001",
                                        "5000000.123456789",
                                        "2.2250738585072011e-308",
                                        "+7.",
                                        ".5",
                                        "6.02214076E+23",
                                        "3.141592653589793238462643383279502884"};
    /* Where a locale with a decimal comma is installed, the test runs under it as well. */
    for (int i = 0; i < 2; i++) {
        for (size_t k = 0; k < COUNT(texts); k++) {
            double value, expected;
            const char *end = texts[k] + strlen(texts[k]);
            assert_ptr_equal(plm_number_scan(texts[k], end, '.', &value), end);
            plm_locale plain = plm_locale_enter();
            expected = strtod(texts[k], NULL);
            plm_locale_leave(&plain);
            assert_memory_equal(&value, &expected, sizeof value);
        }
        if (!setlocale(LC_NUMERIC, "de_DE.UTF-8")) break;
    }
    setlocale(LC_NUMERIC, "C");
    uint64_t state = 5;
    for (int i = 0; i < 20000; i++) { /* every way of printing comes back as strtod reads it */
        char text[64];
        const double number = test_normal(&state) * pow(10, test_uniform(&state) * 40 - 20);
        snprintf(text, sizeof text, i % 2 ? "%.*g" : "%.*e", 1 + i % 20, number);
        double value;
        assert_non_null(plm_number_scan(text, text + strlen(text), '.', &value));
        assert_true(value == strtod(text, NULL));
    }
}

static void words_for_missing_numbers_are_not_finite_and_others_are_no_numbers(void **unused)
{
    (void)unused;
    static const char *const words[] = {"nan",     "NaN", "-nan",      "-nan(ind)", "1.#QNAN",
                                        "-1.#IND", "inf", "-Infinity", "NA"};
    static const char *const wrong[] = {"", "-", ".", "e5", "x", "--1", "nano"};
    double value;
    for (size_t i = 0; i < COUNT(words); i++) {
        assert_ptr_equal(plm_number_scan(words[i], words[i] + strlen(words[i]), '.', &value),
                         words[i] + strlen(words[i]));
        assert_true(isnan(value) || isinf(value));
    }
    for (size_t i = 0; i < COUNT(wrong); i++) {
        const char *end = wrong[i] + strlen(wrong[i]);
        const char *stop = plm_number_scan(wrong[i], end, '.', &value);
        assert_true(stop == NULL || stop != end);
    }
}

static void many_chunks_give_the_rows_in_their_order(void **unused)
{
    (void)unused;
    enum { ROWS = 150000 };
    char *text = malloc((size_t)ROWS * 32);
    size_t size = 0;
    assert_non_null(text);
    for (int i = 0; i < ROWS; i++) {
        size += (size_t)sprintf(text + size, "%d %d %d\n", i % 1000, i / 1000, i % 7);
        if (i % 1000 == 0) size += (size_t)sprintf(text + size, "# note\n\n");
    }
    plm_cloud cloud = parse(text, NULL);
    assert_int_equal(cloud.count, ROWS);
    for (int i = 0; i < ROWS; i += 97) assert_place(&cloud, (size_t)i, i % 1000, i / 1000, i % 7);
    plm_cloud_free(&cloud);
    memcpy(text + size - 6, "1 b 1\n", 6);
    plm_error error = {0};
    assert_int_equal(plm_cloud_parse(text, size, "rows.txt", NULL, &cloud, NULL, &error), PLM_E_FORMAT);
    assert_non_null(strstr(error.message, "rows.txt: line 150300: value 3 (z) is \"b\""));
    free(text);
}

static void coordinates_far_from_zero_keep_their_digits_even_beside_forgotten_zeros(void **unused)
{
    (void)unused;
    enum { ROWS = 400 };
    char text[ROWS * 64];
    for (int kind = 0; kind < 2; kind++) {
        size_t size = 0;
        for (int i = 0; i < ROWS; i++)
            size += (size_t)(kind && i % 200 == 7 ? sprintf(text + size, "0 0 0\n")
                                                  : sprintf(text + size, "%.7f %.7f %.7f\n", 478751 + i * 1e-3,
                                                            5427032 + i * 2e-3, 318 + i * 1e-4));
        plm_cloud cloud = parse(text, NULL);
        for (int i = 0; i < ROWS; i++) {
            if (kind && i % 200 == 7) continue;
            assert_near(cloud.origin[0] + (double)cloud.xyz[i][0], 478751 + i * 1e-3, 4e-8); /* 1e-7 of 0.4 m */
            assert_near(cloud.origin[1] + (double)cloud.xyz[i][1], 5427032 + i * 2e-3, 8e-8);
            assert_near(cloud.origin[2] + (double)cloud.xyz[i][2], 318 + i * 1e-4, 4e-9);
        }
        plm_cloud_free(&cloud);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(separators_and_decimal_signs_are_found_out),
        cmocka_unit_test(columns_without_a_header_are_guessed_from_their_numbers),
        cmocka_unit_test(options_name_columns_and_labels),
        cmocka_unit_test(numbers_are_read_to_the_last_bit_under_any_locale),
        cmocka_unit_test(words_for_missing_numbers_are_not_finite_and_others_are_no_numbers),
        cmocka_unit_test(many_chunks_give_the_rows_in_their_order),
        cmocka_unit_test(coordinates_far_from_zero_keep_their_digits_even_beside_forgotten_zeros),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
