/* traits/centre_line.h: the smooth line through the middle of a long thin cloud of points. Internal. */
#ifndef PLANTIMETER_TRAITS_CENTRE_LINE_H
#define PLANTIMETER_TRAITS_CENTRE_LINE_H

#include "cloud/cloud.h"
#include "traits/axis_curve.h"

/** A centre line and what is known of it. */
typedef struct plm_centre_line {
    plm_curve curve;
    double distance;     /**< median distance of the points from the line: about the tube's radius, noise included */
    double scatter;      /**< SD of the points off the line, along one direction across it */
    size_t inlier_count; /**< points within 2.5 median distances */
    double covariance[PLM_CURVE_BASIS][PLM_CURVE_BASIS]; /**< of the coefficients of u, and of those of v */
} plm_centre_line;

/** What shapes a line may take. */
typedef struct plm_line_shape {
    int degree, spans; /**< as in plm_curve_line */
    double skew;       /**< prior SD of the cubic Legendre term, in lengths of the chord: how unevenly it bends; 0: the
                        * prior of the curvature alone, which leaves it 0.02 */
} plm_line_shape;

/** Fits a smoothing spline of u and v over the chord's parameter to count points, with equal weight for equal lengths of
 * the chord, whatever the density of points is, and weights 1 / (1 + (distance / (2.2 median distance))^4) against what
 * does not belong to the tube. The penalty on curvature is a prior that lets a tube bend away from its chord by 5 % of its
 * length (SD), so that few points give a straight line and many give any gentle shape. That of shape.skew has long tails:
 * a line that is plainly more skew is hardly held back.
 * begin, end: ends of the chord.
 * PLM_E_DEGENERATE  no chord, or fewer points than coefficients. */
plm_status plm_centre_line_fit(const double (*xyz)[3], size_t count, const double begin[3], const double end[3],
                               plm_line_shape shape, plm_centre_line *line, plm_error *error);

/** Standard error of the direction of the chord from parameter a to parameter b, radians, from the scatter. */
double plm_centre_line_direction_error(const plm_centre_line *line, double a, double b);

#endif
