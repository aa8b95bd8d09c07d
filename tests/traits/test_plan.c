/* The plan leaves out what a scene does not need. */
#include "support/test.h"

#include "traits/plan.h"

static plm_plan plan_of(const char *traits, unsigned attributes)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    plm_plan plan;
    assert_ok(plm_plan_make(&options, attributes, &plan, &error));
    assert_int_equal(plan.stage_count, PLM_STAGE_COUNT);
    return plan;
}

static void a_labelled_cloud_is_neither_cleaned_nor_segmented(void **unused)
{
    (void)unused;
    const plm_plan plan = plan_of("leaf_count", PLM_HAS_LABEL | PLM_HAS_ORGAN);
    assert_false(plan.stage[PLM_STAGE_SEGMENT].runs);
    assert_false(plan.stage[PLM_STAGE_CLEAN].runs);
    assert_non_null(strstr(plan.stage[PLM_STAGE_SEGMENT].why, "labels"));
    assert_true(plan.stage[PLM_STAGE_ORGANS].runs);
    assert_true(plan_of("leaf_count", 0).stage[PLM_STAGE_SEGMENT].runs);
}

static void what_runs_names_who_needs_it_and_what_does_not_says_why(void **unused)
{
    (void)unused;
    const plm_plan plan = plan_of("leaf_count", 0);
    for (size_t i = 0; i < plan.stage_count; i++) {
        assert_non_null(plan.stage[i].name);
        assert_true(plan.stage[i].why[0] != 0);
    }
    assert_string_equal(plan.stage[PLM_STAGE_SEGMENT].why, "for leaf_count");
    assert_string_equal(plan.stage[PLM_STAGE_HULL].why, "left out: no trait asked for needs it");
}

static void an_unknown_trait_is_refused_with_the_nearest_name(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    plm_plan plan;
    options.traits = "leaf_count,laef_count";
    assert_int_equal(plm_plan_make(&options, 0, &plan, &error), PLM_E_ARGUMENT);
    assert_string_equal(error.message, "unknown trait \"laef_count\"; did you mean \"leaf_count\"?");
    options.traits = "phase of the moon";
    assert_int_equal(plm_plan_make(&options, 0, &plan, &error), PLM_E_ARGUMENT);
    options.traits = " , ";
    assert_int_equal(plm_plan_make(&options, 0, &plan, &error), PLM_E_ARGUMENT);
    options.traits = "";
    assert_int_equal(plm_plan_make(&options, 0, &plan, &error), PLM_E_ARGUMENT);
}

static void every_row_of_the_table_is_complete_and_has_a_name_of_its_own(void **unused)
{
    (void)unused;
    size_t count;
    const plm_trait *trait = plm_traits(&count);
    for (size_t i = 0; i < count; i++) {
        assert_non_null(trait[i].measure);
        assert_non_null(trait[i].ontology);
        assert_true(strlen(trait[i].name) > 2 && strlen(trait[i].name) < 40);
        assert_true(strlen(trait[i].definition) > 10);
        assert_true(strlen(trait[i].source) > 0);
        assert_ptr_equal(plm_trait_find(trait[i].name), &trait[i]);
        assert_string_not_equal(plm_level_name(trait[i].level), trait[i].name);
    }
    assert_null(plm_trait_find("no_such_trait"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_labelled_cloud_is_neither_cleaned_nor_segmented),
        cmocka_unit_test(what_runs_names_who_needs_it_and_what_does_not_says_why),
        cmocka_unit_test(an_unknown_trait_is_refused_with_the_nearest_name),
        cmocka_unit_test(every_row_of_the_table_is_complete_and_has_a_name_of_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
