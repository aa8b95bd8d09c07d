/* tool/command_measure.c: the `measure` sub-command. Options in, a library call a plant, tables out; no geometry. */
#include "cloud/clock.h"
#include "reports/report.h"
#include "reports/run_json.h"
#include "tool/measure_settings.h"
#include "tool/plant_run.h"
#include "tool/talk.h"
#include "tool/visibility.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write traits.csv, plants.csv, run.json, report.html, and PLANT.labelled.ply, PLANT.leaves.ply and "
             "PLANT.png of "
             "each plant into this folder (default: write nothing)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, output),
     .changes_nothing = true},
    {.letter = 't',
     .name = "traits",
     .argument = "LIST",
     .help =
         "measure only these traits: names, or plant, stem, petiole, leaf for all of that level, separated by commas; "
         "only what they need is run (default: all but absorbed_radiation and leaf_absorbed_radiation, which are run "
         "only "
         "where they are named)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, traits)},
    {.name = "ground",
     .argument = "auto|none|HEIGHT",
     .help = "pot, soil and table: found out, not there, or all below HEIGHT along zenith, e.g. 12mm (default: auto)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, ground)},
    {.name = "habit",
     .argument = "auto|simple|compound|strap|rosette|head|single_leaf|bare_stem",
     .help = "what kind of plant it is (default: auto, found out)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(measure_settings, habit)},
    {.name = "stem-height",
     .argument = "LENGTH",
     .help = "where the stem's diameter is taken: along the stem from its base, of branches from the branching point "
             "(default: 20mm)",
     .kind = PLM_OPTION_LENGTH,
     .offset = offsetof(measure_settings, stem_height),
     .minimum = 0,
     .maximum = 5},
    {.name = "neighbours",
     .argument = "N",
     .help = "neighbours of the smoothness factor (default: 16)",
     .kind = PLM_OPTION_INTEGER,
     .offset = offsetof(measure_settings, neighbours),
     .minimum = 3,
     .maximum = 1000},
    {.name = "alpha",
     .argument = "LENGTH",
     .help = "radius of the leaf surfaces' alpha shapes, e.g. 3.6mm (default: found out from the spacing)",
     .kind = PLM_OPTION_LENGTH,
     .offset = offsetof(measure_settings, alpha),
     .minimum = 0,
     .maximum = 1},
    {.name = "effort",
     .argument = "fast|balanced|precise",
     .help =
         "points that are looked at, a random choice of larger clouds: 50 000, 200 000 or 400 000 (default: balanced)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(measure_settings, effort)},
    {.name = "points",
     .argument = "N",
     .help = "look at about N points (default: by --effort)",
     .kind = PLM_OPTION_INTEGER,
     .offset = offsetof(measure_settings, points),
     .minimum = 1000,
     .maximum = 1000000000},
    {.name = "time-budget",
     .argument = "TIME",
     .help = "use at most this time a plant, reading and writing included, where it lowers the reported errors most; "
             "e.g. 500ms, 2s, 1.5min. What does not fit is left out, and said",
     .kind = PLM_OPTION_DURATION,
     .offset = offsetof(measure_settings, time_budget)},
    {.name = "target-error",
     .argument = "TRAIT=ERROR",
     .help = "look at as few points as bring half the width of the trait's 95 % interval (of organs: the median "
             "organ's) to ERROR, e.g. leaf_area=2% or plant_height=1mm; may come several times, or as a list with "
             "commas",
     .kind = PLM_OPTION_TEXTS,
     .offset = offsetof(measure_settings, target_error)},
    {.name = "seed",
     .argument = "N",
     .help = "seed of random numbers (default: 0)",
     .kind = PLM_OPTION_SEED,
     .offset = offsetof(measure_settings, seed)},
    {.name = "threads",
     .argument = "N",
     .help = "threads to use (default: all); the digits do not depend on it",
     .kind = PLM_OPTION_INTEGER,
     .offset = offsetof(measure_settings, threads),
     .minimum = 1,
     .maximum = 1024,
     .changes_nothing = true},
    {.name = "files",
     .argument = "all|tables",
     .help = "what -o writes: all, or only traits.csv, plants.csv and run.json (default: all)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(measure_settings, files)},
    {.name = "views",
     .argument = "N",
     .help = "plants with a 3D view in report.html: the first N (default: 20)",
     .kind = PLM_OPTION_INTEGER,
     .offset = offsetof(measure_settings, views),
     .minimum = 0,
     .maximum = 1000000,
     .changes_nothing = true},
    {.name = "visibility-correction",
     .argument = "FILE[:PLANT]",
     .help = "with -o and --visible-share: write corrected.csv, plant traits as of the whole plant, by the curves of "
             "PLANT in a "
             "visibility_correction.csv of `study thinning`",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, correction),
     .changes_nothing = true},
    {.name = "visible-share",
     .argument = "SHARE|CSV",
     .help = "share of the whole plant's visible area that the scans have, above 0 to 1; or a CSV with the columns "
             "plant_id and "
             "visible_share",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(measure_settings, share),
     .changes_nothing = true},
    {.letter = 'f',
     .name = "force",
     .help = "measure anew what the folder holds already",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(measure_settings, force),
     .changes_nothing = true},
    {.letter = 'q',
     .name = "quiet",
     .help = "print nothing but errors",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(measure_settings, quiet),
     .changes_nothing = true},
    {.name = "json",
     .help = "print the results as one JSON object instead of the short table",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(measure_settings, json),
     .changes_nothing = true},
};

/** A batch under way, and what became of its plants. */
typedef struct batch_tally {
    size_t failed, skipped;
    size_t
        fell_short; /* measured, but without what the time did not allow, or with larger errors than were asked for */
    bool no_page;   /* there is no time for report.html */
    size_t first_failed; /* its place among the inputs */
    plm_status first_failure;
} batch_tally;

/* Counts a failed plant and says why. */
static void tell_failure(batch *open, size_t input, plm_status failure, batch_tally *count)
{
    if (count->failed++ == 0 || input < count->first_failed) {
        count->first_failed = input;
        count->first_failure = failure;
    }
    const plm_result *plant = plm_results_find(&open->results, open->plant_id[input]);
    fprintf(stderr, "plantimeter: %s: failed: %s\n", open->plant_id[input], plant ? plant->failure : "not recorded");
}

/* One input: measured, unless an earlier run did it. */
static plm_status take_input(batch *open, size_t input, const char *path, const plant_run_options *run,
                             batch_tally *count, plm_error *error)
{
    char sha256[65] = "";
    if (strcmp(path, "-") && open->folder && plm_file_sha256(path, sha256, NULL) != PLM_OK) sha256[0] = 0;
    bool has = false;
    plm_status status;
#pragma omp critical(plm_batch)
    {
        status = batch_has(open, input, sha256, &has, error);
        if (has) count->skipped++;
    }
    if (status != PLM_OK || has) return status;
    plant_outcome outcome = {0};
    status = run_plant(open, input, path, sha256, run, &outcome, error);
#pragma omp critical(plm_batch)
    {
        if (outcome.status != PLM_OK) tell_failure(open, input, outcome.status, count);
        count->fell_short += outcome.fell_short;
        count->no_page |= outcome.no_page;
    }
    return status;
}

/* Clouds, meshes and pictures beside the tables. */
static bool writes_files(const measure_settings *settings)
{
    return settings->output && settings->files == 0;
}

/* When the process began, by the time that it has run: what came before main counts too. */
static double process_begin(void)
{
    struct timespec used;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return plm_seconds_now() - ((double)used.tv_sec + 1e-9 * (double)used.tv_nsec);
}

/* Plants of a large batch are measured side by side, a thread each; of few plants each gets all threads. Either way the
 * tables have the order of the inputs. */
static plm_status take_inputs(batch *open, const measure_settings *settings, const plm_measure_options *measure,
                              const plant_time *time, char *const *input, size_t count, batch_tally *tally,
                              plm_error *error)
{
    const bool side_by_side = count >= 2 * (size_t)omp_get_max_threads();
    plm_status status = PLM_OK;
#pragma omp parallel for schedule(dynamic, 1) if (side_by_side)
    for (size_t i = 0; i < count; i++) {
        plm_status before;
#pragma omp atomic read
        before = status;
        if (before != PLM_OK) continue; /* the batch has ended */
        progress_line line = progress_begin(settings->quiet);
        line = (progress_line){line.is_shown, open->plant_id[i], i + 1, count};
        plm_measure_options mine = *measure;
        mine.progress = progress_stage;
        mine.progress_user = &line;
        const plant_run_options run = {.time = time,
                                       .begin = count == 1 ? time->begin : plm_seconds_now(),
                                       .with_page = count == 1,
                                       .reading = &settings->reading,
                                       .measure = &mine,
                                       .with_files = writes_files(settings),
                                       .views = (size_t)settings->views,
                                       .quiet = settings->quiet};
        plm_error trouble = {0};
        const plm_status found = take_input(open, i, input[i], &run, tally, &trouble);
#pragma omp critical(plm_batch)
        if (found != PLM_OK && status == PLM_OK) {
            *error = trouble;
#pragma omp atomic write
            status = found;
        }
        progress_end(&line);
    }
    return status;
}

static plm_status print_results(const batch *done, const measure_settings *settings, plm_error *error)
{
    if (settings->json) {
        json_t *object = NULL;
        plm_status status = plm_results_json(&done->results, &object, error);
        if (status == PLM_OK && json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) != 0)
            status = plm_fail(error, PLM_E_WRITE, "standard output: the JSON cannot be written");
        if (status == PLM_OK) putchar('\n');
        json_decref(object);
        return status;
    }
    return settings->quiet ? PLM_OK : print_short_table(&done->results, settings->traits, error);
}

/* 0, or 1 where some plants failed or fell short of what was asked for; where all failed, the code of their failure. */
static int exit_code(const batch_tally *count, size_t inputs)
{
    if (count->failed == 0) return count->fell_short ? PLM_EXIT_SOME_FAILED : PLM_EXIT_GOOD;
    return count->failed < inputs ? PLM_EXIT_SOME_FAILED : (int)plm_exit_of(count->first_failure);
}

/* corrected.csv, of all plants of the folder: it follows from the tables and is made anew each time. */
static plm_status write_corrected(const batch *done, const visibility *correction, plm_error *error)
{
    char path[4096];
    if (snprintf(path, sizeof path, "%s/corrected.csv", done->folder) >= (int)sizeof path)
        return plm_fail(error, PLM_E_WRITE, "%.60s...: the path is too long", done->folder);
    return visibility_write(correction, &done->results, path, error);
}

static plm_status run_batch(const measure_settings *settings, const visibility *correction,
                            const plm_measure_options *measure, const plant_time *time, char *const *input,
                            size_t count, batch_tally *tally, plm_error *error)
{
    json_t *recorded = NULL;
    batch open;
    plm_status status = plm_options_json(&plm_command_measure, (void *)settings, &recorded, error);
    if (status != PLM_OK) return status;
    status = batch_open(&open, settings->output, recorded, settings->force, input, count, error);
    if (status != PLM_OK) return status;
    status = take_inputs(&open, settings, measure, time, input, count, tally, error);
    if (status == PLM_OK) status = batch_save(&open, error);
    if (status == PLM_OK && writes_files(settings) && !tally->no_page) {
        bool has_view;
        const plm_report_options page = {.views = (size_t)settings->views};
        status = plm_report_write(settings->output, &page, &has_view, error);
    }
    if (status == PLM_OK && correction->curve_count) status = write_corrected(&open, correction, error);
    if (status == PLM_OK && tally->skipped && !settings->quiet)
        fprintf(stderr, "plantimeter: %zu of %zu plants were measured before; --force measures them again\n",
                tally->skipped, count);
    if (status == PLM_OK) status = print_results(&open, settings, error);
    batch_close(&open);
    return status;
}

static int run(int argc, char **argv)
{
    plant_time time = {.begin = process_begin()};
    measure_settings settings = measure_setting_defaults();
    const int code = plm_parse_options(&plm_command_measure, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc == 0) return plm_usage_error(&plm_command_measure, "no cloud is named");
    plm_error error = {0};
    plm_measure_options measure;
    if (measure_options_of(&settings, &measure, &error) != PLM_OK)
        return plm_usage_error(&plm_command_measure, "%s", error.message);
    time.seconds = settings.time_budget;
    for (int i = 0; i < settings.target_error.count; i++)
        if (plm_targets_parse(settings.target_error.text[i], time.target, &time.target_count, &error) != PLM_OK)
            return plm_usage_error(&plm_command_measure, "--target-error: %s", error.message);
    if ((time.seconds > 0 || time.target_count) && settings.points)
        return plm_usage_error(
            &plm_command_measure,
            "--points says how many points are looked at; leave it out, or --time-budget and --target-error");
    if (!settings.correction != !settings.share || (settings.correction && !settings.output))
        return plm_usage_error(&plm_command_measure,
                               "--visibility-correction, --visible-share and --output go together");
    visibility correction = {0};
    plm_status status = PLM_OK;
    if (settings.correction) status = visibility_read(settings.correction, settings.share, &correction, &error);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    if (settings.threads) omp_set_num_threads(settings.threads);
    batch_tally tally = {0};
    status = run_batch(&settings, &correction, &measure, &time, argv, (size_t)argc, &tally, &error);
    visibility_free(&correction);
    return status == PLM_OK ? exit_code(&tally, (size_t)argc) : plm_report_failure(status, &error);
}

const plm_command plm_command_measure = {
    .name = "measure",
    .arguments = "[OPTION]... CLOUD...",
    .summary = "measure the plants in each CLOUD",
    .description =
        "A CLOUD is one plant: a PLY, PCD, LAS or text file, or a PLY of 3D gaussians; - is standard input. "
        "Its file name "
        "becomes the plant's name. traits.csv has a row for each trait of each organ, with unit, standard "
        "error and status; "
        "plants.csv has a row for each plant; run.json records what was read and what was run; report.html "
        "shows it all on one page.\n\n"
        "A batch that was ended goes on where it was: plants that the folder holds already, from the same "
        "bytes and with the "
        "same options, are not measured again. One bad file does not stop the others; its row says why.\n\n"
        "--time-budget and --target-error replace --effort: passes over more and more points, until the time is "
        "used or the errors are reached; both together end with what comes first. run.json records the passes. "
        "Values that the time did not allow are empty, with that reason; the exit code is then 1, as where a "
        "target error was not reached.",
    .options = options,
    .option_count = COUNT(options),
    .shared = reading_options,
    .shared_count = READING_OPTION_COUNT,
    .shared_offset = offsetof(measure_settings, reading),
    .run = run};
