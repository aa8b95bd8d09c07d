/* segment/strap_tube.c: a stem amid feet of strap leaves is a closed tube: circles across it, whose radius changes slowly along it, tell
 * its line. Circles that hold a foot are wider, and count less. Beyond the last fork the stem goes on as long as the tube is closed and
 * does not widen: a sheath that opens into a leaf widens, an internode does not. */
#include "segment/strap_tube.h"

#include "cloud/linear.h"
#include "segment/stem_fit.h"

#include <math.h>
#include <string.h>

static const double REACH = 1.8;          /* points within so many radii of the line are looked at */
static const double OUTLIER = 0.35;       /* Tukey's cutoff, in radii, at least */
static const double OUTLIER_SIGMAS = 2.5; /* and in sigmas */
static const double LOW = 0.3;            /* quantile of the radii about a node: feet make every other circle larger */
static const double SHELL = 0.3;          /* half thickness of the surface, in radii, at least */
static const double CLOSED = 0.75;        /* share of the directions in which a closed tube has points */
static const double OPEN = 0.45;          /* less is a blade */
static const double WIDE = 1.4;           /* of the lower stem's radius: the stem has become a whorl of leaves */
static const double WIDENED =
    1.1; /* the same beyond the last fork, and of the radius without feet: of the least below */
static const double GAIN = 0.4, GAIN_WIDE = 0.12; /* how far the line follows a circle; one that is too wide */
static const double FOOT_LIKE = 1.2;              /* wider than this: of a foot and the stem together */
static const double FOOT_POWER = 8;               /* by which wide circles count less */
static const double CLOSED_LEAST = 0.05;          /* an open circle counts so much */
enum {
    SECTORS = 12,
    PASSES = 5,
    ABOUT = 8,  /* nodes to both sides for the radius */
    BACK = 12,  /* the tube is followed from so many nodes below the last fork: its foot has drawn the line aside */
    LEVER = 16, /* nodes for the direction where it is followed */
    MISSED = 5  /* nodes without a tube that end it */
};

static double low_radius(const plm_strap_tube *t, size_t from, size_t to)
{
    for (size_t k = from; k < to; k++) t->value[k - from] = (float)t->path.radius[k];
    return plm_quantile(t->value, to - from, LOW);
}

/* A stem does not widen upwards: where circles do, even most of them, they hold feet. */
static void find_low(plm_strap_tube *t)
{
    double least = INFINITY;
    for (size_t n = 0; n < t->path.count; n++) {
        const size_t end = n + ABOUT + 1 < t->path.count ? n + ABOUT + 1 : t->path.count;
        const double low = low_radius(t, n > ABOUT ? n - ABOUT : 0, end);
        least = fmin(least, low);
        t->low[n] = fmin(low, WIDENED * least);
    }
}

void plm_strap_direction(const plm_stem_path *path, size_t from, size_t to, double out[3])
{
    for (int axis = 0; axis < 3; axis++) out[axis] = path->node[to][axis] - path->node[from][axis];
    plm_normalise(out);
}

/* Share of the directions about the circle in which points lie on it. */
static double share_closed(const plm_strap_tube *t, size_t count, const double x[3])
{
    const plm_sketch *s = t->sketch;
    const double shell = fmax(fmax(SHELL * x[2], 2 * s->scale.noise), s->working.cell);
    bool seen[SECTORS] = {false};
    int sectors = 0;
    for (size_t i = 0; i < count; i++) {
        const double dx = t->e[i][0] - x[0], dy = t->e[i][1] - x[1];
        if (fabs(hypot(dx, dy) - x[2]) >= shell) continue;
        const int sector = (int)((atan2(dy, dx) / (2 * PLM_PI) + 0.5) * SECTORS) % SECTORS;
        sectors += !seen[sector];
        seen[sector] = true;
    }
    return (double)sectors / SECTORS;
}

void plm_strap_tube_find_near(plm_strap_tube *t, double radii)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0;
    for (size_t n = 0; n < t->path.count; n++) {
        most = fmax(most, t->path.radius[n]);
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(low[axis], t->path.node[n][axis]);
            high[axis] = fmax(high[axis], t->path.node[n][axis]);
        }
    }
    const double reach = hypot(radii * most, fmax(most, 2 * t->sketch->working.cell));
    t->near_count = 0;
    for (uint32_t i = 0; i < t->sketch->working.count; i++) {
        const float *p = t->sketch->working.xyz[i];
        bool inside = true;
        for (int axis = 0; axis < 3; axis++) inside &= p[axis] >= low[axis] - reach && p[axis] <= high[axis] + reach;
        if (inside) t->near[t->near_count++] = i;
    }
}

/* The circle about a place of the line: its centre, radius and share of the directions; false: too few points. */
static bool fit_circle(const plm_strap_tube *t, const double at[3], const double along[3], double radius,
                       double centre[3], double *found, double *closed)
{
    const plm_sketch *s = t->sketch;
    const double reach = REACH * radius, half = fmax(radius, 2 * s->working.cell), noise = s->scale.noise;
    const double around = hypot(reach, half);
    double u[3], v[3];
    plm_frame_of_axis(along, u, v);
    size_t count = 0;
    for (size_t i = 0; i < t->near_count; i++) {
        const float *p = s->working.xyz[t->near[i]];
        const double d[3] = {p[0] - at[0], p[1] - at[1], p[2] - at[2]};
        if (fabs(d[0]) > around || fabs(d[1]) > around || fabs(d[2]) > around) continue;
        if (fabs(plm_dot(d, along)) > half) continue;
        const double a = plm_dot(d, u), b = plm_dot(d, v);
        if (a * a + b * b > reach * reach) continue;
        t->e[count][0] = a;
        t->e[count++][1] = b;
    }
    double x[3] = {0, 0, radius};
    if (!plm_stem_circle((const double(*)[2])t->e, count, fmax(noise, 0.05 * radius),
                         fmax(OUTLIER * radius, OUTLIER_SIGMAS * noise), x))
        return false;
    for (int axis = 0; axis < 3; axis++) centre[axis] = at[axis] + x[0] * u[axis] + x[1] * v[axis];
    *found = x[2];
    *closed = share_closed(t, count, x);
    return true;
}

/* Draws the line through the centres: a local straight line about each node, to which circles count the less the wider
 * they are, since these hold a foot and are drawn aside by it, and the less closed. */
static void straighten(plm_strap_tube *t)
{
    const plm_stem_path *path = &t->path;
    for (size_t n = 0; n < path->count; n++) {
        const size_t from = n > ABOUT ? n - ABOUT : 0, to = n + ABOUT < path->count ? n + ABOUT + 1 : path->count;
        double sum[3] = {0}, first[3] = {0}, second[3] = {0}; /* of weights, of places, of places by the offset */
        for (size_t k = from; k < to; k++) {
            const double u = ((double)k - (double)n) / (ABOUT + 1), cubed = 1 - fabs(u) * u * u;
            const double wider = fmin(t->low[k] / path->radius[k], 1);
            const double w = cubed * cubed * cubed * pow(wider, FOOT_POWER) * fmax(t->closed[k], CLOSED_LEAST);
            const double power[3] = {w, w * u, w * u * u};
            for (int axis = 0; axis < 3; axis++) {
                sum[axis] += power[axis];
                first[axis] += w * path->node[k][axis];
                second[axis] += w * u * path->node[k][axis];
            }
        }
        const double spread = sum[0] * sum[2] - sum[1] * sum[1];
        for (int axis = 0; axis < 3; axis++)
            t->moved[n][axis] = (sum[2] * first[axis] - sum[1] * second[axis]) / spread;
    }
    memcpy(path->node, t->moved, path->count * sizeof *path->node);
}

/* Circles about all nodes, which move to their centres. */
static void fit_trunk(plm_strap_tube *t)
{
    find_low(t);
    for (size_t n = 0; n < t->path.count; n++) {
        double along[3];
        plm_strap_direction(&t->path, n > PLM_STRAP_ARM ? n - PLM_STRAP_ARM : 0,
                            n + PLM_STRAP_ARM < t->path.count ? n + PLM_STRAP_ARM : t->path.count - 1, along);
        t->closed[n] = 0;
        memcpy(t->moved[n], t->path.node[n], sizeof *t->moved);
        fit_circle(t, t->path.node[n], along, t->low[n], t->moved[n], &t->path.radius[n], &t->closed[n]);
    }
    memcpy(t->path.node, t->moved, t->path.count * sizeof *t->path.node);
}

/* Follows the tube on from its last node until it is no longer one. */
static void follow(plm_strap_tube *t, size_t most)
{
    const plm_stem_path *rough = &t->sketch->stem;
    const double step = rough->along[1] - rough->along[0];
    t->near_count = t->sketch->working.count; /* the tube may go anywhere */
    for (uint32_t i = 0; i < t->near_count; i++) t->near[i] = i;
    for (int missed = 0; t->path.count < most && missed < MISSED; t->path.count++) {
        const size_t last = t->path.count - 1, n = t->path.count;
        double along[3], at[3], centre[3];
        plm_strap_direction(&t->path, last > LEVER ? last - LEVER : 0, last, along);
        for (int axis = 0; axis < 3; axis++) at[axis] = t->path.node[last][axis] + step * along[axis];
        const double low = low_radius(t, n > 2 * ABOUT ? n - 2 * ABOUT : 0, n);
        memcpy(centre, at, sizeof at);
        t->path.radius[n] = low;
        t->closed[n] = 0;
        fit_circle(t, at, along, low, centre, &t->path.radius[n], &t->closed[n]);
        const double gain = t->path.radius[n] < FOOT_LIKE * low ? GAIN : GAIN_WIDE;
        for (int axis = 0; axis < 3; axis++) t->path.node[n][axis] = at[axis] + gain * (centre[axis] - at[axis]);
        missed = t->closed[n] < OPEN ? missed + 1 : 0;
    }
}

static double middle_radius(const plm_strap_tube *t, size_t n)
{
    const size_t from = n > 2 ? n - 2 : 0, to = n + 3 < t->path.count ? n + 3 : t->path.count;
    for (size_t k = from; k < to; k++) t->value[k - from] = (float)t->path.radius[k];
    return plm_quantile(t->value, to - from, 0.5);
}

/* Ends the tube at the node up to which it is a stem by the largest surplus of nodes. */
static void cut_end(plm_strap_tube *t, size_t sure, size_t trunk)
{
    const size_t lower = sure / 2 > PLM_STRAP_LEAST_NODES ? sure / 2 : PLM_STRAP_LEAST_NODES;
    for (size_t k = 0; k < lower; k++) t->value[k] = (float)t->path.radius[k];
    const double wide = WIDE * plm_quantile(t->value, lower, 0.5);
    double least = INFINITY;
    long surplus = 0, most = 0;
    size_t end = PLM_STRAP_LEAST_NODES;
    find_low(t);
    for (size_t n = 0; n < t->path.count; n++) {
        const double radius = middle_radius(t, n);
        bool is_stem = radius <= wide && (n < sure || t->closed[n] >= CLOSED);
        if (n >= trunk) is_stem = t->closed[n] >= CLOSED && radius <= WIDENED * least;
        if (n < sure || is_stem) least = fmin(least, n < trunk ? t->low[n] : radius);
        surplus += is_stem ? 1 : -1;
        if (surplus > most) most = surplus, end = n + 1;
    }
    t->path.count = end > PLM_STRAP_LEAST_NODES ? end : PLM_STRAP_LEAST_NODES;
    find_low(t);
}

void plm_strap_tube_go_on(plm_strap_tube *t, size_t sure, size_t trunk, size_t most)
{
    follow(t, most);
    cut_end(t, sure, trunk);
    memcpy(t->path.radius, t->low, t->path.count * sizeof *t->low);
    plm_stem_measure_along(&t->path);
}

void plm_strap_tube_find(plm_strap_tube *t, size_t fork, size_t most)
{
    const size_t back = BACK < fork - PLM_STRAP_LEAST_NODES ? BACK : fork - PLM_STRAP_LEAST_NODES;
    for (int pass = 0; pass < PASSES; pass++) {
        plm_strap_tube_find_near(t, REACH);
        fit_trunk(t);
        find_low(t);
        straighten(t);
    }
    t->path.count -= back;
    plm_strap_tube_go_on(t, fork, fork, most);
}
