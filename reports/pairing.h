/* reports/pairing.h: which estimate belongs to which manual measurement. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_PAIRING_H
#define PLANTIMETER_REPORTS_PAIRING_H

#include "cloud/cloud.h"

/** One reading of one trait: a row of traits.csv or of a manual table. Strings are the owner's tables'. */
typedef struct plm_reading {
    const char *plant_id, *organ, *organ_id, *trait, *unit;
    double value;
    bool has_position;
    double position[3];
    const char *group;   /**< name of the group of `--by`, "" for none */
    size_t repeat_count; /**< readings of the same thing that value is the mean of */
} plm_reading;

typedef enum plm_match {
    PLM_MATCH_AUTO =
        0, /**< by number where the manual table has one, else by position, else by plant where it is alone */
    PLM_MATCH_ID,
    PLM_MATCH_POSITION, /**< one-to-one with the least total distance between centroids */
    PLM_MATCH_RANK      /**< sorted by value within plant, organ and trait: order statistics, only when asked for */
} plm_match;

/** One matched pair: rows of the two lists. */
typedef struct plm_match_pair {
    size_t estimate, manual;
} plm_match_pair;

/** Pairs readings of equal plant, organ and trait. pair: out, min(estimates, manuals) long at the most; used_*: out, which
 * rows found a partner. Each reading is used at most once; the result does not depend on the order of rows but for ties.
 * PLM_E_MEMORY. */
plm_status plm_match_readings(const plm_reading *estimate, size_t estimate_count, const plm_reading *manual,
                              size_t manual_count, plm_match match, plm_match_pair *pair, size_t *pair_count,
                              bool *used_estimate, bool *used_manual, plm_error *error);

/** Least-cost assignment of rows to columns (rows <= columns), row-major cost: column[row] is each row's. The shortest
 * augmenting path method (R. Jonker and A. Volgenant 1987), O(rows^2 columns). */
plm_status plm_assign(const double *cost, size_t rows, size_t columns, size_t *column, plm_error *error);

/** Factor that turns a value of unit `from` into unit `to` ("mm", "cm", "m", "mm2", "cm2", "m2", "mm3", "cm3", "m3", "l",
 * "deg", "rad", "1", "%", "W"); 0 when the two are not of one kind. */
double plm_unit_conversion(const char *from, const char *to);

#endif
