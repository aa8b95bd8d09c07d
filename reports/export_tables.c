/* reports/export_tables.c: the formats that are tables: Field Book, MIAPPE 1.2 and the table for R's statgenHTP. */
#include "reports/export.h"
#include "reports/sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static void put_value(plm_sheet *sheet, const plm_result *plant, const plm_export_variable *variable, char behind)
{
    const plm_result_row *row = plm_export_row(plant, variable);
    plm_sheet_number(sheet, row ? row->value : NAN, behind);
}

/* Columns that stand elsewhere in the tables. */
static bool is_taken(const char *column)
{
    static const char *const taken[] = {"plant_id", "plant_name", "timestamp", "time", "date", "timePoint"};
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        if (!strcasecmp(taken[i], column)) return true;
    return false;
}

/* All other columns of the metadata, of one plant or (NULL) their names. */
static void put_metadata(plm_sheet *sheet, const plm_export *bundle, const char *plant_id)
{
    const plm_table *table = &bundle->metadata;
    for (size_t column = 0; column < table->columns; column++) {
        const char *name = table->cell[column];
        if (is_taken(name)) continue;
        plm_sheet_text(sheet, plant_id ? plm_export_meta(bundle, plant_id, name) : name, ',');
    }
}

/* ---- Field Book ---------------------------------------------------------------------------------------------------- */

static plm_status field_book_traits(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "traits.trt", error);
    plm_sheet_line(&s, "\"trait\",\"format\",\"defaultValue\",\"minimum\",\"maximum\",\"details\",\"categories\","
                       "\"isVisible\",\"realPosition\"");
    for (size_t k = 0; k < bundle->variable_count; k++) {
        const plm_export_variable *variable = &bundle->variable[k];
        char details[512], place[24];
        snprintf(details, sizeof details, "%s, %s; from the point cloud", variable->trait->definition,
                 plm_unit_name(variable->trait->unit));
        snprintf(place, sizeof place, "%zu", k + 1);
        const char *const cells[] = {variable->column, "numeric", "", "", "", details, "", "true", place};
        for (int i = 0; i < 9; i++) plm_sheet_quoted(&s, cells[i], i < 8 ? ',' : '\n');
    }
    return plm_sheet_close(&s);
}

/* with_traits: the table; else the field file alone. */
static plm_status field_book_table(const plm_export *bundle, const char *folder, const char *name, bool with_traits,
                                   plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, name, error);
    plm_sheet_text(&s, "plant_name", ',');
    put_metadata(&s, bundle, NULL);
    for (size_t k = 0; with_traits && k < bundle->variable_count; k++)
        plm_sheet_text(&s, bundle->variable[k].column, ',');
    plm_sheet_text(&s, "scan_date", '\n');
    for (size_t i = 0; i < bundle->results.count; i++) {
        const plm_result *plant = &bundle->results.plant[i];
        plm_sheet_text(&s, plant->plant_id, ',');
        put_metadata(&s, bundle, plant->plant_id);
        for (size_t k = 0; with_traits && k < bundle->variable_count; k++)
            put_value(&s, plant, &bundle->variable[k], ',');
        plm_sheet_text(&s, plm_export_time(bundle, plant->plant_id), '\n');
    }
    return plm_sheet_close(&s);
}

static plm_status field_book_database(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "database.csv", error);
    plm_sheet_text(&s, "plant_name", ',');
    put_metadata(&s, bundle, NULL);
    plm_sheet_line(&s, "trait,value,timestamp,person,location,number,attached_photo,attached_video,attached_audio,"
                       "device_name");
    for (size_t i = 0; i < bundle->results.count; i++)
        for (size_t k = 0; k < bundle->variable_count; k++) {
            const plm_result *plant = &bundle->results.plant[i];
            if (!plm_export_row(plant, &bundle->variable[k])) continue;
            plm_sheet_text(&s, plant->plant_id, ',');
            put_metadata(&s, bundle, plant->plant_id);
            plm_sheet_text(&s, bundle->variable[k].column, ',');
            put_value(&s, plant, &bundle->variable[k], ',');
            plm_sheet_text(&s, plm_export_time(bundle, plant->plant_id), ',');
            plm_sheet_line(&s, "plantimeter " PLM_VERSION ",,1,,,,plantimeter");
        }
    return plm_sheet_close(&s);
}

plm_status plm_export_field_book(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_status status = field_book_traits(bundle, folder, error);
    if (status == PLM_OK) status = field_book_table(bundle, folder, "field.csv", false, error);
    if (status == PLM_OK) status = field_book_table(bundle, folder, "table.csv", true, error);
    if (status == PLM_OK) status = field_book_database(bundle, folder, error);
    return status;
}

/* ---- MIAPPE -------------------------------------------------------------------------------------------------------- */

/* "row:3; X:..." out of the metadata and the georeference. */
static void put_distribution(plm_sheet *s, const plm_export *bundle, const plm_result *plant)
{
    static const struct {
        const char *key, *columns;
    } places[] = {
        {"row", "row,rowNum"}, {"column", "column,col,colNum"}, {"block", "block,rep,repId"}, {"plot", "plot,plot_id"}};
    char text[512] = "";
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        const char *cell = plm_export_meta(bundle, plant->plant_id, places[k].columns);
        const size_t length = strlen(text);
        if (*cell) snprintf(text + length, sizeof text - length, "%s%s:%.60s", length ? "; " : "", places[k].key, cell);
    }
    const size_t length = strlen(text);
    if (plant->has_place)
        snprintf(text + length, sizeof text - length, "%slatitude:%+.8f; longitude:%+.8f", length ? "; " : "",
                 plant->latitude, plant->longitude);
    plm_sheet_text(s, text, ',');
}

static plm_status miappe_units(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "observation_unit.csv", error);
    plm_sheet_line(
        &s, "studyId,biologicalMaterialId,obsUnitId,obsUnitType,externalId,spatialDistribution,obsUnitFactorValue");
    for (size_t i = 0; i < bundle->results.count; i++) {
        const plm_result *plant = &bundle->results.plant[i];
        plm_sheet_text(&s, plm_export_study(bundle, plant->plant_id), ',');
        plm_sheet_text(&s, plm_export_germplasm(bundle, plant->plant_id), ',');
        plm_sheet_text(&s, plant->plant_id, ',');
        plm_sheet_text(&s, "plant", ',');
        const char *digest = json_string_value(json_object_get(plant->record, "sha256"));
        char reference[96] = "";
        if (digest && *digest) snprintf(reference, sizeof reference, "sha256:%.64s", digest);
        plm_sheet_text(&s, reference, ',');
        put_distribution(&s, bundle, plant);
        plm_sheet_text(&s, plm_export_meta(bundle, plant->plant_id, "treatment,factor"), '\n');
    }
    return plm_sheet_close(&s);
}

static plm_status miappe_variables(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "observed_variable.csv", error);
    plm_sheet_line(&s,
                   "studyId,variableId,variableName,variableAccNumber,traitName,traitEntity,traitEntityAccessionNumber,"
                   "traitCharacteristic,traitCharacteristicAccessionNumber,traitAccNumber,methodName,methodAccNumber,"
                   "methodDesc,methodRef,scaleName,scaleAccNumber,timeScale");
    for (size_t k = 0; k < bundle->variable_count; k++) {
        const plm_export_variable *v = &bundle->variable[k];
        const bool is_own = strncmp(v->id, "plantimeter:", 12) != 0;
        char trait[96], method[512];
        snprintf(trait, sizeof trait, "%s", *v->trait_name ? v->trait_name : v->trait->name);
        snprintf(method, sizeof method, "%s%s%s%s", v->trait->definition, *v->note ? " (" : "", v->note,
                 *v->note ? ")" : "");
        const char *const cells[] = {bundle->options.study ? bundle->options.study : "",
                                     v->id,
                                     v->name,
                                     is_own ? v->id : "",
                                     trait,
                                     v->entity,
                                     v->entity_accession,
                                     v->characteristic,
                                     "",
                                     v->accession,
                                     "point cloud, Plantimeter " PLM_VERSION,
                                     "",
                                     method,
                                     v->trait->source,
                                     plm_unit_name(v->trait->unit),
                                     "",
                                     ""};
        enum { CELLS = sizeof cells / sizeof *cells };
        for (int i = 0; i < CELLS; i++) plm_sheet_text(&s, cells[i], i + 1 < CELLS ? ',' : '\n');
    }
    return plm_sheet_close(&s);
}

static plm_status miappe_files(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "data_file.csv", error);
    plm_sheet_line(&s, "studyId,dataFileLink,dataFileDesc,dataFileVersion");
    plm_sheet_text(&s, bundle->options.study ? bundle->options.study : "", ',');
    plm_sheet_line(&s, "data.csv,\"one row a plant: obsUnitId, time, one column a variable (variableId)\",1");
    plm_status status = plm_sheet_close(&s);
    if (status != PLM_OK) return status;
    s = plm_sheet_open(folder, "data.csv", error);
    plm_sheet_text(&s, "obsUnitId", ',');
    plm_sheet_text(&s, "time", bundle->variable_count ? ',' : '\n');
    for (size_t k = 0; k < bundle->variable_count; k++)
        plm_sheet_text(&s, bundle->variable[k].id, k + 1 < bundle->variable_count ? ',' : '\n');
    for (size_t i = 0; i < bundle->results.count; i++) {
        const plm_result *plant = &bundle->results.plant[i];
        plm_sheet_text(&s, plant->plant_id, ',');
        plm_sheet_text(&s, plm_export_time(bundle, plant->plant_id), bundle->variable_count ? ',' : '\n');
        for (size_t k = 0; k < bundle->variable_count; k++)
            put_value(&s, plant, &bundle->variable[k], k + 1 < bundle->variable_count ? ',' : '\n');
    }
    return plm_sheet_close(&s);
}

plm_status plm_export_miappe(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_status status = miappe_units(bundle, folder, error);
    if (status == PLM_OK) status = miappe_variables(bundle, folder, error);
    if (status == PLM_OK) status = miappe_files(bundle, folder, error);
    return status;
}

/* ---- statgenHTP ---------------------------------------------------------------------------------------------------- */

/* The names that createTimePoints() gives its columns, so that it needs no renaming. */
plm_status plm_export_statgen(const plm_export *bundle, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "timepoints.csv", error);
    static const char *const names[] = {"genotype", "timePoint", "plotId", "repId", "rowNum", "colNum"};
    for (int i = 0; i < 6; i++) plm_sheet_text(&s, names[i], i < 5 || bundle->variable_count ? ',' : '\n');
    for (size_t k = 0; k < bundle->variable_count; k++)
        plm_sheet_text(&s, bundle->variable[k].column, k + 1 < bundle->variable_count ? ',' : '\n');
    for (size_t i = 0; i < bundle->results.count; i++) {
        const plm_result *plant = &bundle->results.plant[i];
        const char *id = plant->plant_id;
        const char *const cells[] = {plm_export_germplasm(bundle, id),
                                     plm_export_time(bundle, id),
                                     id,
                                     plm_export_meta(bundle, id, "repId,rep,block"),
                                     plm_export_meta(bundle, id, "rowNum,row"),
                                     plm_export_meta(bundle, id, "colNum,column,col")};
        for (int c = 0; c < 6; c++) plm_sheet_text(&s, cells[c], c < 5 || bundle->variable_count ? ',' : '\n');
        for (size_t k = 0; k < bundle->variable_count; k++)
            put_value(&s, plant, &bundle->variable[k], k + 1 < bundle->variable_count ? ',' : '\n');
    }
    return plm_sheet_close(&s);
}
