/* tool/command_plan.c: the `plan` sub-command: what `measure` would run for a cloud, what it would leave out, and why. */
#include "reports/run_json.h"
#include "tool/measure_settings.h"

#include <stdio.h>

static const plm_option options[] = {
    {.letter = 't',
     .name = "traits",
     .argument = "LIST",
     .help = "the traits to plan for, as in `measure` (default: all)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, traits)},
    {.name = "ground",
     .argument = "auto|none|HEIGHT",
     .help = "as in `measure`",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, ground)},
    {.name = "json",
     .help = "print one JSON object",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(measure_settings, json)},
};

/** The stages before the library's plan: reading does them. */
static plm_stage georeference_stage(bool is_georeferenced)
{
    plm_stage stage = {.name = "georeference", .runs = is_georeferenced};
    snprintf(stage.why, sizeof stage.why, "%s",
             is_georeferenced ? "--crs says what the coordinates are" : "left out: no --crs, so coordinates are local");
    return stage;
}

static void print_text(const plm_stage *stage, size_t count)
{
    for (size_t i = 0; i < count; i++)
        printf("%-14s%-6s%s\n", stage[i].name, stage[i].runs ? "runs" : "-", stage[i].why);
}

static plm_status print_json(const char *input, const plm_stage *stage, size_t count, plm_error *error)
{
    plm_json_use_seam();
    json_t *rows = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(
            rows, json_pack("{s:s, s:b, s:s}", "stage", stage[i].name, "runs", stage[i].runs, "why", stage[i].why));
    json_t *root = json_pack("{s:s, s:s?, s:o}", "version", PLM_VERSION, "input", input, "plan", rows);
    plm_status status = plm_json_check(root, error);
    if (status == PLM_OK && json_dumpf(root, stdout, JSON_INDENT(1)) != 0)
        status = plm_fail(error, PLM_E_WRITE, "standard output: the JSON cannot be written");
    if (status == PLM_OK) putchar('\n');
    json_decref(root);
    return status;
}

static plm_status show_plan(const char *path, const measure_settings *settings, const plm_measure_options *measure,
                            plm_error *error)
{
    loaded_cloud loaded;
    plm_status status = load_cloud(path, &settings->reading, false, &loaded, error);
    if (status != PLM_OK) return status;
    plm_plan plan;
    status = plm_plan_make(measure, plm_cloud_attributes(&loaded.cloud), &plan, error);
    if (status == PLM_OK) {
        plm_stage stage[PLM_STAGE_MAXIMUM + 1] = {georeference_stage(loaded.is_georeferenced)};
        for (size_t i = 0; i < plan.stage_count; i++) stage[i + 1] = plan.stage[i];
        if (settings->json)
            status = print_json(path, stage, plan.stage_count + 1, error);
        else
            print_text(stage, plan.stage_count + 1);
    }
    free_loaded(&loaded);
    return status;
}

static int run(int argc, char **argv)
{
    measure_settings settings = measure_setting_defaults();
    const int code = plm_parse_options(&plm_command_plan, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc != 1) return plm_usage_error(&plm_command_plan, "expected one cloud, found %d", argc);
    plm_error error = {0};
    plm_measure_options measure;
    if (measure_options_of(&settings, &measure, &error) != PLM_OK)
        return plm_usage_error(&plm_command_plan, "%s", error.message);
    const plm_status status = show_plan(argv[0], &settings, &measure, &error);
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_report_failure(status, &error);
}

const plm_command plm_command_plan = {.name = "plan",
                                      .arguments = "[OPTION]... CLOUD",
                                      .summary = "show what `measure` would run for a CLOUD, what not, and why",
                                      .options = options,
                                      .option_count = COUNT(options),
                                      .shared = reading_options,
                                      .shared_count = READING_OPTION_COUNT,
                                      .shared_offset = offsetof(measure_settings, reading),
                                      .run = run};
