/* tests/support/made_sketch.h: sketches whose points a test lays out. */
#ifndef PLANTIMETER_TESTS_SUPPORT_MADE_SKETCH_H
#define PLANTIMETER_TESTS_SUPPORT_MADE_SKETCH_H

#include "segment/sketch.h"

/** What plain growing gives: distances along the graph from the points that are sources, and in sketch->group the organ (organ[i]: of
 * point i) of the source that is nearest, -1 where none is reached. distance: out, one a point. */
void made_sketch_grow(plm_sketch *sketch, const bool *is_source, const int32_t *organ, float *distance);

#endif
