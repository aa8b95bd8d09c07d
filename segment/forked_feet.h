/* segment/forked_feet.h: petioles that share a foot. Internal. */
#ifndef PLANTIMETER_SEGMENT_FORKED_FEET_H
#define PLANTIMETER_SEGMENT_FORKED_FEET_H

#include "segment/sketch.h"

/** For plants without a stem: splits feet that fork into several petioles with blades, also where these blades touch, or one of them
 * begins before the fork ends.
 * distance: of each working point from the trunk along the graph; component: the foot of the points of its shell, -1 for
 * others, changed with sketch->group; feet: their number, grows. PLM_E_MEMORY only. */
plm_status plm_forked_feet(plm_sketch *sketch, const float *distance, int32_t *component, size_t *feet,
                           plm_error *error);

#endif
