/* From two tables to agreement.csv: repeats, units, groups, angle conventions, gates, what stays unpaired. */
#include "support/test.h"

#include "reports/plots.h"

static const char traits_csv[] =
    "plant_id,organ,organ_id,x,y,z,trait,value,unit,std_error,n_points,status,reason,method\n"
    "a,plant,,0,0,0,plant_height,100,mm,1,10,ok,,x\n"
    "b,plant,,0,0,0,plant_height,205,mm,1,10,ok low_density,,x\n"
    "c,plant,,0,0,0,plant_height,290,mm,1,10,ok,,x\n"
    "d,plant,,0,0,0,plant_height,,mm,,10,failed,no points,x\n"
    "a,petiole,0,0,0,0,petiole_inclination,30,deg,2,10,ok,,x\n"
    "b,petiole,0,0,0,0,petiole_inclination,50,deg,2,10,ok,,x\n"
    "c,petiole,0,0,0,0,petiole_inclination,70,deg,2,10,ok,,x\n";

static const char manual_csv[] = "plant_id;organ;organ_id;trait;value;unit\r\n"
                                 "a;plant;;plant_height;10.1;cm\r\n"
                                 "a;plant;;plant_height;10.3;cm\r\n"
                                 "b;plant;;plant_height;200;mm\r\n"
                                 "c;;;plant_height;300;\r\n"
                                 "d;plant;;plant_height;400;mm\r\n"
                                 "a;petiole;0;petiole_inclination;60;deg\r\n"
                                 "b;petiole;0;petiole_inclination;40;deg\r\n"
                                 "c;petiole;0;petiole_inclination;20;deg\r\n";

static const char field_book_csv[] = "\"plot_id\",\"trait\",\"value\",\"timestamp\",\"number\"\n"
                                     "\"a\",\"plant_height_cm\",\"10.2\",\"2026-05-01\",\"1\"\n"
                                     "\"b\",\"plant_height_cm\",\"20\",\"2026-05-01\",\"1\"\n"
                                     "\"c\",\"plant_height_cm\",\"30\",\"2026-05-01\",\"1\"\n";

static const char metadata_csv[] = "plant_id,species,treatment\na,pepper,dry\nb,pepper,wet\nc,okra,wet\n";

static char folder_path[8][4200];

static const char *write_file(const char *folder, int slot, const char *name, const char *text)
{
    snprintf(folder_path[slot], sizeof folder_path[slot], "%s/%s", folder, name);
    FILE *file = fopen(folder_path[slot], "wb");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
    return folder_path[slot];
}

static const plm_validated_group *find(const plm_validation *v, const char *trait, const char *group)
{
    for (size_t i = 0; i < v->group_count; i++)
        if (!strcmp(v->group[i].trait, trait) && !strcmp(v->group[i].group, group)) return &v->group[i];
    fail_msg("no group %s of %s", group, trait);
    return NULL;
}

static void tables_become_statistics(void **unused)
{
    (void)unused;
    plm_error error = {0};
    char *folder = test_make_folder();
    const plm_validation_options options = {.manual_angle = PLM_ANGLE_HORIZONTAL,
                                            .metadata = write_file(folder, 2, "metadata.csv", metadata_csv),
                                            .by = "species,treatment"};
    plm_validation v;
    assert_ok(plm_validate(write_file(folder, 0, "traits.csv", traits_csv),
                           write_file(folder, 1, "manual.csv", manual_csv), &options, &v, &error));
    const plm_validated_group *height = find(&v, "plant_height", "all");
    assert_int_equal(height->count, 3); /* d failed */
    /* differences: 100 - mean(101, 103), 205 - 200, 290 - 300 */
    assert_near(height->statistic[PLM_STAT_BIAS].value, (-2.0 + 5 - 10) / 3, 1e-12);
    assert_near(height->statistic[PLM_STAT_RMSE].value, sqrt((4.0 + 25 + 100) / 3), 1e-12);
    assert_near(height->repeatability.sd_within, sqrt(2.0), 1e-12);
    assert_near(height->coverage, 0, 0);
    assert_near(find(&v, "petiole_inclination", "all")->statistic[PLM_STAT_RMSE].value, 0, 1e-12);
    assert_int_equal(find(&v, "plant_height", "pepper/wet")->count, 1);
    assert_int_equal(find(&v, "plant_height", "okra/wet")->count, 1);
    assert_ok(plm_validation_write(&v, folder, &error));
    char path[4200];
    snprintf(path, sizeof path, "%s/unmatched.csv", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    char line[2][256];
    assert_non_null(fgets(line[0], sizeof line[0], file));
    assert_non_null(fgets(line[1], sizeof line[1], file));
    assert_string_equal(line[1],
                        "manual,d,plant,,plant_height,400,mm,\"no partner of this plant, organ and number\"\n");
    fclose(file);
    plm_validation_free(&v);
    test_remove_folder(folder);
}

static void field_book_exports_are_manual_tables(void **unused)
{
    (void)unused;
    plm_error error = {0};
    char *folder = test_make_folder();
    const plm_validation_options options = {0};
    plm_validation v;
    assert_ok(plm_validate(write_file(folder, 0, "traits.csv", traits_csv),
                           write_file(folder, 1, "book.csv", field_book_csv), &options, &v, &error));
    assert_near(find(&v, "plant_height", "all")->statistic[PLM_STAT_BIAS].value, (-2.0 + 5 - 10) / 3, 1e-12);
    plm_validation_free(&v);
    test_remove_folder(folder);
}

static void gates_say_what_failed_and_refuse_what_they_cannot_read(void **unused)
{
    (void)unused;
    plm_error error = {0};
    char *folder = test_make_folder();
    const plm_validation_options options = {0};
    plm_validation v;
    assert_ok(plm_validate(write_file(folder, 0, "traits.csv", traits_csv),
                           write_file(folder, 1, "manual.csv", manual_csv), &options, &v, &error));
    plm_gate_result result;
    assert_ok(plm_validation_gate(&v, "plant_height.rmse>5", &result, &error));
    assert_true(result.failed);
    assert_string_equal(result.message, "plant_height.rmse is 6.55744, which is > 5");
    assert_ok(plm_validation_gate(&v, "plant_height.rmse >= 7", &result, &error));
    assert_false(result.failed);
    static const char *const wrong[] = {"plant_height",
                                        "plant_height.rmse",
                                        "plant_height.rmse=5",
                                        "plant_height.nothing>1",
                                        "none.rmse>1",
                                        "plant_height.rmse>x",
                                        "plant_height.tost_p>0.05",
                                        ">",
                                        ""};
    for (size_t i = 0; i < COUNT(wrong); i++)
        assert_int_equal(plm_validation_gate(&v, wrong[i], &result, &error), PLM_E_ARGUMENT);
    plm_validation_free(&v);
    test_remove_folder(folder);
}

static void plots_keep_their_scripts_and_name_the_points(void **unused)
{
    (void)unused;
    plm_error error = {0};
    char *folder = test_make_folder();
    const plm_validation_options options = {0};
    plm_validation v;
    assert_ok(plm_validate(write_file(folder, 0, "traits.csv", traits_csv),
                           write_file(folder, 1, "manual.csv", manual_csv), &options, &v, &error));
    char plots[4200], path[4300];
    snprintf(plots, sizeof plots, "%s/plots", folder);
    bool drawn = false;
    assert_ok(plm_validation_plots(&v, plots, &drawn, &error));
    snprintf(path, sizeof path, "%s/plant_height.gp", plots);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    fclose(file);
    if (drawn) {
        snprintf(path, sizeof path, "%s/plant_height.svg", plots);
        static char svg[1 << 20];
        file = fopen(path, "r");
        assert_non_null(file);
        svg[fread(svg, 1, sizeof svg - 1, file)] = 0;
        fclose(file);
        assert_non_null(strstr(svg, "b plant"));
        assert_non_null(strstr(svg, "RMSE"));
    } else {
        print_message("skipped: gnuplot is not installed\n");
    }
    plm_validation_free(&v);
    test_remove_folder(folder);
}

static void tables_that_do_not_fit_are_refused_by_name(void **unused)
{
    (void)unused;
    char *folder = test_make_folder();
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"plant_id,trait\na,plant_height\n", "no column \"value\""},
        {"plant_id,trait,value\na,plant_height,tall\n", "line 2: value \"tall\" is not a number"},
        {"plant_id,trait,value\nz,plant_height,3\n", "no estimate has a manual partner"},
        {"plant_id,organ,organ_id,trait,value,unit\na,plant,,plant_height,3,mm\na,plant,,plant_height,3,cm2\n",
         "is given in \"mm\" and in \"cm2\""},
    };
    const char *estimates = write_file(folder, 0, "traits.csv", traits_csv);
    for (size_t i = 0; i < COUNT(cases); i++) {
        plm_error error = {0};
        plm_validation v;
        const plm_validation_options options = {0};
        assert_true(plm_validate(estimates, write_file(folder, 1, "m.csv", cases[i].text), &options, &v, &error) !=
                    PLM_OK);
        if (!strstr(error.message, cases[i].message)) fail_msg("%s does not say %s", error.message, cases[i].message);
    }
    test_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_become_statistics),
        cmocka_unit_test(field_book_exports_are_manual_tables),
        cmocka_unit_test(gates_say_what_failed_and_refuse_what_they_cannot_read),
        cmocka_unit_test(plots_keep_their_scripts_and_name_the_points),
        cmocka_unit_test(tables_that_do_not_fit_are_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
