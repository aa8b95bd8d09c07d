/* traits/axis_curve.h: a space curve over a chord: the shape of a stem's or a petiole's centre line. Internal.
 *
 * point(t) = origin + half t along + u(t) across[0] + v(t) across[1], t in [-1, 1]; u and v are B-splines of the given
 * degree with equal spans. Beyond the ends the curve goes on as a straight line. It is single-valued over its chord: a
 * tube may bend by less than 90 degrees from it. */
#ifndef PLANTIMETER_TRAITS_AXIS_CURVE_H
#define PLANTIMETER_TRAITS_AXIS_CURVE_H

#include <stdbool.h>

enum {
    PLM_CURVE_DEGREE = 3,                                /**< largest degree */
    PLM_CURVE_SPANS = 12,                                /**< most spans */
    PLM_CURVE_BASIS = PLM_CURVE_DEGREE + PLM_CURVE_SPANS /**< most coefficients of u or v */
};

typedef struct plm_curve {
    double origin[3];              /**< middle of the chord */
    double along[3], across[2][3]; /**< unit vectors, at right angles */
    double half;                   /**< half of the chord's length */
    int degree, spans;
    double offset[2][PLM_CURVE_BASIS]; /**< coefficients of u and v, degree + spans of each */
} plm_curve;

/** The straight curve from begin to end. degree is cut to [1, 3], spans to [1, 12]. false when the points coincide. */
bool plm_curve_line(const double begin[3], const double end[3], int degree, int spans, plm_curve *curve);

/** Number of coefficients of u (and of v). */
int plm_curve_basis_count(const plm_curve *curve);

/** Basis functions at t: degree + 1 values and their derivatives by t, and the number of the first of them. Beyond
 * [-1, 1] they go on linearly. second may be NULL. */
int plm_curve_basis(const plm_curve *curve, double t, double value[4], double first[4], double second[4]);

void plm_curve_point(const plm_curve *curve, double t, double point[3]);

/** point(t) and its first and second derivative by t. */
void plm_curve_derivatives(const plm_curve *curve, double t, double point[3], double first[3], double second[3]);

/** Unit tangent at t. */
void plm_curve_tangent(const plm_curve *curve, double t, double tangent[3]);

/** How point(b) - point(a) follows from the coefficients: row[k] is its derivative by the k-th coefficient of u (and the
 * same for v); as many as there are coefficients. */
void plm_curve_difference(const plm_curve *curve, double a, double b, double row[PLM_CURVE_BASIS]);

/** Parameter of the curve's point nearest to point: Newton's method from the projection onto the chord. */
double plm_curve_foot(const plm_curve *curve, const double point[3]);

/** Length of the curve between two parameters; negative when to is below from. Gauss-Legendre over each span. */
double plm_curve_length(const plm_curve *curve, double from, double to);

/** Parameter at the length along the curve from parameter from (length may be negative). */
double plm_curve_walk(const plm_curve *curve, double from, double length);

#endif
