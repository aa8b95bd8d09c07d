/* segment/rosette_petioles.h: the petioles of young leaves that count as others'. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_PETIOLES_H
#define PLANTIMETER_SEGMENT_ROSETTE_PETIOLES_H

#include "segment/sketch.h"

/** Gives leaves of a rosette that have no petiole what of others' petioles lies along their way from the core, with its label: what of it
 * is the base of a blade is left to tell. xyz: count points; row[i]: where point i is in out; core: where the petioles meet.
 * PLM_E_MEMORY. */
plm_status plm_rosette_petioles(const float (*xyz)[3], const uint32_t *row, size_t count, const double core[3],
                                plm_segmentation *out, plm_error *error);

#endif
