/* tool/command_report.c: the `report` sub-command: the page of a run, made again. */
#include "tool/command.h"

#include "reports/report.h"

#include <stdio.h>

typedef struct report_settings {
    const char *validation;
    int views;
    bool plots, quiet;
} report_settings;

static const plm_option options[] = {
    {.name = "validation",
     .argument = "DIR",
     .help = "show the statistics and plots that `validate --plots -o DIR` wrote (default: those in RUN, where there "
             "are any)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(report_settings, validation)},
    {.name = "views",
     .argument = "N",
     .help =
         "plants with their whole picture and a 3D view: the first N, of those that `measure --views` kept points of; "
         "the others get a small picture (default: 20)",
     .kind = PLM_OPTION_INTEGER,
     .offset = offsetof(report_settings, views),
     .minimum = 0,
     .maximum = 1000000},
    {.name = "plots",
     .help = "draw the main traits of every plant too (gnuplot): RUN/plots/overview.svg and .png, with data and script",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(report_settings, plots)},
    {.letter = 'q',
     .name = "quiet",
     .help = "print nothing but errors",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(report_settings, quiet)},
};

static int run(int argc, char **argv)
{
    report_settings settings = {.views = PLM_REPORT_VIEWS};
    const int usage = plm_parse_options(&plm_command_report, &argc, argv, &settings);
    if (usage >= 0) return usage;
    if (argc != 1) return plm_usage_error(&plm_command_report, "one folder was expected; found %d", argc);
    const plm_report_options page = {
        .validation = settings.validation, .views = (size_t)settings.views, .plots = settings.plots};
    plm_error error = {0};
    bool has_view = false;
    if (settings.validation && !plm_report_has(settings.validation, "agreement.csv")) {
        plm_fail(&error, PLM_E_READ, "%s/agreement.csv: cannot be opened; `plantimeter validate -o %s` writes it",
                 settings.validation, settings.validation);
        return plm_report_failure(PLM_E_READ, &error);
    }
    const plm_status status = plm_report_write(argv[0], &page, &has_view, &error);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    if (!settings.quiet) {
        printf("%s/report.html\n", argv[0]);
        if (!has_view) fprintf(stderr, "plantimeter: three.js was not there at build time: the page has no 3D views\n");
    }
    return PLM_EXIT_GOOD;
}

const plm_command plm_command_report = {
    .name = "report",
    .arguments = "[OPTION]... RUN",
    .summary = "make the page of a run again: report.html",
    .description = "RUN is the folder of `measure -o RUN`, or of `validate -o RUN`. The page holds all that it shows "
                   "and opens from "
                   "disk: a table of the plants, a card for each with its picture, a 3D view, its traits and warnings, "
                   "agreement with "
                   "manual measurements where there is a validation, and where the values come from.",
    .options = options,
    .option_count = COUNT(options),
    .run = run,
};
