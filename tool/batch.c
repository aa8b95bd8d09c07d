/* tool/batch.c: many plants into one folder. run.json says what was done; it is written last, so every plant that it
 * names is in the tables. */
#include "tool/batch.h"

#include "cloud/clock.h"
#include "io/io.h"
#include "reports/run_json.h"
#include "tool/command.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { LONGEST_PATH = 4096 };

/** Writing the tables may take this share of the time. */
static const double saving_share = 0.05;
static const double seconds_between_saves = 5;

/* ---- Names ------------------------------------------------------------------------------------------------------ */

static bool is_taken(const batch *open, size_t count, const char *id)
{
    for (size_t i = 0; i < count; i++)
        if (!strcmp(open->plant_id[i], id)) return true;
    return false;
}

/* The file's name without folder and ending; "_2" and so on behind a name that was there before. */
static plm_status name_plant(batch *open, size_t at, const char *input, plm_error *error)
{
    const char *slash = strrchr(input, '/'), *base = slash ? slash + 1 : input;
    const char *dot = strrchr(base, '.');
    const size_t length = dot && dot > base ? (size_t)(dot - base) : strlen(base);
    const bool is_stdin = !strcmp(input, "-");
    char *id = plm_alloc(length + 32, 1, error);
    if (!id) return PLM_E_MEMORY;
    snprintf(id, length + 32, "%.*s", is_stdin ? 5 : (int)length, is_stdin ? "stdin" : base);
    const size_t end = strlen(id);
    for (unsigned number = 2; is_taken(open, at, id); number++) snprintf(id + end, 32 - 1, "_%u", number);
    open->plant_id[at] = id;
    return PLM_OK;
}

static plm_status name_plants(batch *open, char *const *input, size_t count, plm_error *error)
{
    open->plant_id = plm_alloc_zero(count, sizeof *open->plant_id, error);
    if (!open->plant_id) return PLM_E_MEMORY;
    open->input_count = count;
    plm_status status = PLM_OK;
    for (size_t i = 0; i < count && status == PLM_OK; i++) status = name_plant(open, i, input[i], error);
    return status;
}

/* Place of a plant in the tables: plants that are no input of this run come first. */
static size_t rank_of(const void *user, const char *id)
{
    const batch *open = user;
    for (size_t i = 0; i < open->input_count; i++)
        if (!strcmp(open->plant_id[i], id)) return i + 1;
    return 0;
}

/* ---- Files ------------------------------------------------------------------------------------------------------ */

static plm_status join(char *path, size_t room, const char *folder, const char *name, const char *ending,
                       plm_error *error)
{
    const int length = snprintf(path, room, "%s/%s%s", folder, name, ending);
    if (length < 0 || (size_t)length >= room)
        return plm_fail(error, PLM_E_WRITE, "%s/%.60s...: the path is longer than %zu bytes", folder, name, room - 1);
    return PLM_OK;
}

plm_status batch_path(const batch *open, size_t input, const char *ending, char *path, size_t room, plm_error *error)
{
    return join(path, room, open->folder, open->plant_id[input], ending, error);
}

static bool exists(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0;
}

/* ---- What the folder holds ---------------------------------------------------------------------------------------- */

/* Names the first option that differs. */
static plm_status check_options(const batch *open, const json_t *root, const char *path, plm_error *error)
{
    const char *version = json_string_value(json_object_get(root, "version"));
    if (!version || strcmp(version, PLM_VERSION))
        return plm_fail(error, PLM_E_WRITE, "%s holds results of version %s; give --force or another -o", path,
                        version ? version : "?");
    const json_t *options = json_object_get(root, "options");
    for (void *at = json_object_iter(open->options); at; at = json_object_iter_next(open->options, at)) {
        const char *name = json_object_iter_key(at);
        if (json_equal(json_object_iter_value(at), json_object_get(options, name))) continue;
        return plm_fail(error, PLM_E_WRITE,
                        "%s holds results that were measured with another --%s; give --force or another -o", path,
                        name);
    }
    return PLM_OK;
}

/* Results without run.json are of somebody else, or of a run that was killed before its first save: those come without
 * tables. */
static plm_status read_folder(batch *open, plm_error *error)
{
    char record[LONGEST_PATH], traits[LONGEST_PATH];
    plm_status status = join(record, sizeof record, open->folder, "run", ".json", error);
    if (status == PLM_OK) status = join(traits, sizeof traits, open->folder, "traits", ".csv", error);
    if (status != PLM_OK) return status;
    if (!exists(record)) {
        if (!exists(traits)) return PLM_OK;
        return plm_fail(error, PLM_E_WRITE, "%s is there already; give --force or another -o", traits);
    }
    json_t *root = NULL;
    status = plm_run_json_read(record, &root, error);
    if (status == PLM_OK) status = check_options(open, root, open->folder, error);
    if (status == PLM_OK) status = plm_results_take_records(&open->results, root, false, rank_of, open, error);
    if (status == PLM_OK && open->results.count) status = plm_results_read_traits(&open->results, traits, error);
    json_decref(root);
    if (status == PLM_E_FORMAT || status == PLM_E_READ) { /* not the input's fault */
        char reason[PLM_ERROR_LENGTH] = "";
        if (error) snprintf(reason, sizeof reason, "%s", error->message);
        return plm_fail(error, PLM_E_WRITE, "%.400s; give --force or another -o", reason);
    }
    return status;
}

/* Under --force a folder is no obstacle: what can be kept of other plants is, what cannot is not missed. */
static void read_folder_leniently(batch *open)
{
    if (read_folder(open, NULL) != PLM_OK) plm_results_free(&open->results);
    for (size_t i = 0; i < open->input_count; i++) {
        plm_result *before = plm_results_find(&open->results, open->plant_id[i]);
        if (before) plm_results_remove(&open->results, before);
    }
}

plm_status batch_open(batch *made, const char *folder, json_t *options, bool force, char *const *input,
                      size_t input_count, plm_error *error)
{
    batch open = {.folder = folder, .options = options, .saved_at = plm_seconds_now()};
    plm_status status = name_plants(&open, input, input_count, error);
    if (status == PLM_OK && folder) status = plm_folder_make(folder, error);
    if (status == PLM_OK && folder && !force) status = read_folder(&open, error);
    if (status == PLM_OK && folder && force) read_folder_leniently(&open);
    if (status == PLM_OK)
        *made = open;
    else
        batch_close(&open);
    return status;
}

static bool has_all_files(const batch *open, const json_t *record)
{
    const json_t *files = json_object_get(record, "files");
    for (size_t i = 0; i < json_array_size(files); i++) {
        char path[LONGEST_PATH];
        const char *name = json_string_value(json_array_get(files, i));
        if (!name || join(path, sizeof path, open->folder, name, "", NULL) != PLM_OK || !exists(path)) return false;
    }
    return true;
}

plm_status batch_has(const batch *open, size_t input, const char *sha256, bool *has, plm_error *error)
{
    const plm_result *plant = plm_results_find(&open->results, open->plant_id[input]);
    *has = false;
    if (!plant) return PLM_OK;
    const char *before = json_string_value(json_object_get(plant->record, "sha256"));
    if (!before || !*sha256 || strcmp(before, sha256))
        return plm_fail(error, PLM_E_WRITE,
                        "%s holds results of another file for the plant \"%s\"; give --force or another -o",
                        open->folder, open->plant_id[input]);
    *has = has_all_files(open, plant->record);
    return PLM_OK;
}

/* ---- Results ------------------------------------------------------------------------------------------------------ */

/* A record of no plants, before the first tables: a run that is killed between these and its record goes on as well. */
static plm_status begin_record(const batch *open, plm_error *error)
{
    char path[LONGEST_PATH];
    plm_status status = join(path, sizeof path, open->folder, "run", ".json", error);
    if (status == PLM_OK && !exists(path)) status = plm_run_json_write(path, open->options, &(plm_results){0}, error);
    return status;
}

plm_status batch_save(batch *open, plm_error *error)
{
    static const char *const names[] = {"traits.csv", "plants.csv", "run.json"};
    if (!open->folder) return PLM_OK;
    const double begin = plm_seconds_now();
    plm_status status = begin_record(open, error);
    for (size_t i = 0; i < COUNT(names) && status == PLM_OK; i++) {
        char path[LONGEST_PATH];
        status = join(path, sizeof path, open->folder, names[i], "", error);
        if (status != PLM_OK) break;
        status = i == 0   ? plm_results_write_traits(&open->results, path, error)
                 : i == 1 ? plm_results_write_plants(&open->results, path, error)
                          : plm_run_json_write(path, open->options, &open->results, error);
    }
    open->saved_at = plm_seconds_now();
    open->save_seconds = open->saved_at - begin;
    return status;
}

plm_status batch_add(batch *open, size_t input, const plm_plant_report *report, json_t *record, plm_error *error)
{
    plm_result *before = plm_results_find(&open->results, open->plant_id[input]);
    if (before) plm_results_remove(&open->results, before);
    plm_status status = plm_results_add(&open->results, report, input + 1, record, error);
    const double passed = plm_seconds_now() - open->saved_at;
    const bool is_time = passed > seconds_between_saves && passed * saving_share > open->save_seconds;
    return status == PLM_OK && is_time ? batch_save(open, error) : status;
}

void batch_close(batch *open)
{
    for (size_t i = 0; open->plant_id && i < open->input_count; i++) plm_free(open->plant_id[i]);
    plm_free(open->plant_id);
    plm_results_free(&open->results);
    json_decref(open->options);
    *open = (batch){0};
}
