/* segment/petiole_foot.h: the stem's end and the petioles' feet, told at all points. Internal. */
#ifndef PLANTIMETER_SEGMENT_PETIOLE_FOOT_H
#define PLANTIMETER_SEGMENT_PETIOLE_FOOT_H

#include "segment/sketch.h"

/** Moves the borders between stem and petioles, in the labels of the plant's points, to where both as tubes say that they
 * are; where the stem ends beside the topmost petiole as well. xyz: count points, in the sketch's frame; row[i]: where point
 * i is in out. Petioles whose points tell nothing stay as they are. PLM_E_MEMORY. */
plm_status plm_petiole_feet(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_sketch *sketch,
                            plm_segmentation *out, plm_error *error);

#endif
