/* segment/head.h: plants without petioles or visible stems among their leaves: heads (lettuce). Internal. */
#ifndef PLANTIMETER_SEGMENT_HEAD_H
#define PLANTIMETER_SEGMENT_HEAD_H

#include "segment/segment.h"
#include "segment/sheet_surface.h"

/** A short upright stem under a head: circles at equal distances, from the lowest up. Lengths as the surface has them. */
typedef struct plm_head_stem {
    size_t count;        /**< circles; 0: no stem was seen */
    double base;         /**< z of the lowest circle */
    double step;         /**< from one circle to the next */
    double (*circle)[3]; /**< x, y, radius */
} plm_head_stem;

/** Looks for the stem at the foot of a surface, z up. noise: sigma across surfaces. The result is the caller's:
 * plm_head_stem_free. PLM_E_MEMORY only. */
plm_status plm_head_find_stem(const plm_sheet_surface *surface, double noise, plm_head_stem *stem, plm_error *error);
void plm_head_stem_free(plm_head_stem *stem);

/** Whether a place is on the stem or in it; below the lowest circle the stem goes on as that. */
bool plm_head_is_stem(const plm_head_stem *stem, const float xyz[3], double tolerance);

/** Takes a plant without tubes for a head where it falls into sheets as a head does: writes label and organ of the points
 * row[0 .. count) of result (places xyz, z up), leaf_count, habit and stem_radius (0: no stem was seen). result->habit says what
 * it was taken for; where that is HEAD, the sheets are its leaves however few or large they are. Where there is no sheet, result
 * stays as it is. noise: sigma across surfaces. PLM_E_MEMORY, or as plm_thin. */
plm_status plm_find_head(const float (*xyz)[3], const uint32_t *row, size_t count, double noise,
                         plm_segmentation *result, plm_error *error);

#endif
