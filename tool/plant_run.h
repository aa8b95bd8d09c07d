/* tool/plant_run.h: one plant of a batch: read, measured, written, recorded. */
#ifndef PLANTIMETER_TOOL_PLANT_RUN_H
#define PLANTIMETER_TOOL_PLANT_RUN_H

#include "tool/batch.h"
#include "tool/reading.h"

/** What a plant's run needs beside its input. */
typedef struct plant_run_options {
    const reading_settings *reading;
    const plm_measure_options *measure;
    bool with_files; /* labelled cloud, meshes and picture too */
    size_t views;    /* and of so many first inputs what the report's 3D view shows */
    bool quiet;
} plant_run_options;

/** Measures input number `input` of the batch from path (its bytes have the digest sha256, "" for unknown) and adds it to the batch's results. A plant that cannot be read or
 * measured is a result as well: *plant_status and a row say why, and PLM_OK comes back. What is not PLM_OK ends the batch:
 * the output cannot be written, or no memory is left for the tables. */
plm_status run_plant(batch *open, size_t input, const char *path, const char *sha256, const plant_run_options *options,
                     plm_status *plant_status, plm_error *error);

#endif
