/* segment/rosette_pieces.h: what of a rosette's blades lies apart from them. Internal. */
#ifndef PLANTIMETER_SEGMENT_ROSETTE_PIECES_H
#define PLANTIMETER_SEGMENT_ROSETTE_PIECES_H

#include "segment/segment.h"

/** In the labels of a rosette's points, gives small pieces of a blade that lie apart from the rest of it to the organ amid whose
 * points they lie, if that is another. xyz: count points; row[i]: where point i is in out. PLM_E_MEMORY. */
plm_status plm_rosette_pieces(const float (*xyz)[3], const uint32_t *row, size_t count, plm_segmentation *out,
                              plm_error *error);

#endif
