/* reports/run_json.h: run.json, the record of a run: what was read, what ran, how long it took, what to beware of.
 * Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_RUN_JSON_H
#define PLANTIMETER_REPORTS_RUN_JSON_H

#include "io/json_file.h"
#include "reports/results.h"
#include "traits/anytime.h"

/** How a plant's time was used, where it was limited or an error was to be reached. */
typedef struct plm_run_time {
    double asked, used; /**< seconds; asked 0: no limit */
    size_t target_count;
    const plm_target *target;
    const plm_anytime_record *record; /**< NULL where nothing was measured */
    size_t left_out_count;
    const char *left_out[8]; /**< outputs that the time did not allow */
} plm_run_time;

/** What is known of one plant's run beside its measurement. Strings are the caller's. */
typedef struct plm_run_plant {
    const plm_plant_report *report;
    const char *input;           /**< as the user named it */
    const char *sha256;          /**< "" where the input could not be read */
    const plm_read_report *read; /**< NULL where the input could not be read */
    size_t point_count;
    double metres_per_unit;
    const char *unit_evidence; /**< "given", "guessed: ...", ... */
    const plm_run_time *time;  /**< NULL: any time, no target */
    double read_seconds, write_seconds;
    uint64_t read_peak_bytes, write_peak_bytes;
    size_t warning_count;
    char (*warning)[256]; /**< of reading and writing; those of the measurement come with it */
    size_t file_count;
    char (*file)[64 + 256]; /**< names of the files written beside the tables */
} plm_run_plant;

/** The plant's object in run.json, the caller's (json_decref). */
plm_status plm_run_plant_json(const plm_run_plant *plant, json_t **object, plm_error *error);

/** Writes run.json: version, options (an object, not taken over) and the records of the results. */
plm_status plm_run_json_write(const char *path, json_t *options, const plm_results *results, plm_error *error);

/** Reads a run.json; *root is the caller's. PLM_E_READ, PLM_E_FORMAT (line and what is wrong there). */
plm_status plm_run_json_read(const char *path, json_t **root, plm_error *error);

/** The results as one object for `--json`: version, plants with their values. The caller's. */
plm_status plm_results_json(const plm_results *results, json_t **object, plm_error *error);

#endif
