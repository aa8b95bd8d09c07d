/* tool/visibility.c: correction for the part of a plant that a scan did not see. */
#include "tool/visibility.h"

#include "reports/csv_table.h"
#include "reports/csv_write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* ---- The files -------------------------------------------------------------------------------------------------- */

static plm_status no_column(const char *path, const char *name, plm_error *error)
{
    return plm_fail(error, PLM_E_FORMAT, "%.200s: line 1: has no column \"%s\"", path, name);
}

static plm_status add_curve(const plm_table *table, const char *path, size_t row, visibility *made, plm_error *error)
{
    visibility_curve curve = {.slope = 0};
    snprintf(curve.trait, sizeof curve.trait, "%s", plm_table_cell(table, row, plm_table_column(table, "trait")));
    if (!plm_table_number(plm_table_cell(table, row, plm_table_column(table, "slope")), &curve.slope) ||
        !plm_table_number(plm_table_cell(table, row, plm_table_column(table, "residual_sd")), &curve.residual))
        return plm_fail(error, PLM_E_FORMAT, "%.200s: line %zu: slope and residual_sd must be numbers", path,
                        table->line[row + 1]);
    made->curve[made->curve_count++] = curve;
    return PLM_OK;
}

/* The curves of one plant; name NULL: the file's only one. */
static plm_status take_curves(const plm_table *table, const char *path, const char *name, visibility *made,
                              plm_error *error)
{
    static const char *const columns[] = {"plant", "trait", "slope", "residual_sd"};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
        if (plm_table_column(table, columns[k]) == SIZE_MAX) return no_column(path, columns[k], error);
    const size_t plant = plm_table_column(table, "plant");
    made->curve = plm_alloc(table->rows, sizeof *made->curve, error);
    if (!made->curve) return PLM_E_MEMORY;
    if (!name && table->rows) name = plm_table_cell(table, 0, plant);
    plm_status status = PLM_OK;
    for (size_t row = 0; row < table->rows && status == PLM_OK; row++) {
        const char *here = plm_table_cell(table, row, plant);
        if (!strcmp(here, name)) status = add_curve(table, path, row, made, error);
    }
    if (status == PLM_OK && !made->curve_count)
        status = plm_fail(error, PLM_E_ARGUMENT, "%.200s has no curves of the plant \"%.60s\"", path, name ? name : "");
    return status;
}

static bool has_several(const plm_table *table)
{
    const size_t plant = plm_table_column(table, "plant");
    for (size_t row = 1; row < table->rows; row++)
        if (strcmp(plm_table_cell(table, row, plant), plm_table_cell(table, 0, plant))) return true;
    return false;
}

static plm_status read_curves(const char *correction, visibility *made, plm_error *error)
{
    char path[4096];
    plm_table table;
    if (snprintf(path, sizeof path, "%s", correction) >= (int)sizeof path)
        return plm_fail(error, PLM_E_ARGUMENT, "%.60s...: the path is too long", correction);
    plm_error trouble = {0};
    char *colon = strrchr(path, ':');
    plm_status status = plm_table_read(path, &table, &trouble);
    if (status != PLM_OK && colon) { /* FILE:PLANT */
        *colon = 0;
        status = plm_table_read(path, &table, &trouble);
    } else {
        colon = NULL;
    }
    if (status != PLM_OK) return plm_fail(error, status, "%s", trouble.message);
    if (!colon && has_several(&table))
        status = plm_fail(error, PLM_E_ARGUMENT, "%.200s holds curves of several plants; name one as FILE:PLANT", path);
    if (status == PLM_OK) status = take_curves(&table, path, colon ? colon + 1 : NULL, made, error);
    plm_table_free(&table);
    return status;
}

static bool is_share(double share)
{
    return share > 0 && share <= 1;
}

static plm_status take_shares(const plm_table *table, const char *path, visibility *made, plm_error *error)
{
    const size_t plant = plm_table_column(table, "plant_id"), column = plm_table_column(table, "visible_share");
    if (plant == SIZE_MAX) return no_column(path, "plant_id", error);
    if (column == SIZE_MAX) return no_column(path, "visible_share", error);
    made->share = plm_alloc(table->rows, sizeof *made->share, error);
    if (!made->share) return PLM_E_MEMORY;
    for (size_t row = 0; row < table->rows; row++) {
        visibility_share one;
        if (!plm_table_number(plm_table_cell(table, row, column), &one.share) || !is_share(one.share))
            return plm_fail(error, PLM_E_FORMAT, "%.200s: line %zu: found \"%.40s\", a share above 0 to 1 was expected",
                            path, table->line[row + 1], plm_table_cell(table, row, column));
        one.plant_id = plm_strdup(plm_table_cell(table, row, plant), error);
        if (!one.plant_id) return PLM_E_MEMORY;
        made->share[made->share_count++] = one;
    }
    return PLM_OK;
}

static plm_status read_shares(const char *share, visibility *made, plm_error *error)
{
    if (plm_table_number(share, &made->common_share)) {
        if (is_share(made->common_share)) return PLM_OK;
        return plm_fail(error, PLM_E_ARGUMENT, "a visible share of %g; above 0 to 1 was expected", made->common_share);
    }
    plm_table table;
    plm_status status = plm_table_read(share, &table, error);
    if (status != PLM_OK) return status;
    status = take_shares(&table, share, made, error);
    plm_table_free(&table);
    return status;
}

plm_status visibility_read(const char *correction, const char *share, visibility *made, plm_error *error)
{
    *made = (visibility){0};
    plm_status status = read_curves(correction, made, error);
    if (status == PLM_OK) status = read_shares(share, made, error);
    if (status != PLM_OK) visibility_free(made);
    return status;
}

void visibility_free(visibility *made)
{
    for (size_t k = 0; k < made->share_count; k++) plm_free(made->share[k].plant_id);
    plm_free(made->share);
    plm_free(made->curve);
    *made = (visibility){0};
}

/* ---- The table -------------------------------------------------------------------------------------------------- */

bool visibility_correct(const visibility_curve *curve, double share, double value, double std_error, double *corrected,
                        double *corrected_error)
{
    const double seen = 1 + curve->slope * (share - 1);
    if (!(seen > 0.05)) return false;
    *corrected = value / seen;
    /* a plant that was seen whole needs no curve, and has no error of one */
    const double of_curve = share < 1 ? value * curve->residual / (seen * seen) : 0;
    *corrected_error = hypot(isfinite(std_error) ? std_error / seen : 0, of_curve);
    return true;
}

static double share_of(const visibility *made, const char *plant_id)
{
    for (size_t k = 0; k < made->share_count; k++)
        if (!strcmp(made->share[k].plant_id, plant_id)) return made->share[k].share;
    return made->common_share;
}

static plm_status write_row(plm_output *output, const plm_result *plant, const visibility_curve *curve, double share,
                            plm_error *error)
{
    const plm_result_row *row = plm_result_find(plant, curve->trait);
    double corrected, corrected_error;
    if (!row || !plm_result_row_is_ok(row) ||
        !visibility_correct(curve, share, row->value, row->std_error, &corrected, &corrected_error))
        return PLM_OK;
    const double number[] = {row->value, row->std_error, share, corrected, corrected_error};
    plm_status status = plm_csv_text(output, plant->plant_id, ',', error);
    if (status == PLM_OK) status = plm_csv_text(output, curve->trait, ',', error);
    for (size_t k = 0; k < sizeof number / sizeof *number && status == PLM_OK; k++)
        status = plm_csv_number(output, number[k], ',', error);
    return status == PLM_OK ? plm_csv_text(output, plm_unit_name(row->trait->unit), '\n', error) : status;
}

plm_status visibility_write(const visibility *made, const plm_results *results, const char *path, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(
        output, error, "plant_id,trait,value,std_error,visible_share,corrected_value,corrected_std_error,unit\n");
    for (size_t i = 0; i < results->count; i++) {
        const double share = share_of(made, results->plant[i].plant_id);
        for (size_t k = 0; k < made->curve_count && share > 0 && status == PLM_OK; k++)
            status = write_row(output, &results->plant[i], &made->curve[k], share, error);
    }
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}
