/* The cases of `plantimeter selftest --stability`: none is beyond its bound, every group is there, and the table can tell. */
#include "support/test.h"

#include "selftest/checks.h"

static void no_case_is_beyond_its_bound(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_check_table table = {0};
    assert_ok(plm_selftest_stability(&table, NULL, NULL, &error));
    for (size_t i = 0; i < table.count; i++) {
        const plm_check *row = &table.check[i];
        if (row->verdict == PLM_VERDICT_BEYOND)
            print_message("%s: %s: found %.17g, reference %.17g, error %.3g, bound %.3g %s\n", row->scene, row->measure,
                          row->found, row->reference, row->error, row->bound, row->note);
    }
    assert_int_equal(plm_check_defects(&table), 0);
    assert_true(table.count > 300);
    plm_check_table_free(&table);
}

static void a_group_that_is_not_there_is_named(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_check_table table = {0};
    assert_int_equal(plm_selftest_stability(&table, "shoes", NULL, &error), PLM_E_ARGUMENT);
    assert_non_null(strstr(error.message, "\"shoes\""));
    assert_int_equal(table.count, 0);
}

static void the_table_can_tell_a_defect(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const plm_error silent = {0};
    plm_check_table table = {0};
    plm_checker checker = {.table = &table, .error = &error};
    const plm_bound bound = {.error = 1e-3, .condition = NAN};
    plm_check_value(&checker, "near enough", 1.0009, 1, bound);
    plm_check_value(&checker, "too far", 1.0011, 1, bound);
    plm_check_value(&checker, "no number", NAN, 1, bound);
    plm_check_value(&checker, "about nothing", 1e-4, 0, (plm_bound){.error = 1e-3, .condition = NAN});
    plm_check_refused(&checker, "a value where none is determined", PLM_OK, &silent);
    plm_check_refused(&checker, "no word of why", PLM_E_DEGENERATE, &silent);
    plm_check_ran(&checker, "refused", PLM_E_DEGENERATE, &silent);
    static const plm_verdict expected[] = {PLM_VERDICT_WITHIN, PLM_VERDICT_BEYOND, PLM_VERDICT_BEYOND,
                                           PLM_VERDICT_BEYOND, PLM_VERDICT_BEYOND, PLM_VERDICT_BEYOND,
                                           PLM_VERDICT_BEYOND};
    assert_int_equal(table.count, COUNT(expected));
    for (size_t i = 0; i < table.count; i++) assert_int_equal(table.check[i].verdict, expected[i]);
    assert_int_equal(plm_check_defects(&table), 6);
    plm_check_table_free(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_case_is_beyond_its_bound),
        cmocka_unit_test(a_group_that_is_not_there_is_named),
        cmocka_unit_test(the_table_can_tell_a_defect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
