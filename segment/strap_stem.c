/* segment/strap_stem.c: where a strap leaf leaves the stem. The feet of the leaves wrap the stem and are forked from it
 * only where a gap shows, so what lies below the forks is neither all of the stem nor nothing but stem. The stem is a closed
 * tube: circles across it, whose radius changes slowly along it, tell its surface; a leaf begins where it leaves that
 * surface by more than the tube's own points scatter about it. Beyond the last fork the stem goes on as long as the tube is
 * closed and does not widen: a sheath that opens into a leaf widens, an internode does not. */
#include "segment/strap_stem.h"

#include "cloud/linear.h"
#include "segment/scratch.h"
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
static const double GAIN = 0.4, GAIN_WIDE = 0.12;  /* how far the line follows a circle; one that is too wide */
static const double FOOT_LIKE = 1.2;               /* wider than this: of a foot and the stem together */
static const double FOOT_POWER = 8;                /* by which wide circles count less */
static const double CLOSED_LEAST = 0.05;           /* an open circle counts so much */
static const double MARGIN = 1.07, SCATTERS = 2.5; /* surface: within so many radii and scatters of the line, ... */
static const double NOISE_SCATTERS = 1.5;          /* ... this many as far as they are noise */
static const double FARTHEST = 3.3;                /* more than margin and scatters can come to */
static const double NEAR_SURFACE = 1.6;            /* points within so many radii tell the scatter */
static const double END_CAP = 0.3;                 /* the stem's end rises so many radii above its last node */
/* A tube of which less of the directions have points, over all the trunk, may be the wrong one: wider ones are tried, each by WIDER, and
 * taken where more by GAINED have, and so many in all. (Three real maize of 17 gain 0.19 to 0.42 and come to 0.66 to 0.80, and so do the
 * stems' labels: IoU 0.21 and 0.80, 0.38 and 0.59, 0.51 and 0.69. Of 28 others, real and virtual, none gains more than 0.08; a stem of few
 * points 0.17, which makes 0.32.) */
static const double NOT_CLOSED = 0.7, GAINED = 0.15, FAIRLY_CLOSED = 0.5, WIDER = 1.6;
enum {
    SECTORS = 12,
    PASSES = 5,
    ARM = 4,    /* nodes to both sides for the direction; a node stands for R / 4 */
    ABOUT = 8,  /* nodes to both sides for the radius */
    BACK = 12,  /* the tube is followed from so many nodes below the last fork: its foot has drawn the line aside */
    LEVER = 16, /* nodes for the direction where it is followed */
    MISSED = 5, /* nodes without a tube that end it */
    WIDER_TRIED = 3,
    MOST_BEYOND = 400,
    LEAST_NODES = 6,
    LEAST_POINTS = 8
};

/* The tube under way: nodes, the radius of each one's circle and the share of directions with points. */
typedef struct tube {
    const plm_sketch *sketch;
    plm_stem_path path;
    double *closed;
    double *low;        /* radius without the feet */
    double (*moved)[3]; /* buffer: nodes */
    float *value;       /* buffer */
    double (*e)[2];     /* buffer: points across the line */
    uint32_t *near;     /* points about the trunk */
    size_t near_count;
} tube;

static double low_radius(const tube *t, size_t from, size_t to)
{
    for (size_t k = from; k < to; k++) t->value[k - from] = (float)t->path.radius[k];
    return plm_quantile(t->value, to - from, LOW);
}

/* A stem does not widen upwards: where circles do, even most of them, they hold feet. */
static void find_low(tube *t)
{
    double least = INFINITY;
    for (size_t n = 0; n < t->path.count; n++) {
        const size_t end = n + ABOUT + 1 < t->path.count ? n + ABOUT + 1 : t->path.count;
        const double low = low_radius(t, n > ABOUT ? n - ABOUT : 0, end);
        least = fmin(least, low);
        t->low[n] = fmin(low, WIDENED * least);
    }
}

static void direction(const plm_stem_path *path, size_t from, size_t to, double out[3])
{
    for (int axis = 0; axis < 3; axis++) out[axis] = path->node[to][axis] - path->node[from][axis];
    plm_normalise(out);
}

/* Share of the directions about the circle in which points lie on it. */
static double share_closed(const tube *t, size_t count, const double x[3])
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

/* The points in the line's box, widened by so many radii: most of the leaves are not. */
static void find_near(tube *t, double radii)
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

/* The circle about a place of the line. x: its centre across the line and its radius; false: too few points. */
static bool fit_circle(const tube *t, const double at[3], const double along[3], double radius, double centre[3],
                       double *found, double *closed)
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
static void straighten(tube *t)
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
static void fit_trunk(tube *t)
{
    find_low(t);
    for (size_t n = 0; n < t->path.count; n++) {
        double along[3];
        direction(&t->path, n > ARM ? n - ARM : 0, n + ARM < t->path.count ? n + ARM : t->path.count - 1, along);
        t->closed[n] = 0;
        memcpy(t->moved[n], t->path.node[n], sizeof *t->moved);
        fit_circle(t, t->path.node[n], along, t->low[n], t->moved[n], &t->path.radius[n], &t->closed[n]);
    }
    memcpy(t->path.node, t->moved, t->path.count * sizeof *t->path.node);
}

/* Follows the tube on from its last node until it is no longer one. */
static void follow(tube *t, double step, size_t most)
{
    for (int missed = 0; t->path.count < most && missed < MISSED; t->path.count++) {
        const size_t last = t->path.count - 1, n = t->path.count;
        double along[3], at[3], centre[3];
        direction(&t->path, last > LEVER ? last - LEVER : 0, last, along);
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

static double middle_radius(const tube *t, size_t n)
{
    const size_t from = n > 2 ? n - 2 : 0, to = n + 3 < t->path.count ? n + 3 : t->path.count;
    for (size_t k = from; k < to; k++) t->value[k - from] = (float)t->path.radius[k];
    return plm_quantile(t->value, to - from, 0.5);
}

/* Ends the tube at the node up to which it is a stem by the largest surplus of nodes. fork: number of nodes of the trunk. */
static void cut_end(tube *t, size_t fork)
{
    const size_t lower = fork / 2 > LEAST_NODES ? fork / 2 : LEAST_NODES;
    for (size_t k = 0; k < lower; k++) t->value[k] = (float)t->path.radius[k];
    const double wide = WIDE * plm_quantile(t->value, lower, 0.5);
    double least = INFINITY;
    long surplus = 0, most = 0;
    size_t end = LEAST_NODES;
    find_low(t);
    for (size_t n = 0; n < t->path.count; n++) {
        const double radius = middle_radius(t, n);
        bool is_stem = radius <= wide;
        if (n >= fork) is_stem = t->closed[n] >= CLOSED && radius <= WIDENED * least;
        if (n < fork || is_stem) least = fmin(least, n < fork ? t->low[n] : radius);
        surplus += is_stem ? 1 : -1;
        if (surplus > most) most = surplus, end = n + 1;
    }
    t->path.count = end > LEAST_NODES ? end : LEAST_NODES;
    find_low(t);
}

/* Nodes of the stem's path as far as it is trunk. */
static size_t trunk_nodes(const plm_sketch *sketch)
{
    double top = 0;
    size_t n = 0;
    for (size_t i = 0; i < sketch->working.count; i++) {
        plm_stem_place place = {0};
        if (!sketch->is_stem[i] || sketch->leaf[i] >= 0) continue;
        plm_stem_nearest(&sketch->stem, sketch->working.xyz[i], &place);
        top = fmax(top, place.along);
    }
    while (n < sketch->stem.count && sketch->stem.along[n] <= top) n++;
    return n;
}

/* Distance of each point from the tube's line over the radius there: INFINITY far off and beyond the tube's end. */
static void measure_offsets(tube *t, float *offset)
{
    const plm_sketch *sketch = t->sketch;
    const plm_stem_path *stem = &t->path;
    const size_t last = stem->count - 1;
    double end_along[3];
    direction(stem, last > ARM ? last - ARM : 0, last, end_along);
    find_near(t, FARTHEST);
    for (size_t i = 0; i < sketch->working.count; i++) offset[i] = INFINITY;
    for (size_t k = 0; k < t->near_count; k++) {
        const uint32_t i = t->near[k];
        plm_stem_place place = {0};
        const double d = plm_stem_nearest(stem, sketch->working.xyz[i], &place);
        const double above = place.along < stem->along[last] ? 0 : plm_dot(place.offset, end_along);
        offset[i] = above > END_CAP * place.radius ? INFINITY : (float)(d / place.radius);
    }
}

/* Up to which offset points are the stem's. What scatters about the tube is its own, all of it, as far as it is the tube's
 * shape; noise spreads stem and feet alike, and beyond some of it there are more points of feet than of the stem. shape: the
 * share that the shape has in the scatter is the share of its margin that is sure; feet are in the scatter of either. */
static double surface_limit(const tube *t, const float *offset, double *shape)
{
    const size_t count = t->sketch->working.count, nodes = t->path.count;
    size_t near = 0;
    for (size_t i = 0; i < count; i++)
        if (offset[i] < NEAR_SURFACE) t->value[near++] = fabsf(offset[i] - 1);
    const double scatter = 1.4826 * plm_quantile(t->value, near, 0.5);
    for (size_t n = 0; n < nodes; n++) t->value[n] = (float)t->path.radius[n];
    const double noise = fmin(t->sketch->scale.noise / plm_quantile(t->value, nodes, 0.5), scatter);
    const double own = sqrt(scatter * scatter - noise * noise);
    *shape = scatter > 0 ? 1 + (MARGIN - 1 + SCATTERS * own) * own / scatter : MARGIN;
    return MARGIN + hypot(SCATTERS * own, NOISE_SCATTERS * noise);
}

static void mark(plm_sketch *sketch, const float *offset, double limit, size_t leaves, size_t *total, size_t *taken)
{
    const size_t count = sketch->working.count;
    for (size_t i = 0; i < count; i++) {
        const int32_t leaf = sketch->leaf[i];
        sketch->is_stem[i] = offset[i] <= limit;
        if (leaf < 0 || (size_t)leaf >= leaves) continue;
        total[leaf]++;
        taken[leaf] += sketch->is_stem[i];
    }
    for (size_t i = 0; i < count; i++) {
        const int32_t leaf = sketch->leaf[i];
        if (!sketch->is_stem[i] || leaf < 0) continue;
        if (2 * taken[leaf] > total[leaf])
            sketch->is_stem[i] = false; /* a leaf that lies along the stem */
        else
            sketch->leaf[i] = -1;
    }
}

static plm_status make_path(const plm_sketch *sketch, size_t nodes, size_t most, plm_stem_path *path, plm_error *error)
{
    path->count = nodes;
    path->node = plm_alloc_zero(most, sizeof *path->node, error);
    path->radius = plm_alloc_zero(most, sizeof *path->radius, error);
    path->along = plm_alloc_zero(most, sizeof *path->along, error);
    if (!path->node || !path->radius || !path->along) return PLM_E_MEMORY;
    memcpy(path->node, sketch->stem.node, nodes * sizeof *path->node);
    memcpy(path->radius, sketch->stem.radius, nodes * sizeof *path->radius);
    return PLM_OK;
}

/* From the trunk's rough path, of fork nodes, to the stem's tube. */
static void find_tube(const plm_sketch *sketch, tube *t, size_t fork, size_t most)
{
    const double step = sketch->stem.along[1] - sketch->stem.along[0];
    const size_t back = BACK < fork - LEAST_NODES ? BACK : fork - LEAST_NODES;
    for (int pass = 0; pass < PASSES; pass++) {
        find_near(t, REACH);
        fit_trunk(t);
        find_low(t);
        straighten(t);
    }
    t->near_count = sketch->working.count; /* the tube may go anywhere */
    for (uint32_t i = 0; i < t->near_count; i++) t->near[i] = i;
    t->path.count -= back;
    follow(t, step, most);
    cut_end(t, fork);
    memcpy(t->path.radius, t->low, t->path.count * sizeof *t->low);
    plm_stem_measure_along(&t->path);
}

/* Mean share of the directions in which the tube's circles have points, over the trunk; nodes that were cut off have none. */
static double trunk_closed(const tube *t, size_t fork)
{
    const size_t end = fork < t->path.count ? fork : t->path.count;
    double sum = 0;
    for (size_t n = 0; n < end; n++) sum += t->closed[n];
    return sum / (double)fork;
}

/* The rough path's radius is that of the tubes which most balls saw. Where those are curled leaves the stem is wider, and no such circle
 * closes. Of the tube that is taken only the path is kept: closed and low are those of the last try. */
static plm_status find_closed_tube(const plm_sketch *sketch, tube *t, size_t fork, size_t most, plm_error *error)
{
    find_tube(sketch, t, fork, most);
    const double closed = trunk_closed(t, fork);
    if (closed >= NOT_CLOSED) return PLM_OK;
    double least = fmax(closed + GAINED, FAIRLY_CLOSED), factor = WIDER;
    plm_stem_path best = t->path;
    plm_status status = PLM_OK;
    for (int k = 0; k < WIDER_TRIED && status == PLM_OK; k++, factor *= WIDER) {
        t->path = (plm_stem_path){0};
        status = make_path(sketch, fork, most, &t->path, error);
        if (status == PLM_OK) {
            for (size_t n = 0; n < fork; n++) t->path.radius[n] *= factor;
            find_tube(sketch, t, fork, most);
            const double share = trunk_closed(t, fork);
            if (share > least) {
                const plm_stem_path worse = best;
                best = t->path;
                t->path = worse;
                least = share;
            }
        }
        plm_stem_path_free(&t->path);
    }
    t->path = best;
    return status;
}

plm_status plm_strap_stem(plm_sketch *sketch, size_t leaves, double *shape, plm_error *error)
{
    const size_t count = sketch->working.count, fork = trunk_nodes(sketch), most = fork + MOST_BEYOND;
    *shape = INFINITY;
    if (fork <= LEAST_NODES) return PLM_OK;
    plm_scratch scratch = {.error = error};
    tube t = {.sketch = sketch,
              .closed = plm_scratch_take(&scratch, most, sizeof *t.closed),
              .low = plm_scratch_take(&scratch, most, sizeof *t.low),
              .moved = plm_scratch_take(&scratch, most, sizeof *t.moved),
              .value = plm_scratch_take(&scratch, most + count, sizeof *t.value),
              .e = plm_scratch_take(&scratch, count, sizeof *t.e),
              .near = plm_scratch_take(&scratch, count, sizeof *t.near)};
    float *offset = plm_scratch_take(&scratch, count, sizeof *offset);
    size_t *total = plm_scratch_take(&scratch, leaves + 1, sizeof *total);
    size_t *taken = plm_scratch_take(&scratch, leaves + 1, sizeof *taken);
    plm_status status = scratch.failed ? PLM_E_MEMORY : make_path(sketch, fork, most, &t.path, error);
    if (status == PLM_OK) status = find_closed_tube(sketch, &t, fork, most, error);
    if (status == PLM_OK) {
        measure_offsets(&t, offset);
        mark(sketch, offset, surface_limit(&t, offset, shape), leaves, total, taken);
        const plm_stem_path rough = sketch->stem;
        sketch->stem = t.path;
        t.path = rough;
    }
    plm_stem_path_free(&t.path);
    plm_scratch_free(&scratch, NULL);
    return status;
}
