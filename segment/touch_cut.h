/* segment/touch_cut.h: organs that touch part where they touch. Internal. */
#ifndef PLANTIMETER_SEGMENT_TOUCH_CUT_H
#define PLANTIMETER_SEGMENT_TOUCH_CUT_H

#include "segment/sketch.h"

/** Moves the borders that lead through a blade to the touch of the two organs nearby, by a minimum cut of the graph.
 * leaflets: the organs are compound leaves. distance: of each working point from the trunk along the graph. owner: the organ of
 * each working point, -1 for none; changed. PLM_E_MEMORY only. */
plm_status plm_touch_cut(const plm_sketch *sketch, bool leaflets, const float *distance, int32_t *owner,
                         plm_error *error);

#endif
