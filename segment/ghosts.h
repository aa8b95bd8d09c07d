/* segment/ghosts.h: how likely a point is none of the plant's: a floater, or a ghost that a depth camera sees between
 * the rim of a leaf and what lies behind it. Internal. */
#ifndef PLANTIMETER_SEGMENT_GHOSTS_H
#define PLANTIMETER_SEGMENT_GHOSTS_H

#include "cloud/cloud.h"

enum { PLM_GHOST_NEIGHBOURS = 24, PLM_GHOST_FEATURES = 23 };

/** Features of count thinned points, more than PLM_GHOST_NEIGHBOURS: feature has count rows, the caller's. All are
 * ratios of lengths, so the unit is free; some compare with the whole cloud. PLM_E_DEGENERATE for too few points. */
plm_status plm_ghost_features(const float (*xyz)[3], size_t count, float (*feature)[PLM_GHOST_FEATURES],
                              plm_error *error);

/** Probability by the trees of segment/ghost_forest.h. */
double plm_ghost_probability(const float feature[PLM_GHOST_FEATURES]);

#endif
