/* selftest/selftest.h: what the installed program can show of itself: hard cases with known answers.
 *
 * Joins cloud/, io/, segment/, mesh/ and traits/; only the tool knows it. References are closed forms over numbers that
 * binary holds exactly, or a longer arithmetic; no file is read. */
#ifndef PLANTIMETER_SELFTEST_SELFTEST_H
#define PLANTIMETER_SELFTEST_SELFTEST_H

#include "../cloud/cloud.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a check found. */
typedef enum plm_verdict {
    PLM_VERDICT_WITHIN = 0, /**< error <= bound */
    PLM_VERDICT_SAID_WHY,   /**< no value, and a message that says why: right where nothing is determined */
    PLM_VERDICT_BEYOND,     /**< error > bound, or a value that is no number: a defect */
    PLM_VERDICT_COUNT
} plm_verdict;

/** "within", "said why" or "BEYOND". */
PLM_API const char *plm_verdict_name(plm_verdict verdict);

/** One case times one trait or function. */
typedef struct plm_check {
    char scene[64];          /**< the case: "needle, aspect 1e+06", "arc of 30 deg, noise 0.1" */
    char measure[40];        /**< the trait or function: "leaf_area", "hull volume" */
    double found, reference; /**< SI; NAN where there is none */
    double error;            /**< |found - reference| over |reference|, or over the case's own scale where that is 0 */
    double condition; /**< of the problem: relative change of the result by relative change of the data; NAN: none */
    double bound;     /**< that the error is held to */
    plm_verdict verdict;
    char note[128]; /**< the message in place of a value, or where the bound is from; may be "" */
} plm_check;

/** A growing table of checks. Zero it first. */
typedef struct plm_check_table {
    size_t count, room;
    plm_check *check;
} plm_check_table;

/** Runs the cases of stability: needles, offsets, units, grids, duplicates, few points, equal eigenvalues, arcs, odd
 * plants, broken numbers, places on the earth. Appends to table (zeroed, or with earlier checks), which is the caller's
 * (plm_check_table_free) whatever comes back. only: the name of the one group to run; NULL: all. progress (may be NULL)
 * is told each group's name. Some seconds.
 * PLM_E_MEMORY, PLM_E_LIBRARY, PLM_E_ARGUMENT (no such group); cases that fail are rows, not errors. */
PLM_API plm_status plm_selftest_stability(plm_check_table *table, const char *only, void (*progress)(const char *group),
                                          plm_error *error);

/** Checks that are beyond their bounds. */
PLM_API size_t plm_check_defects(const plm_check_table *table);

PLM_API void plm_check_table_free(plm_check_table *table);

#ifdef __cplusplus
}
#endif
#endif
