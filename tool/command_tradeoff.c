/* tool/command_tradeoff.c: the `tradeoff` sub-command: what a faster setting costs in accuracy. */
#include "io/io.h"
#include "tool/tradeoff.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define AT(field) .offset = offsetof(tradeoff_settings, field)

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write here (required)",
     .kind = PLM_OPTION_TEXT,
     AT(output)},
    {.name = "truth",
     .argument = "JSON",
     .help = "true values of the CLOUD, or an index of plants with their clouds and truths, as `simulate` writes them",
     .kind = PLM_OPTION_TEXT,
     AT(truth)},
    {.name = "simulate",
     .argument = "KINDS",
     .help = "grow and scan plants of these kinds (see `simulate`), separated by commas, instead of reading a CLOUD",
     .kind = PLM_OPTION_TEXT,
     AT(kinds)},
    {.name = "scanners",
     .argument = "LIST",
     .help = "with --simulate: of dome, rgbd, uniform, splat (default: dome)",
     .kind = PLM_OPTION_TEXT,
     AT(scanners)},
    {.name = "noise",
     .argument = "LIST",
     .help = "with --simulate: standard deviations in mm, e.g. 0,0.5 (default: the scanner's own)",
     .kind = PLM_OPTION_TEXT,
     AT(noises)},
    {.letter = 'n',
     .name = "count",
     .argument = "COUNT",
     .help = "with --simulate: plants of each kind, scanner and noise (default: 1)",
     .kind = PLM_OPTION_INTEGER,
     AT(count),
     .minimum = 1,
     .maximum = 1000},
    {.name = "cloud-points",
     .argument = "N",
     .help = "with --simulate: points on each plant (default: 60000)",
     .kind = PLM_OPTION_INTEGER,
     AT(cloud_points),
     .minimum = 100,
     .maximum = 100000000},
    {.name = "seed",
     .argument = "N",
     .help = "of plants and bootstrap (default: 1)",
     .kind = PLM_OPTION_SEED,
     AT(seed)},
    {.letter = 't',
     .name = "traits",
     .argument = "LIST",
     .help = "only these traits, as in `measure` (default: all that have a true value)",
     .kind = PLM_OPTION_TEXT,
     AT(traits)},
    {.name = "points",
     .argument = "LIST",
     .help = "numbers of points to look at; all points come by themselves (default: 1000 to 5000000 in steps of 1, 2, "
             "5)",
     .kind = PLM_OPTION_TEXT,
     AT(points)},
    {.name = "target",
     .argument = "LIST",
     .help = "print the cheapest setting that reaches this error, e.g. 2%,1deg,leaf_area=3% (default: 5%,2deg)",
     .kind = PLM_OPTION_TEXT,
     AT(target)},
    {.name = "competitors",
     .argument = "PATH|none",
     .help = "the program that runs plain library methods (default: plantimeter-competitors beside this program)",
     .kind = PLM_OPTION_TEXT,
     AT(competitors)},
    {.name = "repeats",
     .argument = "N",
     .help = "of each run; the seconds are their median; a setting that has taken 10 s is not repeated (default: 3)",
     .kind = PLM_OPTION_INTEGER,
     AT(repeats),
     .minimum = 1,
     .maximum = 100},
    {.name = "limit",
     .argument = "SECONDS",
     .help = "end a run after this time; its row counts as failed (default: 60)",
     .kind = PLM_OPTION_INTEGER,
     AT(limit),
     .minimum = 1,
     .maximum = 1000000},
    {.name = "threads",
     .argument = "N",
     .help = "of each run (default: 1: seconds are processor time, which other programs hardly change; with more they "
             "are wall time)",
     .kind = PLM_OPTION_INTEGER,
     AT(threads),
     .minimum = 1,
     .maximum = 1024},
    {.name = "quick",
     .help = "a small grid, run once: 2000, 10000, 50000 and all points; alpha as found",
     .kind = PLM_OPTION_FLAG,
     AT(is_quick)},
    {.letter = 'q', .name = "quiet", .help = "print nothing but errors", .kind = PLM_OPTION_FLAG, AT(is_quiet)},
};

void tradeoff_free(tradeoff *study)
{
    for (size_t i = 0; i < study->plant_count; i++) plm_free(study->plant[i].truth);
    for (size_t i = 0; i < study->run_count; i++) plm_free(study->run[i].value);
    for (size_t i = 0; i < study->rival_count; i++) plm_free(study->rival[i].gives);
    plm_free(study->plant);
    plm_free(study->setting);
    plm_free(study->run);
    plm_free(study->run_place);
    plm_free(study->row);
    plm_free(study->rival);
    plm_free(study->is_wanted);
    *study = (tradeoff){0};
}

static size_t count_failures(const tradeoff *study)
{
    size_t failed = 0;
    for (size_t i = 0; i < study->run_count; i++) failed += !study->run[i].is_good;
    return failed;
}

static void tell_end(const tradeoff *study, bool is_drawn)
{
    const size_t failed = count_failures(study);
    const char *folder = study->settings->output;
    if (!is_drawn) fprintf(stderr, "plantimeter: gnuplot is not installed; the plots' scripts are in %s\n", folder);
    if (study->settings->is_quiet) return;
    tradeoff_print(study);
    if (failed) printf("%zu of %zu runs failed: %s/failures.csv says why\n", failed, study->run_count, folder);
    printf("%zu plants, %zu settings, %zu runs: tradeoff.csv and plots in %s\n", study->plant_count,
           study->setting_count, study->run_count, folder);
}

/* From plants to tables. Gives the exit code. */
static int do_study(tradeoff *study)
{
    plm_error error = {0};
    bool has_rivals = false, is_drawn = true;
    plm_status status = tradeoff_find_rivals(study, &has_rivals, &error);
    const tradeoff_settings *settings = study->settings;
    if (status == PLM_OK && !has_rivals && !settings->competitors && !settings->is_quiet)
        fprintf(stderr, "plantimeter: plantimeter-competitors is not beside this program: no plain library methods\n");
    if (status == PLM_OK) status = tradeoff_make_grid(study, &error);
    if (status == PLM_OK) status = tradeoff_run_all(study, &error);
    if (status == PLM_OK) status = tradeoff_score(study, &error);
    if (status == PLM_OK && !settings->is_quick) status = tradeoff_score_bootstrap(study, &error);
    if (status == PLM_OK) status = tradeoff_write(study, &is_drawn, &error);
    if (status != PLM_OK) return plm_report_failure(status, &error);
    tell_end(study, is_drawn);
    return PLM_EXIT_GOOD;
}

/* What can be checked before anything is done. */
static int check_usage(const tradeoff_settings *settings, int clouds)
{
    plm_error error = {0};
    if (!settings->output) return plm_usage_error(&plm_command_tradeoff, "--output is missing");
    if (settings->kinds && (clouds || settings->truth))
        return plm_usage_error(&plm_command_tradeoff,
                               "--simulate makes its own clouds and truth; leave out CLOUD and --truth");
    if (!settings->kinds && !settings->truth && clouds == 0)
        return plm_usage_error(&plm_command_tradeoff, "which CLOUD? or --truth INDEX, or --simulate KINDS");
    plm_status status = check_reading(&settings->reading, &error);
    if (status == PLM_OK) status = tradeoff_check_target(settings->target, &error);
    if (status == PLM_OK) status = tradeoff_check_lists(settings, &error);
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_usage_error(&plm_command_tradeoff, "%s", error.message);
}

static int run(int argc, char **argv)
{
    tradeoff_settings settings = {.count = 1,
                                  .cloud_points = 60000,
                                  .repeats = 3,
                                  .limit = 60,
                                  .threads = 1,
                                  .seed = 1,
                                  .scanners = "dome",
                                  .reading.minimum_opacity = 0.005};
    int code = plm_parse_options(&plm_command_tradeoff, &argc, argv, &settings);
    if (code >= 0) return code;
    code = check_usage(&settings, argc);
    if (code != PLM_EXIT_GOOD) return code;
    if (settings.is_quick) settings.repeats = 1;
    omp_set_num_threads(1); /* threads of this process would not be there in its children; these set their own number */
    plm_error error = {0};
    const plm_status made = plm_folder_make(settings.output, &error);
    if (made != PLM_OK) return plm_report_failure(made, &error);
    tradeoff study = {.settings = &settings};
    code = tradeoff_find_plants(&study, argv, (size_t)argc);
    if (code == PLM_EXIT_GOOD) code = do_study(&study);
    tradeoff_free(&study);
    return code;
}

const plm_command plm_command_tradeoff = {
    .name = "tradeoff",
    .arguments = "[OPTION]... -o DIR [CLOUD... | CLOUD --truth JSON | --simulate KINDS]",
    .summary = "what a faster setting costs in accuracy: error against run time, and the cheapest setting for an error",
    .description =
        "Measures plants whose traits are known with a grid of settings: points looked at, effort, alpha of leaf "
        "surfaces, and labels found by the program or given with the cloud; and by plain library methods, which get "
        "the "
        "given labels. DIR gets tradeoff.csv (trait, method, settings, points, error, error_ci, seconds, peak_bytes, "
        "...), failures.csv, and of each trait a plot of error against seconds on log axes, with the Pareto front of "
        "each kind of labels and its gnuplot script.\n\n"
        "error is the mean over organs and plants of the absolute difference from the truth, in % of it, of angles in "
        "degrees; error_ci is half of its 95 % interval (BCa bootstrap, plants drawn whole; organs below three "
        "plants). "
        "A CLOUD without --truth is compared with its own finest measurement, all points; error_ci is then 1.96 "
        "standard "
        "errors of that measurement, and a smaller error says nothing. Rows that measured fewer than 95 % of the "
        "organs "
        "that the best row of the trait measured are not on the front.\n\n"
        "Every run is a process of its own. seconds: of measuring alone, without reading, for the traits that need the "
        "same stages together, mean over plants of the median of repeats. peak_bytes: the process's largest resident "
        "memory with program and cloud, largest over plants.",
    .options = options,
    .option_count = COUNT(options),
    .shared = reading_options,
    .shared_count = READING_OPTION_COUNT,
    .shared_offset = offsetof(tradeoff_settings, reading),
    .run = run};
