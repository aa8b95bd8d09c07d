/* tool/agreement_run.c: runs a comparison of two tables and tells what came of it. */
#include "tool/agreement_run.h"

#include "io/io.h"
#include "reports/plots.h"
#include "reports/validation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void print_table(const plm_validation *v)
{
    printf("%-26s %-14s %6s %9s %10s %9s %9s %10s  %s\n", "trait", "group", "n", "R2", "RMSE", "rRMSE %", "MAPE %",
           "bias", "unit");
    for (size_t i = 0; i < v->group_count; i++) {
        const plm_validated_group *g = &v->group[i];
        static const plm_statistic_id shown[] = {PLM_STAT_R2, PLM_STAT_RMSE, PLM_STAT_RRMSE, PLM_STAT_MAPE,
                                                 PLM_STAT_BIAS};
        static const int width[] = {9, 10, 9, 9, 10};
        printf("%-26s %-14s %6zu", g->trait, g->group, g->count);
        for (size_t k = 0; k < COUNT(shown); k++) {
            const double value = g->statistic[shown[k]].value;
            if (isfinite(value))
                printf(" %*.4g", width[k], value);
            else
                printf(" %*s", width[k], "-");
        }
        printf("  %s\n", g->unit);
    }
    size_t estimates = 0, manuals = 0;
    for (size_t i = 0; i < v->estimate.count; i++) estimates += !v->estimate_used[i];
    for (size_t i = 0; i < v->manual.count; i++) manuals += !v->manual_used[i];
    printf("%zu pairs; %zu estimates and %zu manual readings stayed unpaired (unmatched.csv)\n", v->pair_count,
           estimates, manuals);
}

/* Conditions in their order; a shut gate is told and remembered. */
static int try_gates(const plm_validation *v, const char *conditions)
{
    int exit_code = PLM_EXIT_GOOD;
    for (const char *at = conditions; *at;) {
        const size_t length = strcspn(at, ",");
        char condition[256];
        if (length >= sizeof condition) return plm_usage_error(NULL, "a condition of %zu characters", length);
        memcpy(condition, at, length);
        condition[length] = 0;
        plm_gate_result result;
        plm_error error = {0};
        if (plm_validation_gate(v, condition, &result, &error) != PLM_OK)
            return plm_usage_error(NULL, "%s", error.message);
        fprintf(stderr, "plantimeter: %s: %s\n", result.failed ? "failed" : "passed", result.message);
        if (result.failed) exit_code = PLM_EXIT_SOME_FAILED;
        at += length + (at[length] == ',');
    }
    return exit_code;
}

static plm_status draw(const plm_validation *v, const char *output, plm_error *error)
{
    char folder[4096];
    if ((size_t)snprintf(folder, sizeof folder, "%s/plots", output) >= sizeof folder)
        return plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    bool drawn = false;
    const plm_status status = plm_validation_plots(v, folder, &drawn, error);
    if (status == PLM_OK && !drawn)
        fprintf(stderr, "plantimeter: gnuplot is not installed; %s holds the scripts and data\n", folder);
    return status;
}

int agreement_run(const agreement_settings *settings, const char *estimates, const char *manual)
{
    const plm_validation_options options = {.match = (plm_match)settings->match,
                                            .manual_angle = (plm_manual_angle)settings->manual_angle,
                                            .metadata = settings->metadata,
                                            .by = settings->by,
                                            .tolerance = settings->tolerance,
                                            .variance_ratio = settings->variance_ratio,
                                            .resamples = (size_t)settings->resamples,
                                            .seed = settings->seed};
    plm_error error = {0};
    plm_validation validation;
    plm_status status = plm_validate(estimates, manual, &options, &validation, &error);
    if (status != PLM_OK) {
        plm_report_failure(status, &error);
        return PLM_EXIT_INPUT;
    }
    int exit_code = PLM_EXIT_GOOD;
    status = plm_folder_make(settings->output, &error);
    if (status == PLM_OK) status = plm_validation_write(&validation, settings->output, &error);
    if (status == PLM_OK && settings->plots) status = draw(&validation, settings->output, &error);
    if (status != PLM_OK) {
        exit_code = plm_report_failure(status, &error);
    } else {
        if (!settings->quiet) print_table(&validation);
        if (validation.unit_mismatches)
            fprintf(stderr, "plantimeter: %zu pairs were left out: their units do not convert into each other\n",
                    validation.unit_mismatches);
        if (settings->fail_if) exit_code = try_gates(&validation, settings->fail_if);
    }
    plm_validation_free(&validation);
    return exit_code;
}
