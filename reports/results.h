/* reports/results.h: the results of a run, light enough for thousands of plants, and the tables made from them.
 * Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_RESULTS_H
#define PLANTIMETER_REPORTS_RESULTS_H

#include "reports/reports.h"

#include <jansson.h>

/** One row of traits.csv. */
typedef struct plm_result_row {
    const plm_trait *trait;
    int32_t organ_id;        /**< -1: none */
    double position[3];      /**< the organ's centroid in the coordinates of the input, metres; NAN: none */
    double value, std_error; /**< in the trait's unit; NAN: none */
    size_t point_count;
    char *status;       /**< "ok", "ok;flag;flag", "not_applicable" or "failed"; the row's own block */
    const char *reason; /**< in the block of status, as method is */
    const char *method;
} plm_result_row;

/** One plant. Strings are its own. */
typedef struct plm_result {
    char *plant_id;
    size_t rank;   /**< place among the inputs: the order of the tables */
    char *failure; /**< why there are no rows; NULL when there are */
    bool has_place;
    double longitude, latitude; /**< degrees */
    size_t row_count;
    plm_result_row *row;
    json_t *record; /**< its object in run.json, or NULL */
} plm_result;

/** The results of a run. All zero: none. */
typedef struct plm_results {
    size_t count, room;
    plm_result *plant; /**< sorted by rank */
} plm_results;

/** Turns a measured plant into rows; the report is not needed afterwards. record is taken over, also on failure. */
plm_status plm_results_add(plm_results *results, const plm_plant_report *report, size_t rank, json_t *record,
                           plm_error *error);

/** The plant of a name, or NULL. */
plm_result *plm_results_find(const plm_results *results, const char *plant_id);

/** The plant's row of a plant-level trait, or NULL. */
const plm_result_row *plm_result_find(const plm_result *plant, const char *trait);

/** Takes a plant out and frees it. */
void plm_results_remove(plm_results *results, plm_result *plant);

void plm_results_free(plm_results *results);

/** Whether the trait is told of whole plants: of level plant, or of the main stem (diameter and length). */
bool plm_trait_of_plant(const plm_trait *trait);

/** The row of such a trait (organ 0 of a stem's trait) where it holds a value, or NULL. */
const plm_result_row *plm_result_of_plant(const plm_result *plant, const plm_trait *trait);

/** Name of a trait's column in wide tables: "plant_height_mm", "leaf_count". */
void plm_trait_column(const plm_trait *trait, char *name, size_t room);

/** Whether the row holds a value. */
bool plm_result_row_is_ok(const plm_result_row *row);

/** Writes traits.csv and plants.csv (reports.h). */
plm_status plm_results_write_traits(const plm_results *results, const char *path, plm_error *error);
plm_status plm_results_write_plants(const plm_results *results, const char *path, plm_error *error);

/** Reads the rows of traits.csv, as this version writes it, for the plants that results hold without rows; rows of other
 * plants are passed over. PLM_E_FORMAT, PLM_E_READ. */
plm_status plm_results_read_traits(plm_results *results, const char *path, plm_error *error);

/** Adds a plant without rows, as a beginning of reading results back. record is taken over, also on failure. */
plm_status plm_results_add_empty(plm_results *results, const char *plant_id, size_t rank, json_t *record,
                                 plm_error *error);

/** Adds the plants that a run.json (its root) records, still without their rows: those that were measured, and with_failed those
 * that were not, with their reason. rank: gives a plant's rank; NULL: their order in the record. */
plm_status plm_results_take_records(plm_results *results, const json_t *root, bool with_failed,
                                    size_t (*rank)(const void *user, const char *plant_id), const void *user,
                                    plm_error *error);

/** Reads the results of a run from its folder: run.json (its root: out, may be NULL; the caller's) and traits.csv.
 * PLM_E_READ, PLM_E_FORMAT; what was read is the caller's even then. */
plm_status plm_results_read_folder(plm_results *results, const char *folder, json_t **root, plm_error *error);

/** Gives a row its status, reason and method, copied into one block of its own. */
plm_status plm_result_row_texts(plm_result_row *row, const char *status, const char *reason, const char *method,
                                plm_error *error);

/** Names of the flags of a bit set, each behind a semicolon, appended to text of the given room. */
void plm_flags_text(unsigned flags, char *text, size_t room);

#endif
