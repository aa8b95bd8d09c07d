/* tool/tradeoff_rivals.c: plain library methods, which a program of their own runs (plantimeter-competitors): this program does not
 * link what only they need. It prints a JSON object a line. */
#include "tool/tradeoff.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char rival_program[] = "plantimeter-competitors";
enum { MOST_ARGUMENTS = 20 };

/* Runs the program of argv[0], what it prints going to fd. */
static int run_program(void *user, int fd)
{
    char **argument = user;
    const int nothing = open("/dev/null", O_WRONLY);
    if (nothing < 0 || dup2(nothing, STDERR_FILENO) < 0 || dup2(fd, STDOUT_FILENO) < 0) return 126;
    execv(argument[0], argument);
    return 127;
}

/* ---- Finding it ------------------------------------------------------------------------------------------------------ */

/* Beside this program, whose link /proc knows, or in bench/ below it, where the build puts it. */
static bool find_beside(char path[TRADEOFF_PATH])
{
    static const char *const places[] = {"", "bench/"};
    char own[TRADEOFF_PATH];
    const ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
    if (length <= 0) return false;
    own[length] = 0;
    char *slash = strrchr(own, '/');
    if (!slash) return false;
    slash[1] = 0;
    for (size_t k = 0; k < COUNT(places); k++) {
        if (snprintf(path, TRADEOFF_PATH, "%.3900s%s%s", own, places[k], rival_program) >= TRADEOFF_PATH) continue;
        if (access(path, X_OK) == 0) return true;
    }
    return false;
}

/* {"method": "...", "setting": "...", "traits": ["..."]} */
static plm_status add_rival(void *user, json_t *line, plm_error *error)
{
    tradeoff *study = user;
    size_t trait_count;
    const plm_trait *table = plm_traits(&trait_count);
    const char *method = json_string_value(json_object_get(line, "method"));
    const char *setting = json_string_value(json_object_get(line, "setting"));
    json_t *traits = json_object_get(line, "traits"), *name;
    if (!method || !setting || !json_is_array(traits))
        return plm_fail(error, PLM_E_FORMAT, "%s --list: a method without name, setting or traits", rival_program);
    void *grown = plm_realloc(study->rival, study->rival_count + 1, sizeof *study->rival, error);
    if (!grown) return PLM_E_MEMORY;
    study->rival = grown;
    tradeoff_rival *made = &study->rival[study->rival_count];
    made->gives = plm_alloc_zero(trait_count, sizeof *made->gives, error);
    if (!made->gives) return PLM_E_MEMORY;
    study->rival_count++;
    snprintf(made->method, sizeof made->method, "%s", method);
    snprintf(made->setting, sizeof made->setting, "%s", setting);
    size_t k;
    json_array_foreach(traits, k, name)
    {
        const plm_trait *trait = json_is_string(name) ? plm_trait_find(json_string_value(name)) : NULL;
        if (trait) made->gives[trait - table] = true;
    }
    return PLM_OK;
}

/* Hands each line of output, which is a JSON object, to take. */
static plm_status each_line(const char *output, plm_status (*take)(void *user, json_t *line, plm_error *error),
                            void *user, plm_error *error)
{
    plm_status status = PLM_OK;
    size_t lines = 0;
    for (const char *at = output; *at && status == PLM_OK; lines++) {
        const size_t length = strcspn(at, "\n");
        json_t *line = json_loadb(at, length, 0, NULL);
        status = json_is_object(line) ? take(user, line, error)
                                      : plm_fail(error, PLM_E_FORMAT, "%s printed what is no JSON", rival_program);
        json_decref(line);
        at += length + (at[length] == '\n');
    }
    return status == PLM_OK && lines == 0 ? plm_fail(error, PLM_E_LIBRARY, "%s printed nothing", rival_program)
                                          : status;
}

plm_status tradeoff_find_rivals(tradeoff *study, bool *is_there, plm_error *error)
{
    const char *asked = study->settings->competitors;
    *is_there = false;
    if (asked && !strcmp(asked, "none")) return PLM_OK;
    if (!asked && !find_beside(study->program)) {
        study->program[0] = 0;
        return PLM_OK;
    }
    if (asked && access(asked, X_OK) != 0)
        return plm_fail(error, PLM_E_ARGUMENT, "--competitors: %s: %s", asked, strerror(errno));
    if (asked) snprintf(study->program, sizeof study->program, "%s", asked);
    char list[] = "--list";
    char *argument[] = {study->program, list, NULL}, *output;
    size_t size;
    plm_error trouble = {0};
    if (tradeoff_in_child(run_program, argument, 30, &output, &size, &trouble) != PLM_OK)
        return plm_fail(error, PLM_E_ARGUMENT, "--competitors: %.200s %s", study->program, trouble.message);
    const plm_status status = each_line(output, add_rival, study, error);
    plm_free(output);
    *is_there = status == PLM_OK;
    return status;
}

/* ---- Running it ------------------------------------------------------------------------------------------------------ */

/* {"trait": "...", "organ_id": 3, "value": 0.1, "seconds": 0.1, "peak_bytes": 1e8, "points": 1000}: SI. A line without a value says
 * what the whole run took. */
static plm_status take_line(void *user, json_t *line, plm_error *error)
{
    tradeoff_run *run = user;
    size_t count;
    const plm_trait *table = plm_traits(&count);
    const char *failure = json_string_value(json_object_get(line, "failure"));
    if (failure) return plm_fail(error, PLM_E_LIBRARY, "%.150s", failure);
    const char *name = json_string_value(json_object_get(line, "trait"));
    const plm_trait *trait = name ? plm_trait_find(name) : NULL;
    run->seconds = json_number_value(json_object_get(line, "seconds"));
    run->peak_bytes = (uint64_t)json_number_value(json_object_get(line, "peak_bytes"));
    run->points = (size_t)json_integer_value(json_object_get(line, "points"));
    const json_t *value = json_object_get(line, "value");
    if (!trait || !json_is_number(value)) return PLM_OK;
    void *grown = plm_realloc(run->value, run->value_count + 1, sizeof *run->value, error);
    if (!grown) return PLM_E_MEMORY;
    run->value = grown;
    const json_t *organ = json_object_get(line, "organ_id");
    run->value[run->value_count++] =
        (tradeoff_value){(int32_t)(trait - table), json_is_integer(organ) ? (int32_t)json_integer_value(organ) : -1,
                         json_number_value(value), NAN};
    return PLM_OK;
}

plm_status tradeoff_run_rival(const tradeoff *study, const tradeoff_plant *plant, const tradeoff_setting *setting,
                              tradeoff_run *run, plm_error *error)
{
    char points[32], scale[32], threads[16], repeats[16];
    const tradeoff_settings *settings = study->settings;
    static const char *const up[] = {"auto", "x", "y", "z", "-x", "-y", "-z"};
    snprintf(points, sizeof points, "%zu", setting->points);
    snprintf(scale, sizeof scale, "%.17g", plant->metres_per_unit);
    snprintf(threads, sizeof threads, "%d", settings->threads);
    snprintf(repeats, sizeof repeats, "%d", settings->repeats);
    const char *argument[MOST_ARGUMENTS] = {study->program,
                                            "--method",
                                            setting->method,
                                            "--setting",
                                            setting->rival,
                                            "--points",
                                            points,
                                            "--scale",
                                            scale,
                                            "--up",
                                            up[settings->reading.up],
                                            "--labels",
                                            plant->label_field,
                                            "--threads",
                                            threads,
                                            "--repeats",
                                            repeats,
                                            plant->labelled,
                                            NULL};
    char *output;
    size_t size;
    plm_status status = tradeoff_in_child(run_program, argument, (unsigned)settings->limit, &output, &size, error);
    if (status != PLM_OK) return status;
    status = each_line(output, take_line, run, error);
    plm_free(output);
    return status;
}
