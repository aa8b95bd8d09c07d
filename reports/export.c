/* reports/export.c: what is exported: variables with their ontology terms, and the plants' metadata. */
#include "reports/export.h"

#include "reports/assets.h"
#include "reports/run_json.h"

#include <stdio.h>
#include <string.h>

const char *plm_export_mapping(void)
{
    return (const char *)plm_asset_ontology;
}

/* ---- Metadata ---------------------------------------------------------------------------------------------------- */

const char *plm_export_meta(const plm_export *bundle, const char *plant_id, const char *columns)
{
    const plm_table *table = &bundle->metadata;
    const size_t plant = table->columns ? plm_table_column(table, "plant_id") : SIZE_MAX;
    if (plant == SIZE_MAX) return "";
    size_t row = 0;
    while (row < table->rows && strcmp(plm_table_cell(table, row, plant), plant_id)) row++;
    if (row == table->rows) return "";
    for (const char *at = columns; *at;) {
        const size_t length = strcspn(at, ",");
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)length, at);
        const char *cell = plm_table_cell(table, row, plm_table_column(table, name));
        if (*cell) return cell;
        at += length + (at[length] == ',');
    }
    return "";
}

const char *plm_export_time(const plm_export *bundle, const char *plant_id)
{
    const char *found = plm_export_meta(bundle, plant_id, "timestamp,time,date,timePoint");
    return *found || !bundle->options.time ? found : bundle->options.time;
}

const char *plm_export_study(const plm_export *bundle, const char *plant_id)
{
    const char *found = plm_export_meta(bundle, plant_id, "study,studyId,study_id,trial");
    return *found || !bundle->options.study ? found : bundle->options.study;
}

const char *plm_export_germplasm(const plm_export *bundle, const char *plant_id)
{
    return plm_export_meta(bundle, plant_id, "germplasm,genotype,variety,cultivar,accession");
}

/* ---- Variables --------------------------------------------------------------------------------------------------- */

const plm_result_row *plm_export_row(const plm_result *plant, const plm_export_variable *variable)
{
    return plm_result_of_plant(plant, variable->trait);
}

/* The cell of a trait: the user's table first, then the shipped one; "" where both lack it. */
static const char *lookup(const plm_export *bundle, const char *trait, const char *column)
{
    const plm_table *const tables[] = {&bundle->own, &bundle->shipped};
    for (int k = 0; k < 2; k++) {
        if (!tables[k]->columns) continue;
        const size_t name = plm_table_column(tables[k], "trait");
        for (size_t row = 0; name != SIZE_MAX && row < tables[k]->rows; row++) {
            if (strcmp(plm_table_cell(tables[k], row, name), trait)) continue;
            const char *cell = plm_table_cell(tables[k], row, plm_table_column(tables[k], column));
            if (*cell) return cell;
        }
    }
    return "";
}

/* Whether id is one of a list with semicolons. */
static bool is_listed(const char *list, const char *id)
{
    for (const char *at = list; *at;) {
        const size_t length = strcspn(at, ";");
        if (length == strlen(id) && !strncmp(at, id, length)) return true;
        at += length + (at[length] == ';');
    }
    return false;
}

static plm_status describe(const plm_export *bundle, const plm_trait *trait, plm_export_variable *made,
                           plm_error *error)
{
    *made = (plm_export_variable){.trait = trait,
                                  .accession = lookup(bundle, trait->name, "trait_accession"),
                                  .trait_name = lookup(bundle, trait->name, "trait_name"),
                                  .entity = lookup(bundle, trait->name, "entity"),
                                  .entity_accession = lookup(bundle, trait->name, "entity_accession"),
                                  .characteristic = lookup(bundle, trait->name, "characteristic"),
                                  .note = lookup(bundle, trait->name, "note")};
    plm_trait_column(trait, made->column, sizeof made->column);
    snprintf(made->name, sizeof made->name, "%s_pointcloud%s%s", trait->name, trait->unit == PLM_NUMBER ? "" : "_",
             trait->unit == PLM_NUMBER ? "" : plm_unit_name(trait->unit));
    const char *id = lookup(bundle, trait->name, "variable_id");
    if (is_listed(lookup(bundle, trait->name, "hand_variable_id"), id))
        return plm_fail(
            error, PLM_E_ARGUMENT,
            "the variable %s of %s stands for a measurement by hand; one by point cloud is another method and "
            "needs an id of its own",
            id, trait->name);
    if (*id)
        snprintf(made->id, sizeof made->id, "%s", id);
    else
        snprintf(made->id, sizeof made->id, "plantimeter:%.100s", made->name);
    return PLM_OK;
}

static plm_status find_variables(plm_export *bundle, plm_error *error)
{
    size_t count;
    const plm_trait *traits = plm_traits(&count);
    bundle->variable = plm_alloc(count, sizeof *bundle->variable, error);
    if (!bundle->variable) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        plm_export_variable *made = &bundle->variable[bundle->variable_count];
        if (!plm_trait_of_plant(&traits[i])) continue;
        const plm_status status = describe(bundle, &traits[i], made, error);
        if (status != PLM_OK) return status;
        bool has_value = false;
        for (size_t k = 0; k < bundle->results.count && !has_value; k++)
            has_value = plm_export_row(&bundle->results.plant[k], made) != NULL;
        if (!has_value) continue;
        for (size_t k = 0; k < bundle->variable_count; k++)
            if (!strcmp(bundle->variable[k].id, made->id))
                return plm_fail(error, PLM_E_ARGUMENT, "%s and %s have the same variable id %s",
                                bundle->variable[k].trait->name, traits[i].name, made->id);
        bundle->variable_count++;
    }
    return PLM_OK;
}

/* ---- The whole --------------------------------------------------------------------------------------------------- */

static plm_status read_tables(plm_export *bundle, plm_error *error)
{
    const plm_export_options *options = &bundle->options;
    plm_status status = plm_table_parse((const char *)plm_asset_ontology, plm_asset_ontology_size,
                                        "the shipped mapping", &bundle->shipped, error);
    if (status == PLM_OK && options->ontology) status = plm_table_read(options->ontology, &bundle->own, error);
    if (status == PLM_OK && options->ontology && plm_table_column(&bundle->own, "trait") == SIZE_MAX)
        status = plm_fail(error, PLM_E_FORMAT, "%s: no column \"trait\"", options->ontology);
    if (status == PLM_OK && options->metadata) status = plm_table_read(options->metadata, &bundle->metadata, error);
    if (status == PLM_OK && options->metadata && plm_table_column(&bundle->metadata, "plant_id") == SIZE_MAX)
        status = plm_fail(error, PLM_E_FORMAT, "%s: no column \"plant_id\"", options->metadata);
    return status;
}

plm_status plm_export_open(plm_export *made, const char *run, const plm_export_options *options, plm_error *error)
{
    plm_export bundle = {.options = *options};
    plm_status status = plm_results_read_folder(&bundle.results, run, &bundle.root, error);
    if (status == PLM_OK) status = read_tables(&bundle, error);
    if (status == PLM_OK) status = find_variables(&bundle, error);
    if (status == PLM_OK)
        *made = bundle;
    else
        plm_export_close(&bundle);
    return status;
}

void plm_export_close(plm_export *bundle)
{
    plm_results_free(&bundle->results);
    json_decref(bundle->root);
    plm_table_free(&bundle->metadata);
    plm_table_free(&bundle->shipped);
    plm_table_free(&bundle->own);
    plm_free(bundle->variable);
    *bundle = (plm_export){0};
}
