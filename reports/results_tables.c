/* reports/results_tables.c: traits.csv (long) and plants.csv (wide) out of results. */
#include "reports/csv_write.h"
#include "reports/results.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A table under way; the first failure stays. */
typedef struct sheet {
    plm_output *output;
    plm_status status;
    plm_error *error;
} sheet;

static void put_text(sheet *s, const char *cell, char behind)
{
    if (s->status == PLM_OK) s->status = plm_csv_text(s->output, cell, behind, s->error);
}

static void put_number(sheet *s, double value, char behind)
{
    if (s->status == PLM_OK) s->status = plm_csv_number(s->output, value, behind, s->error);
}

/* Coordinates to the micrometre: at UTM coordinates nine digits would be a centimetre. */
static void put_position(sheet *s, double metres, char behind)
{
    char text[64] = "";
    if (isfinite(metres) && fabs(metres) < 1e15) {
        snprintf(text, sizeof text, "%.6f", metres);
        char *end = text + strlen(text);
        while (end[-1] == '0') *--end = 0;
        if (end[-1] < '0' || end[-1] > '9') end[-1] = 0; /* the decimal separator, with nothing behind it */
        for (char *c = text + (text[0] == '-'); *c; c++)
            if (*c < '0' || *c > '9') *c = '.'; /* a locale may put a comma there */
        if (!strcmp(text, "-0")) strcpy(text, "0");
    }
    put_text(s, text, behind);
}

static void put_degrees(sheet *s, const plm_result *plant, double degrees, char behind)
{
    put_position(s, plant->has_place ? degrees : NAN, behind);
}

static bool any_has_place(const plm_results *results)
{
    for (size_t i = 0; i < results->count; i++)
        if (results->plant[i].has_place) return true;
    return false;
}

/* ---- traits.csv ------------------------------------------------------------------------------------------------ */

static void put_trait_row(sheet *s, const plm_result *plant, const plm_result_row *row, bool with_place)
{
    char id[16] = "";
    if (row->organ_id >= 0) snprintf(id, sizeof id, "%d", row->organ_id);
    const bool is_ok = plm_result_row_is_ok(row);
    put_text(s, plant->plant_id, ',');
    put_text(s, plm_level_name(row->trait->level), ',');
    put_text(s, id, ',');
    for (int axis = 0; axis < 3; axis++) put_position(s, row->position[axis], ',');
    put_text(s, row->trait->name, ',');
    put_number(s, is_ok ? row->value : NAN, ',');
    put_text(s, plm_unit_name(row->trait->unit), ',');
    put_number(s, is_ok ? row->std_error : NAN, ',');
    put_number(s, (double)row->point_count, ',');
    put_text(s, row->status, ',');
    put_text(s, row->reason, ',');
    put_text(s, row->method, with_place ? ',' : '\n');
    if (!with_place) return;
    put_degrees(s, plant, plant->longitude, ',');
    put_degrees(s, plant, plant->latitude, '\n');
}

plm_status plm_results_write_traits(const plm_results *results, const char *path, plm_error *error)
{
    sheet s = {.error = error};
    s.status = plm_output_open(path, &s.output, error);
    if (s.status != PLM_OK) return s.status;
    const bool with_place = any_has_place(results);
    s.status = plm_output_print(s.output, error,
                                "plant_id,organ,organ_id,x,y,z,trait,value,unit,std_error,n_points,status,reason,"
                                "method%s\n",
                                with_place ? ",longitude,latitude" : "");
    for (size_t i = 0; i < results->count; i++)
        for (size_t j = 0; j < results->plant[i].row_count; j++)
            put_trait_row(&s, &results->plant[i], &results->plant[i].row[j], with_place);
    const plm_status closed = plm_output_close(s.output, s.status == PLM_OK, error);
    return s.status == PLM_OK ? closed : s.status;
}

/* ---- plants.csv ------------------------------------------------------------------------------------------------ */

void plm_trait_column(const plm_trait *trait, char *name, size_t room)
{
    const bool has_unit = trait->unit != PLM_NUMBER;
    snprintf(name, room, "%s%s%s", trait->name, has_unit ? "_" : "", has_unit ? plm_unit_name(trait->unit) : "");
}

/* Whether any plant has a row of the trait: a column is there for all plants or for none. */
static bool is_column(const plm_results *results, const plm_trait *trait)
{
    if (trait->level != PLM_PLANT || !strcmp(trait->name, "leaf_count")) return false; /* that one is always there */
    for (size_t i = 0; i < results->count; i++)
        if (plm_result_find(&results->plant[i], trait->name)) return true;
    return false;
}

static void put_trait_cell(sheet *s, const plm_result *plant, const char *trait)
{
    const plm_result_row *row = plm_result_find(plant, trait);
    put_number(s, row && plm_result_row_is_ok(row) ? row->value : NAN, ',');
}

static void put_plant_header(sheet *s, const plm_trait *traits, size_t count, const bool *column, bool with_place)
{
    put_text(s, "plant_id", ',');
    for (size_t i = 0; i < count; i++) {
        char name[128];
        plm_trait_column(&traits[i], name, sizeof name);
        if (column[i]) put_text(s, name, ',');
    }
    put_text(s, "leaf_count", ',');
    if (with_place) {
        put_text(s, "longitude", ',');
        put_text(s, "latitude", ',');
    }
    put_text(s, "status", ',');
    put_text(s, "reason", '\n');
}

static void put_plant(sheet *s, const plm_result *plant, const plm_trait *traits, size_t count, const bool *column,
                      bool with_place)
{
    put_text(s, plant->plant_id, ',');
    for (size_t i = 0; i < count; i++)
        if (column[i]) put_trait_cell(s, plant, traits[i].name);
    put_trait_cell(s, plant, "leaf_count");
    if (with_place) {
        put_degrees(s, plant, plant->longitude, ',');
        put_degrees(s, plant, plant->latitude, ',');
    }
    put_text(s, plant->failure ? "failed" : "ok", ',');
    put_text(s, plant->failure ? plant->failure : "", '\n');
}

plm_status plm_results_write_plants(const plm_results *results, const char *path, plm_error *error)
{
    size_t count;
    const plm_trait *traits = plm_traits(&count);
    bool *column = plm_alloc(count, sizeof *column, error);
    if (!column) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) column[i] = is_column(results, &traits[i]);
    sheet s = {.error = error};
    s.status = plm_output_open(path, &s.output, error);
    plm_status closed = PLM_OK;
    if (s.status == PLM_OK) {
        const bool with_place = any_has_place(results);
        put_plant_header(&s, traits, count, column, with_place);
        for (size_t i = 0; i < results->count; i++)
            put_plant(&s, &results->plant[i], traits, count, column, with_place);
        closed = plm_output_close(s.output, s.status == PLM_OK, error);
    }
    plm_free(column);
    return s.status == PLM_OK ? closed : s.status;
}

/* ---- The same from reports -------------------------------------------------------------------------------------- */

static plm_status write_reports(const plm_plant_report *plants, size_t count, const char *path,
                                plm_status (*write)(const plm_results *, const char *, plm_error *), plm_error *error)
{
    plm_results results = {0};
    plm_status status = PLM_OK;
    for (size_t i = 0; i < count && status == PLM_OK; i++)
        status = plm_results_add(&results, &plants[i], i, NULL, error);
    if (status == PLM_OK) status = write(&results, path, error);
    plm_results_free(&results);
    return status;
}

plm_status plm_write_traits_csv(const char *path, const plm_plant_report *plants, size_t count, plm_error *error)
{
    return write_reports(plants, count, path, plm_results_write_traits, error);
}

plm_status plm_write_plants_csv(const char *path, const plm_plant_report *plants, size_t count, plm_error *error)
{
    return write_reports(plants, count, path, plm_results_write_plants, error);
}
