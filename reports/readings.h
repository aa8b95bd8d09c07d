/* reports/readings.h: lists of readings from tables: traits.csv of a run, manual tables, Field Book's database export.
 * Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_READINGS_H
#define PLANTIMETER_REPORTS_READINGS_H

#include "reports/csv_table.h"
#include "reports/pairing.h"

/** Against what a manual table's inclinations were taken. */
typedef enum plm_manual_angle { PLM_ANGLE_ZENITH = 0, PLM_ANGLE_HORIZONTAL, PLM_ANGLE_STEM } plm_manual_angle;

/** Readings of one table. Strings point into the tables and into name. The caller's (plm_readings_free). */
typedef struct plm_readings {
    plm_table table;
    plm_reading *reading;
    double *std_error; /**< of each reading, NAN where the table has none */
    size_t count;
    size_t skipped;       /**< rows without a value (not_applicable, failed, NA) */
    size_t repeat_rows;   /**< rows that were repeats of another */
    double *repeat_value; /**< every row before repeats were averaged: value and which reading it went into */
    uint32_t *repeat_reading;
    size_t repeat_total;
} plm_readings;

/** Reads a table of readings. Columns: plant_id, organ, organ_id, trait, value, unit, and where they are there x, y, z,
 * std_error, status (rows whose status is not ok are skipped). Field Book's database export is recognised by its columns trait
 * and value without plant_id: its first column is the plant, the trait may end in its unit (`plant_height_mm`), and values of
 * other traits that are no numbers (scores, photos) are skipped. An empty
 * organ is the level of the trait in the trait table; an empty unit is the trait's unit there. Rows of the same plant,
 * organ, number and trait are repeats: their mean counts once.
 * PLM_E_FORMAT names file, line and column of what cannot be understood. */
plm_status plm_readings_load(const char *path, plm_readings *readings, plm_error *error);

void plm_readings_free(plm_readings *readings);

/** Brings inclinations of a manual table to the convention of ours (from the zenith): HORIZONTAL: 90 - value; STEM: the
 * readings are insertion angles, so their trait becomes leaf_insertion_angle. */
void plm_readings_convert_angles(plm_readings *readings, plm_manual_angle convention);

/** Sets each reading's group from a metadata table (plant_id and any columns): the values of the named columns
 * (comma-separated), joined by '/'. Plants that it does not know get "". names: out, a block that the groups point
 * into; free it with plm_free after the readings. PLM_E_ARGUMENT names a column that is not there. */
plm_status plm_readings_group(plm_readings *readings, const plm_table *metadata, const char *columns, char **names,
                              plm_error *error);

#endif
