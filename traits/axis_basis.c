/* traits/axis_basis.c: B-spline basis functions over equal spans with clamped ends (de Boor 1978; Piegl and Tiller, The NURBS
 * Book, 2nd ed. 1997, algorithm A2.2) as polynomials of the place within a span. Which polynomials depends only on how
 * many spans there are before and behind, up to degree - 1. */
#include "traits/axis_curve.h"

#include <math.h>

/* Coefficients of 1, u, u^2, u^3 of the degree + 1 functions that are not zero in a span, u from 0 to 1 within it. */
static const double piece[1 + 4 + 9][4][4] = {
    /* degree 1, 0 spans before, 0 behind */
    {{1, -1, 0, 0}, {0, 1, 0, 0}},
    /* degree 2, 0 spans before, 0 behind */
    {{1, -2, 1, 0}, {0, 2, -2, 0}, {0, 0, 1, 0}},
    /* degree 2, 0 spans before, 1 behind */
    {{1, -2, 1, 0}, {0, 2, -3.0 / 2, 0}, {0, 0, 1.0 / 2, 0}},
    /* degree 2, 1 spans before, 0 behind */
    {{1.0 / 2, -1, 1.0 / 2, 0}, {1.0 / 2, 1, -3.0 / 2, 0}, {0, 0, 1, 0}},
    /* degree 2, 1 spans before, 1 behind */
    {{1.0 / 2, -1, 1.0 / 2, 0}, {1.0 / 2, 1, -1, 0}, {0, 0, 1.0 / 2, 0}},
    /* degree 3, 0 spans before, 0 behind */
    {{1, -3, 3, -1}, {0, 3, -6, 3}, {0, 0, 3, -3}, {0, 0, 0, 1}},
    /* degree 3, 0 spans before, 1 behind */
    {{1, -3, 3, -1}, {0, 3, -9.0 / 2, 7.0 / 4}, {0, 0, 3.0 / 2, -1}, {0, 0, 0, 1.0 / 4}},
    /* degree 3, 0 spans before, 2 behind */
    {{1, -3, 3, -1}, {0, 3, -9.0 / 2, 7.0 / 4}, {0, 0, 3.0 / 2, -11.0 / 12}, {0, 0, 0, 1.0 / 6}},
    /* degree 3, 1 spans before, 0 behind */
    {{1.0 / 4, -3.0 / 4, 3.0 / 4, -1.0 / 4},
     {1.0 / 2, 0, -3.0 / 2, 1},
     {1.0 / 4, 3.0 / 4, 3.0 / 4, -7.0 / 4},
     {0, 0, 0, 1}},
    /* degree 3, 1 spans before, 1 behind */
    {{1.0 / 4, -3.0 / 4, 3.0 / 4, -1.0 / 4},
     {7.0 / 12, 1.0 / 4, -5.0 / 4, 7.0 / 12},
     {1.0 / 6, 1.0 / 2, 1.0 / 2, -7.0 / 12},
     {0, 0, 0, 1.0 / 4}},
    /* degree 3, 1 spans before, 2 behind */
    {{1.0 / 4, -3.0 / 4, 3.0 / 4, -1.0 / 4},
     {7.0 / 12, 1.0 / 4, -5.0 / 4, 7.0 / 12},
     {1.0 / 6, 1.0 / 2, 1.0 / 2, -1.0 / 2},
     {0, 0, 0, 1.0 / 6}},
    /* degree 3, 2 spans before, 0 behind */
    {{1.0 / 6, -1.0 / 2, 1.0 / 2, -1.0 / 6},
     {7.0 / 12, -1.0 / 4, -5.0 / 4, 11.0 / 12},
     {1.0 / 4, 3.0 / 4, 3.0 / 4, -7.0 / 4},
     {0, 0, 0, 1}},
    /* degree 3, 2 spans before, 1 behind */
    {{1.0 / 6, -1.0 / 2, 1.0 / 2, -1.0 / 6},
     {2.0 / 3, 0, -1, 1.0 / 2},
     {1.0 / 6, 1.0 / 2, 1.0 / 2, -7.0 / 12},
     {0, 0, 0, 1.0 / 4}},
    /* degree 3, 2 spans before, 2 behind */
    {{1.0 / 6, -1.0 / 2, 1.0 / 2, -1.0 / 6},
     {2.0 / 3, 0, -1, 1.0 / 2},
     {1.0 / 6, 1.0 / 2, 1.0 / 2, -1.0 / 2},
     {0, 0, 0, 1.0 / 6}},
};

/* First of the pieces of a degree; then by spans before, then by spans behind. */
static const int first_piece[PLM_CURVE_DEGREE + 1] = {0, 0, 1, 5};

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

int plm_curve_basis(const plm_curve *curve, double t, double value[4], double first[4], double second[4])
{
    const double clamped = t > -1 ? fmin(t, 1) : -1; /* NaN: -1, and on from there it spreads */
    const double place = 0.5 * (clamped + 1) * curve->spans;
    const int span = smaller((int)place, curve->spans - 1), degree = curve->degree;
    const double u = place - span, scale = 0.5 * curve->spans; /* du / dt */
    const int before = smaller(span, degree - 1), behind = smaller(curve->spans - 1 - span, degree - 1);
    const double(*row)[4] = piece[first_piece[degree] + before * degree + behind];
    for (int k = 0; k < 4; k++) {
        const double *c = row[k];
        value[k] = c[0] + u * (c[1] + u * (c[2] + u * c[3]));
        first[k] = scale * (c[1] + u * (2 * c[2] + u * 3 * c[3]));
        if (t != clamped) value[k] += (t - clamped) * first[k];
    }
    if (second)
        for (int k = 0; k < 4; k++) second[k] = t == clamped ? scale * scale * (2 * row[k][2] + 6 * u * row[k][3]) : 0;
    return span;
}
