/* Nearest names: what a typing error probably meant, and silence where nothing is near. */
#include "support/test.h"

#include "cloud/nearest_name.h"

static const char *const names[] = {"plant_height", "leaf_area", "leaf_inclination", "stem_diameter", "up"};

static const char *name_of(const void *table, size_t i)
{
    return ((const char *const *)table)[i];
}

static const char *nearest(const char *word)
{
    return plm_nearest_name(word, name_of, names, COUNT(names));
}

static void one_edit_is_one_whatever_its_kind(void **unused)
{
    (void)unused;
    assert_int_equal(plm_name_distance("leaf", "leaf"), 0);
    assert_int_equal(plm_name_distance("leaf", "lea"), 1);
    assert_int_equal(plm_name_distance("leaf", "leaff"), 1);
    assert_int_equal(plm_name_distance("leaf", "lead"), 1);
    assert_int_equal(plm_name_distance("leaf", "laef"), 1);
    assert_int_equal(plm_name_distance("", "leaf"), 4);
    assert_int_equal(plm_name_distance("Stem-Diameter", "stem_diameter"), 0);
}

static void a_typing_error_finds_its_name(void **unused)
{
    (void)unused;
    assert_string_equal(nearest("plant_hieght"), "plant_height");
    assert_string_equal(nearest("leaf-area"), "leaf_area");
    assert_string_equal(nearest("stem_diam"), "stem_diameter");
    assert_string_equal(nearest("leaf_inclinations"), "leaf_inclination");
}

static void a_word_that_is_near_nothing_finds_nothing(void **unused)
{
    (void)unused;
    assert_null(nearest("colour_index"));
    assert_null(nearest("x"));
    assert_null(nearest(""));
    char longest[300];
    memset(longest, 'a', sizeof longest);
    longest[sizeof longest - 1] = 0;
    assert_null(nearest(longest));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_edit_is_one_whatever_its_kind),
        cmocka_unit_test(a_typing_error_finds_its_name),
        cmocka_unit_test(a_word_that_is_near_nothing_finds_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
