/* tool/agreement_run.h: what `validate` and `compare` share: settings, running, telling. */
#ifndef PLANTIMETER_TOOL_AGREEMENT_RUN_H
#define PLANTIMETER_TOOL_AGREEMENT_RUN_H

#include "tool/command.h"

#include <stdint.h>

/** Settings of both commands. */
typedef struct agreement_settings {
    const char *output, *metadata, *by, *tolerance, *fail_if;
    int match, manual_angle; /* plm_match, plm_manual_angle */
    double variance_ratio;
    int resamples;
    uint64_t seed;
    bool quiet, plots, statistics;
} agreement_settings;

/** Options that both have. */
#define AGREEMENT_OPTIONS                                                                                              \
    {.letter = 'o',                                                                                                    \
     .name = "output",                                                                                                 \
     .argument = "DIR",                                                                                                \
     .help = "write agreement.csv, agreement.md, pairs.csv and unmatched.csv here (default: the current folder)",      \
     .kind = PLM_OPTION_TEXT,                                                                                          \
     .offset = offsetof(agreement_settings, output)},                                                                  \
        {.name = "by",                                                                                                 \
         .argument = "COLUMNS",                                                                                        \
         .help = "statistics for each group too: columns of the metadata, comma-separated",                            \
         .kind = PLM_OPTION_TEXT,                                                                                      \
         .offset = offsetof(agreement_settings, by)},                                                                  \
        {.name = "metadata",                                                                                           \
         .argument = "CSV",                                                                                            \
         .help = "table of plants: plant_id and the columns for --by",                                                 \
         .kind = PLM_OPTION_TEXT,                                                                                      \
         .offset = offsetof(agreement_settings, metadata)},                                                            \
        {.name = "tolerance",                                                                                          \
         .argument = "LIST",                                                                                           \
         .help = "what difference is as good as none, for the equivalence test: trait=number,... in the trait's unit", \
         .kind = PLM_OPTION_TEXT,                                                                                      \
         .offset = offsetof(agreement_settings, tolerance)},                                                           \
        {.name = "variance-ratio",                                                                                     \
         .argument = "RATIO",                                                                                          \
         .help = "error variance of the estimates over that of the manual values, for Deming (default 1)",             \
         .kind = PLM_OPTION_NUMBER,                                                                                    \
         .offset = offsetof(agreement_settings, variance_ratio),                                                       \
         .minimum = 1e-9,                                                                                              \
         .maximum = 1e9},                                                                                              \
        {.name = "resamples",                                                                                          \
         .argument = "N",                                                                                              \
         .help = "bootstrap resamples (default 2000)",                                                                 \
         .kind = PLM_OPTION_INTEGER,                                                                                   \
         .offset = offsetof(agreement_settings, resamples),                                                            \
         .minimum = 100,                                                                                               \
         .maximum = 1000000},                                                                                          \
        {.name = "seed",                                                                                               \
         .argument = "N",                                                                                              \
         .help = "of the bootstrap's random numbers (default 1)",                                                      \
         .kind = PLM_OPTION_SEED,                                                                                      \
         .offset = offsetof(agreement_settings, seed)},                                                                \
        {.name = "fail-if",                                                                                            \
         .argument = "CONDITIONS",                                                                                     \
         .help = "exit with 1 where one holds: 'leaf_area.mape>5,plant_height.r2<0.9'",                                \
         .kind = PLM_OPTION_TEXT,                                                                                      \
         .offset = offsetof(agreement_settings, fail_if)},                                                             \
        {.name = "plots",                                                                                              \
         .help = "draw each trait too (gnuplot): DIR/plots/TRAIT.svg and .png, with data and script",                  \
         .kind = PLM_OPTION_FLAG,                                                                                      \
         .offset = offsetof(agreement_settings, plots)},                                                               \
    {                                                                                                                  \
        .letter = 'q', .name = "quiet", .help = "print no table", .kind = PLM_OPTION_FLAG,                             \
        .offset = offsetof(agreement_settings, quiet)                                                                  \
    }

/** The defaults. */
#define AGREEMENT_DEFAULTS                                                                                             \
    {                                                                                                                  \
        .output = ".", .variance_ratio = 1, .resamples = 2000, .seed = 1                                               \
    }

/** Compares two tables, writes the results, prints the main ones. Gives the exit code. */
int agreement_run(const agreement_settings *settings, const char *estimates, const char *manual);

#endif
