/* traits/stem_surface.h: a stem's surface, and where the line of a petiole comes to it. Internal. */
#ifndef PLANTIMETER_TRAITS_STEM_SURFACE_H
#define PLANTIMETER_TRAITS_STEM_SURFACE_H

#include "traits/axis.h"

/** Distance of a point from the stem's surface, metres, negative inside. foot: parameter of its foot on the stem's line. */
double plm_stem_off(const plm_axis *stem, const double point[3], double *foot);

/** Angle between a line at t and the stem's axis at its foot, folded to [0, pi/2]. */
double plm_stem_angle(const plm_axis *stem, const plm_curve *line, double t);

/** Parameter at which a line, followed inwards from t, first comes to the stem's surface: found in steps, as a line that misses
 * the stem's middle leaves it again. low where it comes to it only beyond low, t where it is inside there already, NAN where it
 * passes the stem by. */
double plm_stem_crossing(const plm_axis *stem, const plm_curve *line, double t, double low);

/** Where the stem cuts a tube obliquely only a part of its ring is left: the share of the ring of a radius about the line at t
 * that lies outside of the stem (by the margin), and the mean of that part, from the line (0 where all is left). */
double plm_stem_ring_left(const plm_axis *stem, const plm_curve *line, double t, double radius, double margin,
                          double mean[3]);

#endif
