/* segment/leaflet_shape.h: whether a piece of blade is a leaflet that hangs at a place. Internal. */
#ifndef PLANTIMETER_SEGMENT_LEAFLET_SHAPE_H
#define PLANTIMETER_SEGMENT_LEAFLET_SHAPE_H

#include <stdbool.h>
#include <stddef.h>

/** Middle and principal axes of a piece. */
typedef struct plm_piece_shape {
    double middle[3];
    double axis[3][3]; /**< longest first, the last is the normal */
    double across;     /**< SD along the second */
} plm_piece_shape;

plm_piece_shape plm_piece_shape_of(const double (*xyz)[3], size_t count);

/** Whether a piece is a leaflet whose base lies at a place: it runs away from there, longer than wide, and nothing of it is behind. */
bool plm_hangs_at(const double (*xyz)[3], size_t count, const plm_piece_shape *shape, const double place[3]);

/** Whether a place is at a side of a piece: off its middle, and the way from there to the middle is not its longer one. */
bool plm_is_at_side(const plm_piece_shape *shape, const double place[3]);

#endif
