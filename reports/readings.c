/* reports/readings.c: rows of trait tables as readings: columns found by name, units and organs filled in from the trait
 * table, repeats averaged. */
#include "reports/readings.h"

#include "traits/traits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct column_set {
    size_t plant, organ, organ_id, trait, value, unit, x, y, z, std_error, status;
    bool is_field_book;
} column_set;

static plm_status find_columns(const plm_table *table, const char *path, column_set *c, plm_error *error)
{
    *c = (column_set){.plant = plm_table_column(table, "plant_id"),
                      .organ = plm_table_column(table, "organ"),
                      .organ_id = plm_table_column(table, "organ_id"),
                      .trait = plm_table_column(table, "trait"),
                      .value = plm_table_column(table, "value"),
                      .unit = plm_table_column(table, "unit"),
                      .x = plm_table_column(table, "x"),
                      .y = plm_table_column(table, "y"),
                      .z = plm_table_column(table, "z"),
                      .std_error = plm_table_column(table, "std_error"),
                      .status = plm_table_column(table, "status")};
    if (c->trait == SIZE_MAX || c->value == SIZE_MAX)
        return plm_fail(error, PLM_E_FORMAT,
                        "%s: line 1: no column \"%s\"; plant_id, organ, organ_id, trait, value, unit were expected",
                        path, c->trait == SIZE_MAX ? "trait" : "value");
    c->is_field_book = c->plant == SIZE_MAX;
    if (c->is_field_book) c->plant = 0; /* the unique id comes first */
    return PLM_OK;
}

/* A trait's row by its name, or by its name with the unit behind it (plant_height_mm), cut off in place. */
static const plm_trait *find_trait(char *name, const char **unit)
{
    const plm_trait *trait = plm_trait_find(name);
    char *last = strrchr(name, '_');
    if (trait || !last) return trait;
    *last = 0;
    trait = plm_trait_find(name);
    if (trait && plm_unit_conversion(last + 1, plm_unit_name(trait->unit)) > 0)
        *unit = last + 1;
    else
        *last = '_', trait = NULL;
    return trait;
}

static bool position_of(const plm_table *table, size_t row, const column_set *c, double position[3])
{
    return plm_table_number(plm_table_cell(table, row, c->x), &position[0]) &&
           plm_table_number(plm_table_cell(table, row, c->y), &position[1]) &&
           plm_table_number(plm_table_cell(table, row, c->z), &position[2]);
}

/* One row; used is false where it holds no value. */
static plm_status take_row(plm_readings *r, size_t row, const column_set *c, const char *path, plm_reading *out,
                           double *std_error, bool *used, plm_error *error)
{
    const char *text = plm_table_cell(&r->table, row, c->value), *status = plm_table_cell(&r->table, row, c->status);
    *used = !(status[0] && strncmp(status, "ok", 2)) && text[0] && strcmp(text, "NA");
    if (!*used) return PLM_OK;
    char *trait_name = r->table.cell[(row + 1) * r->table.columns + c->trait];
    *out = (plm_reading){.plant_id = plm_table_cell(&r->table, row, c->plant),
                         .organ = plm_table_cell(&r->table, row, c->organ),
                         .organ_id = plm_table_cell(&r->table, row, c->organ_id),
                         .unit = plm_table_cell(&r->table, row, c->unit),
                         .trait = trait_name,
                         .group = "",
                         .repeat_count = 1};
    const char *unit = "";
    const plm_trait *trait = find_trait(trait_name, &unit);
    if (!plm_table_number(text, &out->value)) {
        *used = trait || !c->is_field_book; /* scores, colours and photos of other traits are no readings */
        if (!*used) return PLM_OK;
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: value \"%s\" is not a number", path, r->table.line[row + 1],
                        text);
    }
    if (!out->unit[0]) out->unit = unit[0] ? unit : trait ? plm_unit_name(trait->unit) : "1";
    if (!out->organ[0]) out->organ = trait ? plm_level_name(trait->level) : "plant";
    out->has_position = position_of(&r->table, row, c, out->position);
    if (!plm_table_number(plm_table_cell(&r->table, row, c->std_error), std_error)) *std_error = NAN;
    return PLM_OK;
}

typedef struct keyed {
    const plm_reading *reading;
    size_t row;
} keyed;

static int by_key(const void *a, const void *b)
{
    const keyed *x = a, *y = b;
    int order = strcmp(x->reading->plant_id, y->reading->plant_id);
    if (!order) order = strcmp(x->reading->organ, y->reading->organ);
    if (!order) order = strcmp(x->reading->organ_id, y->reading->organ_id);
    if (!order) order = strcmp(x->reading->trait, y->reading->trait);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

/* Organs without a number are told apart by nothing but their row: they are never repeats. */
static bool is_repeat(const plm_reading *a, const plm_reading *b)
{
    return !strcmp(a->plant_id, b->plant_id) && !strcmp(a->organ, b->organ) && !strcmp(a->organ_id, b->organ_id) &&
           !strcmp(a->trait, b->trait) && (a->organ_id[0] || !strcmp(a->organ, "plant"));
}

static plm_status merge_repeats(plm_readings *r, const char *path, plm_error *error)
{
    keyed *key = plm_alloc(r->count, sizeof *key, error);
    plm_reading *merged = key ? plm_alloc(r->count, sizeof *merged, error) : NULL;
    double *merged_error = merged ? plm_alloc(r->count, sizeof *merged_error, error) : NULL;
    r->repeat_value = plm_alloc(r->count, sizeof *r->repeat_value, error);
    r->repeat_reading = plm_alloc(r->count, sizeof *r->repeat_reading, error);
    plm_status status = merged_error && r->repeat_value && r->repeat_reading ? PLM_OK : PLM_E_MEMORY;
    size_t count = 0;
    if (status == PLM_OK) {
        for (size_t i = 0; i < r->count; i++) key[i] = (keyed){&r->reading[i], i};
        qsort(key, r->count, sizeof *key, by_key);
    }
    for (size_t begin = 0, end; status == PLM_OK && begin < r->count; begin = end) {
        merged[count] = *key[begin].reading;
        merged_error[count] = r->std_error[key[begin].row];
        double sum = 0;
        for (end = begin; end < r->count && (end == begin || is_repeat(key[begin].reading, key[end].reading)); end++) {
            const double factor = plm_unit_conversion(key[end].reading->unit, merged[count].unit);
            if (!(factor > 0)) {
                status =
                    plm_fail(error, PLM_E_FORMAT, "%s: %s of %s is given in \"%s\" and in \"%s\"", path,
                             merged[count].trait, merged[count].plant_id, merged[count].unit, key[end].reading->unit);
                break;
            }
            r->repeat_value[end] = key[end].reading->value * factor;
            r->repeat_reading[end] = (uint32_t)count;
            sum += r->repeat_value[end];
        }
        if (end == begin) break;
        merged[count].repeat_count = end - begin;
        merged[count++].value = sum / (double)(end - begin);
    }
    plm_free(key);
    if (status != PLM_OK) {
        plm_free(merged);
        plm_free(merged_error);
        return status;
    }
    plm_free(r->reading);
    plm_free(r->std_error);
    r->reading = merged, r->std_error = merged_error;
    r->repeat_total = r->count;
    r->repeat_rows = r->count - count;
    r->count = count;
    return PLM_OK;
}

plm_status plm_readings_load(const char *path, plm_readings *out, plm_error *error)
{
    plm_readings r = {0};
    plm_status status = plm_table_read(path, &r.table, error);
    column_set columns = {0};
    if (status == PLM_OK) status = find_columns(&r.table, path, &columns, error);
    if (status == PLM_OK) {
        r.reading = plm_alloc(r.table.rows, sizeof *r.reading, error);
        r.std_error = plm_alloc(r.table.rows, sizeof *r.std_error, error);
        if (!r.reading || !r.std_error) status = PLM_E_MEMORY;
    }
    for (size_t row = 0; status == PLM_OK && row < r.table.rows; row++) {
        bool used = false;
        status = take_row(&r, row, &columns, path, &r.reading[r.count], &r.std_error[r.count], &used, error);
        r.count += used;
        r.skipped += !used;
    }
    if (status == PLM_OK) status = merge_repeats(&r, path, error);
    if (status == PLM_OK)
        *out = r;
    else
        plm_readings_free(&r);
    return status;
}

void plm_readings_free(plm_readings *readings)
{
    plm_table_free(&readings->table);
    plm_free(readings->reading);
    plm_free(readings->std_error);
    plm_free(readings->repeat_value);
    plm_free(readings->repeat_reading);
    *readings = (plm_readings){0};
}

void plm_readings_convert_angles(plm_readings *readings, plm_manual_angle convention)
{
    for (size_t i = 0; i < readings->count; i++) {
        plm_reading *reading = &readings->reading[i];
        const double right_angle = 90 * plm_unit_conversion("deg", reading->unit);
        if (!strstr(reading->trait, "inclination") || right_angle == 0) continue;
        if (convention == PLM_ANGLE_HORIZONTAL) reading->value = right_angle - reading->value;
        if (convention == PLM_ANGLE_STEM) {
            const plm_trait *trait = plm_trait_find("leaf_insertion_angle");
            reading->trait = "leaf_insertion_angle";
            if (trait) reading->organ = plm_level_name(trait->level);
        }
    }
}

/* The values of the named columns in a row, joined by '/', written to *at. */
static plm_status join_columns(const plm_table *table, size_t row, const char *columns, char **at, plm_error *error)
{
    for (const char *name = columns; *name;) {
        const size_t length = strcspn(name, ",");
        char header[128];
        if (length >= sizeof header) return plm_fail(error, PLM_E_ARGUMENT, "a column name of %zu characters", length);
        memcpy(header, name, length);
        header[length] = 0;
        const size_t column = plm_table_column(table, header);
        if (column == SIZE_MAX) return plm_fail(error, PLM_E_ARGUMENT, "the metadata have no column \"%s\"", header);
        if (name != columns) *(*at)++ = '/';
        const char *cell = plm_table_cell(table, row, column);
        memcpy(*at, cell, strlen(cell));
        *at += strlen(cell);
        name += length + (name[length] == ',');
    }
    *(*at)++ = 0;
    return PLM_OK;
}

plm_status plm_readings_group(plm_readings *readings, const plm_table *metadata, const char *columns, char **names,
                              plm_error *error)
{
    const size_t plant = plm_table_column(metadata, "plant_id");
    if (plant == SIZE_MAX) return plm_fail(error, PLM_E_ARGUMENT, "the metadata have no column \"plant_id\"");
    size_t named = 1, room = 1;
    for (const char *c = columns; *c; c++) named += *c == ',';
    for (size_t row = 0; row < metadata->rows; row++) {
        room += named + 1;
        for (size_t column = 0; column < metadata->columns; column++)
            room += named * strlen(plm_table_cell(metadata, row, column)); /* a column may be named twice */
    }
    char *block = plm_alloc(room, 1, error);
    const char **group = plm_alloc(metadata->rows, sizeof *group, error);
    plm_status status = block && group ? PLM_OK : PLM_E_MEMORY;
    char *at = block;
    for (size_t row = 0; status == PLM_OK && row < metadata->rows; row++) {
        group[row] = at;
        status = join_columns(metadata, row, columns, &at, error);
    }
    /* The readings are sorted by plant, so each plant is looked up once. */
    const char *last = NULL, *found = "";
    for (size_t i = 0; status == PLM_OK && i < readings->count; i++) {
        const char *id = readings->reading[i].plant_id;
        if (!last || strcmp(last, id)) {
            last = id, found = "";
            for (size_t row = 0; row < metadata->rows; row++)
                if (!strcmp(plm_table_cell(metadata, row, plant), id)) found = group[row];
        }
        readings->reading[i].group = found;
    }
    plm_free(group);
    if (status == PLM_OK)
        *names = block;
    else
        plm_free(block);
    return status;
}
