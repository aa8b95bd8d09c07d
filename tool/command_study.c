/* tool/command_study.c: the `study` sub-command. `study thinning`: what loss of geometry does to traits (laser-scanning paper). */
#include "io/io.h"
#include "mesh/mesh.h"
#include "simulate/simulate.h"
#include "tool/command.h"
#include "tool/study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct study_settings {
    const char *output, *plants, *scenarios;
    int max_loss, rays;
    uint64_t seed;
    double density;
} study_settings;

#define AT(field) .offset = offsetof(study_settings, field)

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write here (required)",
     .kind = PLM_OPTION_TEXT,
     AT(output)},
    {.name = "plants",
     .argument = "LIST",
     .help = "of tomato, maize, cucumber, arabidopsis (default: all)",
     .kind = PLM_OPTION_TEXT,
     AT(plants)},
    {.name = "scenarios",
     .argument = "LIST",
     .help = "of random, inside-out, outside-in (default: all)",
     .kind = PLM_OPTION_TEXT,
     AT(scenarios)},
    {.name = "max-loss",
     .argument = "PERCENT",
     .help = "of the faces, in steps of one percent (default: 30)",
     .kind = PLM_OPTION_INTEGER,
     AT(max_loss),
     .minimum = 2,
     .maximum = STUDY_STEPS_MOST - 1},
    {.name = "density",
     .argument = "HITS_PER_MM2",
     .help = "of the dome on the intact plant (default: 0.105)",
     .kind = PLM_OPTION_NUMBER,
     AT(density),
     .minimum = 1e-4,
     .maximum = 100},
    {.name = "rays",
     .argument = "N",
     .help = "thinning: of light at each step (default: 1000000); light: the most (default: 4096000)",
     .kind = PLM_OPTION_INTEGER,
     AT(rays),
     .minimum = 100,
     .maximum = 1000000000},
    {.name = "seed",
     .argument = "N",
     .help = "of plants, rays and random loss (default: 1)",
     .kind = PLM_OPTION_SEED,
     AT(seed)},
};

/* ---- Which plants and scenarios -------------------------------------------------------------------------------- */

static const char *plant_name(int k)
{
    return k < STUDY_PLANTS ? study_plants[k].name : NULL;
}

static const char *scenario_name(int k)
{
    return k < PLM_LOSS_COUNT ? plm_loss_name((plm_loss)k) : NULL;
}

/* Marks the names of a comma-separated list; NULL marks all. False when one is none of them. */
static bool mark_names(const char *list, const char *(*name)(int k), bool *is_wanted)
{
    for (int k = 0; name(k); k++) is_wanted[k] = !list;
    while (list && *list) {
        const size_t length = strcspn(list, ",");
        bool is_known = false;
        for (int k = 0; name(k); k++)
            if (strlen(name(k)) == length && !strncmp(name(k), list, length)) is_known = is_wanted[k] = true;
        if (!is_known) return false;
        list += length + (list[length] == ',');
    }
    return true;
}

/* ---- Steps: a small file each, renamed into place, so that a killed study goes on where it was ----------------------- */

static plm_status step_path(const study *all, const study_settings *settings, int plant, int loss, int step,
                            char path[STUDY_PATH], plm_error *error)
{
    char name[160];
    snprintf(name, sizeof name, "steps/%s_%s_%02d_s%llu_d%g_r%d.txt", study_plants[plant].name,
             plm_loss_name((plm_loss)loss), step, (unsigned long long)settings->seed, settings->density,
             settings->rays);
    return study_path(all, name, path, error);
}

static bool read_step(const char *path, double *value)
{
    FILE *file = fopen(path, "r");
    int count = 0;
    while (file && count < PLM_THIN_COUNT && fscanf(file, "%lf", &value[count]) == 1) count++;
    if (file) fclose(file);
    return count == PLM_THIN_COUNT;
}

static plm_status write_step(const char *path, const double *value, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    for (int t = 0; t < PLM_THIN_COUNT && status == PLM_OK; t++)
        status = plm_output_print(output, error, "%.17g\n", value[t]);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* ---- The study --------------------------------------------------------------------------------------------------- */

typedef struct progress {
    int done, total, measured;
    time_t start;
} progress;

static void show(const progress *now, const char *plant, const char *scenario, int step)
{
    if (!isatty(STDERR_FILENO)) return;
    const double each = now->measured ? difftime(time(NULL), now->start) / now->measured : 0;
    fprintf(stderr, "\r%3d %% %s %s %2d %%, about %.0f s left   ", 100 * now->done / now->total, plant, scenario, step,
            each * (now->total - now->done));
    if (now->done == now->total) fputc('\n', stderr);
}

/* Largest distance of a vertex from the line over the stem's base. */
static double radius_of(const plm_mesh *mesh)
{
    double most = 0;
    for (size_t k = 0; k < mesh->vertex_count; k++) most = fmax(most, hypot(mesh->vertex[k][0], mesh->vertex[k][1]));
    return most;
}

static void note_model(const plm_virtual_plant *plant, study_model *model)
{
    *model = (study_model){.is_there = true,
                           .leaves = plant->leaf_count,
                           .nodes = plant->stem_count ? (size_t)plant->stem[0].node_count : plant->leaf_count,
                           .vertices = plant->mesh.vertex_count,
                           .faces = plant->mesh.triangle_count,
                           .height = plant->whole.height,
                           .radius = radius_of(&plant->mesh)};
}

/* Only where something is left to do. */
static plm_status start_once(const study_settings *settings, const plm_virtual_plant *plant, plm_thinning **thinning,
                             plm_error *error)
{
    const plm_thinning_options thin = {.seed = settings->seed,
                                       .density = settings->density * 1e6,
                                       .light_rays = (uint64_t)settings->rays,
                                       .hull = plm_convex_hull};
    return *thinning ? PLM_OK : plm_thinning_start(plant, &thin, thinning, error);
}

/* The half ellipsoid's faces for figure 8; the file stays from run to run, as the steps do. */
static plm_status ensure_ellipsoid(const study *all, const study_settings *settings, const plm_virtual_plant *plant,
                                   int p, plm_thinning **thinning, plm_error *error)
{
    char name[64], path[STUDY_PATH];
    snprintf(name, sizeof name, "ellipsoid_%s.csv", study_plants[p].name);
    plm_status status = study_path(all, name, path, error);
    if (status != PLM_OK || access(path, R_OK) == 0) return status;
    status = start_once(settings, plant, thinning, error);
    return status == PLM_OK ? study_write_ellipsoid(all, p, *thinning, error) : status;
}

static plm_status one_step(study *all, const study_settings *settings, const plm_virtual_plant *plant,
                           plm_thinning **thinning, int p, int l, int step, progress *now, plm_error *error)
{
    char path[STUDY_PATH];
    double *value = all->value[p][l][step];
    plm_status status = step_path(all, settings, p, l, step, path, error);
    if (status == PLM_OK && !read_step(path, value)) {
        status = start_once(settings, plant, thinning, error);
        if (status == PLM_OK) status = plm_thinning_step(*thinning, (plm_loss)l, step, value, error);
        if (status == PLM_OK) status = write_step(path, value, error);
        now->measured++;
    }
    now->done++;
    if (status == PLM_OK) show(now, study_plants[p].name, plm_loss_name((plm_loss)l), step);
    return status;
}

static plm_status study_one(study *all, const study_settings *settings, int p, progress *now, plm_error *error)
{
    plm_virtual_plant plant;
    plm_thinning *thinning = NULL;
    const plm_plant_options grow = {.seed = settings->seed, .resolution = study_plants[p].resolution};
    plm_status status = plm_plant_grow(study_plants[p].kind, &grow, &plant, error);
    if (status != PLM_OK) return status;
    note_model(&plant, &all->model[p]);
    status = ensure_ellipsoid(all, settings, &plant, p, &thinning, error);
    for (int l = 0; l < PLM_LOSS_COUNT; l++)
        for (int step = 0; step <= all->max_loss && all->has_loss[l] && status == PLM_OK; step++)
            status = one_step(all, settings, &plant, &thinning, p, l, step, now, error);
    for (int l = PLM_LOSS_COUNT - 1; l >= 0; l--)
        if (all->has_loss[l]) all->model[p].area = all->value[p][l][0][PLM_THIN_AREA];
    plm_thinning_free(thinning);
    plm_virtual_plant_free(&plant);
    return status;
}

static int study_thinning(study *all, const study_settings *settings)
{
    plm_error error = {0};
    plm_status status = PLM_OK;
    progress now = {.start = time(NULL)};
    for (int p = 0; p < STUDY_PLANTS; p++)
        for (int l = 0; l < PLM_LOSS_COUNT; l++)
            if (all->has_plant[p] && all->has_loss[l]) now.total += all->max_loss + 1;
    for (int p = 0; p < STUDY_PLANTS && status == PLM_OK; p++)
        if (all->has_plant[p]) status = study_one(all, settings, p, &now, &error);
    if (status == PLM_OK) status = study_write_tables(all, &error);
    bool is_drawn = true;
    if (status == PLM_OK) is_drawn = study_plot(all, &status, &error);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    if (!is_drawn)
        fprintf(stderr, "plantimeter: gnuplot did not draw all figures; their scripts are in %s\n", all->folder);
    printf("%d steps, %d of them measured now: thinning.csv, table1, table2, table3 and figures in %s\n", now.total,
           now.measured, all->folder);
    return PLM_EXIT_GOOD;
}

/* The folder and that of the steps. */
static plm_status make_folders(const study *all, plm_error *error)
{
    char steps[STUDY_PATH];
    const plm_status status = study_path(all, "steps", steps, error);
    return status == PLM_OK ? plm_folder_make(steps, error) : status;
}

/* `study light`, on the first of the plants. */
static int study_light_error(study *all, const study_settings *settings)
{
    plm_error error = {0};
    bool is_drawn = true;
    int plant = 0;
    while (plant + 1 < STUDY_PLANTS && !all->has_plant[plant]) plant++;
    plm_status status = plm_folder_make(all->folder, &error);
    if (status == PLM_OK) status = study_light(all, plant, (uint64_t)settings->rays, settings->seed, &is_drawn, &error);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    if (!is_drawn) fprintf(stderr, "plantimeter: gnuplot did not draw light_error; its script is in %s\n", all->folder);
    printf("%s: light_error.csv and its figure in %s\n", study_plants[plant].name, all->folder);
    return PLM_EXIT_GOOD;
}

static int run(int argc, char **argv)
{
    study_settings settings = {.max_loss = 30, .seed = 1, .density = 0.105};
    const int code = plm_parse_options(&plm_command_study, &argc, argv, &settings);
    if (code >= 0) return code;
    const bool is_light = argc == 1 && strcmp(argv[0], "light") == 0;
    if (argc != 1 || (!is_light && strcmp(argv[0], "thinning") != 0))
        return plm_usage_error(&plm_command_study, "which study? There are thinning and light");
    if (!settings.rays) settings.rays = is_light ? 4096000 : 1000000;
    if (!settings.output) return plm_usage_error(&plm_command_study, "--output is missing");
    plm_error error = {0};
    study *all = plm_alloc_zero(1, sizeof *all, &error);
    if (!all) return plm_report_failure(PLM_E_MEMORY, &error);
    all->folder = settings.output;
    all->max_loss = settings.max_loss;
    int result;
    if (!mark_names(settings.plants, plant_name, all->has_plant))
        result = plm_usage_error(&plm_command_study, "--plants: \"%s\" names a plant that the study does not have",
                                 settings.plants);
    else if (!mark_names(settings.scenarios, scenario_name, all->has_loss))
        result =
            plm_usage_error(&plm_command_study, "--scenarios: \"%s\" names an unknown scenario", settings.scenarios);
    else if (is_light)
        result = study_light_error(all, &settings);
    else if (make_folders(all, &error) != PLM_OK)
        result = plm_report_failure(error.status, &error);
    else
        result = study_thinning(all, &settings);
    plm_free(all);
    return result;
}

const plm_command plm_command_study = {
    .name = "study",
    .arguments = "thinning|light [OPTION]... -o DIR",
    .summary = "what loss of geometry does to traits, as the laser-scanning paper studied it; the error of light",
    .description =
        "thinning: grows the paper's four plants, removes their faces percent by percent (at random, from the inside, "
        "from the "
        "outside), scans and lights each step, and writes thinning.csv (plant, scenario, loss_percent, trait, value, "
        "relative), the paper's tables 1, 2 and 3 with its values beside ours (CSV and Markdown), "
        "visibility_correction.csv (relative trait = 1 + slope x (relative visible area - 1)) and figures 8, 9, 10, 11 "
        "and 13 "
        "with "
        "their gnuplot scripts.\n\n"
        "light: the error of absorbed light against the number of rays, and the standard error that is told of it, on "
        "the first of "
        "the plants: light_error.csv and its figure.\n\n"
        "A study that was stopped goes on where it was: finished steps lie in DIR/steps.",
    .options = options,
    .option_count = COUNT(options),
    .run = run};
