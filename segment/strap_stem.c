/* segment/strap_stem.c: where a strap leaf leaves the stem. The feet of the leaves wrap the stem and are forked from it
 * only where a gap shows, so what lies below the forks is neither all of the stem nor nothing but stem. A leaf begins where it leaves
 * the surface of the stem's tube (segment/strap_tube.c) by more than the tube's own points scatter about it. */
#include "segment/strap_stem.h"

#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"
#include "segment/strap_tube.h"

#include <math.h>
#include <string.h>

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
/* Where two leaves lie on each other, what forks from the stem is seen late, and the rough path runs on into one of them: it turns by so much
 * (radians, over TURN_ARM nodes to both sides), above so large a share of its nodes. The tube that goes straight on is taken
 * where its circles are no less closed than those on the way, and so large a share of theirs at least. */
static const double TURN = 0.15, TURN_ABOVE = 1. / 3, STRAIGHT_LEAST = 0.4;
enum { WIDER_TRIED = 3, MOST_BEYOND = 400, TURN_ARM = 8 };

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
static void measure_offsets(plm_strap_tube *t, float *offset)
{
    const plm_sketch *sketch = t->sketch;
    const plm_stem_path *stem = &t->path;
    const size_t last = stem->count - 1;
    double end_along[3];
    plm_strap_direction(stem, last > PLM_STRAP_ARM ? last - PLM_STRAP_ARM : 0, last, end_along);
    plm_strap_tube_find_near(t, FARTHEST);
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
static double surface_limit(const plm_strap_tube *t, const float *offset, double *shape)
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

/* The first nodes of a path, with room for most. */
static plm_status make_path(const plm_stem_path *from, size_t nodes, size_t most, plm_stem_path *path, plm_error *error)
{
    path->count = nodes;
    path->node = plm_alloc_zero(most, sizeof *path->node, error);
    path->radius = plm_alloc_zero(most, sizeof *path->radius, error);
    path->along = plm_alloc_zero(most, sizeof *path->along, error);
    if (!path->node || !path->radius || !path->along) return PLM_E_MEMORY;
    memcpy(path->node, from->node, nodes * sizeof *path->node);
    memcpy(path->radius, from->radius, nodes * sizeof *path->radius);
    return PLM_OK;
}

/* Mean share of the directions in which the tube's circles have points, over its nodes [from, to); those that were cut off have none. */
static double mean_closed(const plm_strap_tube *t, size_t from, size_t to)
{
    const size_t end = to < t->path.count ? to : t->path.count;
    double sum = 0;
    for (size_t n = from; n < end; n++) sum += t->closed[n];
    return sum / (double)(to - from);
}

/* Another try: the tube's path and shares, and room for such. */
typedef struct rival {
    plm_stem_path path;
    double *closed;
} rival;

static void swap(plm_strap_tube *t, rival *r)
{
    const rival other = *r;
    *r = (rival){t->path, t->closed};
    t->path = other.path;
    t->closed = other.closed;
}

/* Keeps the tube or its rival, which is swapped in. */
static void choose(plm_strap_tube *t, rival *r, bool rival_is_better)
{
    if (!rival_is_better) swap(t, r);
    plm_stem_path_free(&r->path);
    r->path = (plm_stem_path){0};
}

/* The rough path's radius is that of the tubes which most balls saw. Where those are curled leaves the stem is wider, and no such circle
 * closes. */
static plm_status find_closed_tube(plm_strap_tube *t, rival *r, size_t fork, size_t most, plm_error *error)
{
    plm_strap_tube_find(t, fork, most);
    const double closed = mean_closed(t, 0, fork);
    if (closed >= NOT_CLOSED) return PLM_OK;
    double least = fmax(closed + GAINED, FAIRLY_CLOSED), factor = WIDER;
    plm_status status = PLM_OK;
    for (int k = 0; k < WIDER_TRIED && status == PLM_OK; k++, factor *= WIDER) {
        double share = 0;
        swap(t, r);
        status = make_path(&t->sketch->stem, fork, most, &t->path, error);
        if (status == PLM_OK) {
            for (size_t n = 0; n < fork; n++) t->path.radius[n] *= factor;
            plm_strap_tube_find(t, fork, most);
            share = mean_closed(t, 0, fork);
        }
        choose(t, r, share > least);
        least = fmax(least, share);
    }
    return status;
}

/* The node at which the path turns most; 0: it does not turn. Noise makes the way turn over more nodes than plm_stem_turn looks at. */
static size_t find_turn(const plm_stem_path *path)
{
    size_t best = 0;
    double least = cos(TURN);
    for (size_t n = PLM_STRAP_LEAST_NODES + TURN_ARM / 2; n + TURN_ARM < path->count; n++) {
        double below[3], beyond[3];
        if ((double)n < TURN_ABOVE * (double)path->count) continue;
        plm_strap_direction(path, n - TURN_ARM, n, below);
        plm_strap_direction(path, n, n + TURN_ARM, beyond);
        const double cosine = plm_dot(below, beyond);
        if (cosine < least) least = cosine, best = n;
    }
    return best;
}

static plm_status go_straight(plm_strap_tube *t, rival *r, size_t fork, size_t most, plm_error *error)
{
    const size_t turn = find_turn(&t->path), old = t->path.count;
    if (!turn) return PLM_OK;
    const size_t cut = turn - TURN_ARM / 2;
    const double was = mean_closed(t, turn, old);
    bool is_better = false;
    swap(t, r);
    const plm_status status = make_path(&r->path, cut, most, &t->path, error);
    if (status == PLM_OK) {
        memcpy(t->closed, r->closed, cut * sizeof *t->closed);
        plm_strap_tube_go_on(t, cut, cut > fork ? cut : fork, most);
        const size_t count = t->path.count;
        const double now = count > turn ? mean_closed(t, turn, count) : 0;
        is_better =
            count > turn && now >= was && now * (double)(count - turn) > STRAIGHT_LEAST * was * (double)(old - turn);
        if (is_better)
            memcpy(t->path.radius, r->path.radius, cut * sizeof *t->path.radius); /* feet are out of these already */
    }
    choose(t, r, is_better);
    return status;
}

plm_status plm_strap_stem(plm_sketch *sketch, size_t leaves, double *shape, plm_error *error)
{
    const size_t count = sketch->working.count, fork = trunk_nodes(sketch), most = fork + MOST_BEYOND;
    *shape = INFINITY;
    if (fork <= PLM_STRAP_LEAST_NODES) return PLM_OK;
    plm_scratch scratch = {.error = error};
    plm_strap_tube t = {.sketch = sketch,
                        .closed = plm_scratch_take(&scratch, most, sizeof *t.closed),
                        .low = plm_scratch_take(&scratch, most, sizeof *t.low),
                        .moved = plm_scratch_take(&scratch, most, sizeof *t.moved),
                        .value = plm_scratch_take(&scratch, most + count, sizeof *t.value),
                        .e = plm_scratch_take(&scratch, count, sizeof *t.e),
                        .near = plm_scratch_take(&scratch, count, sizeof *t.near)};
    rival r = {.closed = plm_scratch_take(&scratch, most, sizeof *r.closed)};
    float *offset = plm_scratch_take(&scratch, count, sizeof *offset);
    size_t *total = plm_scratch_take(&scratch, leaves + 1, sizeof *total);
    size_t *taken = plm_scratch_take(&scratch, leaves + 1, sizeof *taken);
    plm_status status = scratch.failed ? PLM_E_MEMORY : make_path(&sketch->stem, fork, most, &t.path, error);
    if (status == PLM_OK) status = find_closed_tube(&t, &r, fork, most, error);
    if (status == PLM_OK) status = go_straight(&t, &r, fork, most, error);
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
