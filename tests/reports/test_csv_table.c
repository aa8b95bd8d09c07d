/* CSV tables as people write them, and what is no table. */
#include "support/test.h"

#include "reports/csv_table.h"

static void quotes_separators_marks_and_line_ends_are_understood(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static const char *const texts[] = {
        "a,b,c\n1,\"x, \"\"y\"\"\",3\n",
        "\xef\xbb\xbf"
        "a;b;c\r\n1;\"x, \"\"y\"\"\";3\r\n\r\n",
        "a\tb\tc\n1\tx, \"y\"\t3",
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        plm_table table;
        assert_ok(plm_table_parse(texts[i], strlen(texts[i]), "t.csv", &table, &error));
        assert_int_equal(table.columns, 3);
        assert_int_equal(table.rows, 1);
        assert_int_equal(plm_table_column(&table, "B"), 1);
        assert_string_equal(plm_table_cell(&table, 0, 1), "x, \"y\"");
        assert_string_equal(plm_table_cell(&table, 0, 2), "3");
        assert_string_equal(plm_table_cell(&table, 0, plm_table_column(&table, "none")), "");
        plm_table_free(&table);
    }
}

static void short_rows_are_filled_and_multi_line_cells_count_lines(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static const char text[] = "a,b,c\n1\n\"two\nlines\",2,3,,\nlast,\n";
    plm_table table;
    assert_ok(plm_table_parse(text, strlen(text), "t.csv", &table, &error));
    assert_int_equal(table.rows, 3);
    assert_string_equal(plm_table_cell(&table, 0, 2), "");
    assert_string_equal(plm_table_cell(&table, 1, 0), "two\nlines");
    assert_int_equal(table.line[3], 5);
    assert_string_equal(plm_table_cell(&table, 2, 2), "");
    plm_table_free(&table);
}

static void what_is_no_table_is_named_by_line(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        size_t size;
        const char *message;
    } cases[] = {
        {"", 0, "t.csv: line 1: the file is empty; a header line was expected"},
        {"\n\n", 2, "t.csv: line 1: the file is empty; a header line was expected"},
        {"a,b\n1,\"x\n", 9, "t.csv: line 2: a quote is never closed"},
        {"a,b\n1,2,3\n", 10, "t.csv: line 2: more cells than the header's 2"},
        {"a,b\n1\0", 6, "t.csv: holds zero bytes; a text table was expected"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        plm_error error = {0};
        plm_table table;
        assert_int_equal(plm_table_parse(cases[i].text, cases[i].size, "t.csv", &table, &error), PLM_E_FORMAT);
        assert_string_equal(error.message, cases[i].message);
    }
    plm_error error = {0};
    plm_table table;
    assert_int_equal(plm_table_read("no/such/file.csv", &table, &error), PLM_E_READ);
}

static void numbers_are_whole_cells(void **unused)
{
    (void)unused;
    double value;
    assert_true(plm_table_number(" -1.5e2 ", &value) && value == -150);
    assert_true(plm_table_number(".5", &value) && value == 0.5);
    static const char *const wrong[] = {"", "NA", "nan", "inf", "1,5", "3 mm", "-", "1e999"};
    for (size_t i = 0; i < COUNT(wrong); i++) assert_false(plm_table_number(wrong[i], &value));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quotes_separators_marks_and_line_ends_are_understood),
        cmocka_unit_test(short_rows_are_filled_and_multi_line_cells_count_lines),
        cmocka_unit_test(what_is_no_table_is_named_by_line),
        cmocka_unit_test(numbers_are_whole_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
