/* traits/stem_foot.h: the base of a plant that stands on the foot of one stem. Internal. */
#ifndef PLANTIMETER_TRAITS_STEM_FOOT_H
#define PLANTIMETER_TRAITS_STEM_FOOT_H

#include "traits/extreme.h"

/** Puts the base of a plant (base: of plm_extreme_along down the zenith: minus a height) to the end of the tube that its lowest
 * points lie on, where they lie on one: a stem that is cut off, across its axis, level, or between. The tube is fitted to the
 * foot (traits/tube_fit.h), and the points' places along it tell where it ends and how it is cut.
 *
 * xyz: count points, offsets in metres, z up. changed: whether the base did; it stays where the lowest points are no tube that is
 * thicker than the noise and rather upright. Of the points alone, in no order. PLM_E_MEMORY. */
plm_status plm_stem_foot(const float (*xyz)[3], size_t count, plm_extreme *base, bool *changed, plm_error *error);

#endif
