/* tool/tradeoff.h: what the parts of the `tradeoff` sub-command share: plants with truth, the grid of settings, runs in child
 * processes, and the table of error against cost.
 *
 * This process reads no cloud and starts no thread before the last child has ended: each run's peak memory is its own, and a
 * run that crashes, or is out of time or memory, costs one row. */
#ifndef PLANTIMETER_TOOL_TRADEOFF_H
#define PLANTIMETER_TOOL_TRADEOFF_H

#include "tool/reading.h"

enum { TRADEOFF_PATH = 4096, TRADEOFF_NAME = 64, TRADEOFF_TEXT = 96, TRADEOFF_WHY = 160, TRADEOFF_GROUPS = 32 };

typedef struct tradeoff_settings {
    reading_settings reading;
    const char *output, *truth, *kinds, *scanners, *noises, *traits, *points, *target, *competitors;
    int count, cloud_points, repeats, limit, threads;
    uint64_t seed;
    bool is_quick, is_quiet;
} tradeoff_settings;

/** Which of the cloud's points are which organ: found by the program, or given with the cloud. */
typedef enum tradeoff_labels { TRADEOFF_OWN = 0, TRADEOFF_GIVEN, TRADEOFF_LABELS } tradeoff_labels;

/** "own" or "given". */
const char *tradeoff_labels_name(tradeoff_labels labels);

/** A value of an organ (-1: of the plant). SI. */
typedef struct tradeoff_value {
    int32_t trait; /* row of the trait table */
    int32_t organ_id;
    double value, std_error;
} tradeoff_value;

/** A plant and what is known of it: true values, or those of the finest setting. */
typedef struct tradeoff_plant {
    char name[TRADEOFF_NAME], cloud[TRADEOFF_PATH];
    char labelled[TRADEOFF_PATH]; /* cloud with the given labels; "" where there is none */
    char label_field[TRADEOFF_NAME];
    size_t point_count;
    double metres_per_unit;
    tradeoff_value *truth;
    size_t truth_count;
} tradeoff_plant;

/** One row of the grid. */
typedef struct tradeoff_setting {
    char method[TRADEOFF_NAME], text[TRADEOFF_TEXT];
    char rival[TRADEOFF_TEXT]; /* the competitor's own setting; "" of ours */
    tradeoff_labels labels;
    size_t points;     /* looked at; 0: all */
    int neighbours;    /* 0: the default */
    double alpha;      /* times the median of the leaves' alphas as found; 0: found out for each place */
    unsigned needs;    /* only traits that have one of these needs; 0: any */
    const bool *gives; /* competitors: the traits that the method gives; NULL: ours, all */
} tradeoff_setting;

/** Traits that need the same stages are one run. */
typedef struct tradeoff_group {
    unsigned stages, needs;
    char list[2048]; /* of --traits */
} tradeoff_group;

/** One setting on one plant, for one group of traits. */
typedef struct tradeoff_run {
    size_t plant, setting, group;
    bool is_good;
    char why[TRADEOFF_WHY]; /* where it is not */
    double seconds;         /* median of the repeats */
    uint64_t peak_bytes;    /* largest of the repeats */
    size_t points;          /* looked at */
    double leaf_alpha;      /* median over leaves, m; NAN where no surface was made */
    tradeoff_value *value;
    size_t value_count;
} tradeoff_run;

/** One row of tradeoff.csv. Errors in % of the true value, of angles in degrees. */
typedef struct tradeoff_row {
    const plm_trait *trait;
    size_t setting, plants, count, missing, failed;
    double points, error, half_interval, low, high, median_error, seconds;
    uint64_t peak_bytes;
    bool takes_part, is_on_front;
} tradeoff_row;

/** The competitors' program: its methods are told by itself. */
typedef struct tradeoff_rival {
    char method[TRADEOFF_NAME], setting[TRADEOFF_TEXT];
    bool *gives; /* a trait of the table each */
} tradeoff_rival;

/** All of a study. */
typedef struct tradeoff {
    const tradeoff_settings *settings;
    bool has_truth;
    char program[TRADEOFF_PATH]; /* the competitors'; "" where there is none */
    size_t plant_count, setting_count, group_count, run_count, row_count, rival_count;
    tradeoff_plant *plant;
    tradeoff_setting *setting;
    tradeoff_group group[TRADEOFF_GROUPS];
    tradeoff_run *run; /* plant after plant */
    size_t *run_place; /* by plant, setting of the grid and group: number of the run from 1 on, 0 for none */
    size_t grid_count; /* settings that were run */
    tradeoff_row *row;
    tradeoff_rival *rival;
    bool *is_wanted; /* a trait of the table each */
} tradeoff;

/* ---- Plants (tradeoff_plants.c) ------------------------------------------------------------------------------------ */

/** Grows and scans the plants of --simulate into DIR/plants, or takes the clouds that are named, with --truth. Gives an exit
 * code, PLM_EXIT_GOOD when all went well; what is wrong has been told. */
int tradeoff_find_plants(tradeoff *study, char *const *cloud, size_t count);

/** Reads the truth of a plant from a file of `simulate`. truth is the caller's. PLM_E_READ, PLM_E_FORMAT (file, line, what is
 * missing). */
plm_status tradeoff_read_truth(const char *path, tradeoff_value **truth, size_t *count, plm_error *error);

/* ---- The grid (tradeoff_grid.c) ------------------------------------------------------------------------------------- */

/** Checks --traits and --points. PLM_E_ARGUMENT. */
plm_status tradeoff_check_lists(const tradeoff_settings *settings, plm_error *error);

/** Chooses the traits, makes the groups and the grid. PLM_E_FORMAT: the truth has none of the traits. */
plm_status tradeoff_make_grid(tradeoff *study, plm_error *error);

/** Appends a row to the grid; NULL: no memory. */
tradeoff_setting *tradeoff_add_setting(tradeoff *study, const char *method, plm_error *error);

/** Whether a setting has anything to do with a trait. */
bool tradeoff_applies(const tradeoff_setting *setting, size_t trait);

/* ---- Runs (tradeoff_run.c, tradeoff_rivals.c) ------------------------------------------------------------------------- */

/** Everything on everything. Runs that fail say why in their row; PLM_OK all the same. */
plm_status tradeoff_run_all(tradeoff *study, plm_error *error);

/** Reads the cloud once: its points, unit and field of labels. PLM_E_READ, PLM_E_FORMAT. */
plm_status tradeoff_probe(const tradeoff *study, tradeoff_plant *plant, plm_error *error);

/** Measures a plant with all its points, takes the values as its truth, and writes the cloud labelled to path. */
plm_status tradeoff_measure_reference(const tradeoff *study, tradeoff_plant *plant, const char *path, plm_error *error);

/** Finds the competitors' program and asks for its methods. is_there: out. PLM_E_ARGUMENT: a program that was named is none. */
plm_status tradeoff_find_rivals(tradeoff *study, bool *is_there, plm_error *error);

/** One method of the competitors' program on one plant; fills the run's figures and values. */
plm_status tradeoff_run_rival(const tradeoff *study, const tradeoff_plant *plant, const tradeoff_setting *setting,
                              tradeoff_run *run, plm_error *error);

/** Calls work(user, fd) in a child process, at most limit seconds (0: any), and gives what it wrote to fd, ended by a zero byte
 * (the caller's; size without it). A child that did not end well gives PLM_E_LIBRARY and why in error. */
plm_status tradeoff_in_child(int (*work)(void *user, int fd), void *user, unsigned limit, char **output, size_t *size,
                             plm_error *error);

/** The run of a plant, setting and group, or NULL. */
const tradeoff_run *tradeoff_find_run(const tradeoff *study, size_t plant, size_t setting, size_t group);

/** The group that a trait is measured in; competitors have no groups (0). */
size_t tradeoff_group_of(const tradeoff *study, const tradeoff_setting *setting, size_t trait);

/* ---- What it comes to (tradeoff_score.c, tradeoff_write.c) -------------------------------------------------------------- */

/** Makes the rows: errors with intervals, cost, and the front of each trait and kind of labels. */
plm_status tradeoff_score(tradeoff *study, plm_error *error);

/** Pairs of values and truth of one trait and setting. */
typedef struct tradeoff_pairs {
    double *difference,
        *truth;   /* of angles in degrees over 100, so that the mean of |difference| / |truth| in % is in degrees */
    double *size; /* of each error, in % or degrees */
    uint32_t *plant;
    size_t count;
    double told; /* sum of the reference's standard errors, as sizes */
} tradeoff_pairs;

/** Room for all pairs of any trait of a study. The caller's: tradeoff_pairs_free. */
plm_status tradeoff_pairs_make(const tradeoff *study, tradeoff_pairs *pairs, plm_error *error);
void tradeoff_pairs_free(tradeoff_pairs *pairs);

/** Gathers the pairs of a trait and setting over all plants; the row has what was counted, with sums for the means of cost. */
tradeoff_row tradeoff_gather(const tradeoff *study, size_t trait, size_t setting, tradeoff_pairs *pairs);

plm_status tradeoff_add_row(tradeoff *study, const tradeoff_row *row, plm_error *error);

/** Marks the fronts of the rows from first on, which are one trait's: one for each kind of labels. */
plm_status tradeoff_mark_fronts(tradeoff *study, size_t first, plm_error *error);

/** Adds rows for the number of resamples of `validate`'s bootstrap intervals (tradeoff_bootstrap.c). */
plm_status tradeoff_score_bootstrap(tradeoff *study, plm_error *error);

/** Writes tradeoff.csv and, for each trait, tradeoff_TRAIT.gp with its SVG and PNG; is_drawn false where there is no gnuplot. */
plm_status tradeoff_write(const tradeoff *study, bool *is_drawn, plm_error *error);

/** Checks --target. PLM_E_ARGUMENT. */
plm_status tradeoff_check_target(const char *text, plm_error *error);

/** Prints, for each trait, the cheapest setting that reaches the target. */
void tradeoff_print(const tradeoff *study);

void tradeoff_free(tradeoff *study);

#endif
