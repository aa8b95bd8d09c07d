/* tool/plant_run.h: one plant of a batch: read, measured, written, recorded. */
#ifndef PLANTIMETER_TOOL_PLANT_RUN_H
#define PLANTIMETER_TOOL_PLANT_RUN_H

#include "tool/batch.h"
#include "tool/reading.h"
#include "traits/anytime.h"

/** How long a plant's run may take, and the errors that it should come to. All zero: as long as it takes. */
typedef struct plant_time {
    double begin; /* when the process began, plm_seconds_now */
    double seconds;
    size_t target_count;
    plm_target target[PLM_MOST_TARGETS];
} plant_time;

/** What became of a plant. */
typedef struct plant_outcome {
    plm_status status;
    bool fell_short; /* values are missing for want of time, or a target error was not reached */
    bool no_page;    /* no time is left for report.html */
} plant_outcome;

/** What a plant's run needs beside its input. */
typedef struct plant_run_options {
    const reading_settings *reading;
    const plm_measure_options *measure;
    const plant_time *time;
    double begin;    /* when the plant's time began */
    bool with_page;  /* report.html is this plant's alone, and counts */
    bool with_files; /* labelled cloud, meshes and picture too */
    size_t views;    /* and of so many first inputs what the report's 3D view shows */
    bool quiet;
} plant_run_options;

/** Measures input number `input` of the batch from path (its bytes have the digest sha256, "" for unknown) and adds it to the batch's results. A plant that cannot be read or
 * measured is a result as well: outcome->status and a row say why, and PLM_OK comes back. What is not PLM_OK ends the batch:
 * the output cannot be written, or no memory is left for the tables. */
plm_status run_plant(batch *open, size_t input, const char *path, const char *sha256, const plant_run_options *options,
                     plant_outcome *outcome, plm_error *error);

#endif
