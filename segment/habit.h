/* segment/habit.h: what kind of plant it is. Internal. */
#ifndef PLANTIMETER_SEGMENT_HABIT_H
#define PLANTIMETER_SEGMENT_HABIT_H

#include "segment/side_groups.h"

/** Guesses the habit from the side groups of plm_side_groups_find. PLM_E_MEMORY. */
plm_status plm_habit_guess(const plm_sketch *sketch, const plm_side_groups *groups, plm_habit *habit, plm_error *error);

#endif
