/* segment/rosette_core.h: whose the points at the middle of a rosette are. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_CORE_H
#define PLANTIMETER_SEGMENT_ROSETTE_CORE_H

#include "segment/sketch.h"

/** Gives the tube points at a rosette's core to the petioles whose lines lead there. distance: of each working point from the
 * rim of the core along the graph, 0 within. Writes sketch->leaf. PLM_E_MEMORY only. */
plm_status plm_rosette_core(plm_sketch *sketch, const float *distance, plm_error *error);

#endif
