/* segment/rosette_links.h: leaves of a rosette that are pieces of others' petioles. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_LINKS_H
#define PLANTIMETER_SEGMENT_ROSETTE_LINKS_H

#include "segment/segment.h"

/** In the labels of a rosette's points, makes leaves whose blades are tubes, on the way from the core (at middle) to another leaf, petiole
 * of that; the others are numbered anew in their order. xyz: count points; row[i]: where point i is in out. PLM_E_MEMORY. */
plm_status plm_rosette_links(const float (*xyz)[3], const uint32_t *row, size_t count, const double middle[3],
                             plm_segmentation *out, plm_error *error);

#endif
