/* traits/cut_end.c: the lower rim of a cut tube, from its points' places along the axis. How a rim slants turns each point's place by
 * what the plane through it rises to the axis, so that all points of a rim share one place. Condition: the error is the gap between
 * points along the axis, or the noise along it over the root of the points that it blurs; where points are few, how the rim slants. */
#include "traits/cut_end.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "traits/sample_end.h"

#include <math.h>
#include <string.h>

enum {
    KNOWN = 3,   /* slants: across, halfway, level */
    OBLIQUE = 8, /* and so many ways around */
    SLANTS = KNOWN + OBLIQUE,
    TIP = SLANTS, /* no rim: the tube narrows to a tip */
    ENDS = SLANTS + 1,
    PARTS = 5,
    STEPS = 96,      /* of the grid of rims */
    PASSES = 2,      /* the second about what the first found */
    END_POINTS = 40, /* that a rim is told by, at least, and at most (evenly chosen from more) */
    MOST_POINTS = 300,
    LOWEST = 3 /* points that may be stray */
};

/* How the rim slants, between across the axis (0) and level (1), and how likely that is beforehand; how likely, for all ways
 * together, it is cut so obliquely (tangent) to the axis; and how likely it narrows over so many radii instead. */
static const double slant[KNOWN] = {0, 0.5, 1}, likely[KNOWN] = {0.45, 0.2, 0.2};
static const double oblique = 0.3, oblique_likely = 0.1;
static const double narrows = 2, tip_likely = 0.05;
/* Which part of the noise blurs the rim, all as likely. Few views are left there to mean in a voxel, whose noise then is up to several
 * times that of the plant. */
static const double part_of_noise[PARTS] = {0.1, 0.25, 0.5, 0.75, 1}, part_of_fused[PARTS] = {0.5, 1, 1.5, 2, 3};
/* The points that tell the rim lie so far above it: SD of noise, and times what the rim may rise across the foot. */
static const double noise_depth = 8, slant_depth = 2.5;
static const double stray = 0.02; /* share of the points that are anywhere */
static const double zoom = 5;     /* SD about the mean of the first pass */

/** What tells the rim. Places along the axis. */
typedef struct evidence {
    size_t count;
    double place[ENDS][MOST_POINTS]; /* at which a plane that slants so through a point meets the axis */
    double shift[ENDS]; /* by how much that is less than the point's own place, on the mean around the tube */
    double normal[ENDS][3];
    double narrows[ENDS]; /* depth over which the tube has less and less surface */
    double top;           /* up to which points were taken, by their own places */
} evidence;

/* Places of a point on the axis: its own, and that of a plane with a normal through it. */
static double place_of(const double point[3], const plm_cut_tube *tube, const double normal[3])
{
    double gap[3];
    for (int k = 0; k < 3; k++) gap[k] = point[k] - tube->origin[k];
    return plm_dot(gap, normal) / plm_dot(tube->axis, normal);
}

static void find_normals(const plm_cut_tube *tube, double normal[ENDS][3])
{
    double across[2][3];
    plm_frame_of_axis(tube->axis, across[0], across[1]);
    memcpy(normal[TIP], tube->axis, sizeof normal[TIP]);
    for (int s = 0; s < SLANTS; s++) {
        const double level = s < KNOWN ? slant[s] : 0, angle = 2 * PLM_PI * (s - KNOWN) / OBLIQUE;
        for (int k = 0; k < 3; k++) {
            normal[s][k] = (1 - level) * tube->axis[k] + (k == 2 ? level : 0);
            if (s >= KNOWN) normal[s][k] += oblique * (cos(angle) * across[0][k] + sin(angle) * across[1][k]);
        }
        plm_normalise(normal[s]);
    }
}

static double likely_of(int which)
{
    return which < KNOWN ? likely[which] : which == TIP ? tip_likely : oblique_likely / OBLIQUE;
}

/* Up to where along the axis points tell the rim. own: places of all of count points, which are reordered. */
static double top_of(double *own, size_t count, const plm_cut_tube *tube)
{
    const size_t wanted = END_POINTS < count - 1 ? END_POINTS : count - 1, lowest = LOWEST < wanted ? LOWEST : wanted;
    const double enough = plm_order_select(own, count, wanted), low = plm_order_select(own, count, lowest);
    const double lean = sqrt(fmax(1 - tube->axis[2] * tube->axis[2], 0)) / tube->axis[2],
                 rise = tube->radius * fmax(lean, oblique);
    return fmax(enough, low + fmax(noise_depth * tube->noise, slant_depth * rise));
}

/* own: places of the points, each across the axis. */
static void gather(const double (*xyz)[3], size_t count, const plm_cut_tube *tube, const double *own, evidence *e)
{
    size_t below = 0, seen = 0;
    for (size_t i = 0; i < count; i++) below += own[i] <= e->top;
    const size_t stride = below > MOST_POINTS ? (below + MOST_POINTS - 1) / MOST_POINTS : 1;
    e->count = 0;
    for (size_t i = 0; i < count; i++) {
        for (int s = 0; s < ENDS; s++) e->shift[s] += (own[i] - place_of(xyz[i], tube, e->normal[s])) / (double)count;
        if (own[i] > e->top || seen++ % stride) continue;
        for (int s = 0; s < ENDS; s++) e->place[s][e->count] = place_of(xyz[i], tube, e->normal[s]);
        e->count++;
    }
}

/* The tube's surface at a height above its end, per that far above it, blurred by noise; depth: over which it grows from nothing. */
static double surface_at(double above, double noise, double depth)
{
    if (!(noise > 0)) return above < 0 ? 0 : above < depth ? above / depth : 1;
    double begin[3], full[3];
    plm_blurred_powers(above / noise, begin);
    if (!(depth > 0)) return begin[0];
    plm_blurred_powers((above - depth) / noise, full);
    return noise * (begin[1] - full[1]) / depth;
}

/* Its integral up to a height. */
static double surface_below(double above, double noise, double depth)
{
    if (!(noise > 0)) return above < depth ? above * above / (2 * depth) : above - depth / 2;
    double begin[3], full[3];
    plm_blurred_powers(above / noise, begin);
    if (!(depth > 0)) return noise * begin[1];
    plm_blurred_powers((above - depth) / noise, full);
    return noise * noise * (begin[2] - full[2]) / (2 * depth);
}

/* How likely the points are, in logarithms, where the end is at a place and so much noise blurs it; range: of stray points. */
static double likelihood(const evidence *e, int which, double end, double noise, double range)
{
    const double reach = e->top - end - e->shift[which], depth = e->narrows[which];
    const double surface = fmax(reach > 0 || noise > 0 ? surface_below(reach, noise, depth) : 0, 0.1 * range);
    double sum = 0;
    for (size_t i = 0; i < e->count; i++)
        sum += log((1 - stray) * surface_at(e->place[which][i] - end, noise, depth) / surface + stray / range);
    return sum;
}

/* Height of the lowest place of a rim: the rim's plane falls from the axis as far as the zenith, taken across the axis in it,
 * is long. */
static double lowest_of_rim(const evidence *e, int which, const plm_cut_tube *tube, double rim)
{
    if (which == TIP) return tube->origin[2] + rim * tube->axis[2];
    const double *normal = e->normal[which], steep = tube->axis[2] / plm_dot(tube->axis, normal);
    const double fall[3] = {-steep * normal[0], -steep * normal[1], 1 - steep * normal[2]};
    return tube->origin[2] + rim * tube->axis[2] - fmax(tube->radius + tube->taper * rim, 0) * plm_norm(fall);
}

/** Moments of the posterior. */
typedef struct posterior {
    double total, rim, rim_squares, end, end_squares;
} posterior;

/* Over a grid of rims. Weights are relative to the greatest. */
static posterior integrate(const evidence *e, const plm_cut_tube *tube, double first, double step, double range)
{
    const double *part = tube->fused ? part_of_fused : part_of_noise;
    const int parts = tube->noise > 0 ? PARTS : 1;
    double weight[ENDS][PARTS][STEPS], most = -INFINITY;
    for (int s = 0; s < ENDS; s++)
        for (int p = 0; p < parts; p++)
            for (int k = 0; k < STEPS; k++) {
                const double rim = first + (k + 0.5) * step;
                weight[s][p][k] = log(likely_of(s)) + likelihood(e, s, rim, part[p] * tube->noise, range);
                most = fmax(most, weight[s][p][k]);
            }
    posterior sum = {0};
    for (int s = 0; s < ENDS; s++)
        for (int p = 0; p < parts; p++)
            for (int k = 0; k < STEPS; k++) {
                const double w = exp(weight[s][p][k] - most), rim = first + (k + 0.5) * step;
                const double end = lowest_of_rim(e, s, tube, rim) - tube->origin[2];
                sum.total += w;
                sum.rim += w * rim, sum.rim_squares += w * rim * rim;
                sum.end += w * end, sum.end_squares += w * end * end;
            }
    return sum;
}

static double spread_of(double total, double sum, double squares)
{
    return sqrt(fmax(squares / total - pow(sum / total, 2), 0));
}

plm_status plm_cut_end(const double (*xyz)[3], size_t count, const plm_cut_tube *tube, double *end, double *std_error,
                       plm_error *error)
{
    double *own = plm_alloc(2 * count, sizeof *own, error);
    if (!own) return PLM_E_MEMORY;
    evidence e = {0};
    find_normals(tube, e.normal);
    e.narrows[TIP] = narrows * tube->radius;
    double low = INFINITY;
    for (size_t i = 0; i < count; i++) {
        own[i] = own[count + i] = place_of(xyz[i], tube, tube->axis);
        for (int s = 0; s < ENDS; s++) low = fmin(low, place_of(xyz[i], tube, e.normal[s]));
    }
    e.top = top_of(own + count, count, tube);
    gather(xyz, count, tube, own, &e);
    plm_free(own);
    /* From half as far below the lowest point as the others reach above it, to where a few points would make a tube of their own. */
    const double range = 1.5 * (e.top - low), least = e.top - range, most = e.top - 0.2 * range;
    double first = least, step = (most - least) / STEPS;
    posterior sum = {0};
    for (int pass = 0; pass < PASSES; pass++) {
        sum = integrate(&e, tube, first, step, range);
        const double rim = sum.rim / sum.total, reach = zoom * (spread_of(sum.total, sum.rim, sum.rim_squares) + step);
        first = fmax(rim - reach, least);
        step = (fmin(rim + reach, most) - first) / STEPS;
    }
    *end = tube->origin[2] + sum.end / sum.total;
    *std_error = spread_of(sum.total, sum.end, sum.end_squares);
    return PLM_OK;
}
