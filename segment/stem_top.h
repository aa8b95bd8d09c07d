/* segment/stem_top.h: the point where the main stem ends, among the ways from its base. Internal. */
#ifndef PLANTIMETER_SEGMENT_STEM_TOP_H
#define PLANTIMETER_SEGMENT_STEM_TOP_H

#include "segment/sketch.h"

/** The ways from the base to every point: each a row a working point. */
typedef struct plm_tube_ways {
    float *distance;  /**< INFINITY: not reached */
    uint32_t *parent; /**< UINT32_MAX: the base, or not reached */
    uint32_t *order;  /**< the reached ones, nearest first */
    size_t reached;
} plm_tube_ways;

/** The end of the stem. top: in, the highest thick point; out, the point to which the way is thick for the longest, but where hardly a blade
 * hangs on that way beyond a fork and most do on the other branch, that one's, if it is at least half as good. PLM_E_MEMORY only. */
plm_status plm_stem_top(const plm_sketch *sketch, const plm_tube_ways *ways, uint32_t *top, plm_error *error);

#endif
