/* segment/head.h: plants without petioles or visible stems among their leaves: heads (lettuce). Internal. */
#ifndef PLANTIMETER_SEGMENT_HEAD_H
#define PLANTIMETER_SEGMENT_HEAD_H

#include "segment/segment.h"
#include "segment/sheet_surface.h"

/** A short upright stem under a head: circles, each step above the one before. */
typedef struct plm_head_stem {
    size_t count; /**< circles; 0: no stem was seen */
    double base, step;
    double (*circle)[3]; /**< x, y, radius */
} plm_head_stem;

/** Looks for the stem at the foot of a surface, z up. height: of the plant. The caller's: plm_head_stem_free.
 * PLM_E_MEMORY only. */
plm_status plm_head_find_stem(const plm_sheet_surface *surface, double noise, plm_head_stem *stem, plm_error *error);
void plm_head_stem_free(plm_head_stem *stem);

/** Whether a place is on the stem or in it. */
bool plm_head_is_stem(const plm_head_stem *stem, const float xyz[3], double tolerance);

/** Takes a plant without tubes for a head where it falls into sheets as a head does: writes labels, organs, leaf_count and
 * habit of result for the count points of row[] (places xyz), which it leaves as they are elsewhere. The habit in result
 * says what it was taken for; HEAD is kept whatever the sheets say. noise: sigma across surfaces. PLM_E_MEMORY only. */
plm_status plm_find_head(const float (*xyz)[3], const uint32_t *row, size_t count, double noise,
                         plm_segmentation *result, plm_error *error);

#endif
