/* reports/results_read.c: the rows of a traits.csv that an earlier run wrote, so that a batch goes on where it was ended.
 * Rows are written again from what is read: nine digits of a number survive that unchanged. */
#include "reports/csv_table.h"
#include "reports/run_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 12 };
static const char *const column_names[COLUMNS] = {"plant_id", "organ_id",  "x",        "y",      "z",      "trait",
                                                  "value",    "std_error", "n_points", "status", "reason", "method"};
enum { PLANT, ORGAN, X, Y, Z, TRAIT, VALUE, ERROR, POINTS, STATUS, REASON, METHOD };

static plm_status broken_row(const plm_table *table, size_t row, const char *path, const char *what, plm_error *error)
{
    return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: %s; it is not a table of this version", path,
                    table->line[row + 1], what);
}

static plm_status find_columns(const plm_table *table, const char *path, size_t column[COLUMNS], plm_error *error)
{
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = plm_table_column(table, column_names[i]);
        if (column[i] == SIZE_MAX)
            return plm_fail(error, PLM_E_FORMAT, "%s: no column \"%s\"; it is not a table of this version", path,
                            column_names[i]);
    }
    return PLM_OK;
}

static double number_or_nan(const char *cell)
{
    double value;
    return plm_table_number(cell, &value) ? value : NAN;
}

static plm_status read_row(const plm_table *table, size_t at, const size_t column[COLUMNS], const char *path,
                           plm_result_row *row, plm_error *error)
{
    const char *cell[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) cell[i] = plm_table_cell(table, at, column[i]);
    *row = (plm_result_row){.trait = plm_trait_find(cell[TRAIT])};
    if (!row->trait) return broken_row(table, at, path, "an unknown trait", error);
    const double organ = number_or_nan(cell[ORGAN]), points = number_or_nan(cell[POINTS]);
    row->organ_id = isgreaterequal(organ, 0) && organ <= INT32_MAX ? (int32_t)organ : -1;
    for (int axis = 0; axis < 3; axis++) row->position[axis] = number_or_nan(cell[X + axis]);
    row->value = number_or_nan(cell[VALUE]);
    row->std_error = number_or_nan(cell[ERROR]);
    row->point_count = isgreaterequal(points, 0) && points < 1e15 ? (size_t)points : 0;
    return plm_result_row_texts(row, cell[STATUS], cell[REASON], cell[METHOD], error);
}

/* Rows [first, last) of the table belong to one plant. */
static plm_status read_plant(const plm_table *table, size_t first, size_t last, const size_t column[COLUMNS],
                             const char *path, plm_result *plant, plm_error *error)
{
    if (plant->row) return broken_row(table, first, path, "rows of one plant in two places", error);
    plant->row = plm_alloc(last - first, sizeof *plant->row, error);
    if (!plant->row) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (size_t i = first; i < last && status == PLM_OK; i++) {
        status = read_row(table, i, column, path, &plant->row[plant->row_count], error);
        if (status == PLM_OK) plant->row_count++;
    }
    return status;
}

static plm_status read_table(plm_results *results, const plm_table *table, const char *path, plm_error *error)
{
    size_t column[COLUMNS];
    plm_status status = find_columns(table, path, column, error);
    for (size_t first = 0, last; first < table->rows && status == PLM_OK; first = last) {
        const char *id = plm_table_cell(table, first, column[PLANT]);
        for (last = first + 1; last < table->rows && !strcmp(plm_table_cell(table, last, column[PLANT]), id);) last++;
        plm_result *plant = plm_results_find(results, id);
        if (plant) status = read_plant(table, first, last, column, path, plant, error);
    }
    return status;
}

plm_status plm_results_read_traits(plm_results *results, const char *path, plm_error *error)
{
    plm_table table;
    plm_status status = plm_table_read(path, &table, error);
    if (status != PLM_OK) return status;
    status = read_table(results, &table, path, error);
    plm_table_free(&table);
    return status;
}

/* ---- The folder of a run ------------------------------------------------------------------------------------------ */

static plm_status take_record(plm_results *results, json_t *record, const char *id, size_t rank, plm_error *error)
{
    plm_status status = plm_results_add_empty(results, id, rank, json_incref(record), error);
    if (status != PLM_OK) return status;
    plm_result *plant = plm_results_find(results, id);
    const json_t *place = json_object_get(record, "place");
    if (place) {
        plant->has_place = true;
        plant->longitude = json_number_value(json_object_get(place, "longitude"));
        plant->latitude = json_number_value(json_object_get(place, "latitude"));
    }
    const char *state = json_string_value(json_object_get(record, "status"));
    if (!state || strcmp(state, "ok")) {
        const char *reason = json_string_value(json_object_get(record, "reason"));
        plant->failure = plm_strdup(reason ? reason : "not measured", error);
        if (!plant->failure) status = PLM_E_MEMORY;
    }
    return status;
}

plm_status plm_results_take_records(plm_results *results, const json_t *root, bool with_failed,
                                    size_t (*rank)(const void *user, const char *plant_id), const void *user,
                                    plm_error *error)
{
    const json_t *plants = json_object_get(root, "plants");
    plm_status status = PLM_OK;
    for (size_t i = 0; i < json_array_size(plants) && status == PLM_OK; i++) {
        json_t *record = json_array_get(plants, i);
        const char *id = json_string_value(json_object_get(record, "plant_id"));
        const char *state = json_string_value(json_object_get(record, "status"));
        if (!id || !state || (strcmp(state, "ok") && !with_failed) || plm_results_find(results, id)) continue;
        status = take_record(results, record, id, rank ? rank(user, id) : i, error);
    }
    return status;
}

plm_status plm_results_read_folder(plm_results *results, const char *folder, json_t **root, plm_error *error)
{
    char path[4096];
    json_t *found = NULL;
    if ((size_t)snprintf(path, sizeof path, "%s/traits.csv", folder) >= sizeof path)
        return plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    snprintf(path, sizeof path, "%s/run.json", folder);
    plm_status status = plm_run_json_read(path, &found, error);
    if (status == PLM_OK) status = plm_results_take_records(results, found, true, NULL, NULL, error);
    snprintf(path, sizeof path, "%s/traits.csv", folder);
    if (status == PLM_OK) status = plm_results_read_traits(results, path, error);
    if (root)
        *root = found;
    else
        json_decref(found);
    return status;
}
