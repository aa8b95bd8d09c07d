/* tool/command_series.c: the `series` sub-command: the same plants on several days. */
#include "tool/command.h"

#include "reports/series.h"

#include <stdio.h>
#include <string.h>

typedef struct series_settings {
    const char *output, *dates;
    bool plots, quiet;
} series_settings;

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write series.csv, wide.csv and growth.csv here (required)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(series_settings, output)},
    {.name = "dates",
     .argument = "CSV",
     .help = "when each run was scanned: columns run (the folder, or its last name) and date (2026-05-02, "
             "2026-05-02T09:30 or a "
             "number of days) (required)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(series_settings, dates)},
    {.name = "plots",
     .help = "draw each trait over time too (gnuplot): DIR/plots/TRAIT.svg and .png, with data and script",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(series_settings, plots)},
    {.letter = 'q',
     .name = "quiet",
     .help = "print nothing but errors",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(series_settings, quiet)},
};

static void print_summary(const plm_series *series)
{
    size_t outliers = 0;
    for (size_t i = 0; i < series->point_count; i++) outliers += series->point[i].is_outlier;
    printf("%zu dates, %zu values, %zu outliers (marked in series.csv, left out of growth.csv)\n", series->run_count,
           series->point_count, outliers);
    printf("%-20s %-18s %14s %22s\n", "plant", "trait", "rate", "relative rate, 1/day");
    for (size_t k = 0; k < series->line_count; k++) {
        const plm_series_line *line = &series->line[k];
        if (strcmp(line->trait->name, "plant_height") && strcmp(line->trait->name, "total_leaf_area")) continue;
        plm_rate absolute, relative;
        plm_series_fit(series, line, &absolute, &relative);
        printf("%-20s %-18s %7.4g %s/day %14.4g\n", line->plant_id, line->trait->name, absolute.value,
               plm_unit_name(line->trait->unit), relative.value);
    }
}

static plm_status write_all(const plm_series *series, const series_settings *settings, plm_error *error)
{
    plm_status status = plm_folder_make(settings->output, error);
    if (status == PLM_OK) status = plm_series_write(series, settings->output, error);
    if (status != PLM_OK || !settings->plots) return status;
    char folder[4096];
    if ((size_t)snprintf(folder, sizeof folder, "%s/plots", settings->output) >= sizeof folder)
        return plm_fail(error, PLM_E_WRITE, "the folder's name is too long");
    bool drawn = false;
    status = plm_series_plots(series, folder, &drawn, error);
    if (status == PLM_OK && !drawn)
        fprintf(stderr, "plantimeter: gnuplot is not installed; %s holds the scripts and data\n", folder);
    return status;
}

static int run(int argc, char **argv)
{
    series_settings settings = {0};
    const int usage = plm_parse_options(&plm_command_series, &argc, argv, &settings);
    if (usage >= 0) return usage;
    if (argc < 2) return plm_usage_error(&plm_command_series, "two runs at least were expected; found %d", argc);
    if (!settings.dates) return plm_usage_error(&plm_command_series, "--dates CSV is missing");
    if (!settings.output) return plm_usage_error(&plm_command_series, "-o DIR is missing");
    plm_error error = {0};
    plm_series series;
    plm_status status = plm_series_open(&series, argv, (size_t)argc, settings.dates, &error);
    if (status == PLM_OK) {
        status = write_all(&series, &settings, &error);
        if (status == PLM_OK && !settings.quiet) print_summary(&series);
        plm_series_close(&series);
    }
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_report_failure(status, &error);
}

const plm_command plm_command_series = {
    .name = "series",
    .arguments = "[OPTION]... --dates CSV -o DIR RUN RUN...",
    .summary = "traits over time, growth rates and outliers from runs of several days",
    .description =
        "Each RUN is the folder of `measure -o RUN`; plants are joined by their names. growth.csv has the absolute and "
        "the "
        "relative growth rate of each interval and of the whole (weighted least squares), with standard errors. A "
        "value that "
        "jumps off the line through its neighbouring days is marked as an outlier and left out of the rates.",
    .options = options,
    .option_count = COUNT(options),
    .run = run,
};
