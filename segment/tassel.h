/* segment/tassel.h: the tassel at the top of a maize is no leaf. Internal. */
#ifndef PLANTIMETER_SEGMENT_TASSEL_H
#define PLANTIMETER_SEGMENT_TASSEL_H

#include "segment/sketch.h"

/** Takes the tassel (or an open panicle) off the leaves of a strap plant: its points become those of no organ. from_base: of each point, along the
 * graph (m). foot: the least of each leaf, in and out; leaves: their number, in and out. PLM_E_MEMORY only. */
plm_status plm_strap_tassel(plm_sketch *sketch, const float *from_base, double *foot, size_t *leaves, plm_error *error);

#endif
