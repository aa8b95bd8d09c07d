/* traits/target.h: errors that are to be reached: "leaf_area=2%". Internal to traits/ and tool/. */
#ifndef PLANTIMETER_TRAITS_TARGET_H
#define PLANTIMETER_TRAITS_TARGET_H

#include "traits/traits.h"

enum { PLM_MOST_TARGETS = 8 };

/** Half the width of a trait's 95 % interval (1.96 standard errors) that is to be reached. Traits of organs: by the median organ. */
typedef struct plm_target {
    const plm_trait *trait;
    double half_width; /**< SI, or a share of the value */
    bool is_relative;
} plm_target;

/** How a target came out. half_width is in the target's terms; INFINITY where the trait has no value. */
typedef struct plm_target_outcome {
    bool is_reached;
    double half_width; /**< of the plant's value or the median organ */
    double worst;      /**< of the worst organ */
    size_t organs, organs_within;
} plm_target_outcome;

/** Reads a comma-separated list of TRAIT=ERROR, where ERROR is a percentage ("2%") or a number in the trait's unit, which may be
 * named ("1mm", "0.5 deg", "3cm2"; lengths in m, cm or mm). Appends to targets. PLM_E_ARGUMENT. */
plm_status plm_targets_parse(const char *text, plm_target target[PLM_MOST_TARGETS], size_t *count, plm_error *error);

/** How values compare to a target. */
plm_target_outcome plm_target_check(const plm_target *target, const plm_trait_value *value, size_t count);

#endif
