/* reports/validation.h: a run's traits against manual measurements, or against another run. Internal to reports/, tool/. */
#ifndef PLANTIMETER_REPORTS_VALIDATION_H
#define PLANTIMETER_REPORTS_VALIDATION_H

#include "reports/agreement.h"
#include "reports/readings.h"

typedef struct plm_validation_options {
    plm_match match;
    plm_manual_angle manual_angle;
    const char *metadata;  /**< path of a CSV with plant_id and group columns; NULL: no groups */
    const char *by;        /**< its columns to group by, comma-separated; NULL: no groups */
    const char *tolerance; /**< of TOST: "plant_height=5,leaf_area=1", in the trait's reported unit; NULL: none */
    double variance_ratio; /**< for Deming; 0: 1 */
    size_t resamples;      /**< 0: 2000 */
    uint64_t seed;
} plm_validation_options;

/** A pair as the statistics see it: both values in the estimate's unit. */
typedef struct plm_validated_pair {
    const plm_reading *estimate, *manual;
    double estimate_value, manual_value, std_error;
} plm_validated_pair;

/** Statistics of one trait in one group ("all" is every pair of the trait). */
typedef struct plm_validated_group {
    const char *trait, *group, *unit;
    size_t first, count; /**< its pairs in plm_validation.pair where group is not "all"; count always */
    plm_statistic statistic[PLM_STAT_COUNT];
    plm_repeatability repeatability; /**< of the manual values, degrees 0 where nothing was repeated */
    double coverage; /**< share of pairs whose 95 % interval holds the manual value; NAN without errors */
} plm_validated_group;

/** The caller's (plm_validation_free). */
typedef struct plm_validation {
    plm_readings estimate, manual;
    plm_table metadata;
    char *group_names;
    plm_validated_pair *pair; /**< sorted by trait, then group, plant and organ number */
    size_t pair_count;
    bool *estimate_used, *manual_used;
    plm_validated_group *group; /**< per trait: "all", then its groups by name */
    size_t group_count;
    size_t unit_mismatches; /**< pairs left out for units that do not convert; they are listed as unmatched */
} plm_validation;

/** Pairs two tables and computes every statistic. PLM_E_ARGUMENT where no reading of one table has a partner. */
plm_status plm_validate(const char *estimates_path, const char *manual_path, const plm_validation_options *options,
                        plm_validation *validation, plm_error *error);

void plm_validation_free(plm_validation *validation);

/** Writes agreement.csv, agreement.md, pairs.csv and unmatched.csv into folder, which exists. */
plm_status plm_validation_write(const plm_validation *validation, const char *folder, plm_error *error);

/** One condition of `--fail-if`, "TRAIT.STATISTIC OP NUMBER" with OP one of < <= > >=. */
typedef struct plm_gate_result {
    bool failed;       /**< the condition holds: the gate is shut */
    char message[256]; /**< "leaf_area.mape is 6.2, which is > 5" */
} plm_gate_result;

/** Tries a condition on the group "all". PLM_E_ARGUMENT for a condition that cannot be read, a trait without pairs, or a
 * statistic that is unknown or has no value. */
plm_status plm_validation_gate(const plm_validation *validation, const char *condition, plm_gate_result *result,
                               plm_error *error);

#endif
