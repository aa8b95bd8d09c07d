/* traits/plan.h: the stages and who needs them. Internal. */
#ifndef PLANTIMETER_TRAITS_PLAN_H
#define PLANTIMETER_TRAITS_PLAN_H

#include "traits/traits.h"

/** The stages, in the order in which they run. */
typedef enum plm_stage_id {
    PLM_STAGE_FRAME = 0,
    PLM_STAGE_GROUND,
    PLM_STAGE_CLEAN,
    PLM_STAGE_INDEX,
    PLM_STAGE_SEGMENT,
    PLM_STAGE_ORGANS,
    PLM_STAGE_SURFACES,
    PLM_STAGE_AXES,
    PLM_STAGE_HULL,
    PLM_STAGE_SMOOTHNESS,
    PLM_STAGE_LIGHT,
    PLM_STAGE_TRAITS,
    PLM_STAGE_COUNT
} plm_stage_id;

/** Which rows of the trait table a list asks for: chosen (as long as the table, the caller's) is set or cleared for each.
 * The list holds names of traits and of levels ("leaf": all traits of leaves), separated by commas; NULL and "all": all.
 * PLM_E_ARGUMENT  an unknown name (the message names the nearest one), or no name at all. */
plm_status plm_trait_choose(const char *list, bool *chosen, plm_error *error);

/** As plm_plan_make, for the rows of the trait table that chosen marks. */
plm_status plm_plan_of(const plm_measure_options *options, const bool *chosen, unsigned attributes, plm_plan *plan,
                       plm_error *error);

/** PLM_NEEDS_... with all that they rest on; and those that make a stage run. */
unsigned plm_needs_closure(unsigned needs);
unsigned plm_stage_needs(plm_stage_id stage);

/** Makes the stages run that needs name and that were left out as nobody asked for them, with the reason why. */
void plm_plan_widen(plm_plan *plan, unsigned needs, unsigned attributes, const plm_measure_options *options,
                    const char *why);

/** The most points that the stages look at: options->points, or by effort; 0: all. */
size_t plm_point_budget(const plm_measure_options *options);

/** Marks a stage as left out, with a printf-style reason. */
void plm_plan_leave_out(plm_plan *plan, plm_stage_id stage, const char *format, ...) PLM_PRINTF(3, 4);

#endif
