/* reports/run_json.c: run.json, and the object that `measure --json` prints. */
#include "reports/run_json.h"

#include <math.h>
#include <string.h>

/* null for what JSON cannot say. */
static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

/** An object under way; a part that could not be made or stored is remembered. */
typedef struct builder {
    json_t *object;
    bool is_broken;
} builder;

static builder begin_object(void)
{
    json_t *object = json_object();
    return (builder){.object = object, .is_broken = !object};
}

static void set(builder *b, const char *key, json_t *value)
{
    if (json_object_set_new(b->object, key, value) != 0) b->is_broken = true;
}

static void append(json_t *array, bool *is_broken, json_t *value)
{
    if (json_array_append_new(array, value) != 0) *is_broken = true;
}

/* The object, or NULL when a part of it is missing. */
static json_t *finish(builder *b)
{
    if (!b->is_broken) return b->object;
    json_decref(b->object);
    return NULL;
}

static json_t *finish_array(json_t *array, bool is_broken)
{
    if (array && !is_broken) return array;
    json_decref(array);
    return NULL;
}

/* ---- The record of a plant -------------------------------------------------------------------------------------- */

static json_t *rotation_json(const plm_frame *frame)
{
    json_t *rows = json_array();
    bool is_broken = false;
    for (int row = 0; row < 3; row++) {
        json_t *cells = json_array();
        for (int column = 0; column < 3; column++) append(cells, &is_broken, number(frame->rotation[row][column]));
        append(rows, &is_broken, cells);
    }
    return finish_array(rows, is_broken);
}

static json_t *frame_json(const plm_frame *frame)
{
    static const char *const up[] = {"tilted", "x", "y", "z", "-x", "-y", "-z"};
    builder b = begin_object();
    set(&b, "up", json_string(up[frame->up]));
    set(&b, "rotation", rotation_json(frame));
    set(&b, "confidence", number(frame->confidence));
    set(&b, "evidence", json_string(frame->evidence));
    return finish(&b);
}

static json_t *ground_json(const plm_ground *ground)
{
    builder b = begin_object();
    set(&b, "found", json_boolean(ground->found));
    if (ground->found) set(&b, "soil_height_m", number(ground->soil_height));
    if (ground->has_pot) {
        set(&b, "pot_rim_height_m", number(ground->rim_height));
        set(&b, "pot_diameter_m", number(ground->pot_diameter));
    }
    if (ground->has_table) set(&b, "table_height_m", number(ground->table_height));
    return finish(&b);
}

static json_t *organs_json(const plm_segmentation *segmentation)
{
    if (!segmentation->label) return json_null();
    builder b = begin_object();
    set(&b, "habit", json_string(plm_habit_name(segmentation->habit)));
    set(&b, "stems", json_integer((json_int_t)segmentation->stem_count));
    set(&b, "petioles", json_integer((json_int_t)segmentation->petiole_count));
    set(&b, "leaves", json_integer((json_int_t)segmentation->leaf_count));
    return finish(&b);
}

static json_t *stage_json(const char *name, bool runs, const char *why, double seconds, double processor_seconds,
                          uint64_t peak_bytes)
{
    builder b = begin_object();
    set(&b, "stage", json_string(name));
    set(&b, "runs", json_boolean(runs));
    if (*why) set(&b, "why", json_string(why));
    set(&b, "seconds", number(seconds));
    if (processor_seconds > 0) set(&b, "processor_seconds", number(processor_seconds));
    if (peak_bytes) set(&b, "peak_bytes", json_integer((json_int_t)peak_bytes));
    return finish(&b);
}

static json_t *plan_json(const plm_run_plant *plant)
{
    json_t *stages = json_array();
    bool is_broken = false;
    append(stages, &is_broken, stage_json("read", true, "", plant->read_seconds, 0, plant->read_peak_bytes));
    const plm_measurement *measurement = plant->report->measurement;
    for (size_t i = 0; measurement && i < measurement->plan.stage_count; i++) {
        const plm_stage *stage = &measurement->plan.stage[i];
        append(stages, &is_broken,
               stage_json(stage->name, stage->runs, stage->why, stage->seconds, stage->processor_seconds,
                          stage->peak_bytes));
    }
    append(stages, &is_broken, stage_json("write", true, "", plant->write_seconds, 0, plant->write_peak_bytes));
    return finish_array(stages, is_broken);
}

/* The iterative fits behind the values: how well they were determined, and why they ended. */
static json_t *fits_json(const plm_measurement *measurement)
{
    json_t *fits = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < measurement->value_count; i++) {
        const plm_trait_value *value = &measurement->value[i];
        const plm_fit_note *fit = &value->estimate.fit;
        if (fit->step_count == 0) continue;
        builder b = begin_object();
        set(&b, "trait", json_string(value->trait->name));
        set(&b, "organ_id", json_integer(value->organ_id));
        set(&b, "steps", json_integer(fit->step_count));
        set(&b, "condition", number(fit->condition));
        set(&b, "end", json_string(fit->end));
        append(fits, &is_broken, finish(&b));
    }
    return finish_array(fits, is_broken);
}

static json_t *warnings_json(const plm_run_plant *plant)
{
    json_t *warnings = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < plant->warning_count; i++) append(warnings, &is_broken, plm_json_text(plant->warning[i]));
    const plm_measurement *measurement = plant->report->measurement;
    for (size_t i = 0; measurement && i < measurement->warning_count; i++)
        append(warnings, &is_broken, plm_json_text(measurement->warning[i]));
    return finish_array(warnings, is_broken);
}

static json_t *files_json(const plm_run_plant *plant)
{
    json_t *files = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < plant->file_count; i++) append(files, &is_broken, plm_json_text(plant->file[i]));
    return finish_array(files, is_broken);
}

static json_t *dropped_json(const plm_read_report *read)
{
    builder b = begin_object();
    set(&b, "not_finite", json_integer((json_int_t)read->dropped_not_finite));
    set(&b, "transparent", json_integer((json_int_t)read->dropped_transparent));
    set(&b, "withheld", json_integer((json_int_t)read->dropped_withheld));
    return finish(&b);
}

static json_t *unit_json(const plm_run_plant *plant)
{
    builder b = begin_object();
    set(&b, "metres_per_unit", number(plant->metres_per_unit));
    set(&b, "evidence", plm_json_text(plant->unit_evidence));
    return finish(&b);
}

static json_t *place_json(const plm_georeference *place)
{
    builder b = begin_object();
    set(&b, "longitude", number(place->longitude));
    set(&b, "latitude", number(place->latitude));
    set(&b, "height_m", number(place->height));
    return finish(&b);
}

/* ---- Time and targets ------------------------------------------------------------------------------------------ */

static const char *group_text(const bool has_group[PLM_GROUP_COUNT])
{
    if (has_group[PLM_GROUP_PLANT] && has_group[PLM_GROUP_ORGANS]) return "plant and organs";
    return has_group[PLM_GROUP_PLANT] ? "plant" : has_group[PLM_GROUP_ORGANS] ? "organs" : "none";
}

static json_t *pass_json(const plm_pass_record *pass)
{
    builder b = begin_object();
    set(&b, "points", json_integer((json_int_t)pass->points));
    set(&b, "traits_of", json_string(group_text(pass->has_group)));
    set(&b, "complete", json_string(group_text(pass->is_complete)));
    set(&b, "predicted_s", number(pass->predicted));
    set(&b, "seconds", number(pass->seconds));
    return finish(&b);
}

static json_t *target_json(const plm_target *target, const plm_target_outcome *outcome)
{
    const double factor = target->is_relative ? 100 : plm_unit_factor(target->trait->unit);
    builder b = begin_object();
    set(&b, "trait", json_string(target->trait->name));
    set(&b, "unit", json_string(target->is_relative ? "%" : plm_unit_name(target->trait->unit)));
    set(&b, "asked", number(factor * target->half_width));
    set(&b, "half_width_95", outcome ? number(factor * outcome->half_width) : json_null());
    set(&b, "reached", json_boolean(outcome && outcome->is_reached));
    if (outcome && target->trait->level != PLM_PLANT) {
        set(&b, "worst_organ", number(factor * outcome->worst));
        set(&b, "organs", json_integer((json_int_t)outcome->organs));
        set(&b, "organs_within", json_integer((json_int_t)outcome->organs_within));
    }
    return finish(&b);
}

static json_t *targets_json(const plm_run_time *time)
{
    json_t *array = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < time->target_count; i++)
        append(array, &is_broken, target_json(&time->target[i], time->record ? &time->record->outcome[i] : NULL));
    return finish_array(array, is_broken);
}

/* Of the points that a group's values rest on; null where there are none. */
static json_t *points_json(const plm_anytime_record *record, plm_group group)
{
    return record && record->points[group] ? json_integer((json_int_t)record->points[group]) : json_null();
}

static json_t *time_json(const plm_run_time *time)
{
    json_t *passes = json_array(), *left_out = json_array();
    bool is_broken = false, is_list_broken = false;
    for (size_t i = 0; time->record && i < time->record->pass_count; i++)
        append(passes, &is_broken, pass_json(&time->record->pass[i]));
    for (size_t i = 0; i < time->left_out_count; i++) append(left_out, &is_list_broken, json_string(time->left_out[i]));
    builder b = begin_object();
    set(&b, "asked_s", time->asked > 0 ? number(time->asked) : json_null());
    set(&b, "used_s", number(time->used));
    set(&b, "points_of_plant_traits", points_json(time->record, PLM_GROUP_PLANT));
    set(&b, "points_of_organ_traits", points_json(time->record, PLM_GROUP_ORGANS));
    set(&b, "passes", finish_array(passes, is_broken));
    set(&b, "left_out", finish_array(left_out, is_list_broken));
    return finish(&b);
}

plm_status plm_run_plant_json(const plm_run_plant *plant, json_t **object, plm_error *error)
{
    plm_json_use_seam();
    const plm_plant_report *report = plant->report;
    const plm_measurement *measurement = report->measurement;
    builder b = begin_object();
    set(&b, "plant_id", plm_json_text(report->plant_id));
    set(&b, "input", plm_json_text(plant->input));
    set(&b, "sha256", json_string(plant->sha256));
    set(&b, "status", json_string(measurement ? "ok" : "failed"));
    if (report->failure) set(&b, "reason", plm_json_text(report->failure));
    if (plant->read) {
        set(&b, "format", plm_json_text(plant->read->description));
        set(&b, "fields", plm_json_text(plant->read->fields));
        set(&b, "rows", json_integer((json_int_t)plant->read->rows));
        set(&b, "points", json_integer((json_int_t)plant->point_count));
        set(&b, "dropped", dropped_json(plant->read));
        set(&b, "unit", unit_json(plant));
    }
    if (measurement) set(&b, "used_points", json_integer((json_int_t)measurement->used_points));
    if (report->georeference) set(&b, "place", place_json(report->georeference));
    if (measurement) {
        set(&b, "frame", frame_json(&measurement->frame));
        set(&b, "ground", ground_json(&measurement->ground));
        set(&b, "organs", organs_json(&measurement->segmentation));
    }
    if (plant->time) set(&b, "time_budget", time_json(plant->time));
    if (plant->time && plant->time->target_count) set(&b, "target_error", targets_json(plant->time));
    set(&b, "plan", plan_json(plant));
    if (measurement) set(&b, "fits", fits_json(measurement));
    set(&b, "warnings", warnings_json(plant));
    set(&b, "files", files_json(plant));
    *object = finish(&b);
    return plm_json_check(*object, error);
}

/* ---- The file --------------------------------------------------------------------------------------------------- */

static json_t *root_json(json_t *options, const plm_results *results)
{
    builder b = begin_object();
    set(&b, "program", json_string("plantimeter"));
    set(&b, "version", json_string(PLM_VERSION));
    set(&b, "options", json_incref(options));
    json_t *plants = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < results->count; i++)
        if (results->plant[i].record) append(plants, &is_broken, json_incref(results->plant[i].record));
    set(&b, "plants", finish_array(plants, is_broken));
    return finish(&b);
}

plm_status plm_run_json_write(const char *path, json_t *options, const plm_results *results, plm_error *error)
{
    plm_json_use_seam();
    json_t *root = root_json(options, results);
    const plm_status status = plm_json_write(path, root, PLM_JSON_DIGITS, error);
    json_decref(root);
    return status;
}

plm_status plm_run_json_read(const char *path, json_t **root, plm_error *error)
{
    plm_json_use_seam();
    json_error_t trouble;
    json_t *found = json_load_file(path, 0, &trouble);
    if (!found && json_error_code(&trouble) == json_error_cannot_open_file)
        return plm_fail(error, PLM_E_READ, "%s: cannot be opened", path);
    if (!found) return plm_fail(error, PLM_E_FORMAT, "%s: line %d: %s", path, trouble.line, trouble.text);
    *root = found;
    return PLM_OK;
}

/* ---- For programs ----------------------------------------------------------------------------------------------- */

static json_t *row_json(const plm_result_row *row)
{
    const bool is_ok = plm_result_row_is_ok(row);
    builder b = begin_object();
    set(&b, "organ", json_string(plm_level_name(row->trait->level)));
    set(&b, "organ_id", row->organ_id < 0 ? json_null() : json_integer(row->organ_id));
    set(&b, "trait", json_string(row->trait->name));
    set(&b, "value", number(is_ok ? row->value : NAN));
    set(&b, "unit", json_string(plm_unit_name(row->trait->unit)));
    set(&b, "std_error", number(is_ok ? row->std_error : NAN));
    set(&b, "n_points", json_integer((json_int_t)row->point_count));
    set(&b, "status", json_string(row->status));
    set(&b, "reason", plm_json_text(row->reason));
    set(&b, "method", plm_json_text(row->method));
    return finish(&b);
}

static json_t *plant_json(const plm_result *plant)
{
    builder b = begin_object();
    set(&b, "plant_id", plm_json_text(plant->plant_id));
    set(&b, "status", json_string(plant->failure ? "failed" : "ok"));
    set(&b, "reason", plm_json_text(plant->failure ? plant->failure : ""));
    if (plant->has_place) {
        set(&b, "longitude", number(plant->longitude));
        set(&b, "latitude", number(plant->latitude));
    }
    json_t *rows = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < plant->row_count; i++) append(rows, &is_broken, row_json(&plant->row[i]));
    set(&b, "traits", finish_array(rows, is_broken));
    return finish(&b);
}

plm_status plm_results_json(const plm_results *results, json_t **object, plm_error *error)
{
    plm_json_use_seam();
    builder b = begin_object();
    set(&b, "version", json_string(PLM_VERSION));
    json_t *plants = json_array();
    bool is_broken = false;
    for (size_t i = 0; i < results->count; i++) append(plants, &is_broken, plant_json(&results->plant[i]));
    set(&b, "plants", finish_array(plants, is_broken));
    *object = finish(&b);
    return plm_json_check(*object, error);
}
