/* segment/strap_trunk.h: the trunk of a merge tree, off the stem, shared out to the leaves that go on in it. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_TRUNK_H
#define PLANTIMETER_SEGMENT_STRAP_TRUNK_H

#include "segment/sketch.h"

/** Writes leaf of the points that have none, are not of the stem, and are joined to a leaf: from those far from the base
 * (from_base: distance of each point along the graph, INFINITY where there is none) inwards, to the leaf whose surface
 * goes on through the point. */
plm_status plm_strap_trunk(plm_sketch *sketch, const float *from_base, plm_error *error);

/** The same for the points of beyond, which no distance puts in order: a leaf goes on where it fits best of all first. */
plm_status plm_strap_beyond(plm_sketch *sketch, const bool *beyond, plm_error *error);

#endif
