/* tool/command_info.c: the `info` sub-command: what a file holds, and what it would be taken for. */
#include "cloud/sampling.h"
#include "reports/run_json.h"
#include "tool/reading.h"

#include <stdio.h>

typedef struct info_settings {
    reading_settings reading;
    bool json;
} info_settings;

static const plm_option options[] = {
    {.name = "json", .help = "print one JSON object", .kind = PLM_OPTION_FLAG, .offset = offsetof(info_settings, json)},
};

/** What is told of a file. Lengths in the file's unit. */
typedef struct cloud_facts {
    double low[3], high[3];
    double spacing, noise; /* 0: too few points */
    plm_frame frame;
} cloud_facts;

static plm_status find_sampling(const plm_cloud *cloud, plm_sampling *sampling, plm_error *error)
{
    plm_index *index;
    plm_status status = plm_index_build((const float(*)[3])cloud->xyz, cloud->count, &index, error);
    if (status != PLM_OK) return status;
    status = plm_sampling_measure(index, (const float(*)[3])cloud->xyz, cloud->count, NULL, sampling, error);
    plm_index_free(index);
    return status == PLM_E_DEGENERATE ? PLM_OK : status;
}

static plm_status find_facts(const loaded_cloud *loaded, plm_up up, cloud_facts *facts, plm_error *error)
{
    const double to_file = 1 / loaded->scale.metres_per_unit;
    float low[3], high[3];
    plm_sampling sampling = {0};
    plm_status status = plm_cloud_bounds(&loaded->cloud, low, high, error);
    if (status == PLM_OK) status = find_sampling(&loaded->cloud, &sampling, error);
    if (status != PLM_OK) return status;
    for (int axis = 0; axis < 3; axis++) {
        facts->low[axis] = (loaded->cloud.origin[axis] + low[axis]) * to_file;
        facts->high[axis] = (loaded->cloud.origin[axis] + high[axis]) * to_file;
    }
    status = plm_find_up(&loaded->cloud, up, &facts->frame, error);
    if (status != PLM_OK) return status;
    facts->spacing = sampling.spacing * to_file;
    facts->noise = sampling.noise * to_file;
    return PLM_OK;
}

/* The axis, or that it is none of the six. */
static const char *up_name(const plm_frame *frame)
{
    static const char *const names[] = {"tilted", "x", "y", "z", "-x", "-y", "-z"};
    return names[frame->up];
}

static void print_text(const char *path, const loaded_cloud *loaded, const cloud_facts *facts)
{
    const plm_read_report *report = &loaded->report;
    printf("file          %s\n", path);
    printf("format        %s\n", report->description);
    printf("points        %zu of %llu rows", loaded->cloud.count, (unsigned long long)report->rows);
    if (report->dropped_not_finite) printf("; %llu not finite", (unsigned long long)report->dropped_not_finite);
    if (report->dropped_transparent) printf("; %llu transparent", (unsigned long long)report->dropped_transparent);
    if (report->dropped_withheld) printf("; %llu withheld", (unsigned long long)report->dropped_withheld);
    printf("\nfields        %s\n", report->fields);
    if (report->label_field[0])
        printf("labels        field \"%s\"; --labels %s uses them\n", report->label_field, report->label_field);
    printf("from          %.9g %.9g %.9g\n", facts->low[0], facts->low[1], facts->low[2]);
    printf("to            %.9g %.9g %.9g\n", facts->high[0], facts->high[1], facts->high[2]);
    printf("size          %.6g %.6g %.6g\n", facts->high[0] - facts->low[0], facts->high[1] - facts->low[1],
           facts->high[2] - facts->low[2]);
    if (facts->spacing > 0) printf("spacing       %.4g (noise %.3g)\n", facts->spacing, facts->noise);
    printf("up            %s (%s, confidence %.2f)\n", up_name(&facts->frame), facts->frame.evidence,
           facts->frame.confidence);
    printf("unit          %s: %.9g m (%s)\n", loaded->scale.unit, loaded->scale.metres_per_unit,
           loaded->scale.evidence);
}

static plm_status print_json(const char *path, const loaded_cloud *loaded, const cloud_facts *facts, plm_error *error)
{
    plm_json_use_seam();
    const plm_read_report *report = &loaded->report;
    json_t *root = json_pack(
        "{s:s, s:s?, s:s, s:I, s:I, s:I, s:I, s:I, s:s?, s:s?, s:[f,f,f], s:[f,f,f], s:f, s:f, s:{s:s, s:f, s:s}, "
        "s:{s:s, s:f, s:s}}",
        "version", PLM_VERSION, "input", path, "format", report->description, "points", (json_int_t)loaded->cloud.count,
        "rows", (json_int_t)report->rows, "dropped_not_finite", (json_int_t)report->dropped_not_finite,
        "dropped_transparent", (json_int_t)report->dropped_transparent, "dropped_withheld",
        (json_int_t)report->dropped_withheld, "fields", report->fields, "label_field", report->label_field, "low",
        facts->low[0], facts->low[1], facts->low[2], "high", facts->high[0], facts->high[1], facts->high[2], "spacing",
        facts->spacing, "noise", facts->noise, "unit", "name", loaded->scale.unit, "metres_per_unit",
        loaded->scale.metres_per_unit, "evidence", loaded->scale.evidence, "up", "axis", up_name(&facts->frame),
        "confidence", facts->frame.confidence, "evidence", facts->frame.evidence);
    plm_status status = plm_json_check(root, error);
    if (status == PLM_OK && json_dumpf(root, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) != 0)
        status = plm_fail(error, PLM_E_WRITE, "standard output: the JSON cannot be written");
    if (status == PLM_OK) putchar('\n');
    json_decref(root);
    return status;
}

static plm_status show_info(const char *path, const info_settings *settings, plm_error *error)
{
    loaded_cloud loaded;
    plm_status status = load_cloud(path, &settings->reading, false, &loaded, error);
    if (status != PLM_OK) return status;
    cloud_facts facts = {0};
    status = find_facts(&loaded, (plm_up)settings->reading.up, &facts, error);
    if (status == PLM_OK && settings->json)
        status = print_json(path, &loaded, &facts, error);
    else if (status == PLM_OK)
        print_text(path, &loaded, &facts);
    free_loaded(&loaded);
    return status;
}

static int run(int argc, char **argv)
{
    info_settings settings = {.reading.minimum_opacity = 0.005};
    const int code = plm_parse_options(&plm_command_info, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc != 1) return plm_usage_error(&plm_command_info, "expected one cloud, found %d", argc);
    plm_error error = {0};
    if (check_reading(&settings.reading, &error) != PLM_OK)
        return plm_usage_error(&plm_command_info, "%s", error.message);
    const plm_status status = show_info(argv[0], &settings, &error);
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_report_failure(status, &error);
}

const plm_command plm_command_info = {.name = "info",
                                      .arguments = "[OPTION]... CLOUD",
                                      .summary = "tell what a CLOUD holds: points, fields, size, spacing, unit, up",
                                      .options = options,
                                      .option_count = COUNT(options),
                                      .shared = reading_options,
                                      .shared_count = READING_OPTION_COUNT,
                                      .shared_offset = offsetof(info_settings, reading),
                                      .run = run};
