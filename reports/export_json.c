/* reports/export_json.c: the formats that are JSON: BrAPI v2.1 and the Frictionless data package. */
#include "reports/export.h"
#include "reports/run_json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_ROOM = 4096, NUMBER_TEXT = 96 };

static plm_status write_json(const char *folder, const char *name, json_t *object, plm_error *error)
{
    char path[PATH_ROOM];
    plm_status status = PLM_OK;
    if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, name) >= sizeof path)
        status = plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    if (status == PLM_OK) status = plm_json_write(path, object, PLM_JSON_DIGITS, error);
    json_decref(object);
    return status;
}

/* An empty text is null. */
static json_t *text_or_null(const char *text)
{
    return *text ? plm_json_text(text) : json_null();
}

/* Appends an item; array becomes NULL when one is missing. */
static void append(json_t **array, json_t *item)
{
    if (*array && json_array_append_new(*array, item) == 0) return;
    json_decref(*array);
    *array = NULL;
}

/* ---- BrAPI --------------------------------------------------------------------------------------------------------- */

/* Values of additionalInfo are texts in the schema. */
static json_t *additional_info(const plm_result_row *row)
{
    char number[NUMBER_TEXT];
    json_t *info = json_object();
    if (!info) return NULL;
    bool is_whole = json_object_set_new(info, "status", plm_json_text(row->status)) == 0 &&
                    json_object_set_new(info, "method", plm_json_text(row->method)) == 0;
    if (isfinite(row->std_error)) {
        snprintf(number, sizeof number, "%.9g", row->std_error);
        is_whole = is_whole && json_object_set_new(info, "std_error", json_string(number)) == 0;
        snprintf(number, sizeof number, "%.9g;%.9g", row->value - 1.959963984540054 * row->std_error,
                 row->value + 1.959963984540054 * row->std_error);
        is_whole = is_whole && json_object_set_new(info, "ci95", json_string(number)) == 0;
    }
    snprintf(number, sizeof number, "%zu", row->point_count);
    is_whole = is_whole && json_object_set_new(info, "n_points", json_string(number)) == 0;
    if (is_whole) return info;
    json_decref(info);
    return NULL;
}

static json_t *observation(const plm_export *bundle, const plm_result *plant, const plm_export_variable *variable,
                           const plm_result_row *row)
{
    char value[NUMBER_TEXT], reference[96];
    snprintf(value, sizeof value, "%.9g", row->value);
    const char *digest = json_string_value(json_object_get(plant->record, "sha256"));
    snprintf(reference, sizeof reference, "sha256:%.64s", digest ? digest : "");
    const char *study = plm_export_study(bundle, plant->plant_id), *time = plm_export_time(bundle, plant->plant_id);
    const char *germplasm = plm_export_germplasm(bundle, plant->plant_id);
    return json_pack("{s:o,s:o,s:s,s:s,s:s,s:o,s:s,s:n,s:o,s:n,s:o,s:n,s:[{s:s,s:s}],s:o}", "observationUnitDbId",
                     plm_json_text(plant->plant_id), "observationUnitName", plm_json_text(plant->plant_id),
                     "observationVariableDbId", variable->id, "observationVariableName", variable->name, "value", value,
                     "observationTimeStamp", text_or_null(time), "collector", "Plantimeter " PLM_VERSION, "uploadedBy",
                     "studyDbId", text_or_null(study), "germplasmDbId", "germplasmName", text_or_null(germplasm),
                     "season", "externalReferences", "referenceId", reference, "referenceSource", "point cloud",
                     "additionalInfo", additional_info(row));
}

static plm_status write_observations(const plm_export *bundle, const char *folder, plm_error *error)
{
    json_t *all = json_array();
    for (size_t i = 0; all && i < bundle->results.count; i++)
        for (size_t k = 0; all && k < bundle->variable_count; k++) {
            const plm_result_row *row = plm_export_row(&bundle->results.plant[i], &bundle->variable[k]);
            if (row) append(&all, observation(bundle, &bundle->results.plant[i], &bundle->variable[k], row));
        }
    return write_json(folder, "observations.json", all, error);
}

static plm_status write_units(const plm_export *bundle, const char *folder, plm_error *error)
{
    json_t *all = json_array();
    for (size_t i = 0; all && i < bundle->results.count; i++) {
        const char *id = bundle->results.plant[i].plant_id;
        append(&all, json_pack("{s:o,s:o,s:o,s:o,s:{s:s,s:{s:s}}}", "observationUnitDbId", plm_json_text(id),
                               "observationUnitName", plm_json_text(id), "studyDbId",
                               text_or_null(plm_export_study(bundle, id)), "germplasmName",
                               text_or_null(plm_export_germplasm(bundle, id)), "observationUnitPosition", "entryType",
                               "TEST", "observationLevel", "levelName", "plant"));
    }
    return write_json(folder, "observationunits.json", all, error);
}

/* The parts of a variable have ids of their own: trait, method (never that of a measurement by hand) and scale. */
static json_t *variable_json(const plm_export_variable *v)
{
    char trait_id[160], method_id[160], scale_id[64];
    const char *unit = plm_unit_name(v->trait->unit);
    snprintf(trait_id, sizeof trait_id, "%s%s",
             *v->accession ? "" : "plantimeter:", *v->accession ? v->accession : v->trait->name);
    snprintf(method_id, sizeof method_id, "plantimeter:pointcloud:%s", v->trait->name);
    snprintf(scale_id, sizeof scale_id, "plantimeter:scale:%s", unit);
    return json_pack("{s:s,s:s,s:{s:s,s:s,s:o,s:o,s:o},s:{s:s,s:s,s:s,s:s},s:{s:s,s:s,s:s,s:s}}",
                     "observationVariableDbId", v->id, "observationVariableName", v->name, "trait", "traitDbId",
                     trait_id, "traitName", *v->trait_name ? v->trait_name : v->trait->name, "entity",
                     text_or_null(v->entity), "attribute", text_or_null(v->characteristic), "traitDescription",
                     text_or_null(v->note), "method", "methodDbId", method_id, "methodName", "point cloud, Plantimeter",
                     "methodClass", "Computation", "description", v->trait->definition, "scale", "scaleDbId", scale_id,
                     "scaleName", unit, "dataType", "Numerical", "units", unit);
}

static plm_status write_variables(const plm_export *bundle, const char *folder, plm_error *error)
{
    json_t *all = json_array();
    for (size_t k = 0; all && k < bundle->variable_count; k++) append(&all, variable_json(&bundle->variable[k]));
    return write_json(folder, "variables.json", all, error);
}

plm_status plm_export_brapi(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_json_use_seam();
    plm_status status = write_observations(bundle, folder, error);
    if (status == PLM_OK) status = write_units(bundle, folder, error);
    if (status == PLM_OK) status = write_variables(bundle, folder, error);
    return status;
}

/* ---- Frictionless -------------------------------------------------------------------------------------------------- */

static json_t *field(const char *name, const char *type, const char *title, const char *description, bool is_required)
{
    json_t *made =
        json_pack("{s:s,s:s,s:s,s:s}", "name", name, "type", type, "title", title, "description", description);
    if (!made || !is_required || json_object_set_new(made, "constraints", json_pack("{s:b}", "required", 1)) == 0)
        return made;
    json_decref(made);
    return NULL;
}

/** The columns of traits.csv. */
static const struct column_row {
    const char *name, *type, *title, *description;
    bool is_required;
} trait_columns[] = {
    {"plant_id", "string", "plant", "name of the plant: of its file", true},
    {"organ", "string", "organ", "plant, stem, petiole or leaf", true},
    {"organ_id", "integer", "number of the organ", "empty for the plant", false},
    {"x", "number", "x, m", "centroid of the organ in the input's frame", false},
    {"y", "number", "y, m", "centroid of the organ in the input's frame", false},
    {"z", "number", "z, m", "centroid of the organ in the input's frame", false},
    {"trait", "string", "trait", "name of the trait, docs/traits.md", true},
    {"value", "number", "value", "empty where the scene does not give it: see status and reason", false},
    {"unit", "string", "unit", "mm, cm2, cm3, deg or 1", true},
    {"std_error", "number", "standard error", "in the unit of the value", false},
    {"n_points", "integer", "points", "that the value rests on", false},
    {"status", "string", "status", "ok, ok with flags behind semicolons, not_applicable or failed", true},
    {"reason", "string", "reason", "why there is no value", false},
    {"method", "string", "method", "how it was measured", false},
    {"longitude", "number", "longitude, degrees", "of the plant, WGS 84", false},
    {"latitude", "number", "latitude, degrees", "of the plant, WGS 84", false},
};

/* The fields of a CSV that was written, by its header. */
static json_t *fields_of(const char *folder, const char *name, plm_error *error)
{
    char path[PATH_ROOM];
    plm_table table;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (plm_table_read(path, &table, error) != PLM_OK) return NULL;
    json_t *fields = json_array();
    for (size_t c = 0; fields && c < table.columns; c++) {
        const char *column = table.cell[c];
        const struct column_row *known = NULL;
        for (size_t k = 0; k < sizeof trait_columns / sizeof *trait_columns && !known; k++)
            if (!strcmp(trait_columns[k].name, column)) known = &trait_columns[k];
        const plm_trait *trait = NULL;
        size_t count;
        const plm_trait *traits = plm_traits(&count);
        for (size_t k = 0; k < count && !known && !trait; k++) {
            char named[128];
            plm_trait_column(&traits[k], named, sizeof named);
            if (!strcmp(named, column)) trait = &traits[k];
        }
        if (known)
            append(&fields, field(column, known->type, known->title, known->description, known->is_required));
        else
            append(&fields, field(column, trait ? "number" : "string", column, trait ? trait->definition : "", false));
    }
    plm_table_free(&table);
    return fields;
}

/* key: the column that is different in every row, NULL: there is none (an organ's number is empty for the plant). */
static json_t *resource(const char *folder, const char *name, const char *path, const char *key, plm_error *error)
{
    json_t *schema = json_pack("{s:o,s:[s,s]}", "fields", fields_of(folder, path, error), "missingValues", "", "NA");
    if (schema && key && json_object_set_new(schema, "primaryKey", json_string(key)) != 0) {
        json_decref(schema);
        schema = NULL;
    }
    return json_pack("{s:s,s:s,s:s,s:s,s:s,s:s,s:o}", "name", name, "path", path, "profile", "tabular-data-resource",
                     "format", "csv", "mediatype", "text/csv", "encoding", "utf-8", "schema", schema);
}

plm_status plm_export_frictionless(const plm_export *bundle, const char *folder, plm_error *error)
{
    char path[PATH_ROOM];
    plm_json_use_seam();
    if ((size_t)snprintf(path, sizeof path, "%s/traits.csv", folder) >= sizeof path)
        return plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    plm_status status = plm_results_write_traits(&bundle->results, path, error);
    snprintf(path, sizeof path, "%s/plants.csv", folder);
    if (status == PLM_OK) status = plm_results_write_plants(&bundle->results, path, error);
    if (status != PLM_OK) return status;
    json_t *traits = resource(folder, "traits", "traits.csv", NULL, error);
    json_t *plants = resource(folder, "plants", "plants.csv", "plant_id", error);
    json_t *package =
        json_pack("{s:s,s:s,s:s,s:s,s:[o,o]}", "profile", "tabular-data-package", "name", "plantimeter-run", "title",
                  "Traits measured with Plantimeter", "version", PLM_VERSION, "resources", traits, plants);
    return write_json(folder, "datapackage.json", package, error);
}
