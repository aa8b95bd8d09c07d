/* traits/stem_surface.c: a stem's surface, and where the line of a petiole comes to it. */
#include "traits/stem_surface.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

enum { BISECTIONS = 50, RING = 16 };

double plm_stem_off(const plm_axis *stem, const double point[3], double *foot)
{
    const double low = fmin(stem->begin, stem->end), high = fmax(stem->begin, stem->end);
    *foot = fmin(fmax(plm_curve_foot(&stem->line, point), low), high);
    double at[3], gap[3];
    plm_curve_point(&stem->line, *foot, at);
    for (int k = 0; k < 3; k++) gap[k] = point[k] - at[k];
    return plm_norm(gap) - plm_axis_radius(stem, *foot);
}

double plm_stem_angle(const plm_axis *stem, const plm_curve *line, double t)
{
    double point[3], tangent[3], along[3], foot;
    plm_curve_point(line, t, point);
    plm_curve_tangent(line, t, tangent);
    plm_stem_off(stem, point, &foot);
    plm_curve_tangent(&stem->line, foot, along);
    return acos(fmin(fabs(plm_dot(tangent, along)), 1));
}

double plm_stem_crossing(const plm_axis *stem, const plm_curve *line, double t, double low)
{
    const double step =
        0.25 * fmax(stem->radius, 1e-3 * line->half) / line->half; /* a stem of no width has an end, too */
    double point[3], foot, outer = t, before = INFINITY;
    for (;; outer -= step) {
        plm_curve_point(line, outer, point);
        const double off = plm_stem_off(stem, point, &foot);
        if (off <= 0) break;
        if (outer <= low && !(off < before)) return NAN;
        before = off;
    }
    if (outer <= low) return low;
    if (outer == t) return t;
    double inner = outer;
    outer += step;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (inner + outer);
        plm_curve_point(line, middle, point);
        if (plm_stem_off(stem, point, &foot) > 0)
            outer = middle;
        else
            inner = middle;
    }
    return 0.5 * (inner + outer);
}

double plm_stem_ring_left(const plm_axis *stem, const plm_curve *line, double t, double radius, double margin,
                          double mean[3])
{
    double centre[3], tangent[3], across[2][3], foot;
    plm_curve_point(line, t, centre);
    memset(mean, 0, 3 * sizeof *mean);
    if (plm_stem_off(stem, centre, &foot) > radius + margin) return 1;
    plm_curve_tangent(line, t, tangent);
    plm_frame_of_axis(tangent, across[0], across[1]);
    int left = 0;
    for (int i = 0; i < RING; i++) {
        const double angle = 2 * PLM_PI * i / RING;
        double arm[3], point[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = radius * (cos(angle) * across[0][k] + sin(angle) * across[1][k]);
            point[k] = centre[k] + arm[k];
        }
        if (plm_stem_off(stem, point, &foot) <= margin) continue;
        left++;
        for (int k = 0; k < 3; k++) mean[k] += arm[k];
    }
    for (int k = 0; k < 3 && left; k++) mean[k] /= left;
    return (double)left / RING;
}
