/* traits/schedule.h: which pass of an anytime measurement comes next: over how many points and for which traits, so that it ends
 * in time and the reported errors fall most. Knows no clock and runs nothing: times come in, decisions go out. Internal. */
#ifndef PLANTIMETER_TRAITS_SCHEDULE_H
#define PLANTIMETER_TRAITS_SCHEDULE_H

#include "traits/pace.h"

/** Two groups of traits, that may rest on different passes: those of the plant as a whole, and those of its organs (and sums over
 * them), which must all come from one pass. */
typedef enum plm_group { PLM_GROUP_PLANT = 0, PLM_GROUP_ORGANS, PLM_GROUP_COUNT } plm_group;

plm_group plm_group_of(const plm_trait *trait);

/** What is known of a group so far. */
typedef struct plm_group_state {
    bool is_wanted;
    plm_plan plan;      /**< for the group alone */
    size_t value_count; /**< values with a standard error: the weight of the group */
    size_t points;      /**< of its best complete pass; 0: none yet */
    double power;       /**< standard errors fall as points^-power */
} plm_group_state;

typedef struct plm_schedule {
    size_t all; /**< points of the cloud */
    plm_group_state group[PLM_GROUP_COUNT];
    plm_plan plan; /**< for both */
} plm_schedule;

/** A pass to be run. */
typedef struct plm_next_pass {
    bool has_group[PLM_GROUP_COUNT];
    size_t points;
    double predicted; /**< seconds */
} plm_next_pass;

/** The power of errors where nothing is known: they go with the spacing of points. */
#define PLM_USUAL_POWER 0.5

/** The first pass: all traits over few points, from which the times of larger ones are told; where that would not end in time, the
 * plant's alone. */
plm_next_pass plm_schedule_first(const plm_schedule *schedule, const plm_pace *pace, double seconds_left);

/** The pass that lowers the errors most within the seconds left; false: none is worth its time, or fits. */
bool plm_schedule_next(const plm_schedule *schedule, const plm_pace *pace, double seconds_left, plm_next_pass *next);

/** The seconds that a pass of these groups is predicted to take. */
double plm_schedule_seconds(const plm_schedule *schedule, const plm_pace *pace, const bool has_group[PLM_GROUP_COUNT],
                            size_t points);

/** A group's pass over so many points is complete. log_ratio: mean over its traits of the logarithm of the last pass's error over
 * this one's (NAN: none is known), of which the power is learnt: half of it, as few traits say it. */
void plm_schedule_done(plm_schedule *schedule, plm_group group, size_t points, size_t value_count, double log_ratio);

#endif
