/* segment/blade_base.h: where the blade of a simple leaf (also the first ones of a compound plant), or of a rosette's, begins
 * on its petiole, told at all points. Internal. */
#ifndef PLANTIMETER_SEGMENT_BLADE_BASE_H
#define PLANTIMETER_SEGMENT_BLADE_BASE_H

#include "segment/scale.h"
#include "segment/segment.h"

/** How many leaves, from the base up, are simple: on a plant of compound leaves those before the first that has leaflets, which
 * tell themselves where they begin. What has one leaflet higher up is young, and its leaflets are not told apart; nor are any
 * where no leaf has more. row: as below. */
size_t plm_simple_leaves(const uint32_t *row, size_t count, const plm_segmentation *out);

/** Moves the border between petiole and leaf, in the labels of the plant's points, to where the outline of the blade says
 * that it begins; the leaflet numbers follow. xyz: count points; row[i]: where point i is in out. Only
 * plm_simple_leaves are looked at. Leaves without petiole, and those whose points tell no
 * border, stay as they are; of a rosette also those whose blades would begin far towards the tip from where they were thought to,
 * small ones that lean on their petioles, are hardly wider than these or are in noise, and all where the noise hides the petioles' width. PLM_E_MEMORY. */
plm_status plm_blade_bases(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_scale *scale,
                           plm_segmentation *out, plm_error *error);

/* ---- Shared by its files --------------------------------------------------------------------------------------- */

/** A leaf about its junction, flattened, in metres. place: along the petiole from a first guess of the junction on (beyond it
 * along the blade), across, and off the blade's plane. */
typedef struct plm_base_view {
    size_t count;
    double (*place)[3];
    double scale;     /**< R */
    double radius;    /**< of the petiole */
    double noise;     /**< across the blade */
    double blur;      /**< along it */
    double gathering; /**< of voxel means (cloud/sampling.h), else 0 */
} plm_base_view;

enum { PLM_BASE_ROWS = 75, PLM_BASE_OUTLINES = 57 };

/** Logarithm of how much less likely than the best a row is that does not count. */
#define PLM_BASE_UNLIKELY 12.0

/** How likely the points of either side of a leaf are, by outline and by the row at which the blade begins. */
typedef struct plm_base_table {
    float likelihood[PLM_BASE_ROWS][2][PLM_BASE_OUTLINES]; /**< logarithms; nothing where rest is -INFINITY */
    double rest[PLM_BASE_ROWS]; /**< logarithm of what else tells of a row; -INFINITY where it is unlikely */
    double first, step;         /**< place along the petiole of row 0, and from row to row, metres */
} plm_base_table;

/** Fills the table of a leaf (see base_outline.c); expected: where its blade is thought to begin beforehand. told: false where
 * petiole or blade have too few points; the table tells nothing then. PLM_E_MEMORY. */
plm_status plm_base_look(const plm_base_view *view, double expected, plm_base_table *table, bool *told,
                         plm_error *error);

/** Fills the table by thickness alone, which tells of a petiole's end at any width of the blade. told: false where it tells no place
 * clearly, or there is noise. PLM_E_MEMORY. */
plm_status plm_base_look_at_thickness(const plm_base_view *view, plm_base_table *table, bool *told, plm_error *error);

/** Shares of the outlines when nothing is known of them. */
void plm_base_any(double share[PLM_BASE_OUTLINES]);

/** Shares of the outlines among the sides of all leaves of a plant (see base_shares.c). */
void plm_base_shares(const plm_base_table *const *table, size_t count, double share[PLM_BASE_OUTLINES]);

/** SD of points along a blade, by what they have across it and by their voxels' edge (0: what they have across it). */
double plm_base_blur(double noise, double pitch);

/** Logarithm of how likely a row is where outlines have such shares. */
double plm_base_evidence(const plm_base_table *table, int row, const double share[PLM_BASE_OUTLINES]);

/** Place along the petiole at which the blade begins, the mean over what is likely where outlines have such shares. */
double plm_base_mean(const plm_base_table *table, const double share[PLM_BASE_OUTLINES]);

/** Whether the blade reaches to the sides of all that is compared with outlines. A smaller one ends within it, and an outline,
 * which knows no tip, would put its base where it ends. */
bool plm_base_is_wide(const plm_base_view *view);

/** The R by which a blade as wide as this one, as seen at the view's scale, would just be wide. */
double plm_base_own_scale(const plm_base_view *view);

/** Whether the noise is wide against the petiole, so that thickness tells nothing and its line is known badly. */
bool plm_base_is_noisy(const plm_base_view *view);

/** In noise, the angle by which a narrow blade lies aside of the way ahead, towards positive places across; 0 of one that
 * reaches to the sides of all that is compared. The line of a short petiole in noise is off by tens of degrees, and beside a
 * narrow blade an outline would find nothing on one side. */
double plm_base_turn(const plm_base_view *view);

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
