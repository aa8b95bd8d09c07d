/* segment/touch_cut.h: organs that touch part where they touch. Internal. */
#ifndef PLANTIMETER_SEGMENT_TOUCH_CUT_H
#define PLANTIMETER_SEGMENT_TOUCH_CUT_H

#include "segment/sketch.h"

/** Moves the borders that lead through a blade to the touch of the two organs nearby, by a minimum cut of the graph.
 * owner: the organ of each working point, -1 for none; changed. distance: from the trunk along the graph.
 * PLM_E_MEMORY only. */
plm_status plm_touch_cut(const plm_sketch *sketch, int32_t *owner, const float *distance, plm_error *error);

#endif
