/* simulate/blade.c: outlines and bending of leaf blades. */
#include "simulate/blade.h"

#include <string.h>

#include "cloud/linear.h"

/* Half width of a leaf with two margins, not yet scaled: beta profile, waisted between lobes, toothed. */
static double profile(const plm_blade_spec *spec, double t)
{
    if (t <= 0 || t >= 1) return 0;
    const double peak = spec->rise / (spec->rise + spec->fall);
    double half = pow(t / peak, spec->rise) * pow((1 - t) / (1 - peak), spec->fall);
    if (spec->lobe_count > 0) half *= 1 - spec->lobe_depth * 0.5 * (1 + cos(2 * PLM_PI * spec->lobe_count * t));
    if (spec->tooth_count > 0) {
        const double phase = spec->tooth_count * t - floor(spec->tooth_count * t);
        half *= 1 - spec->tooth_depth * phase; /* a saw pointing to the tip */
    }
    return half;
}

void plm_blade_margins(const plm_blade_spec *spec, double t, double half[2])
{
    const double scaled = 0.5 * spec->width * profile(spec, t);
    const double foot = t < 1 ? 0.5 * spec->base_width * (1 - t) * (1 - t) : 0;
    const double both = sqrt(scaled * scaled + foot * foot);
    half[0] = both * (1 + spec->asymmetry);
    half[1] = both * (1 - spec->asymmetry);
}

static void outline_of_margins(plm_blade *blade)
{
    const int side = PLM_OUTLINE_POINTS / 2;
    blade->outline_count = 2 * side;
    for (int k = 0; k < side; k++) {
        /* denser towards both ends, where the margins run across */
        const double t = 0.5 - 0.5 * cos(PLM_PI * k / (side - 1.0));
        double half[2];
        plm_blade_margins(&blade->spec, t, half);
        double *left = blade->outline[k], *right = blade->outline[2 * side - 1 - k];
        left[0] = right[0] = t * blade->spec.length;
        left[1] = half[0];
        right[1] = -half[1];
    }
}

/* Distance of the outline from the centre in direction a from the tip's: an egg shape, lobed, toothed, with the sinus
 * of a heart-shaped base that ends at the junction. */
static double radius_around(const plm_blade_spec *spec, double centre, double a)
{
    const double front = spec->length - centre, back = centre + spec->sinus * spec->length;
    double lobes = 1;
    if (spec->lobe_count > 0) {
        const double wave = pow(fabs(cos(0.5 * spec->lobe_count * a)), spec->lobe_power);
        lobes = 1 - spec->lobe_depth * (1 - wave);
    }
    if (spec->tooth_count > 0) lobes *= 1 - spec->tooth_depth * 0.5 * (1 - cos(spec->tooth_count * a));
    const double egg = 0.5 * (front + back) + 0.5 * (front - back) * cos(a);
    const double round = egg * lobes, away = PLM_PI - fabs(a), width = spec->sinus_width > 0 ? spec->sinus_width : 0.35;
    const double dip = exp(-(away / width) * (away / width));
    return round * (1 - dip) + centre * dip;
}

static void outline_around(plm_blade *blade)
{
    double widest = 0;
    blade->centre = 0.3 * blade->spec.length;
    blade->outline_count = PLM_OUTLINE_POINTS;
    for (int k = 0; k < PLM_OUTLINE_POINTS; k++) {
        const double a = 2 * PLM_PI * k / PLM_OUTLINE_POINTS;
        const double folded = a > PLM_PI ? a - 2 * PLM_PI : a; /* -pi to pi, 0 towards the tip */
        const double r = radius_around(&blade->spec, blade->centre, folded);
        blade->outline[k][0] = blade->centre + r * cos(folded);
        blade->outline[k][1] = r * sin(folded);
        widest = fmax(widest, fabs(blade->outline[k][1]));
    }
    for (int k = 0; k < PLM_OUTLINE_POINTS; k++) {
        double *y = &blade->outline[k][1];
        *y *= 0.5 * blade->spec.width / widest * (*y > 0 ? 1 + blade->spec.asymmetry : 1 - blade->spec.asymmetry);
    }
}

void plm_blade_place(const plm_blade_spec *spec, const double start[3], const plm_frame_at *frame, plm_blade *blade)
{
    blade->spec = *spec;
    blade->centre = 0;
    if (spec->is_palmate)
        outline_around(blade);
    else
        outline_of_margins(blade);
    plm_curve_grow(start, frame, spec->length, &spec->bend, &blade->midrib);
}

/* Sideways and upward offset at arc length a from the midrib: an arc that leaves at angle `fold` with curvature c. */
static void cross_section(double a, double fold, double c, double *sideways, double *up)
{
    const double turn = c * a;
    if (fabs(turn) < 1e-6) {
        *sideways = a * cos(fold + 0.5 * turn);
        *up = a * sin(fold + 0.5 * turn);
    } else {
        *sideways = (sin(fold + turn) - sin(fold)) / c;
        *up = (cos(fold) - cos(fold + turn)) / c;
    }
}

void plm_blade_point(const plm_blade *blade, double x, double y, double point[3])
{
    const plm_blade_spec *spec = &blade->spec;
    const double t = fmin(fmax(x / spec->length, 0), 1), a = fabs(y), share = 2 * a / spec->width;
    double clasp = 0;
    if (spec->clasp_radius > 0) clasp = exp(-x / spec->clasp_length) / spec->clasp_radius;
    const double fold = (spec->fold + (spec->fold_end - spec->fold) * t) * (1 - spec->clasp_radius * clasp);
    double sideways, up;
    cross_section(a, fold, 2 * spec->cup / spec->width + clasp, &sideways, &up);
    const double phase = 2 * PLM_PI * spec->wave_count * x / spec->length + spec->wave_phase[y < 0];
    up += spec->wave * share * share * sin(phase) * fmin(1, 4 * t * (1 - t) + 0.25 * spec->is_palmate);
    const double relief = 2 * PLM_PI * spec->dimple_count / spec->length;
    up += spec->dimple * fmin(1, 4 * share) * sin(relief * (x + 0.8 * a) + spec->dimple_phase) * cos(relief * 0.7 * y);
    plm_frame_at frame;
    plm_curve_at(&blade->midrib, x, point, &frame);
    for (int i = 0; i < 3; i++) point[i] += (y < 0 ? -sideways : sideways) * frame.side[i] + up * frame.normal[i];
}

double plm_blade_rim(const plm_blade *blade, double x, double y)
{
    enum { SKIP = 4 }; /* a polygon of 128 sides will do */
    double nearest = INFINITY;
    for (int k = 0; k < blade->outline_count; k += SKIP) {
        const double *p = blade->outline[k], *q = blade->outline[(k + SKIP) % blade->outline_count];
        const double ex = q[0] - p[0], ey = q[1] - p[1], squared = ex * ex + ey * ey;
        double t = squared > 0 ? ((x - p[0]) * ex + (y - p[1]) * ey) / squared : 0;
        t = fmin(fmax(t, 0), 1);
        const double dx = p[0] + t * ex - x, dy = p[1] + t * ey - y;
        nearest = fmin(nearest, dx * dx + dy * dy);
    }
    return sqrt(nearest);
}

/* Extent of the drawing across at x: from the rightmost to the leftmost crossing of the outline. */
static bool extent_across(const plm_blade *blade, double x, double *low, double *high)
{
    *low = INFINITY, *high = -INFINITY;
    for (int k = 0; k < blade->outline_count; k++) {
        const double *p = blade->outline[k], *q = blade->outline[(k + 1) % blade->outline_count];
        if ((p[0] > x) == (q[0] > x)) continue;
        const double y = p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]);
        *low = fmin(*low, y);
        *high = fmax(*high, y);
    }
    return *high > *low;
}

/* Length of the cross-section at x along the surface, and of its chord. */
static bool section(const plm_blade *blade, double x, double *length, double *chord)
{
    enum { PIECES = 32 };
    double low, high, from[3], before[3], here[3];
    if (!extent_across(blade, x, &low, &high)) return false;
    plm_blade_point(blade, x, low, from);
    memcpy(before, from, sizeof from);
    *length = 0;
    for (int j = 1; j <= PIECES; j++) {
        plm_blade_point(blade, x, low + (high - low) * j / PIECES, here);
        *length += plm_distance(before, here);
        memcpy(before, here, sizeof here);
    }
    *chord = plm_distance(from, before);
    return true;
}

void plm_blade_width(const plm_blade *blade, double *width, double *chord)
{
    enum { SECTIONS = 96 };
    double first = INFINITY, last = -INFINITY, across, straight;
    for (int k = 0; k < blade->outline_count; k++) {
        first = fmin(first, blade->outline[k][0]);
        last = fmax(last, blade->outline[k][0]);
    }
    *width = *chord = 0;
    for (int k = 1; k < SECTIONS; k++) {
        if (!section(blade, first + (last - first) * k / SECTIONS, &across, &straight)) continue;
        *width = fmax(*width, across);
        *chord = fmax(*chord, straight);
    }
}
