/* segment/strap_stem.h: the stem of a plant with strap leaves, as a tube. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_STEM_H
#define PLANTIMETER_SEGMENT_STRAP_STEM_H

#include "segment/sketch.h"

/** Sharpens sketch->stem, which runs on into a leaf: fits its line and radius where it is trunk (stem by is_stem, and in
 * no leaf), follows the tube from there to its end, and writes is_stem anew: what lies on the tube. Points of leaves on it
 * (leaf[] from 0 to leaves) become stem and leave their leaf, but of no leaf more than half. shape: out, nearer
 * to the line than so many radii the tube's own shape puts points, beyond it only noise does. A stem too short to fit stays
 * as it is, its shape INFINITY. PLM_E_MEMORY. */
plm_status plm_strap_stem(plm_sketch *sketch, size_t leaves, double *shape, plm_error *error);

#endif
