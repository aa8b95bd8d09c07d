/* tool/light_run.c: meshes in, absorbed light out: light.csv, light.json and a coloured mesh of each plant. */
#include "tool/light_run.h"

#include "cloud/clock.h"
#include "io/io.h"
#include "mesh/mesh.h"
#include "reports/run_json.h"
#include "tool/command.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { LONGEST_PATH = 4096 };

/** One mesh to be lit. */
typedef struct lit_mesh {
    char path[LONGEST_PATH], id[160];
    double metres_per_unit, rotation[3][3]; /* to z up */
    bool is_of_leaves;                      /* all its faces are of leaves */
} lit_mesh;

/** What is being written. */
typedef struct light_job {
    const light_settings *settings;
    char (*id)[160]; /* of the plants so far: each has a name of its own */
    size_t id_count;
    plm_output *table;
    json_t *plants;
    size_t done, failed;
    plm_status first_failure;
} light_job;

/* ---- One mesh ---------------------------------------------------------------------------------------------------- */

/* To metres and z up, in place; origin and all. */
static void set_upright(plm_mesh *mesh, const lit_mesh *wanted)
{
    for (size_t k = 0; k <= mesh->vertex_count; k++) {
        double *at = k < mesh->vertex_count ? mesh->vertex[k] : mesh->origin, turned[3] = {0};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) turned[i] += wanted->rotation[i][j] * at[j] * wanted->metres_per_unit;
        memcpy(at, turned, sizeof turned);
    }
}

/* The mesh in the table's words: a row for the plant, a row for each organ. */
static plm_status write_rows(const light_job *job, const char *id, const plm_light *light, const plm_light_group *group,
                             size_t count, double area, plm_error *error)
{
    static const char *const names[PLM_LABEL_COUNT] = {"other", "stem", "petiole", "leaf", "ground"};
    plm_status status =
        plm_output_print(job->table, error, "%s,plant,,%.9g,%.9g,%.9g,%.9g\n", id, 1e4 * area, light->absorbed,
                         light->absorbed_std_error, area > 0 ? light->absorbed / area : 0);
    for (size_t g = 0; g < count && status == PLM_OK; g++) {
        char number[16] = "";
        if (group[g].organ >= 0) snprintf(number, sizeof number, "%d", group[g].organ);
        status = plm_output_print(job->table, error, "%s,%s,%s,%.9g,%.9g,%.9g,%.9g\n", id,
                                  group[g].label < 0 ? "organ" : names[group[g].label], number, 1e4 * group[g].area,
                                  light->group_power[g], light->group_std_error[g],
                                  group[g].area > 0 ? light->group_power[g] / group[g].area : 0);
    }
    return status;
}

static plm_status note_plant(const light_job *job, const lit_mesh *wanted, const plm_light *light, double seconds,
                             plm_error *error)
{
    json_t *object =
        json_pack("{s:s, s:s, s:i, s:f, s:f, s:f, s:f, s:f, s:I, s:I, s:f, s:f}", "plant_id", wanted->id, "mesh",
                  wanted->path, "faces", (int)light->face_count, "emitted_w", light->emitted, "absorbed_w",
                  light->absorbed, "absorbed_std_error_w", light->absorbed_std_error, "escaped_w", light->escaped,
                  "balance", (light->absorbed + light->escaped) / (light->emitted > 0 ? light->emitted : 1) - 1, "rays",
                  (json_int_t)job->settings->light.rays, "rays_cast", (json_int_t)light->ray_count, "seconds", seconds,
                  "rays_cast_per_second", seconds > 0 ? (double)light->ray_count / seconds : 0);
    const plm_status status = plm_json_check(object, error);
    if (status != PLM_OK) return status;
    return json_array_append_new(job->plants, object) == 0
               ? PLM_OK
               : plm_fail(error, PLM_E_MEMORY, "out of memory for light.json");
}

static plm_status write_mesh(const light_job *job, const lit_mesh *wanted, const plm_mesh *mesh, const uint8_t *label,
                             const plm_light *light, plm_error *error)
{
    char path[LONGEST_PATH];
    if (snprintf(path, sizeof path, "%s/%s.light.ply", job->settings->output, wanted->id) >= (int)sizeof path)
        return plm_fail(error, PLM_E_WRITE, "%.200s...: the path is too long", job->settings->output);
    return plm_light_write(path, mesh, label, light, error);
}

static plm_status trace(const light_job *job, const lit_mesh *wanted, const plm_mesh *mesh, const uint8_t *label,
                        plm_error *error)
{
    plm_light light = {0};
    plm_light_group *group = NULL;
    size_t count = 0;
    double area = 0, seconds = 0;
    int32_t *face_group = plm_alloc(mesh->triangle_count, sizeof *face_group, error);
    plm_status status = face_group ? plm_light_groups(mesh, label, face_group, &group, &count, error) : PLM_E_MEMORY;
    if (status == PLM_OK) {
        const double begin = plm_seconds_now();
        status = plm_light_trace(mesh, face_group, count, &job->settings->light, &light, error);
        seconds = plm_seconds_now() - begin;
    }
    if (status == PLM_OK) {
        status = plm_mesh_area(mesh, &area, error);
    }
    if (status == PLM_OK) status = write_mesh(job, wanted, mesh, label, &light, error);
    if (status == PLM_OK) status = write_rows(job, wanted->id, &light, group, count, area, error);
    if (status == PLM_OK) status = note_plant(job, wanted, &light, seconds, error);
    if (status == PLM_OK && !job->settings->is_quiet)
        printf("%s: %zu faces, %zu organs, %.4g W of %.4g W absorbed (standard error %.2g W), %.1f s\n", wanted->id,
               mesh->triangle_count, count, light.absorbed, light.emitted, light.absorbed_std_error, seconds);
    plm_light_free(&light);
    plm_free(group);
    plm_free(face_group);
    return status;
}

static plm_status light_mesh(const light_job *job, const lit_mesh *wanted, plm_error *error)
{
    plm_mesh mesh = {0};
    uint8_t *label = NULL;
    plm_status status = plm_mesh_read(wanted->path, &mesh, &label, error);
    if (status != PLM_OK) return status;
    if (wanted->is_of_leaves && !label) {
        label = plm_alloc(mesh.triangle_count, 1, error);
        if (label)
            memset(label, PLM_LABEL_LEAF, mesh.triangle_count);
        else
            status = PLM_E_MEMORY;
    }
    set_upright(&mesh, wanted);
    if (status == PLM_OK) status = trace(job, wanted, &mesh, label, error);
    plm_free(label);
    plm_mesh_free(&mesh);
    return status;
}

/* ---- Inputs ------------------------------------------------------------------------------------------------------ */

/* The rotation that turns an axis to z. */
static void axis_up(int up, double rotation[3][3])
{
    static const double turn[6][3][3] = {
        {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},   /* z */
        {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},  /* y */
        {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},  /* x */
        {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, /* -z */
        {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},  /* -y */
        {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},  /* -x */
    };
    memcpy(rotation, turn[up], sizeof turn[up]);
}

/* The file's name without folder, ".ply", and what comes of `simulate` and `measure` before it; "_2" behind one that was there. */
static plm_status name_plant(light_job *job, const char *path, char id[160], plm_error *error)
{
    static const char *const endings[] = {".ply", ".obj", ".mesh", ".leaves"};
    const char *slash = strrchr(path, '/');
    snprintf(id, 140, "%s", !strcmp(path, "-") ? "stdin" : slash ? slash + 1 : path);
    for (size_t k = 0; k < COUNT(endings); k++) {
        const size_t length = strlen(id), cut = strlen(endings[k]);
        if (length > cut && !strcmp(id + length - cut, endings[k])) id[length - cut] = 0;
    }
    const size_t end = strlen(id);
    bool is_taken = true;
    for (unsigned number = 2; is_taken; number++) {
        is_taken = false;
        for (size_t k = 0; k < job->id_count; k++) is_taken |= !strcmp(job->id[k], id);
        if (is_taken) snprintf(id + end, 16, "_%u", number);
    }
    void *larger = plm_realloc(job->id, job->id_count + 1, sizeof *job->id, error);
    if (!larger) return PLM_E_MEMORY;
    job->id = larger;
    memcpy(job->id[job->id_count++], id, 160);
    return PLM_OK;
}

/* A failure is the plant's own, unless nothing can be written any more. */
static plm_status take(light_job *job, const lit_mesh *wanted, plm_error *error)
{
    const plm_status status = light_mesh(job, wanted, error);
    job->done++;
    if (status == PLM_OK || status == PLM_E_WRITE) return status;
    if (!job->failed++) job->first_failure = status;
    plm_report_failure(status, error);
    return PLM_OK;
}

static plm_status take_mesh(light_job *job, const char *path, plm_error *error)
{
    static const double metres[] = {1, 0.01, 0.001};
    lit_mesh wanted = {.metres_per_unit = metres[job->settings->unit]};
    if (snprintf(wanted.path, sizeof wanted.path, "%s", path) >= (int)sizeof wanted.path)
        return plm_fail(error, PLM_E_READ, "%.200s...: the path is too long", path);
    axis_up(job->settings->up, wanted.rotation);
    const plm_status status = name_plant(job, path, wanted.id, error);
    return status == PLM_OK ? take(job, &wanted, error) : status;
}

/* A plant of run.json: its leaf meshes, and how they lie. False where it has none that can be lit; the user is told. */
static bool plant_of_run(const char *folder, const json_t *plant, lit_mesh *wanted)
{
    const char *id = json_string_value(json_object_get(plant, "plant_id"));
    const json_t *rotation = json_object_get(json_object_get(plant, "frame"), "rotation");
    const double scale = json_number_value(json_object_get(json_object_get(plant, "unit"), "metres_per_unit"));
    struct stat found;
    *wanted = (lit_mesh){.is_of_leaves = true, .metres_per_unit = scale > 0 ? scale : 1};
    if (!id) return false;
    if (snprintf(wanted->path, sizeof wanted->path, "%s/%s.leaves.ply", folder, id) >= (int)sizeof wanted->path ||
        stat(wanted->path, &found) != 0 || json_array_size(rotation) != 3) {
        fprintf(stderr, "plantimeter: %s: left out: the run has no leaf surfaces of it\n", id);
        return false;
    }
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            wanted->rotation[i][j] = json_number_value(json_array_get(json_array_get(rotation, i), j));
    return true;
}

static plm_status take_run(light_job *job, const char *folder, plm_error *error)
{
    char path[LONGEST_PATH];
    json_t *root = NULL;
    if (snprintf(path, sizeof path, "%s/run.json", folder) >= (int)sizeof path)
        return plm_fail(error, PLM_E_READ, "%.200s...: the path is too long", folder);
    plm_status status = plm_run_json_read(path, &root, error);
    const char *crs = json_string_value(json_object_get(json_object_get(root, "options"), "crs"));
    if (status == PLM_OK && crs && !strcmp(crs, "geodetic"))
        status = plm_fail(error, PLM_E_FORMAT, "%s: its meshes are in degrees of longitude and latitude", path);
    const json_t *plants = json_object_get(root, "plants");
    const size_t before = job->done;
    for (size_t k = 0; k < json_array_size(plants) && status == PLM_OK; k++) {
        lit_mesh wanted;
        if (!plant_of_run(folder, json_array_get(plants, k), &wanted)) continue;
        status = name_plant(job, wanted.path, wanted.id, error);
        if (status == PLM_OK) status = take(job, &wanted, error);
    }
    if (status == PLM_OK && job->done == before)
        status = plm_fail(error, PLM_E_FORMAT, "%s: names no plant with leaf surfaces", path);
    json_decref(root);
    return status;
}

/* ---- The run ----------------------------------------------------------------------------------------------------- */

static plm_status write_record(const light_job *job, plm_error *error)
{
    const plm_light_options *light = &job->settings->light;
    char path[LONGEST_PATH];
    snprintf(path, sizeof path, "%.4000s/light.json", job->settings->output);
    json_t *root =
        json_pack("{s:s, s:s, s:{s:I, s:i, s:[f,f,f], s:[f,f,f], s:f, s:f, s:i, s:I}, s:O}", "program", "plantimeter",
                  "version", PLM_VERSION, "options", "rays", (json_int_t)light->rays, "sources",
                  light->circles * light->around, "reflectance", light->reflectance[0], light->reflectance[1],
                  light->reflectance[2], "transmittance", light->transmittance[0], light->transmittance[1],
                  light->transmittance[2], "power_w", light->irradiance > 0 ? 0 : light->power, "irradiance_w_m2",
                  light->irradiance, "depth", light->depth, "seed", (json_int_t)light->seed, "plants", job->plants);
    const plm_status status = plm_json_write(path, root, PLM_JSON_DIGITS, error);
    json_decref(root);
    return status;
}

static plm_status take_all(light_job *job, char *const *input, size_t count, plm_error *error)
{
    plm_status status = PLM_OK;
    for (size_t k = 0; k < count && status == PLM_OK; k++) {
        struct stat found;
        const bool is_folder = stat(input[k], &found) == 0 && S_ISDIR(found.st_mode);
        status = is_folder ? take_run(job, input[k], error) : take_mesh(job, input[k], error);
    }
    return status;
}

int light_run(const light_settings *settings, char *const *input, size_t count)
{
    plm_error error = {0};
    char path[LONGEST_PATH];
    light_job job = {.settings = settings};
    plm_json_use_seam();
    plm_status status = plm_folder_make(settings->output, &error);
    if (status == PLM_OK && !(job.plants = json_array())) status = plm_json_check(NULL, &error);
    if (status == PLM_OK && snprintf(path, sizeof path, "%s/light.csv", settings->output) >= (int)sizeof path)
        status = plm_fail(&error, PLM_E_WRITE, "%.200s...: the path is too long", settings->output);
    if (status == PLM_OK) status = plm_output_open(path, &job.table, &error);
    if (status == PLM_OK) {
        status = plm_output_print(job.table, &error,
                                  "plant_id,organ,organ_id,area_cm2,absorbed_W,std_error_W,absorbed_W_per_m2\n");
        if (status == PLM_OK) status = take_all(&job, input, count, &error);
        const plm_status closed = plm_output_close(job.table, status == PLM_OK, &error);
        if (status == PLM_OK) status = closed;
    }
    if (status == PLM_OK) status = write_record(&job, &error);
    json_decref(job.plants);
    plm_free(job.id);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    if (!job.failed) return PLM_EXIT_GOOD;
    return job.failed < job.done ? PLM_EXIT_SOME_FAILED : (int)plm_exit_of(job.first_failure);
}
