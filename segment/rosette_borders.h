/* segment/rosette_borders.h: where the blades of a rosette's leaves begin, by the likeness of its leaves. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_BORDERS_H
#define PLANTIMETER_SEGMENT_ROSETTE_BORDERS_H

#include "segment/sketch.h"

/** Whether a rosette's tubes and narrow blades are blurred so that its leaves have to tell of each other. */
bool plm_rosette_is_noisy(const plm_scale *scale);

/** Moves the border between petiole and blade, in the labels of a rosette's points, of leaves whose blades are narrow in noise (the more, the
 * narrower), and of those that are unlike the others, to the share of the way from crown to tip at which it lies in most
 * leaves with wide blades. xyz: count points; row[i]: where point i is in out; core: where the petioles meet. Where fewer than
 * three leaves tell, all stays. For noisy rosettes. PLM_E_MEMORY. */
plm_status plm_rosette_borders(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_scale *scale,
                               const double core[3], plm_segmentation *out, plm_error *error);

#endif
