/* tool/tradeoff_run.c: every setting on every plant, each in a process of its own. */
#include "cloud/clock.h"
#include "reports/plant_files.h"
#include "tool/measure_settings.h"
#include "tool/tradeoff.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/** Repeats end where they have taken so many seconds together. */
static const double enough_seconds = 10;
/** A found leaf is the true one that it shares at least this part of their common points with. */
static const double same_leaf = 0.5;
enum { MOST_ORGANS = 20000 };

/** What a child is to do. */
typedef struct child_task {
    const tradeoff *study;
    const tradeoff_plant *plant;
    const tradeoff_setting *setting; /* NULL: the finest */
    const char *traits;
    double alpha;         /* metres; 0: found out */
    const char *labelled; /* the cloud is written here, with the labels that were found; NULL: not */
} child_task;

/** What it sends first; value_count tradeoff_value follow. A failed task sends its error. */
typedef struct child_head {
    plm_error error;
    double seconds, leaf_alpha, metres_per_unit;
    uint64_t peak_bytes;
    size_t points, point_count, value_count;
    char label_field[TRADEOFF_NAME];
} child_head;

static bool send_all(int fd, const void *data, size_t size)
{
    const char *at = data;
    while (size > 0) {
        const ssize_t sent = write(fd, at, size);
        if (sent <= 0) return false;
        at += sent;
        size -= (size_t)sent;
    }
    return true;
}

/* ---- In the child: which found leaf is which ------------------------------------------------------------------------ */

/** Numbers of leaves: same[found] is the true leaf's, -1 for none. */
typedef struct leaf_matches {
    int32_t *same;
    size_t count;
} leaf_matches;

static size_t leaf_numbers(const uint8_t *label, const int32_t *organ, size_t count)
{
    int32_t most = -1;
    for (size_t i = 0; i < count; i++)
        if (label[i] == PLM_LABEL_LEAF && organ[i] > most) most = organ[i];
    return (size_t)(most + 1);
}

static bool is_leaf(uint8_t label, int32_t organ)
{
    return label == PLM_LABEL_LEAF && organ >= 0;
}

static plm_status match_leaves(const plm_segmentation *found, const plm_cloud *truth, leaf_matches *matches,
                               plm_error *error)
{
    const size_t n = truth->count;
    const size_t trues = leaf_numbers(truth->label, truth->organ, n);
    const size_t founds = leaf_numbers(found->label, found->organ, n);
    if (trues > MOST_ORGANS || founds > MOST_ORGANS)
        return plm_fail(error, PLM_E_FORMAT, "numbers of leaves reach %zu; the most is %d",
                        trues > founds ? trues : founds, MOST_ORGANS);
    size_t *both = plm_alloc_zero(trues * founds + trues + founds + 1, sizeof *both, error);
    matches->same = both ? plm_alloc(founds + 1, sizeof *matches->same, error) : NULL;
    if (!matches->same) {
        plm_free(both);
        return PLM_E_MEMORY;
    }
    size_t *of_true = both + trues * founds, *of_found = of_true + trues;
    for (size_t i = 0; i < n; i++) {
        const bool is_true = is_leaf(truth->label[i], truth->organ[i]),
                   is_found = is_leaf(found->label[i], found->organ[i]);
        if (is_true) of_true[truth->organ[i]]++;
        if (is_found) of_found[found->organ[i]]++;
        if (is_true && is_found) both[(size_t)truth->organ[i] * founds + (size_t)found->organ[i]]++;
    }
    matches->count = founds;
    for (size_t f = 0; f < founds; f++) {
        matches->same[f] = -1;
        for (size_t t = 0; t < trues; t++) {
            const double common = (double)both[t * founds + f];
            if (common > 0 && common >= same_leaf * ((double)(of_true[t] + of_found[f]) - common))
                matches->same[f] = (int32_t)t;
        }
    }
    plm_free(both);
    return PLM_OK;
}

/* The number that the truth has for an organ; -1 for a leaf that is none of the true ones. */
static int32_t true_number(const leaf_matches *matches, plm_level level, int32_t organ)
{
    if (!matches->same || level == PLM_STEM) return organ; /* petioles have their leaf's number */
    return organ >= 0 && (size_t)organ < matches->count ? matches->same[organ] : -1;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(double *value, size_t count)
{
    if (count == 0) return NAN;
    qsort(value, count, sizeof *value, by_value);
    return count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
}

/* Median alpha of the leaves, as it was found. */
static double typical_alpha(const plm_measurement *measurement, plm_error *error)
{
    const plm_trait *alpha = plm_trait_find("leaf_alpha");
    double *value = plm_alloc(measurement->value_count, sizeof *value, error);
    size_t count = 0;
    for (size_t i = 0; value && i < measurement->value_count; i++) {
        const plm_trait_value *row = &measurement->value[i];
        if (row->trait == alpha && row->estimate.state == PLM_STATE_OK) value[count++] = row->estimate.value;
    }
    const double median = value ? median_of(value, count) : NAN;
    plm_free(value);
    return median;
}

/* ---- In the child: measuring ---------------------------------------------------------------------------------------- */

static double clock_now(const tradeoff_settings *settings)
{
    struct timespec now;
    clock_gettime(settings->threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static plm_status options_of(const child_task *task, plm_measure_options *options, plm_error *error)
{
    measure_settings settings = measure_setting_defaults();
    settings.reading = task->study->settings->reading;
    settings.traits = task->traits;
    settings.alpha = task->alpha;
    if (task->setting && task->setting->neighbours) settings.neighbours = task->setting->neighbours;
    const plm_status status = measure_options_of(&settings, options, error);
    if (status == PLM_OK) options->points = task->setting && task->setting->points ? task->setting->points : SIZE_MAX;
    return status;
}

static plm_status load(const child_task *task, bool is_labelled, bool keep_original, loaded_cloud *loaded,
                       plm_error *error)
{
    reading_settings reading = task->study->settings->reading;
    reading.labels = is_labelled ? task->plant->label_field : NULL;
    return load_cloud(is_labelled ? task->plant->labelled : task->plant->cloud, &reading, keep_original, loaded, error);
}

static bool has_given_labels(const child_task *task)
{
    return task->setting && task->setting->labels == TRADEOFF_GIVEN;
}

/* Own labels are compared with the given ones; time and memory have been taken before. */
static plm_status find_matches(const child_task *task, const plm_measurement *measurement, leaf_matches *matches,
                               plm_error *error)
{
    const plm_segmentation *found = &measurement->segmentation;
    if (!task->setting || has_given_labels(task) || !task->plant->labelled[0] || !found->label) return PLM_OK;
    loaded_cloud truth;
    plm_status status = load(task, true, false, &truth, error);
    if (status != PLM_OK) return status;
    if (truth.cloud.count != found->count || !truth.cloud.organ)
        status = plm_fail(error, PLM_E_FORMAT, "%s: %zu points with organs; the cloud without labels has %zu",
                          task->plant->labelled, truth.cloud.organ ? truth.cloud.count : 0, found->count);
    if (status == PLM_OK) status = match_leaves(found, &truth.cloud, matches, error);
    free_loaded(&truth);
    return status;
}

static size_t collect(const plm_measurement *measurement, const leaf_matches *matches, tradeoff_value *value)
{
    size_t trait_count, count = 0;
    const plm_trait *table = plm_traits(&trait_count);
    for (size_t i = 0; i < measurement->value_count; i++) {
        const plm_trait_value *row = &measurement->value[i];
        const bool is_plant = row->trait->level == PLM_PLANT;
        const int32_t organ = is_plant ? -1 : true_number(matches, row->trait->level, row->organ_id);
        if (row->estimate.state != PLM_STATE_OK || !isfinite(row->estimate.value) || (!is_plant && organ < 0)) continue;
        value[count++] =
            (tradeoff_value){(int32_t)(row->trait - table), organ, row->estimate.value, row->estimate.std_error};
    }
    return count;
}

static plm_status write_labelled(const char *path, const loaded_cloud *loaded, const plm_measurement *measurement,
                                 plm_error *error)
{
    plm_input_frame frame = {.xyz = (const float(*)[3])loaded->original,
                             .metres_per_unit = loaded->scale.metres_per_unit,
                             .georeference = loaded->is_georeferenced ? &loaded->georeference : NULL};
    memcpy(frame.origin, loaded->original_origin, sizeof frame.origin);
    if (!measurement->segmentation.label) return PLM_OK; /* it could not be cut into organs */
    return plm_write_labelled_cloud(path, measurement, &frame, error);
}

static plm_status measure(const child_task *task, child_head *head, tradeoff_value **value, plm_error *error)
{
    loaded_cloud loaded;
    plm_measure_options options;
    plm_measurement measurement;
    leaf_matches matches = {0};
    plm_status status = options_of(task, &options, error);
    if (status == PLM_OK) status = load(task, has_given_labels(task), task->labelled != NULL, &loaded, error);
    if (status != PLM_OK) return status;
    const double begin = clock_now(task->study->settings);
    status = plm_measure(&loaded.cloud, &options, &measurement, error);
    head->seconds = clock_now(task->study->settings) - begin;
    head->peak_bytes = plm_peak_bytes();
    if (status == PLM_OK) {
        head->points = measurement.used_points;
        head->leaf_alpha = typical_alpha(&measurement, error);
        status = find_matches(task, &measurement, &matches, error);
        if (status == PLM_OK && task->labelled) status = write_labelled(task->labelled, &loaded, &measurement, error);
        *value = plm_alloc(measurement.value_count, sizeof **value, error);
        if (!*value) status = PLM_E_MEMORY;
        if (status == PLM_OK) head->value_count = collect(&measurement, &matches, *value);
        plm_measurement_free(&measurement);
    }
    plm_free(matches.same);
    free_loaded(&loaded);
    return status;
}

static int measure_in_child(void *user, int fd)
{
    const child_task *task = user;
    child_head head = {0};
    tradeoff_value *value = NULL;
    plm_error error = {0};
    omp_set_num_threads(task->study->settings->threads);
    const plm_status status = measure(task, &head, &value, &error);
    if (status != PLM_OK) {
        head.error = error;
        head.error.status = status;
        head.value_count = 0;
    }
    const bool is_sent = send_all(fd, &head, sizeof head) && send_all(fd, value, head.value_count * sizeof *value);
    plm_free(value);
    return is_sent ? 0 : 1;
}

static int probe_in_child(void *user, int fd)
{
    const child_task *task = user;
    child_head head = {0};
    loaded_cloud loaded;
    const plm_status status = load(task, false, false, &loaded, &head.error);
    head.error.status = status;
    if (status == PLM_OK) {
        head.point_count = loaded.cloud.count;
        head.metres_per_unit = loaded.scale.metres_per_unit;
        snprintf(head.label_field, sizeof head.label_field, "%s", loaded.report.label_field);
        free_loaded(&loaded);
    }
    return send_all(fd, &head, sizeof head) ? 0 : 1;
}

/* ---- In this process ------------------------------------------------------------------------------------------------ */

/* Sends a child on a task. value: out, the caller's. */
static plm_status send_child(const child_task *task, int (*work)(void *user, int fd), child_head *head,
                             tradeoff_value **value, plm_error *error)
{
    char *output;
    size_t size;
    *value = NULL;
    child_task copy = *task;
    const plm_status status =
        tradeoff_in_child(work, &copy, (unsigned)task->study->settings->limit, &output, &size, error);
    if (status != PLM_OK) return status;
    plm_status result = PLM_E_LIBRARY;
    if (size >= sizeof *head) {
        memcpy(head, output, sizeof *head);
        result = head->error.status == PLM_OK ? PLM_OK : plm_fail(error, head->error.status, "%s", head->error.message);
        if (result == PLM_OK && size == sizeof *head + head->value_count * sizeof **value) {
            *value = plm_alloc(head->value_count, sizeof **value, error);
            if (!*value) result = PLM_E_MEMORY;
            if (*value) memcpy(*value, output + sizeof *head, head->value_count * sizeof **value);
        }
    } else {
        plm_fail(error, result, "a child process said nothing");
    }
    plm_free(output);
    return result;
}

plm_status tradeoff_probe(const tradeoff *study, tradeoff_plant *plant, plm_error *error)
{
    child_head head;
    tradeoff_value *value;
    const child_task task = {.study = study, .plant = plant};
    const plm_status status = send_child(&task, probe_in_child, &head, &value, error);
    plm_free(value);
    if (status != PLM_OK) return status;
    plant->point_count = head.point_count;
    plant->metres_per_unit = head.metres_per_unit;
    const char *field = study->settings->reading.labels;
    snprintf(plant->label_field, sizeof plant->label_field, "%s", field ? field : head.label_field);
    return PLM_OK;
}

plm_status tradeoff_measure_reference(const tradeoff *study, tradeoff_plant *plant, const char *path, plm_error *error)
{
    child_head head;
    const child_task task = {.study = study, .plant = plant, .traits = study->settings->traits, .labelled = path};
    const plm_status status = send_child(&task, measure_in_child, &head, &plant->truth, error);
    if (status != PLM_OK) return status;
    plant->truth_count = head.value_count;
    if (access(path, R_OK) == 0) {
        snprintf(plant->labelled, sizeof plant->labelled, "%s", path);
        snprintf(plant->label_field, sizeof plant->label_field, "label");
    }
    return PLM_OK;
}

/* Once, or as often as is asked for. */
static plm_status measure_repeatedly(const tradeoff *study, const child_task *task, tradeoff_run *run, plm_error *error)
{
    double seconds[100], total = 0;
    size_t done = 0;
    plm_status status = PLM_OK;
    while (done < (size_t)study->settings->repeats && (done == 0 || total < enough_seconds) && status == PLM_OK) {
        child_head head;
        tradeoff_value *value;
        status = send_child(task, measure_in_child, &head, &value, error);
        if (status != PLM_OK) break;
        total += seconds[done++] = head.seconds;
        run->points = head.points;
        run->leaf_alpha = head.leaf_alpha;
        if (head.peak_bytes > run->peak_bytes) run->peak_bytes = head.peak_bytes;
        if (done == 1) {
            run->value = value;
            run->value_count = head.value_count;
        } else {
            plm_free(value);
        }
    }
    run->seconds = median_of(seconds, done);
    return status;
}

/* Points that a setting looks at: all of a cloud that has no more. */
static size_t budget_on(const tradeoff_plant *plant, const tradeoff_setting *setting)
{
    return setting->points >= plant->point_count ? 0 : setting->points;
}

static size_t place_of(const tradeoff *study, size_t plant, size_t setting, size_t group)
{
    return (plant * study->grid_count + setting) * TRADEOFF_GROUPS + group;
}

/* A run that was the same, under another name. Runs of one plant lie together, the last one's at the end. */
static const tradeoff_run *find_same(const tradeoff *study, const tradeoff_run *run)
{
    const tradeoff_plant *plant = &study->plant[run->plant];
    const tradeoff_setting *setting = &study->setting[run->setting];
    for (size_t i = study->run_count; i-- > 0 && study->run[i].plant == run->plant;) {
        const tradeoff_run *other = &study->run[i];
        const tradeoff_setting *theirs = &study->setting[other->setting];
        if (other->group == run->group && theirs->labels == setting->labels && theirs->alpha == setting->alpha &&
            theirs->neighbours == setting->neighbours && !strcmp(theirs->method, setting->method) &&
            !strcmp(theirs->rival, setting->rival) && budget_on(plant, theirs) == budget_on(plant, setting))
            return other;
    }
    return NULL;
}

/* Alpha of the run with the same labels and points that found it out. */
static double alpha_found(const tradeoff *study, const tradeoff_run *run)
{
    const tradeoff_setting *setting = &study->setting[run->setting];
    for (size_t i = study->run_count; i-- > 0 && study->run[i].plant == run->plant;) {
        const tradeoff_setting *theirs = &study->setting[study->run[i].setting];
        if (study->run[i].group == run->group && theirs->labels == setting->labels &&
            theirs->points == setting->points && theirs->alpha == 0 && !strcmp(theirs->method, setting->method))
            return study->run[i].leaf_alpha;
    }
    return NAN;
}

static plm_status run_once(const tradeoff *study, tradeoff_run *run, plm_error *error)
{
    const tradeoff_setting *setting = &study->setting[run->setting];
    const tradeoff_plant *plant = &study->plant[run->plant];
    if (setting->rival[0]) return tradeoff_run_rival(study, plant, setting, run, error);
    child_task task = {.study = study, .plant = plant, .setting = setting, .traits = study->group[run->group].list};
    if (setting->alpha > 0) {
        task.alpha = setting->alpha * alpha_found(study, run);
        if (!(task.alpha > 0)) return plm_fail(error, PLM_E_DEGENERATE, "no leaf has an alpha to begin from");
    }
    return measure_repeatedly(study, &task, run, error);
}

static plm_status take_run(tradeoff *study, tradeoff_run run, plm_error *error)
{
    void *grown = plm_realloc(study->run, study->run_count + 1, sizeof *study->run, error);
    if (!grown) return PLM_E_MEMORY;
    study->run = grown;
    const tradeoff_run *same = find_same(study, &run);
    plm_error trouble = {0};
    if (same) {
        const tradeoff_run here = run;
        run = *same;
        run.setting = here.setting;
        run.value = plm_alloc(run.value_count, sizeof *run.value, error);
        if (!run.value) return PLM_E_MEMORY;
        if (run.value_count) memcpy(run.value, same->value, run.value_count * sizeof *run.value);
    } else {
        run.is_good = run_once(study, &run, &trouble) == PLM_OK;
        snprintf(run.why, sizeof run.why, "%.150s", trouble.message);
    }
    study->run[study->run_count++] = run;
    study->run_place[place_of(study, run.plant, run.setting, run.group)] = study->run_count;
    return PLM_OK;
}

/* Whether a group has a trait that the setting has to do with. */
static bool has_work(const tradeoff_setting *setting, const tradeoff_group *group)
{
    return setting->needs == 0 || setting->needs & group->needs;
}

static void show(const tradeoff *study, size_t plant, size_t setting)
{
    if (study->settings->is_quiet || !isatty(STDERR_FILENO)) return;
    fprintf(stderr, "\r\033[K%zu of %zu plants, %zu of %zu settings: %s %s", plant + 1, study->plant_count, setting + 1,
            study->setting_count, study->setting[setting].method, study->setting[setting].text);
}

plm_status tradeoff_run_all(tradeoff *study, plm_error *error)
{
    study->grid_count = study->setting_count;
    study->run_place =
        plm_alloc_zero(study->plant_count * study->grid_count, TRADEOFF_GROUPS * sizeof *study->run_place, error);
    plm_status status = study->run_place ? PLM_OK : PLM_E_MEMORY;
    for (size_t p = 0; p < study->plant_count; p++)
        for (size_t s = 0; s < study->setting_count && status == PLM_OK; s++) {
            const tradeoff_setting *setting = &study->setting[s];
            const size_t groups = setting->rival[0] ? 1 : study->group_count;
            show(study, p, s);
            if (setting->labels == TRADEOFF_GIVEN && !study->plant[p].labelled[0]) continue;
            for (size_t g = 0; g < groups && status == PLM_OK; g++)
                if (setting->rival[0] || has_work(setting, &study->group[g]))
                    status =
                        take_run(study, (tradeoff_run){.plant = p, .setting = s, .group = g, .leaf_alpha = NAN}, error);
        }
    if (!study->settings->is_quiet && isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
    return status;
}

const tradeoff_run *tradeoff_find_run(const tradeoff *study, size_t plant, size_t setting, size_t group)
{
    if (setting >= study->grid_count || group >= TRADEOFF_GROUPS) return NULL;
    const size_t place = study->run_place[place_of(study, plant, setting, group)];
    return place ? &study->run[place - 1] : NULL;
}
