/* segment/rosette_stem.h: stems that are none. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_STEM_H
#define PLANTIMETER_SEGMENT_ROSETTE_STEM_H

#include "segment/sketch.h"

/** Takes the stem off a sketch that has one where its way hardly rises or, where the user has not said what
 * plant it is, leads along a leaf among those of a rosette. Writes sketch->group. PLM_E_MEMORY. */
plm_status plm_stem_drop_false(plm_sketch *sketch, plm_error *error);

#endif
