/* segment/strap_leaves.h: leaves that have no petiole (maize, sorghum). Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_LEAVES_H
#define PLANTIMETER_SEGMENT_STRAP_LEAVES_H

#include "segment/sketch.h"

/** Writes leaf (numbered in no order), is_tube and is_stem of a plant with strap leaves from the merge tree of the
 * distance from the stem's base. along: out, an array of one a leaf, the distance of its foot from the base
 * (plm_free). */
plm_status plm_strap_leaves(plm_sketch *sketch, double **along, size_t *leaves, plm_error *error);

#endif
