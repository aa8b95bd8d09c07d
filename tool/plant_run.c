/* tool/plant_run.c: one plant of a batch from file to results. */
#include "tool/plant_run.h"

#include "cloud/clock.h"
#include "reports/plant_files.h"
#include "reports/run_json.h"
#include "reports/view_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** What writing may take longer than predicted. */
static const double file_margin = 1.3;

/** The files of a plant. */
typedef enum plant_file { FILE_CLOUD = 0, FILE_MESH, FILE_PICTURE, FILE_VIEW, FILE_COUNT } plant_file;

enum { WARNINGS = 16, LONGEST_PATH = 4096 };

/** Where a plant's run stands; what is in it is freed by free_state. */
typedef struct plant_state {
    loaded_cloud loaded;
    plm_measurement measurement;
    bool is_read, is_measured;
    char file[FILE_COUNT][sizeof *((plm_run_plant *)0)->file];
    char warning[WARNINGS][256];
    plm_run_plant record;
    bool is_timed; /* anytime and what follows are set */
    plm_anytime_options anytime;
    plm_anytime_record done;
    plm_run_time time;
} plant_state;

static void warn(plant_state *state, const char *text)
{
    if (state->record.warning_count < WARNINGS)
        snprintf(state->warning[state->record.warning_count++], sizeof *state->warning, "%s", text);
}

static plm_status read_plant(const char *path, const plant_run_options *options, plant_state *state, plm_error *error)
{
    const double begin = plm_seconds_now();
    plm_status status = load_cloud(path, options->reading, options->with_files, &state->loaded, error);
    state->record.read_seconds = plm_seconds_now() - begin;
    state->record.read_peak_bytes = plm_peak_bytes();
    if (status != PLM_OK) return status;
    state->is_read = true;
    const plm_read_report *report = &state->loaded.report;
    state->record.read = report;
    state->record.point_count = state->loaded.cloud.count;
    state->record.metres_per_unit = state->loaded.scale.metres_per_unit;
    state->record.unit_evidence = state->loaded.scale.evidence;
    if (state->loaded.scale.is_doubtful) warn(state, state->loaded.scale.evidence);
    if (report->label_field[0] && !options->reading->labels) {
        char text[256];
        snprintf(text, sizeof text, "the file has labels in its field \"%s\"; --labels %s uses them",
                 report->label_field, report->label_field);
        warn(state, text);
    }
    return PLM_OK;
}

static plm_status measure_plant(const plant_run_options *options, plant_state *state, plm_error *error)
{
    plm_measure_options measure = *options->measure;
    loaded_cloud *loaded = &state->loaded;
    if (loaded->is_georeferenced) { /* heights and zenith of the local frame */
        measure.ground_height -= loaded->georeference.height;
        if (measure.up == PLM_UP_AUTO) measure.up = PLM_UP_Z;
    }
    const plm_status status = state->is_timed ? plm_measure_anytime(&loaded->cloud, &measure, &state->anytime,
                                                                    &state->measurement, &state->done, error)
                                              : plm_measure(&loaded->cloud, &measure, &state->measurement, error);
    state->is_measured = status == PLM_OK;
    return status;
}

/* ---- Time ------------------------------------------------------------------------------------------------------ */

static void begin_timing(const plant_run_options *options, plant_state *state)
{
    const plant_time *time = options->time;
    state->is_timed = time->seconds > 0 || time->target_count;
    if (!state->is_timed) return;
    unsigned outputs = 0;
    if (options->with_files)
        for (int cost = PLM_COST_LABELS; cost < PLM_COST_COUNT; cost++) outputs |= 1U << cost;
    if (!options->with_page) outputs &= ~(1U << PLM_COST_PAGE);
    state->anytime = (plm_anytime_options){.begin = options->begin,
                                           .seconds = time->seconds,
                                           .outputs = outputs,
                                           .target_count = time->target_count,
                                           .target = time->target};
    state->time = (plm_run_time){.asked = time->seconds, .target_count = time->target_count, .target = time->target};
    state->record.time = &state->time;
}

static void leave_out(plant_state *state, const char *what)
{
    if (state->time.left_out_count < sizeof state->time.left_out / sizeof *state->time.left_out)
        state->time.left_out[state->time.left_out_count++] = what;
}

/* Whether there is time for an output; what there is none for is noted. */
static bool has_time_for(plant_state *state, plm_cost cost, const char *what)
{
    if (!state->is_timed) return true;
    const plm_measurement *measurement = &state->measurement;
    const size_t size =
        plm_cost_size(cost, measurement->cloud.count, measurement->cloud.count, measurement->leaves.triangle_count);
    const double predicted = plm_pace_predict(&state->done.pace, (int)cost, size);
    const bool has = file_margin * predicted <= plm_anytime_left(&state->anytime, &state->done.pace);
    if (!has) leave_out(state, what);
    return has;
}

static void tell_times(plant_state *state, const plant_run_options *options)
{
    char text[256];
    const double asked = options->time->seconds;
    if (asked > 0 && state->record.read_seconds > asked) {
        snprintf(text, sizeof text, "time budget: reading alone took %.3g s of %.3g s", state->record.read_seconds,
                 asked);
        warn(state, text);
    }
    if (state->done.is_late[PLM_GROUP_PLANT])
        warn(state, "time budget: some traits of the plant were left out; their rows say so");
    if (state->done.is_late[PLM_GROUP_ORGANS])
        warn(state, "time budget: some traits of organs were left out; their rows say so");
    size_t length = (size_t)snprintf(text, sizeof text, "time budget: not written:");
    for (size_t i = 0; i < state->time.left_out_count; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s %s", i ? "," : "", state->time.left_out[i]);
    if (state->time.left_out_count) warn(state, text);
}

/* Whether all targets were reached; those that were not are told. */
static bool tell_targets(plant_state *state)
{
    bool all = true;
    for (size_t i = 0; i < state->time.target_count; i++) {
        const plm_target *target = &state->time.target[i];
        const plm_target_outcome *outcome = &state->done.outcome[i];
        if (outcome->is_reached) continue;
        all = false;
        const double factor = target->is_relative ? 100 : plm_unit_factor(target->trait->unit);
        const char *unit = target->is_relative ? "%" : plm_unit_name(target->trait->unit);
        const size_t points = state->done.points[plm_group_of(target->trait)];
        char text[256], came[64] = "it has no value";
        if (outcome->half_width < HUGE_VAL)
            snprintf(came, sizeof came, "half the width of the 95 %% interval is %.3g %s", factor * outcome->half_width,
                     unit);
        snprintf(text, sizeof text, "target error %s=%.3g %s was not reached: %s with %s%zu points",
                 target->trait->name, factor * target->half_width, unit, came,
                 points >= state->record.point_count ? "all " : "", points);
        warn(state, text);
    }
    return all;
}

/* ---- Files ----------------------------------------------------------------------------------------------------- */

/* Counts a written file in. */
static void note_file(plant_state *state, const char *path)
{
    const char *slash = strrchr(path, '/');
    snprintf(state->file[state->record.file_count++], sizeof *state->file, "%.300s", slash ? slash + 1 : path);
}

static const struct {
    const char *name;
    plm_cost cost;
} plant_files[FILE_COUNT] = {
    [FILE_CLOUD] = {"labelled.ply", PLM_COST_CLOUD_FILE},
    [FILE_MESH] = {"leaves.ply", PLM_COST_MESH_FILE},
    [FILE_PICTURE] = {"png", PLM_COST_PICTURE},
    [FILE_VIEW] = {"view.json", PLM_COST_VIEW},
};

/* Whether a file is to be written. Changes the state only where time is limited. */
static bool wants_file(plant_file file, bool with_view, plant_state *state)
{
    const plm_measurement *measurement = &state->measurement;
    if (file == FILE_CLOUD && !measurement->segmentation.label) return false;
    if (file == FILE_MESH && !measurement->leaves.triangle_count) return false;
    if (file == FILE_VIEW && !with_view) return false;
    if (file == FILE_CLOUD && state->is_timed && !state->done.has_all_points) {
        leave_out(state, plant_files[file].name);
        return false;
    }
    return has_time_for(state, plant_files[file].cost, plant_files[file].name);
}

static plm_status write_file(plant_file file, const char *path, const plm_plant_report *report,
                             const plm_input_frame *frame, plm_error *error)
{
    switch (file) {
        case FILE_CLOUD:
            return plm_write_labelled_cloud(path, report->measurement, frame, error);
        case FILE_MESH:
            return plm_write_leaf_meshes(path, report->measurement, frame, error);
        case FILE_PICTURE:
            return plm_write_picture(path, report, error);
        default:
            return plm_write_view(path, report->plant_id, report->measurement, NULL, error);
    }
}

/* Side by side where time is not limited: what there is time for is known only after the file before. */
static plm_status write_files(const batch *open, size_t input, const plm_plant_report *report, bool with_view,
                              plant_state *state, plm_error *error)
{
    plm_input_frame frame = {.xyz = (const float(*)[3])state->loaded.original,
                             .metres_per_unit = state->loaded.scale.metres_per_unit,
                             .georeference = report->georeference};
    memcpy(frame.origin, state->loaded.original_origin, sizeof frame.origin);
    struct {
        char path[LONGEST_PATH];
        plm_status status;
        plm_error error;
        bool is_written;
    } file[FILE_COUNT] = {0};
#pragma omp parallel for schedule(dynamic, 1) if (!state->is_timed)
    for (int k = 0; k < FILE_COUNT; k++) {
        if (!wants_file((plant_file)k, with_view, state)) continue;
        char suffix[32];
        snprintf(suffix, sizeof suffix, ".%s", plant_files[k].name);
        file[k].status = batch_path(open, input, suffix, file[k].path, sizeof file[k].path, &file[k].error);
        if (file[k].status == PLM_OK)
            file[k].status = write_file((plant_file)k, file[k].path, report, &frame, &file[k].error);
        file[k].is_written = file[k].status == PLM_OK;
    }
    for (int k = 0; k < FILE_COUNT; k++) {
        if (file[k].status != PLM_OK) return plm_fail(error, file[k].status, "%s", file[k].error.message);
        if (file[k].is_written) note_file(state, file[k].path);
    }
    return PLM_OK;
}

static void tell_warnings(const plant_state *state, const char *plant_id)
{
    for (size_t i = 0; i < state->record.warning_count; i++)
        fprintf(stderr, "plantimeter: %s: warning: %s\n", plant_id, state->warning[i]);
    for (size_t i = 0; i < state->measurement.warning_count; i++)
        fprintf(stderr, "plantimeter: %s: warning: %s\n", plant_id, state->measurement.warning[i]);
}

static void free_state(plant_state *state)
{
    if (state->is_read) free_loaded(&state->loaded);
    if (state->is_measured) plm_measurement_free(&state->measurement);
}

/* Reads and measures; what goes wrong is the plant's own. */
static plm_status take_plant(const char *path, const plant_run_options *options, plant_state *state, plm_error *error)
{
    plm_status status = read_plant(path, options, state, error);
    return status == PLM_OK ? measure_plant(options, state, error) : status;
}

/* What a plant whose time or error was limited fell short of. */
static void conclude(const plant_run_options *options, plant_state *state, plant_outcome *outcome)
{
    if (options->with_files && options->with_page)
        outcome->no_page = !has_time_for(state, PLM_COST_PAGE, "report.html");
    tell_times(state, options);
    const bool reached = tell_targets(state);
    outcome->fell_short = !reached || state->done.is_late[PLM_GROUP_PLANT] || state->done.is_late[PLM_GROUP_ORGANS];
    state->time.record = &state->done;
    state->time.used = plm_seconds_now() - options->begin;
}

plm_status run_plant(batch *open, size_t input, const char *path, const char *sha256, const plant_run_options *options,
                     plant_outcome *outcome, plm_error *error)
{
    plant_state state = {0};
    plm_error trouble = {0};
    plm_plant_report report = {.plant_id = open->plant_id[input]};
    state.record = (plm_run_plant){
        .report = &report, .input = path, .sha256 = sha256, .warning = state.warning, .file = state.file};
    begin_timing(options, &state);
    outcome->status = take_plant(path, options, &state, &trouble);
    if (state.is_measured) report.measurement = &state.measurement;
    if (state.is_read && state.loaded.is_georeferenced) report.georeference = &state.loaded.georeference;
    if (outcome->status != PLM_OK) report.failure = trouble.message;
    plm_status status = PLM_OK;
    const double begin = plm_seconds_now();
    if (state.is_measured && options->with_files)
        status = write_files(open, input, &report, input < options->views, &state, error);
    state.record.write_seconds = plm_seconds_now() - begin;
    state.record.write_peak_bytes = plm_peak_bytes();
    if (state.is_timed && state.is_measured) conclude(options, &state, outcome);
    if (!options->quiet) tell_warnings(&state, report.plant_id);
    json_t *record = NULL;
    if (status == PLM_OK) status = plm_run_plant_json(&state.record, &record, error);
    if (status == PLM_OK) {
#pragma omp critical(plm_batch)
        status = batch_add(open, input, &report, record, error);
    }
    free_state(&state);
    return status;
}
