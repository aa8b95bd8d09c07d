/* segment/tip_leaf.h: the youngest leaf, through which the way up the stem runs on. Internal. */
#ifndef PLANTIMETER_SEGMENT_TIP_LEAF_H
#define PLANTIMETER_SEGMENT_TIP_LEAF_H

#include "segment/side_groups.h"

/** For plants of leaves with petioles on a stem: what lies beyond the last leaf's foot and is far longer than the stem is thick, wider
 * than it, and no mere rest beside the other leaves is a leaf, however much it looks like tube (in little noise): makes blade of it and ends the stem's
 * path below. groups: as found. Writes is_tube and stem; found: out, whether there is one: then classes are to be tidied, the
 * stem marked anew and side groups found again. PLM_E_MEMORY only. */
plm_status plm_tip_leaf(plm_sketch *sketch, const plm_side_groups *groups, bool *found, plm_error *error);

#endif
