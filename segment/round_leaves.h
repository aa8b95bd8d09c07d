/* segment/round_leaves.h: leaves all of which noise makes round. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROUND_LEAVES_H
#define PLANTIMETER_SEGMENT_ROUND_LEAVES_H

#include "segment/side_groups.h"

/** For plants of leaves with petioles on a stem: in noise, makes blade of the least sure tube of side groups that have no blade
 * but half of the points that those with blades have, or more, if a quarter of it is not sure and there are three with blades. groups: as
 * found. Writes is_tube; found: out, whether there are any: then classes are to be tidied and side groups found again.
 * PLM_E_MEMORY only. */
plm_status plm_round_leaves(plm_sketch *sketch, const plm_side_groups *groups, bool *found, plm_error *error);

#endif
