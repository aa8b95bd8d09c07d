/* segment/strap_border.h: the feet of strap leaves that noise put into the stem. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_BORDER_H
#define PLANTIMETER_SEGMENT_STRAP_BORDER_H

#include "segment/sketch.h"

/** Gives the points of the stem farther off its line than shape (in its radii) that lie nearer to the plane in which a leaf
 * beside them runs on than to the stem's surface to that leaf: writes leaf, is_stem and is_tube. PLM_E_MEMORY. */
plm_status plm_strap_border(plm_sketch *sketch, double shape, plm_error *error);

#endif
