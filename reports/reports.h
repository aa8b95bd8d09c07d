/* reports/reports.h: tables, pictures and the record of a run, from measured traits.
 *
 * Knows cloud/, io/ and traits/ results only. Every file is written beside its target and renamed. */
#ifndef PLANTIMETER_REPORTS_REPORTS_H
#define PLANTIMETER_REPORTS_REPORTS_H

#include "../io/io.h"
#include "../traits/traits.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One measured plant of a run, as the tables show it. Strings are the caller's. */
typedef struct plm_plant_report {
    const char *plant_id;
    const plm_measurement *measurement;   /**< NULL when the plant failed */
    const char *failure;                  /**< why, when it failed */
    const plm_georeference *georeference; /**< NULL when there is none */
} plm_plant_report;

/** Writes the long table (design: traits.csv): plant_id, organ, organ_id, x, y, z, trait, value, unit, std_error,
 * n_points, status, reason, method. */
PLM_API plm_status plm_write_traits_csv(const char *path, const plm_plant_report *plants, size_t count,
                                        plm_error *error);

/** Writes the wide table (plants.csv): one row a plant, a column a plant-level trait named trait_unit, leaf_count and
 * status. */
PLM_API plm_status plm_write_plants_csv(const char *path, const plm_plant_report *plants, size_t count,
                                        plm_error *error);

/** Draws a plant (side view, top view, organs in colours, traits printed beside) as a PNG. */
PLM_API plm_status plm_write_picture(const char *path, const plm_plant_report *plant, plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
