/* segment/stem_fit.h: the line of the main stem: nearest places, smoothing, and its fit to the points. Internal. */
#ifndef PLANTIMETER_SEGMENT_STEM_FIT_H
#define PLANTIMETER_SEGMENT_STEM_FIT_H

#include "segment/sketch.h"

/** The place on the stem's line that is nearest to a point. */
typedef struct plm_stem_place {
    double along;     /**< arc length from the base */
    double radius;    /**< of the stem there */
    double offset[3]; /**< from there to the point */
} plm_stem_place;

/** Distance of a point from the line (INFINITY and place untouched when the path is empty). */
double plm_stem_nearest(const plm_stem_path *stem, const float xyz[3], plm_stem_place *place);

/** Box-smooths the nodes over +-reach nodes (fewer near the ends, so that they stay) and measures along anew. buffer:
 * scratch, stem->count rows. */
void plm_stem_smooth(plm_stem_path *stem, size_t reach, double (*buffer)[3]);

/** Writes sketch->stem, in place of what it held, and is_stem: the way from base to top by parent[] (one a working point),
 * centred and measured. A way that hardly rises is none: then the sketch stays. tapers: the stem is nowhere
 * thicker than at its foot. */
plm_status plm_stem_trace(plm_sketch *sketch, const uint32_t *parent, uint32_t base, uint32_t top, bool tapers,
                          plm_error *error);

/** Sharpens the line and the radii by robust circles. radius[] must hold a guess within some 40 %. */
plm_status plm_stem_fit(const plm_sketch *sketch, plm_stem_path *stem, plm_error *error);

/** Fits a circle to points across the line, robustly (Tukey's cutoff), held near its start as far as the points do not
 * tell. x: centre and radius, in: the start, which has its centre at 0. Gives the number of points used; 0: too few, and x is of no use. */
size_t plm_stem_circle(const double (*e)[2], size_t count, double scatter, double cutoff, double x[3]);

/** Writes along[] from the nodes. */
void plm_stem_measure_along(plm_stem_path *stem);

/** Mean radius of the nodes [first, end). */
double plm_stem_mean_radius(const plm_stem_path *stem, size_t first, size_t end);

void plm_stem_path_free(plm_stem_path *path);

/** Nodes beside a place that do not count for where the way goes: feet of leaves widen it, and bend it to and fro. */
enum { PLM_STEM_NEAR = 4 };

/** Direction (pointing up) and mean radius of the path beyond (step 1) or before (-1) a node, by the nodes from PLM_STEM_NEAR on; there
 * must be some. */
double plm_stem_look(const plm_stem_path *stem, size_t n, int step, double out[3]);

/** Whether the path's turn at a node is undone beside it, as about a leaf's foot; false within ten nodes of an end, which do not tell. */
bool plm_stem_zigzag(const plm_stem_path *stem, size_t n);

/** Angle (radians) between the directions of the path below and above node n. */
double plm_stem_turn(const plm_stem_path *stem, size_t n);

/** Arc length at which the upper half of the path turns down as sharply as no stem does: what follows is a way through leaves
 * that touch. INFINITY: it does not. */
double plm_stem_hairpin(const plm_stem_path *stem);

/** The first node from arc length `from` on at which the path turns as it does where a way leaves the stem for a petiole;
 * 0 where there is none. */
size_t plm_stem_kink(const plm_stem_path *stem, double from);

/** Replaces what the stem's path does from node kink on by its straight continuation, as far as tube points lie along it:
 * only where that is at least so long (metres), which *done says. PLM_E_MEMORY. */
plm_status plm_stem_straighten(plm_sketch *sketch, size_t kink, double least, bool *done, plm_error *error);

/** The same at the lowest fork at which the way turned into the thinner branch, where the other goes straight on: a way through
 * a petiole and its leaflets, which noise makes thick, may be longer than that through the rest of the stem. */
plm_status plm_stem_leave_thin(plm_sketch *sketch, double least, bool *done, plm_error *error);

/** plm_stem_straighten, however short that is, at the first turn of the path's last part that is sharper than a stem's and a leaf's length
 * before its end; *done: whether there is one. */
plm_status plm_stem_leave_turn(plm_sketch *sketch, bool *done, plm_error *error);

#endif
