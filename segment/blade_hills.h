/* segment/blade_hills.h: leaves of a rosette that share a foot and touch. Internal. */
#ifndef PLANTIMETER_SEGMENT_BLADE_HILLS_H
#define PLANTIMETER_SEGMENT_BLADE_HILLS_H

#include "segment/sketch.h"

/** Parts the groups of sketch->group that are several hills of distance (of each working point from the trunk along the graph) into
 * as many groups; one keeps the number, the others count on from *groups, which is changed. The border between them is
 * that of the ways, to be moved to the touch (plm_touch_cut). PLM_E_MEMORY only. */
plm_status plm_blade_hills(plm_sketch *sketch, const float *distance, size_t *groups, plm_error *error);

#endif
