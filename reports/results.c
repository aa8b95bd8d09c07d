/* reports/results.c: measured plants as rows, in the order of the inputs. */
#include "reports/results.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct flag_row {
    unsigned flag;
    const char *name;
} flag_names[] = {
    {PLM_FLAG_LOW_DENSITY, "low_density"}, {PLM_FLAG_TRUNCATED, "truncated"},
    {PLM_FLAG_MERGED_LEAF, "merged_leaf"}, {PLM_FLAG_ALPHA_SENSITIVE, "alpha_sensitive"},
    {PLM_FLAG_COMPLETED, "completed"},     {PLM_FLAG_OCCLUDED, "occluded"},
    {PLM_FLAG_CURVED, "curved"},           {PLM_FLAG_UNCERTAIN, "uncertain"},
};

void plm_flags_text(unsigned flags, char *text, size_t room)
{
    for (size_t i = 0; i < sizeof flag_names / sizeof *flag_names; i++) {
        const size_t length = strlen(text);
        if (flags & flag_names[i].flag) snprintf(text + length, room - length, ";%s", flag_names[i].name);
    }
}

bool plm_result_row_is_ok(const plm_result_row *row)
{
    return row->status[0] == 'o';
}

/* ---- Rows ------------------------------------------------------------------------------------------------------ */

plm_status plm_result_row_texts(plm_result_row *row, const char *status, const char *reason, const char *method,
                                plm_error *error)
{
    const size_t lengths[] = {strlen(status) + 1, strlen(reason) + 1, strlen(method) + 1};
    char *block = plm_alloc(lengths[0] + lengths[1] + lengths[2], 1, error);
    if (!block) return PLM_E_MEMORY;
    row->status = memcpy(block, status, lengths[0]);
    row->reason = memcpy(block + lengths[0], reason, lengths[1]);
    row->method = memcpy(block + lengths[0] + lengths[1], method, lengths[2]);
    return PLM_OK;
}

static plm_status make_row(const plm_trait_value *value, const plm_georeference *reference, plm_result_row *row,
                           plm_error *error)
{
    static const char *const states[] = {
        [PLM_STATE_OK] = "ok", [PLM_STATE_NOT_APPLICABLE] = "not_applicable", [PLM_STATE_FAILED] = "failed"};
    const plm_estimate *estimate = &value->estimate;
    const double factor = plm_unit_factor(value->trait->unit);
    *row = (plm_result_row){.trait = value->trait,
                            .organ_id = value->organ_id,
                            .value = estimate->value * factor,
                            .std_error = estimate->std_error * factor,
                            .point_count = estimate->point_count};
    memcpy(row->position, value->centroid, sizeof row->position);
    plm_status status = PLM_OK;
    if (reference && isfinite(value->centroid[0]))
        status = plm_georeference_restore(reference, value->centroid, row->position, error);
    char text[160];
    snprintf(text, sizeof text, "%s", states[estimate->state]);
    if (estimate->state == PLM_STATE_OK) plm_flags_text(estimate->flags, text, sizeof text);
    return status == PLM_OK ? plm_result_row_texts(row, text, estimate->reason, estimate->method, error) : status;
}

static void free_result(plm_result *plant)
{
    for (size_t i = 0; i < plant->row_count; i++) plm_free(plant->row[i].status);
    plm_free(plant->row);
    plm_free(plant->failure);
    plm_free(plant->plant_id);
    json_decref(plant->record);
    *plant = (plm_result){0};
}

static plm_status make_rows(const plm_plant_report *report, plm_result *plant, plm_error *error)
{
    const plm_measurement *measurement = report->measurement;
    plant->row = plm_alloc(measurement->value_count, sizeof *plant->row, error);
    if (!plant->row) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (size_t i = 0; i < measurement->value_count && status == PLM_OK; i++) {
        status = make_row(&measurement->value[i], report->georeference, &plant->row[i], error);
        if (status == PLM_OK) plant->row_count++;
    }
    return status;
}

static plm_status make_result(const plm_plant_report *report, plm_result *plant, plm_error *error)
{
    plant->plant_id = plm_strdup(report->plant_id, error);
    if (!plant->plant_id) return PLM_E_MEMORY;
    if (!report->measurement) {
        plant->failure = plm_strdup(report->failure ? report->failure : "not measured", error);
        return plant->failure ? PLM_OK : PLM_E_MEMORY;
    }
    if (report->georeference) {
        plant->has_place = true;
        plant->longitude = report->georeference->longitude;
        plant->latitude = report->georeference->latitude;
    }
    return make_rows(report, plant, error);
}

/* ---- Plants ---------------------------------------------------------------------------------------------------- */

/* Moves the plant in, behind those of smaller or equal rank. */
static plm_status insert(plm_results *results, const plm_result *plant, plm_error *error)
{
    if (results->count == results->room) {
        const size_t room = results->room ? 2 * results->room : 16;
        plm_result *grown = plm_realloc(results->plant, room, sizeof *grown, error);
        if (!grown) return PLM_E_MEMORY;
        results->plant = grown;
        results->room = room;
    }
    size_t place = results->count++;
    for (; place > 0 && results->plant[place - 1].rank > plant->rank; place--)
        results->plant[place] = results->plant[place - 1];
    results->plant[place] = *plant;
    return PLM_OK;
}

plm_status plm_results_add(plm_results *results, const plm_plant_report *report, size_t rank, json_t *record,
                           plm_error *error)
{
    plm_result made = {.rank = rank, .record = record};
    plm_status status = make_result(report, &made, error);
    if (status == PLM_OK) status = insert(results, &made, error);
    if (status != PLM_OK) free_result(&made);
    return status;
}

plm_status plm_results_add_empty(plm_results *results, const char *plant_id, size_t rank, json_t *record,
                                 plm_error *error)
{
    plm_result made = {.rank = rank, .record = record, .plant_id = plm_strdup(plant_id, error)};
    const plm_status status = made.plant_id ? insert(results, &made, error) : PLM_E_MEMORY;
    if (status != PLM_OK) free_result(&made);
    return status;
}

plm_result *plm_results_find(const plm_results *results, const char *plant_id)
{
    for (size_t i = 0; i < results->count; i++)
        if (!strcmp(results->plant[i].plant_id, plant_id)) return &results->plant[i];
    return NULL;
}

const plm_result_row *plm_result_find(const plm_result *plant, const char *trait)
{
    for (size_t i = 0; i < plant->row_count; i++)
        if (plant->row[i].trait->level == PLM_PLANT && !strcmp(plant->row[i].trait->name, trait)) return &plant->row[i];
    return NULL;
}

bool plm_trait_of_plant(const plm_trait *trait)
{
    return trait->level == PLM_PLANT || !strcmp(trait->name, "stem_diameter") || !strcmp(trait->name, "stem_length");
}

const plm_result_row *plm_result_of_plant(const plm_result *plant, const plm_trait *trait)
{
    const int32_t organ = trait->level == PLM_PLANT ? -1 : 0;
    for (size_t i = 0; i < plant->row_count; i++) {
        const plm_result_row *row = &plant->row[i];
        if (row->trait == trait && row->organ_id == organ) return plm_result_row_is_ok(row) ? row : NULL;
    }
    return NULL;
}

void plm_results_remove(plm_results *results, plm_result *plant)
{
    free_result(plant);
    const size_t place = (size_t)(plant - results->plant);
    memmove(plant, plant + 1, (--results->count - place) * sizeof *plant);
}

void plm_results_free(plm_results *results)
{
    for (size_t i = 0; i < results->count; i++) free_result(&results->plant[i]);
    plm_free(results->plant);
    *results = (plm_results){0};
}
