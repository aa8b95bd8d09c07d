/* segment/strap_feet.h: leaves that touch far from their feet taken apart. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_FEET_H
#define PLANTIMETER_SEGMENT_STRAP_FEET_H

#include "segment/sketch.h"

/** A leaf that stands on several feet, with long legs up to where they meet, is as many leaves: writes leaf of the legs,
 * -1 to what lies beyond their meeting and near the stem. Legs may go on in leaves that have no foot of their own. At most PLM_STRAP_PIECES_MOST
 * legs of a leaf are told apart. from_base:
 * distance of each point along the graph; branch: of each point, the leaf whose tip it was found to be of, -1; beyond:
 * out where any was taken apart, the points about a meeting and beyond it, for plm_strap_beyond. leaves: in and out, their number; foot: one a leaf,
 * with room for PLM_STRAP_FEET_MOST more; out, for each leaf that is new, the distance of its foot. Gives whether any was
 * taken apart. */
plm_status plm_strap_feet(plm_sketch *sketch, const float *from_base, const int32_t *branch, bool *beyond, double *foot,
                          size_t *leaves, bool *apart, plm_error *error);

enum { PLM_STRAP_FEET_MOST = 64 };

#endif
