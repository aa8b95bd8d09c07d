/* io/columns.c: columns of numbers, and what their names mean. */
#include "io/columns.h"

#include "io/number.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

size_t plm_scalar_size(plm_scalar type)
{
    static const size_t sizes[PLM_SCALAR_COUNT] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return sizes[type];
}

bool plm_host_is_little(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

plm_column *plm_columns_add(plm_columns *columns, const char *name, size_t name_length, plm_scalar type,
                            plm_error *error)
{
    if (columns->count == columns->room) {
        const size_t room = columns->room ? 2 * columns->room : 16;
        plm_column *larger = plm_realloc(columns->column, room, sizeof *larger, error);
        if (!larger) return NULL;
        columns->column = larger;
        columns->room = room;
    }
    plm_column *column = &columns->column[columns->count++];
    *column = (plm_column){.type = type, .is_whole = type < PLM_FLOAT32};
    const size_t length = name_length < sizeof column->name - 1 ? name_length : sizeof column->name - 1;
    memcpy(column->name, name, length);
    return column;
}

void plm_columns_free(plm_columns *columns)
{
    plm_free(columns->column);
    *columns = (plm_columns){0};
}

/* One loop a type: the switch stays outside of the loop. */
#define LOAD(T)                                                                                                        \
    for (size_t i = 0; i < count; i++, from += column->stride) {                                                       \
        T stored;                                                                                                      \
        unsigned char turned[sizeof(T)];                                                                               \
        if (column->is_swapped) {                                                                                      \
            for (size_t k = 0; k < sizeof(T); k++) turned[k] = from[sizeof(T) - 1 - k];                                \
            memcpy(&stored, turned, sizeof stored);                                                                    \
        } else {                                                                                                       \
            memcpy(&stored, from, sizeof stored);                                                                      \
        }                                                                                                              \
        values[i] = (double)stored;                                                                                    \
    }                                                                                                                  \
    break

void plm_column_load(const plm_column *column, size_t first, size_t count, double *values)
{
    const unsigned char *from = column->data + first * column->stride;
    switch (column->type) {
        case PLM_INT8:
            LOAD(int8_t);
        case PLM_UINT8:
            LOAD(uint8_t);
        case PLM_INT16:
            LOAD(int16_t);
        case PLM_UINT16:
            LOAD(uint16_t);
        case PLM_INT32:
            LOAD(int32_t);
        case PLM_UINT32:
            LOAD(uint32_t);
        case PLM_INT64:
            LOAD(int64_t);
        case PLM_UINT64:
            LOAD(uint64_t);
        case PLM_FLOAT32:
            LOAD(float);
        case PLM_FLOAT64:
            LOAD(double);
        case PLM_SCALAR_COUNT:
            break;
    }
    if (column->mask)
        for (size_t i = 0; i < count; i++) values[i] = (double)((unsigned)values[i] & column->mask);
    if (column->scale != 0)
        for (size_t i = 0; i < count; i++) values[i] = values[i] * column->scale + column->shift;
}

/* Names that columns go by. Earlier names win: a file with z and height has its z in z. */
static const struct {
    const char *name;
    plm_role role;
} names[] = {
    {"x", PLM_ROLE_X},
    {"y", PLM_ROLE_Y},
    {"z", PLM_ROLE_Z},
    {"longitude", PLM_ROLE_X},
    {"latitude", PLM_ROLE_Y},
    {"lon", PLM_ROLE_X},
    {"lat", PLM_ROLE_Y},
    {"easting", PLM_ROLE_X},
    {"northing", PLM_ROLE_Y},
    {"height", PLM_ROLE_Z},
    {"elevation", PLM_ROLE_Z},
    {"altitude", PLM_ROLE_Z},
    {"red", PLM_ROLE_RED},
    {"green", PLM_ROLE_GREEN},
    {"blue", PLM_ROLE_BLUE},
    {"r", PLM_ROLE_RED},
    {"g", PLM_ROLE_GREEN},
    {"b", PLM_ROLE_BLUE},
    {"diffuse_red", PLM_ROLE_RED},
    {"diffuse_green", PLM_ROLE_GREEN},
    {"diffuse_blue", PLM_ROLE_BLUE},
    {"rgb", PLM_ROLE_PACKED_COLOUR},
    {"rgba", PLM_ROLE_PACKED_COLOUR},
    {"nx", PLM_ROLE_NX},
    {"ny", PLM_ROLE_NY},
    {"nz", PLM_ROLE_NZ},
    {"normal_x", PLM_ROLE_NX},
    {"normal_y", PLM_ROLE_NY},
    {"normal_z", PLM_ROLE_NZ},
    {"extent_0", PLM_ROLE_EXTENT_0},
    {"extent_1", PLM_ROLE_EXTENT_1},
    {"opacity", PLM_ROLE_OPACITY},
    {"f_dc_0", PLM_ROLE_DC_0},
    {"f_dc_1", PLM_ROLE_DC_1},
    {"f_dc_2", PLM_ROLE_DC_2},
    {"scale_0", PLM_ROLE_SCALE_0},
    {"scale_1", PLM_ROLE_SCALE_1},
    {"scale_2", PLM_ROLE_SCALE_2},
    {"rot_0", PLM_ROLE_ROTATION_0},
    {"rot_1", PLM_ROLE_ROTATION_1},
    {"rot_2", PLM_ROLE_ROTATION_2},
    {"rot_3", PLM_ROLE_ROTATION_3},
    {"withheld", PLM_ROLE_WITHHELD},
};

/* CloudCompare writes every attribute that it does not know as "scalar_" + its name. */
static const char *plain_name(const char *name)
{
    static const char prefix[] = "scalar_";
    const size_t length = sizeof prefix - 1;
    return strncasecmp(name, prefix, length) == 0 && name[length] ? name + length : name;
}

plm_role plm_role_of_name(const char *name)
{
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcasecmp(plain_name(name), names[i].name) == 0) return names[i].role;
    return PLM_ROLE_COUNT;
}

/* The first column of that name, else the first of that name without CloudCompare's prefix. */
static const plm_column *column_named(const plm_columns *columns, const char *name)
{
    for (int is_plain = 0; is_plain < 2; is_plain++)
        for (size_t i = 0; i < columns->count; i++) {
            const plm_column *column = &columns->column[i];
            const char *mine = is_plain ? plain_name(column->name) : column->name;
            if (!column->is_list && strcasecmp(mine, is_plain ? plain_name(name) : name) == 0) return column;
        }
    return NULL;
}

/* A column by its name or by its number from 1 on. */
static const plm_column *column_of(const plm_columns *columns, const char *field)
{
    const plm_column *column = column_named(columns, field);
    if (column) return column;
    unsigned long long number;
    if (!plm_number_whole(field, strlen(field), &number) || number < 1 || number > columns->count) return NULL;
    column = &columns->column[number - 1];
    return column->is_list ? NULL : column;
}

static void list_fields(const plm_columns *columns, plm_read_report *report)
{
    size_t used = 0;
    for (size_t i = 0; i < columns->count; i++) {
        const size_t room = sizeof report->fields - used;
        char shown[PLM_SHOWN_LENGTH];
        const char *name = plm_show(columns->column[i].name, strlen(columns->column[i].name), shown);
        const int length = snprintf(report->fields + used, room, "%s%s", i ? "," : "", name);
        if (length < 0 || (size_t)length >= room) {
            report->fields[used] = 0; /* cut at the comma */
            return;
        }
        used += (size_t)length;
    }
}

/* The field that most looks like labels: the earliest name of the list that the file has. */
static void guess_label_field(const plm_columns *columns, plm_read_report *report)
{
    static const char *const likely[] = {"label",       "labels",   "class",   "classification", "point_class",
                                         "organ_label", "semantic", "segment", "instance",       "organ_id"};
    for (size_t i = 0; i < sizeof likely / sizeof *likely; i++)
        for (size_t j = 0; j < columns->count; j++)
            if (strcasecmp(plain_name(columns->column[j].name), likely[i]) == 0) {
                snprintf(report->label_field, sizeof report->label_field, "%s", columns->column[j].name);
                return;
            }
}

static bool has_all(const plm_roles *roles, plm_role first, plm_role last)
{
    for (plm_role role = first; role <= last; role++)
        if (!roles->column[role]) return false;
    return true;
}

static void forget(plm_roles *roles, plm_role first, plm_role last)
{
    for (plm_role role = first; role <= last; role++) roles->column[role] = NULL;
}

/* Leaves only roles that make up whole attributes. */
static void settle(plm_roles *roles)
{
    roles->is_splat = has_all(roles, PLM_ROLE_OPACITY, PLM_ROLE_ROTATION_3);
    if (roles->is_splat) {
        forget(roles, PLM_ROLE_RED, PLM_ROLE_EXTENT_1); /* the gaussian's own colour and axes count */
        return;
    }
    forget(roles, PLM_ROLE_DC_0, PLM_ROLE_ROTATION_3);
    const bool has_colour = has_all(roles, PLM_ROLE_RED, PLM_ROLE_BLUE);
    if (!has_colour) forget(roles, PLM_ROLE_RED, PLM_ROLE_BLUE);
    if (has_colour) forget(roles, PLM_ROLE_PACKED_COLOUR, PLM_ROLE_PACKED_COLOUR);
    if (!has_all(roles, PLM_ROLE_NX, PLM_ROLE_NZ)) forget(roles, PLM_ROLE_NX, PLM_ROLE_NZ);
    /* A lone opacity may be a logit or a share: only this project's own files say which. */
    if (!has_all(roles, PLM_ROLE_EXTENT_0, PLM_ROLE_EXTENT_1)) forget(roles, PLM_ROLE_EXTENT_0, PLM_ROLE_OPACITY);
}

static plm_status find_label_roles(const plm_columns *columns, const plm_bytes *bytes, const plm_read_options *options,
                                   plm_roles *roles, const plm_read_report *report, plm_error *error)
{
    static const char text[] = "%s: no field \"%s\" for %s; the fields are %s";
    if (!options->label_field) return PLM_OK;
    roles->column[PLM_ROLE_LABEL] = column_of(columns, options->label_field);
    if (!roles->column[PLM_ROLE_LABEL])
        return plm_fail(error, PLM_E_ARGUMENT, text, bytes->name, options->label_field, "labels", report->fields);
    if (options->label_scheme == PLM_LABELS_INSTANCES) return PLM_OK;
    roles->column[PLM_ROLE_ORGAN] = column_of(columns, options->organ_field ? options->organ_field : "organ");
    if (!roles->column[PLM_ROLE_ORGAN] && options->organ_field)
        return plm_fail(error, PLM_E_ARGUMENT, text, bytes->name, options->organ_field, "organ numbers",
                        report->fields);
    return PLM_OK;
}

plm_status plm_roles_find(const plm_columns *columns, const plm_bytes *bytes, const plm_read_options *options,
                          plm_roles *roles, plm_read_report *report, plm_error *error)
{
    *roles = (plm_roles){0};
    list_fields(columns, report);
    guess_label_field(columns, report);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!roles->column[names[i].role]) roles->column[names[i].role] = column_named(columns, names[i].name);
    for (plm_role role = PLM_ROLE_X; role <= PLM_ROLE_Z; role++)
        if (!roles->column[role])
            return plm_fail(error, PLM_E_FORMAT, "%s: no field %c: the fields are %s; x, y and z were expected",
                            bytes->name, "xyz"[role], report -> fields[0] ? report -> fields : "none");
    settle(roles);
    if (roles->is_splat && report->format == PLM_FORMAT_PLY) report->format = PLM_FORMAT_SPLAT;
    return find_label_roles(columns, bytes, options, roles, report, error);
}
