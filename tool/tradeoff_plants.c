/* tool/tradeoff_plants.c: the plants of a study: virtual ones, clouds with a truth file, or clouds alone, whose finest measurement
 * then stands for the truth. */
#include "tool/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { MOST_KINDS = 32, MOST_ARGUMENTS = 64, NOISE_TEXT = 16 };

/* ---- Truth files ---------------------------------------------------------------------------------------------------- */

/** Organs that the scanner saw less of are not scored: what is not there cannot be measured. */
static const struct seen_row {
    const char *trait;
    double share;
} seen[] = {{"leaf_area", 0.9}, {"leaf_inclination", 0.8}, {"petiole_inclination", 0.5}, {"petiole_length", 0.5}};

static bool is_seen(const plm_trait *trait, const json_t *organ)
{
    const json_t *share = json_object_get(organ, "visible_fraction"), *points = json_object_get(organ, "points");
    if (json_is_integer(points) && json_integer_value(points) == 0) return false;
    for (size_t i = 0; i < COUNT(seen); i++)
        if (!strcmp(trait->name, seen[i].trait) && json_is_number(share))
            return json_number_value(share) >= seen[i].share;
    return true;
}

typedef struct truth_list {
    tradeoff_value *value;
    size_t count;
} truth_list;

/* Truth files are in metres and degrees. */
static plm_status add_truth(truth_list *list, size_t row, const plm_trait *trait, int32_t organ_id, double value,
                            plm_error *error)
{
    void *grown = plm_realloc(list->value, list->count + 1, sizeof *list->value, error);
    if (!grown) return PLM_E_MEMORY;
    list->value = grown;
    if (trait->unit == PLM_DEGREE) value /= plm_unit_factor(PLM_DEGREE);
    list->value[list->count++] = (tradeoff_value){(int32_t)row, organ_id, value, NAN};
    return PLM_OK;
}

/* The traits of one object: of the plant, or of an organ of the level. */
static plm_status take_object(truth_list *list, const json_t *object, plm_level level, int32_t organ_id,
                              plm_error *error)
{
    size_t count;
    const plm_trait *table = plm_traits(&count);
    plm_status status = PLM_OK;
    for (size_t t = 0; t < count && status == PLM_OK; t++) {
        const json_t *value = json_object_get(object, table[t].name);
        if (table[t].level != level || !json_is_number(value) || !is_seen(&table[t], object)) continue;
        status = add_truth(list, t, &table[t], organ_id, json_number_value(value), error);
    }
    return status;
}

static plm_status take_organs(truth_list *list, const json_t *organs, plm_error *error)
{
    plm_status status = PLM_OK;
    for (size_t k = 0; k < json_array_size(organs) && status == PLM_OK; k++) {
        const json_t *organ = json_array_get(organs, k), *id = json_object_get(organ, "organ_id");
        const char *name = json_string_value(json_object_get(organ, "organ"));
        for (int level = PLM_STEM; name && json_is_integer(id) && level < PLM_LEVEL_COUNT && status == PLM_OK; level++)
            if (!strcmp(name, plm_level_name((plm_level)level)))
                status = take_object(list, organ, (plm_level)level, (int32_t)json_integer_value(id), error);
    }
    return status;
}

/* A JSON object; the caller's. */
static plm_status load_json(const char *path, json_t **object, plm_error *error)
{
    json_error_t trouble;
    *object = NULL;
    if (access(path, R_OK) != 0) return plm_fail(error, PLM_E_READ, "%s: cannot be read", path);
    *object = json_load_file(path, 0, &trouble);
    if (!*object) return plm_fail(error, PLM_E_FORMAT, "%s: line %d: %s", path, trouble.line, trouble.text);
    if (json_is_object(*object)) return PLM_OK;
    json_decref(*object);
    *object = NULL;
    return plm_fail(error, PLM_E_FORMAT, "%s: expected a JSON object as `plantimeter simulate` writes it", path);
}

plm_status tradeoff_read_truth(const char *path, tradeoff_value **truth, size_t *count, plm_error *error)
{
    json_t *object;
    truth_list list = {0};
    plm_status status = load_json(path, &object, error);
    if (status != PLM_OK) return status;
    const json_t *plant = json_object_get(object, "plant"), *organs = json_object_get(object, "organs");
    if (!json_is_object(plant) || !json_is_array(organs))
        status =
            plm_fail(error, PLM_E_FORMAT, "%s: has no \"plant\" and \"organs\"; expected the truth of one plant", path);
    if (status == PLM_OK) status = take_object(&list, plant, PLM_PLANT, -1, error);
    if (status == PLM_OK) status = take_organs(&list, organs, error);
    if (status == PLM_OK && list.count == 0)
        status = plm_fail(error, PLM_E_FORMAT, "%s: has no value of any trait", path);
    json_decref(object);
    if (status != PLM_OK) {
        plm_free(list.value);
        return status;
    }
    *truth = list.value;
    *count = list.count;
    return PLM_OK;
}

/* ---- Plants --------------------------------------------------------------------------------------------------------- */

/* folder/name; folder is what stands before the last slash of a path where is_file. */
static plm_status join(const char *folder, bool is_file, const char *name, char path[TRADEOFF_PATH], plm_error *error)
{
    size_t length = strlen(folder);
    const char *slash = is_file ? strrchr(folder, '/') : NULL;
    if (is_file) length = slash ? (size_t)(slash - folder) : 0;
    const bool is_whole = name[0] == '/' || length == 0;
    const int used = is_whole ? snprintf(path, TRADEOFF_PATH, "%s", name)
                              : snprintf(path, TRADEOFF_PATH, "%.*s/%s", (int)length, folder, name);
    return used < TRADEOFF_PATH ? PLM_OK : plm_fail(error, PLM_E_ARGUMENT, "%.200s...: the path is too long", folder);
}

static plm_status add_plant(tradeoff *study, const char *name, const char *cloud, tradeoff_plant **plant,
                            plm_error *error)
{
    void *grown = plm_realloc(study->plant, study->plant_count + 1, sizeof *study->plant, error);
    if (!grown) return PLM_E_MEMORY;
    study->plant = grown;
    *plant = &study->plant[study->plant_count++];
    **plant = (tradeoff_plant){0};
    snprintf((*plant)->name, sizeof(*plant)->name, "%.60s", name);
    if (snprintf((*plant)->cloud, TRADEOFF_PATH, "%s", cloud) >= TRADEOFF_PATH)
        return plm_fail(error, PLM_E_ARGUMENT, "%.200s...: the path is too long", cloud);
    return PLM_OK;
}

static plm_status add_case(tradeoff *study, const char *index, const json_t *row, plm_error *error)
{
    const char *id = json_string_value(json_object_get(row, "plant_id"));
    const char *file = json_string_value(json_object_get(row, "file"));
    const char *labelled = json_string_value(json_object_get(row, "labelled"));
    const char *truth = json_string_value(json_object_get(row, "truth"));
    if (!id || !file || !truth)
        return plm_fail(error, PLM_E_FORMAT, "%s: a case without plant_id, file or truth", index);
    char path[TRADEOFF_PATH];
    tradeoff_plant *plant;
    plm_status status = join(index, true, file, path, error);
    if (status == PLM_OK) status = add_plant(study, id, path, &plant, error);
    if (status == PLM_OK && labelled) status = join(index, true, labelled, plant->labelled, error);
    if (status == PLM_OK) status = join(index, true, truth, path, error);
    if (status == PLM_OK) status = tradeoff_read_truth(path, &plant->truth, &plant->truth_count, error);
    if (status == PLM_OK) status = tradeoff_probe(study, plant, error);
    if (status == PLM_OK && labelled && !study->settings->reading.labels)
        snprintf(plant->label_field, sizeof plant->label_field, "label");
    return status;
}

/* Every plant of an index as `simulate` writes it. is_index: out. */
static plm_status add_index(tradeoff *study, const char *path, bool *is_index, plm_error *error)
{
    json_t *object;
    plm_status status = load_json(path, &object, error);
    if (status != PLM_OK) return status;
    const json_t *cases = json_object_get(object, "cases");
    *is_index = json_is_array(cases);
    for (size_t k = 0; k < json_array_size(cases) && status == PLM_OK; k++)
        status = add_case(study, path, json_array_get(cases, k), error);
    if (status == PLM_OK && *is_index && json_array_size(cases) == 0)
        status = plm_fail(error, PLM_E_FORMAT, "%s: names no plant", path);
    json_decref(object);
    return status;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* A cloud by its path, with the labels that it may hold. */
static plm_status add_cloud(tradeoff *study, const char *path, tradeoff_plant **plant, plm_error *error)
{
    char name[TRADEOFF_NAME];
    const char *base = base_name(path);
    snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
    plm_status status = add_plant(study, name, path, plant, error);
    if (status == PLM_OK) status = tradeoff_probe(study, *plant, error);
    if (status == PLM_OK && (*plant)->label_field[0])
        snprintf((*plant)->labelled, TRADEOFF_PATH, "%s", (*plant)->cloud);
    return status;
}

static plm_status add_cloud_with_truth(tradeoff *study, const char *path, const char *truth, plm_error *error)
{
    tradeoff_value *value = NULL;
    size_t count = 0;
    tradeoff_plant *plant;
    plm_status status = tradeoff_read_truth(truth, &value, &count, error);
    if (status == PLM_OK) status = add_cloud(study, path, &plant, error);
    if (status != PLM_OK) {
        plm_free(value);
        return status;
    }
    plant->truth = value;
    plant->truth_count = count;
    if (!plant->labelled[0] && !study->settings->is_quiet)
        fprintf(stderr, "plantimeter: %s has no labels: leaves and petioles are taken by their numbers\n", path);
    return PLM_OK;
}

/* What is known of it is what the finest setting gives. */
static plm_status add_cloud_alone(tradeoff *study, const char *path, plm_error *error)
{
    tradeoff_plant *plant;
    char folder[TRADEOFF_PATH], name[TRADEOFF_NAME + 32], labelled[TRADEOFF_PATH];
    plm_status status = add_cloud(study, path, &plant, error);
    if (status == PLM_OK) status = join(study->settings->output, false, "reference", folder, error);
    if (status == PLM_OK) status = plm_folder_make(folder, error);
    if (status != PLM_OK) return status;
    snprintf(name, sizeof name, "%s.labelled.ply", plant->name);
    status = join(folder, false, name, labelled, error);
    plant->labelled[0] = 0; /* the finest setting's own labels count here */
    return status == PLM_OK ? tradeoff_measure_reference(study, plant, labelled, error) : status;
}

/* ---- Virtual plants -------------------------------------------------------------------------------------------------- */

typedef struct simulate_task {
    int count;
    char *argument[MOST_ARGUMENTS];
} simulate_task;

/* Its exit code goes to fd: what is wrong it tells itself. */
static int simulate_in_child(void *user, int fd)
{
    simulate_task *task = user;
    const char code = (char)plm_command_simulate.run(task->count, task->argument);
    fflush(stdout);
    return write(fd, &code, 1) == 1 ? 0 : 1;
}

/* Cuts a list at its commas, in place. */
static size_t cut(char *list, char **word, size_t most)
{
    size_t count = 0;
    for (char *at = list; *at && count < most;) {
        word[count++] = at;
        at += strcspn(at, ",");
        if (*at) *at++ = 0;
    }
    return count;
}

/* One scanner with one noise ("" for its own): DIR/plants/SCANNER_NOISEmm. */
static int simulate_with(tradeoff *study, const char *scanner, const char *noise, char *kinds)
{
    const tradeoff_settings *settings = study->settings;
    char folder[TRADEOFF_PATH], name[TRADEOFF_NAME], count[16], points[16], seed[24], *word[MOST_KINDS];
    plm_error error = {0};
    snprintf(name, sizeof name, "plants/%.20s%s%.16s%s", scanner, noise[0] ? "_" : "", noise, noise[0] ? "mm" : "");
    snprintf(count, sizeof count, "%d", settings->count);
    snprintf(points, sizeof points, "%d", settings->cloud_points);
    snprintf(seed, sizeof seed, "%llu", (unsigned long long)settings->seed);
    if (join(settings->output, false, name, folder, &error) != PLM_OK) return plm_report_failure(error.status, &error);
    const char *argument[] = {"simulate", "-q",       "-o",   folder,      "-n",    count,     "--seed",
                              seed,       "--points", points, "--scanner", scanner, "--noise", noise};
    simulate_task task = {.count = (int)COUNT(argument) - (noise[0] ? 0 : 2)};
    memcpy(task.argument, argument, (size_t)task.count * sizeof *argument);
    const size_t kind_count = cut(kinds, word, MOST_KINDS);
    for (size_t k = 0; k < kind_count; k++) task.argument[task.count++] = word[k];
    char *output, path[TRADEOFF_PATH];
    size_t size;
    bool is_index;
    plm_status status = tradeoff_in_child(simulate_in_child, &task, 0, &output, &size, &error);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    const int code = size == 1 ? output[0] : PLM_EXIT_SOME_FAILED;
    plm_free(output);
    if (code != PLM_EXIT_GOOD) return code;
    status = join(folder, false, "truth.json", path, &error);
    if (status == PLM_OK) status = add_index(study, path, &is_index, &error);
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_report_failure(status, &error);
}

static int simulate_plants(tradeoff *study)
{
    const tradeoff_settings *settings = study->settings;
    static const char *const what[] = {"--scanners", "--noise"};
    const char *list[] = {settings->scanners, settings->noises};
    char text[2][256], *word[2][MOST_KINDS];
    size_t count[2];
    for (int k = 0; k < 2; k++) {
        if (snprintf(text[k], sizeof text[k], "%s", list[k] ? list[k] : "") >= (int)sizeof text[k])
            return plm_usage_error(&plm_command_tradeoff, "%s: the list is too long", what[k]);
        count[k] = cut(text[k], word[k], MOST_KINDS);
    }
    static char none[] = "";
    if (count[1] == 0) word[1][count[1]++] = none;
    int code = PLM_EXIT_GOOD;
    for (size_t s = 0; s < count[0]; s++)
        for (size_t n = 0; n < count[1] && code == PLM_EXIT_GOOD; n++) {
            char kinds[512];
            double noise;
            if (strlen(word[1][n]) > NOISE_TEXT || (word[1][n][0] && !plm_parse_number(word[1][n], &noise)))
                return plm_usage_error(&plm_command_tradeoff, "--noise: \"%s\" is no number", word[1][n]);
            if (snprintf(kinds, sizeof kinds, "%s", settings->kinds) >= (int)sizeof kinds)
                return plm_usage_error(&plm_command_tradeoff, "--simulate: the list is too long");
            code = simulate_with(study, word[0][s], word[1][n], kinds);
        }
    return code;
}

/* ---- All of them ------------------------------------------------------------------------------------------------------ */

int tradeoff_find_plants(tradeoff *study, char *const *cloud, size_t count)
{
    const tradeoff_settings *settings = study->settings;
    plm_error error = {0};
    plm_status status = PLM_OK;
    study->has_truth = settings->kinds || settings->truth;
    if (settings->kinds) return simulate_plants(study);
    bool is_index = false;
    if (settings->truth) status = add_index(study, settings->truth, &is_index, &error);
    if (status == PLM_OK && is_index && count > 0)
        return plm_usage_error(&plm_command_tradeoff, "%s names its clouds; leave out the others", settings->truth);
    if (status == PLM_OK && settings->truth && !is_index && count != 1)
        return plm_usage_error(&plm_command_tradeoff, "%s is the truth of one plant; give one CLOUD", settings->truth);
    for (size_t k = 0; k < count && status == PLM_OK; k++)
        status = settings->truth ? add_cloud_with_truth(study, cloud[k], settings->truth, &error)
                                 : add_cloud_alone(study, cloud[k], &error);
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_report_failure(status, &error);
}
