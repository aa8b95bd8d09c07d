/* tool/plant_run.c: one plant of a batch from file to results. */
#include "tool/plant_run.h"

#include "cloud/clock.h"
#include "reports/plant_files.h"
#include "reports/run_json.h"
#include "reports/view_file.h"

#include <stdio.h>
#include <string.h>

enum { FILES = 4, WARNINGS = 2, LONGEST_PATH = 4096 };

/** Where a plant's run stands; what is in it is freed by free_state. */
typedef struct plant_state {
    loaded_cloud loaded;
    plm_measurement measurement;
    bool is_read, is_measured;
    char file[FILES][sizeof *((plm_run_plant *)0)->file];
    char warning[WARNINGS][256];
    plm_run_plant record;
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
    const plm_status status = plm_measure(&loaded->cloud, &measure, &state->measurement, error);
    state->is_measured = status == PLM_OK;
    return status;
}

/* Counts a written file in. */
static void note_file(plant_state *state, const char *path)
{
    const char *slash = strrchr(path, '/');
    snprintf(state->file[state->record.file_count++], sizeof *state->file, "%.300s", slash ? slash + 1 : path);
}

static plm_status write_files(const batch *open, size_t input, const plm_plant_report *report, bool with_view,
                              plant_state *state, plm_error *error)
{
    const plm_measurement *measurement = &state->measurement;
    plm_input_frame frame = {.xyz = (const float(*)[3])state->loaded.original,
                             .metres_per_unit = state->loaded.scale.metres_per_unit,
                             .georeference = report->georeference};
    memcpy(frame.origin, state->loaded.original_origin, sizeof frame.origin);
    char path[LONGEST_PATH];
    plm_status status = PLM_OK;
    if (measurement->segmentation.label) {
        status = batch_path(open, input, ".labelled.ply", path, sizeof path, error);
        if (status == PLM_OK) status = plm_write_labelled_cloud(path, measurement, &frame, error);
        if (status == PLM_OK) note_file(state, path);
    }
    if (status == PLM_OK && measurement->leaves.triangle_count) {
        status = batch_path(open, input, ".leaves.ply", path, sizeof path, error);
        if (status == PLM_OK) status = plm_write_leaf_meshes(path, measurement, &frame, error);
        if (status == PLM_OK) note_file(state, path);
    }
    if (status == PLM_OK) status = batch_path(open, input, ".png", path, sizeof path, error);
    if (status == PLM_OK) status = plm_write_picture(path, report, error);
    if (status == PLM_OK) note_file(state, path);
    if (status != PLM_OK || !with_view) return status;
    status = batch_path(open, input, ".view.json", path, sizeof path, error);
    if (status == PLM_OK) status = plm_write_view(path, report->plant_id, measurement, NULL, error);
    if (status == PLM_OK) note_file(state, path);
    return status;
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

plm_status run_plant(batch *open, size_t input, const char *path, const char *sha256, const plant_run_options *options,
                     plm_status *plant_status, plm_error *error)
{
    plant_state state = {0};
    plm_error trouble = {0};
    plm_plant_report report = {.plant_id = open->plant_id[input]};
    state.record = (plm_run_plant){
        .report = &report, .input = path, .sha256 = sha256, .warning = state.warning, .file = state.file};
    *plant_status = take_plant(path, options, &state, &trouble);
    if (state.is_measured) report.measurement = &state.measurement;
    if (state.is_read && state.loaded.is_georeferenced) report.georeference = &state.loaded.georeference;
    if (*plant_status != PLM_OK) report.failure = trouble.message;
    if (!options->quiet) tell_warnings(&state, report.plant_id);
    plm_status status = PLM_OK;
    const double begin = plm_seconds_now();
    if (state.is_measured && options->with_files)
        status = write_files(open, input, &report, input < options->views, &state, error);
    state.record.write_seconds = plm_seconds_now() - begin;
    state.record.write_peak_bytes = plm_peak_bytes();
    json_t *record = NULL;
    if (status == PLM_OK) status = plm_run_plant_json(&state.record, &record, error);
    if (status == PLM_OK) {
#pragma omp critical(plm_batch)
        status = batch_add(open, input, &report, record, error);
    }
    free_state(&state);
    return status;
}
