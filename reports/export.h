/* reports/export.h: a run in the formats of breeders' systems. Internal to reports/ and tool/.
 *
 * Plants are the units of observation; leaves are none in BrAPI and MIAPPE, and stay in traits.csv. Exported are the traits of
 * the plant and those of its main stem (stem 0). */
#ifndef PLANTIMETER_REPORTS_EXPORT_H
#define PLANTIMETER_REPORTS_EXPORT_H

#include "reports/csv_table.h"
#include "reports/results.h"

/** One exported variable: trait, method and unit. */
typedef struct plm_export_variable {
    const plm_trait *trait;
    char column[96]; /**< "plant_height_mm" */
    char name[128];  /**< "plant_height_pointcloud_mm" */
    char id[128];    /**< the user's, or "plantimeter:" and the name */
    const char *accession, *trait_name, *entity, *entity_accession, *characteristic,
        *note; /**< "" where there is none */
} plm_export_variable;

typedef struct plm_export_options {
    const char *metadata; /**< CSV with plant_id and columns of the plants; NULL: none */
    const char *ontology; /**< CSV that adds to the shipped mapping or overrides it; NULL: none */
    const char *study;    /**< id of the study; NULL: none */
    const char *time;     /**< when the scans were made, ISO 8601, where the metadata have no date; NULL: unknown */
} plm_export_options;

/** What the writers share. */
typedef struct plm_export {
    plm_results results;
    json_t *root; /**< run.json */
    plm_table metadata, shipped, own;
    plm_export_options options;
    size_t variable_count;
    plm_export_variable *variable;
} plm_export;

/** Reads a run, the metadata and the mapping. PLM_E_READ, PLM_E_FORMAT; PLM_E_ARGUMENT: metadata without plant_id, two traits of
 * one variable id, or a variable id that stands for a measurement by hand (another method is another variable). */
plm_status plm_export_open(plm_export *made, const char *run, const plm_export_options *options, plm_error *error);
void plm_export_close(plm_export *bundle);

/** The shipped mapping (CSV). */
const char *plm_export_mapping(void);

/** The row of a variable of a plant where it holds a value, or NULL. */
const plm_result_row *plm_export_row(const plm_result *plant, const plm_export_variable *variable);

/** The metadata of a plant: the first of the named columns (comma-separated) that is there and not empty, or "". */
const char *plm_export_meta(const plm_export *bundle, const char *plant_id, const char *columns);
/** The plant's study and its germplasm, or "". */
const char *plm_export_study(const plm_export *bundle, const char *plant_id);
const char *plm_export_germplasm(const plm_export *bundle, const char *plant_id);
/** When the plant was scanned, or "". */
const char *plm_export_time(const plm_export *bundle, const char *plant_id);

/** One writer each, into a folder that exists. */
plm_status plm_export_field_book(const plm_export *bundle, const char *folder, plm_error *error);
plm_status plm_export_brapi(const plm_export *bundle, const char *folder, plm_error *error);
plm_status plm_export_miappe(const plm_export *bundle, const char *folder, plm_error *error);
plm_status plm_export_frictionless(const plm_export *bundle, const char *folder, plm_error *error);
plm_status plm_export_statgen(const plm_export *bundle, const char *folder, plm_error *error);

#endif
