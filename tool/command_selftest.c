/* tool/command_selftest.c: the `selftest` sub-command: hard cases with known answers, run by the installed program. */
#include "selftest/selftest.h"
#include "tool/command.h"

#include <jansson.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <unistd.h>

typedef struct selftest_settings {
    bool stability, json, quiet;
    const char *only;
} selftest_settings;

static const plm_option options[] = {
    {.name = "stability",
     .help = "the cases of numerical stability (the only ones so far, so also without it)",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(selftest_settings, stability)},
    {.name = "only",
     .argument = "GROUP",
     .help = "one group of cases: meshes, hulls, eigenvectors, leaves, tubes, plants, numbers or places",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(selftest_settings, only)},
    {.name = "json",
     .help = "print one JSON object",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(selftest_settings, json)},
    {.letter = 'q',
     .name = "quiet",
     .help = "only what is beyond its bound, and the count",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(selftest_settings, quiet)},
};

static void tell_group(const char *group)
{
    if (isatty(STDERR_FILENO)) fprintf(stderr, "%s ...\n", group);
}

static void print_number(int width, double number)
{
    if (isnan(number))
        printf("%*s", width, "-");
    else
        printf("%*.2g", width, number);
}

static void print_text(const plm_check_table *table, bool is_quiet)
{
    printf("%-46s %-32s %9s %9s %9s  %s\n", "case", "measure", "error", "condition", "bound", "verdict");
    for (size_t i = 0; i < table->count; i++) {
        const plm_check *row = &table->check[i];
        if (is_quiet && row->verdict != PLM_VERDICT_BEYOND) continue;
        printf("%-46s %-32s ", row->scene, row->measure);
        print_number(9, row->error);
        print_number(10, row->condition);
        print_number(10, row->bound);
        printf("  %s%s%s\n", plm_verdict_name(row->verdict), row->note[0] ? ": " : "", row->note);
    }
    const size_t defects = plm_check_defects(table);
    if (defects)
        printf("%zu of %zu checks are beyond their bounds\n", defects, table->count);
    else
        printf("all %zu checks are within their bounds\n", table->count);
}

/* JSON has no NaN. */
static json_t *number_or_null(double number)
{
    return isfinite(number) ? json_real(number) : json_null();
}

static int print_json(const plm_check_table *table)
{
    json_t *rows = json_array();
    for (size_t i = 0; rows && i < table->count; i++) {
        const plm_check *row = &table->check[i];
        json_array_append_new(rows, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:s, s:s}", "case", row->scene,
                                              "measure", row->measure, "found", number_or_null(row->found), "reference",
                                              number_or_null(row->reference), "error", number_or_null(row->error),
                                              "condition", number_or_null(row->condition), "bound",
                                              number_or_null(row->bound), "verdict", plm_verdict_name(row->verdict),
                                              "note", row->note));
    }
    json_t *root =
        json_pack("{s:s, s:i, s:o}", "version", PLM_VERSION, "defects", (int)plm_check_defects(table), "checks", rows);
    const bool failed = !root || json_dumpf(root, stdout, JSON_INDENT(1)) != 0;
    putchar('\n');
    json_decref(root);
    return failed ? PLM_EXIT_OUTPUT : PLM_EXIT_GOOD;
}

static int run(int argc, char **argv)
{
    selftest_settings settings = {0};
    int code = plm_parse_options(&plm_command_selftest, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc > 0) return plm_usage_error(&plm_command_selftest, "unexpected argument \"%s\"", argv[0]);
    omp_set_num_threads(1); /* hundreds of small plants: threads would only wait for each other */
    plm_error error = {0};
    plm_check_table table = {0};
    const plm_status status = plm_selftest_stability(&table, settings.only, tell_group, &error);
    if (status != PLM_OK) {
        code = plm_report_failure(status, &error);
    } else {
        code = PLM_EXIT_GOOD;
        if (settings.json)
            code = print_json(&table);
        else
            print_text(&table, settings.quiet);
        if (code == PLM_EXIT_GOOD && plm_check_defects(&table)) code = PLM_EXIT_SOME_FAILED;
    }
    plm_check_table_free(&table);
    return code;
}

const plm_command plm_command_selftest = {
    .name = "selftest",
    .arguments = "[OPTION]...",
    .summary = "measure hard cases with known answers, and say what is beyond its bound",
    .description =
        "Each row is a case (a needle triangle, a stem seen over 20 degrees, a lawn, the date line) and a trait or "
        "function, with its relative error (absolute where the answer is 0), the condition of the problem, and the "
        "bound that the error is held to. References are closed forms. \"said why\": there is no value, and a message "
        "says why, which is right where the points determine none.\n\n"
        "Exit code 1: a check is beyond its bound, which is a defect of this build or of the machine.",
    .options = options,
    .option_count = COUNT(options),
    .run = run};
