/* segment/blade_base.h: where the blade of a simple leaf, or of a rosette's, begins on its petiole, told at all points. Internal. */
#ifndef PLANTIMETER_SEGMENT_BLADE_BASE_H
#define PLANTIMETER_SEGMENT_BLADE_BASE_H

#include "segment/scale.h"
#include "segment/segment.h"

/** Moves the border between petiole and leaf, in the labels of the plant's points, to where the outline of the blade says
 * that it begins. xyz: count points; row[i]: where point i is in out. Leaves without petiole, and those whose points tell no
 * border, stay as they are; of a rosette also those whose blades are too small for an outline or would begin far
 * towards the tip from where they were thought to, and all where the noise hides the petioles' width. PLM_E_MEMORY. */
plm_status plm_blade_bases(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_scale *scale,
                           plm_segmentation *out, plm_error *error);

/* ---- Shared by its files --------------------------------------------------------------------------------------- */

/** A leaf about its junction, flattened, in metres. place: along the petiole from a first guess of the junction on (beyond it
 * along the blade), across, and off the blade's plane. */
typedef struct plm_base_view {
    size_t count;
    double (*place)[3];
    double scale;  /**< R */
    double radius; /**< of the petiole */
    double noise;
    double gathering; /**< of voxel means (cloud/sampling.h), else 0 */
} plm_base_view;

/** Place along the petiole at which the blade begins, the mean over what is likely (see base_outline.c); expected: where it is
 * thought to be beforehand. NAN where petiole or blade have too few points. PLM_E_MEMORY. */
plm_status plm_base_find(const plm_base_view *view, double expected, double *junction, plm_error *error);

/** Whether the blade reaches to the sides of all that is compared with outlines. A smaller one ends within it, and an outline,
 * which knows no tip, would put its base where it ends. */
bool plm_base_is_wide(const plm_base_view *view);

/** A point in the petiole's strip. */
typedef struct plm_base_height {
    double along, off, weight;
} plm_base_height;

/** Squares of the heights in the strip about their course, in the order of list (by places along), summed up in cumulated[0 ..
 * number]. list, rest, cumulated: room for one more than the view has points. Gives their number; 0 where thickness tells
 * nothing, as there is noise or too little. */
size_t plm_base_heights(const plm_base_view *view, plm_base_height *list, double *rest, double *cumulated);

/** Log likelihood of those heights when they have one variance before a place along and a smaller one from there on; 0 when
 * there are none. */
double plm_base_thickness(const plm_base_view *view, const plm_base_height *list, const double *cumulated, size_t count,
                          double at);

#endif
