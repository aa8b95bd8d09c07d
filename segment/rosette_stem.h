/* segment/rosette_stem.h: stems that are none. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_STEM_H
#define PLANTIMETER_SEGMENT_ROSETTE_STEM_H

#include "segment/sketch.h"

/** Takes the stem off a sketch where its way hardly rises, or leads along a leaf among those of a rosette. The sketch has one; writes
 * sketch->group. PLM_E_MEMORY. */
plm_status plm_rosette_has_no_stem(plm_sketch *sketch, plm_error *error);

#endif
