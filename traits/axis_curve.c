/* traits/axis_curve.c: curves over a chord, and distances along them. */
#include "traits/axis_curve.h"

#include "cloud/linear.h"

#include <string.h>

enum { FOOT_STEPS = 12, WALK_STEPS = 30 };

bool plm_curve_line(const double begin[3], const double end[3], int degree, int spans, plm_curve *curve)
{
    plm_curve line = {.degree = degree < 1                  ? 1
                                : degree > PLM_CURVE_DEGREE ? PLM_CURVE_DEGREE
                                                            : degree,
                      .spans = spans < 1                 ? 1
                               : spans > PLM_CURVE_SPANS ? PLM_CURVE_SPANS
                                                         : spans};
    for (int i = 0; i < 3; i++) {
        line.origin[i] = 0.5 * (begin[i] + end[i]);
        line.along[i] = end[i] - begin[i];
    }
    line.half = 0.5 * plm_normalise(line.along);
    if (!(line.half > 0) || !isfinite(line.half)) return false;
    plm_frame_of_axis(line.along, line.across[0], line.across[1]);
    *curve = line;
    return true;
}

int plm_curve_basis_count(const plm_curve *curve)
{
    return curve->degree + curve->spans;
}

void plm_curve_derivatives(const plm_curve *curve, double t, double point[3], double first[3], double second[3])
{
    double n0[4], n1[4], n2[4];
    const int begin = plm_curve_basis(curve, t, n0, n1, n2);
    double sum[3][2] = {{0}};
    for (int k = 0; k <= curve->degree; k++)
        for (int c = 0; c < 2; c++) {
            const double offset = curve->offset[c][begin + k];
            sum[0][c] += n0[k] * offset;
            sum[1][c] += n1[k] * offset;
            sum[2][c] += n2[k] * offset;
        }
    for (int i = 0; i < 3; i++) {
        const double u = curve->across[0][i], v = curve->across[1][i];
        point[i] = curve->origin[i] + curve->half * t * curve->along[i] + sum[0][0] * u + sum[0][1] * v;
        first[i] = curve->half * curve->along[i] + sum[1][0] * u + sum[1][1] * v;
        second[i] = sum[2][0] * u + sum[2][1] * v;
    }
}

void plm_curve_point(const plm_curve *curve, double t, double point[3])
{
    double first[3], second[3];
    plm_curve_derivatives(curve, t, point, first, second);
}

void plm_curve_tangent(const plm_curve *curve, double t, double tangent[3])
{
    double point[3], second[3];
    plm_curve_derivatives(curve, t, point, tangent, second);
    plm_normalise(tangent);
}

void plm_curve_difference(const plm_curve *curve, double a, double b, double row[PLM_CURVE_BASIS])
{
    double value[4], first[4];
    memset(row, 0, PLM_CURVE_BASIS * sizeof *row);
    const int begin_b = plm_curve_basis(curve, b, value, first, NULL);
    for (int k = 0; k <= curve->degree; k++) row[begin_b + k] += value[k];
    const int begin_a = plm_curve_basis(curve, a, value, first, NULL);
    for (int k = 0; k <= curve->degree; k++) row[begin_a + k] -= value[k];
}

double plm_curve_foot(const plm_curve *curve, const double point[3])
{
    double from_middle[3];
    for (int i = 0; i < 3; i++) from_middle[i] = point[i] - curve->origin[i];
    double t = plm_dot(from_middle, curve->along) / curve->half;
    for (int step = 0; step < FOOT_STEPS; step++) {
        double at[3], first[3], second[3], gap[3];
        plm_curve_derivatives(curve, t, at, first, second);
        for (int i = 0; i < 3; i++) gap[i] = point[i] - at[i];
        const double speed = plm_dot(first, first);
        /* Beyond the centre of curvature Newton's divisor changes sign; Gauss-Newton's does not. */
        const double newton = speed - plm_dot(gap, second);
        const double change = plm_dot(gap, first) / (newton > 0.2 * speed ? newton : speed);
        t += fmin(fmax(change, -0.5), 0.5);
        if (fabs(change) < 1e-13) break;
    }
    return t;
}

/* Length within one smooth piece. Five points integrate a cubic's speed to 1e-9 where a span bends by 30 degrees. */
static double piece_length(const plm_curve *curve, double from, double to)
{
    static const double node[5] = {0, -0.5384693101056831, 0.5384693101056831, -0.9061798459386640, 0.9061798459386640};
    static const double weight[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                     0.2369268850561891};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = 0;
    for (int k = 0; k < 5; k++) {
        double point[3], first[3], second[3];
        plm_curve_derivatives(curve, middle + half * node[k], point, first, second);
        sum += weight[k] * plm_norm(first);
    }
    return sum * half;
}

double plm_curve_length(const plm_curve *curve, double from, double to)
{
    if (to < from) return -plm_curve_length(curve, to, from);
    double length = 0, begin = from;
    for (int i = 0; i <= curve->spans; i++) { /* pieces end at the knots, where a higher derivative jumps */
        const double end = fmin(to, -1 + 2.0 * i / curve->spans);
        if (end > begin) {
            length += piece_length(curve, begin, end);
            begin = end;
        }
    }
    return to > begin ? length + piece_length(curve, begin, to) : length;
}

double plm_curve_walk(const plm_curve *curve, double from, double length)
{
    double t = from;
    for (int step = 0; step < WALK_STEPS; step++) {
        double point[3], first[3], second[3];
        plm_curve_derivatives(curve, t, point, first, second);
        const double change = (length - plm_curve_length(curve, from, t)) / plm_norm(first);
        t += change;
        if (fabs(change) < 1e-12) break;
    }
    return t;
}
