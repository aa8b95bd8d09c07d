/* segment/leaf_of.h: whose leaf a labelled point is of. Internal. */
#ifndef PLANTIMETER_SEGMENT_LEAF_OF_H
#define PLANTIMETER_SEGMENT_LEAF_OF_H

#include "segment/segment.h"

/** The leaf that row at of out is of, by its blade or its petiole; -1: none. */
static inline int32_t plm_leaf_of(const plm_segmentation *out, size_t at)
{
    const bool has = out->label[at] == PLM_LABEL_PETIOLE || out->label[at] == PLM_LABEL_LEAF;
    const int32_t leaf = out->organ[at];
    return has && leaf >= 0 && (size_t)leaf < out->leaf_count ? leaf : -1;
}

#endif
