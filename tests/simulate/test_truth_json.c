/* The truth file reads like those of the development clouds. */
#include <jansson.h>

#include "simulate/simulate.h"
#include "support/test.h"

/* Keys of `theirs` that `ours` lacks, but for those that only other kinds of scans have. */
static void has_all_keys(json_t *ours, json_t *theirs, const char *what)
{
    static const char *const other[] = {"difficulty", "transform", "convex_hull_volume", "convex_hull_area",
                                        "floaters"};
    const char *key;
    json_t *value;
    json_object_foreach(theirs, key, value)
    {
        bool is_other = false;
        for (size_t k = 0; k < COUNT(other); k++) is_other = is_other || !strcmp(key, other[k]);
        if (!is_other && !json_object_get(ours, key)) fail_msg("%s: the key \"%s\" is missing", what, key);
    }
}

static json_t *first_organ(json_t *truth, const char *name)
{
    json_t *organ;
    size_t k;
    json_array_foreach(json_object_get(truth, "organs"), k, organ)
    {
        if (!strcmp(json_string_value(json_object_get(organ, "organ")), name)) return organ;
    }
    return NULL;
}

static json_t *write_and_load(const char *folder, const char *kind)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    char path[4200];
    assert_ok(plm_plant_grow(kind, &(plm_plant_options){.seed = 2, .resolution = 0.3}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .points = 2000}, &scan, &error));
    snprintf(path, sizeof path, "%s/truth.json", folder);
    assert_ok(plm_truth_write(path, "plant_2", &plant, &scan, &error));
    json_t *truth = json_load_file(path, 0, NULL);
    assert_non_null(truth);
    assert_near(json_real_value(json_object_get(json_object_get(truth, "plant"), "plant_height")), plant.whole.height,
                1e-12);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
    return truth;
}

static void truth_files_have_every_key_of_the_development_clouds(void **state)
{
    (void)state;
    static const char *const pair[][2] = {
        {"eggplant", "eggplant_11_clean"}, {"tomato", "tomato_16_clean"}, {"maize", "maize_15_clean"}};
    const char *data = test_data_folder();
    if (!data) skip();
    char *folder = test_make_folder();
    for (size_t k = 0; k < COUNT(pair); k++) {
        char path[4200];
        snprintf(path, sizeof path, "%s/dev/%s.truth.json", data, pair[k][1]);
        json_t *theirs = json_load_file(path, 0, NULL), *ours = write_and_load(folder, pair[k][0]);
        assert_non_null(theirs);
        has_all_keys(ours, theirs, pair[k][0]);
        has_all_keys(json_object_get(ours, "plant"), json_object_get(theirs, "plant"), "plant");
        has_all_keys(json_object_get(ours, "scan"), json_object_get(theirs, "scan"), "scan");
        has_all_keys(json_object_get(ours, "definitions"), json_object_get(theirs, "definitions"), "definitions");
        static const char *const organ[] = {"stem", "petiole", "leaf"};
        for (size_t i = 0; i < COUNT(organ); i++)
            if (first_organ(theirs, organ[i]))
                has_all_keys(first_organ(ours, organ[i]), first_organ(theirs, organ[i]), organ[i]);
        json_decref(theirs);
        json_decref(ours);
    }
    test_remove_folder(folder);
}

static void readings_are_the_truth_within_reading_errors(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_virtual_plant plant;
    char *text = NULL;
    assert_ok(plm_plant_grow("pepper", &(plm_plant_options){.seed = 2, .resolution = 0.2}, &plant, &error));
    assert_ok(plm_manual_readings("p", &plant, 4, &text, &error));
    double height = 0, diameter = 0;
    assert_int_equal(sscanf(text, "p,plant,,plant_height,%lf,mm", &height), 1);
    assert_near(height, 1000 * plant.whole.height, 3); /* 0.5 mm SD and rounding: 5 SD */
    assert_int_equal(sscanf(strstr(text, "p,stem,0"), "p,stem,0,stem_diameter,%lf,mm", &diameter), 1);
    assert_near(diameter, 1000 * plant.stem[0].diameter, 0.12);
    plm_free(text);
    plm_virtual_plant_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(truth_files_have_every_key_of_the_development_clouds),
        cmocka_unit_test(readings_are_the_truth_within_reading_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
