/* tool/batch.h: many plants into one folder: their names, what an earlier run has done already, and the tables, which are
 * complete whenever the batch is ended. */
#ifndef PLANTIMETER_TOOL_BATCH_H
#define PLANTIMETER_TOOL_BATCH_H

#include "reports/results.h"

/** A batch under way. */
typedef struct batch {
    const char *folder;  /* NULL: nothing is written */
    json_t *options;     /* those that change results */
    plm_results results; /* of earlier runs and of this one */
    size_t input_count;
    char **plant_id; /* of each input */
    double saved_at, save_seconds;
} batch;

/** Names the plants, makes the folder and reads what it holds. options is taken over, also on failure.
 * folder   NULL: nothing is written and nothing read.
 * force    the inputs are measured anew whatever the folder holds; other plants in it stay where the options are the same.
 * PLM_E_WRITE  the folder cannot be made, or holds results of other options or of another version. */
plm_status batch_open(batch *made, const char *folder, json_t *options, bool force, char *const *input,
                      size_t input_count, plm_error *error);

/** Whether the input was measured already, with all its files in place. PLM_E_WRITE when the folder holds a plant of this
 * name from another file. */
plm_status batch_has(const batch *open, size_t input, const char *sha256, bool *has, plm_error *error);

/** "FOLDER/PLANT" + ending in path. PLM_E_WRITE when it does not fit. */
plm_status batch_path(const batch *open, size_t input, const char *ending, char *path, size_t room, plm_error *error);

/** Adds a plant's results; record is taken over. The tables are written now and then, so that a killed batch loses little. */
plm_status batch_add(batch *open, size_t input, const plm_plant_report *report, json_t *record, plm_error *error);

/** Writes the tables. */
plm_status batch_save(batch *open, plm_error *error);

void batch_close(batch *open);

#endif
