/* segment/strap_feet.c: where the tip of one blade lies on another, the tree that grows from the tips has one leaf of both.
 * The same tree upside down grows from the feet: where two legs of a leaf meet that are long and end apart, or stand on
 * the stem at two nodes, it is two leaves, and the meeting is a touch. */
#include "segment/strap_feet.h"

#include "segment/merge_tree.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"

#include <math.h>

static const double LEG = 0.07;          /* length of a leg below the meeting, in sizes of the plant */
static const double LEAST_SHARE = 0.005; /* of the points that a leg holds at least */
static const double CLEAR = 2;           /* nearer to the stem's line, in its radii, feet wrap the stem and touch */
/* Two legs are two leaves if so long as this, their lower ends so far apart, both in sizes: else a leaf with a slit, ... */
static const double FREE_LEG = 0.1, APART = 0.08;
/* ... or both begin so near to what is cleared away about the stem (radii), so far apart along it (sizes). */
static const double ON_STEM = 1, NODES = 0.05;
/* In R: a leg ends with the nearest point of the other, which may have gone over to it a little before they meet. */
static const double UNSURE = 0.6;

typedef struct work {
    plm_sketch *sketch;
    const float *from_base;
    float *upside, *reach;
    int32_t *leg;
    size_t legs;
    uint32_t *low;   /* of each leg, the point nearest to the base */
    float *length;   /* of each leg, from there on */
    uint32_t *tip;   /* of each leaf, its farthest point */
    int32_t *leaf;   /* of each leg, the leaf that it becomes; -1: none of its own */
    double farthest; /* of all points */
} work;

/* How far a point is outside of what feet wrap; below 0 within it. */
static double clear_of_stem(const plm_sketch *s, uint32_t i, plm_stem_place *place)
{
    const double off = plm_stem_nearest(&s->stem, s->working.xyz[i], place);
    return off - CLEAR * place->radius - 2 * s->scale.noise;
}

static void start_from_feet(work *w)
{
    const plm_sketch *s = w->sketch;
    for (size_t i = 0; i < s->working.count; i++) {
        if (isfinite(w->from_base[i])) w->farthest = fmax(w->farthest, w->from_base[i]);
        w->reach[i] = (float)(LEG * s->scale.size);
    }
    for (uint32_t i = 0; i < s->working.count; i++) {
        plm_stem_place place = {0};
        w->upside[i] = INFINITY;
        if (s->leaf[i] < 0 || s->is_stem[i] || !isfinite(w->from_base[i])) continue;
        if (clear_of_stem(s, i, &place) > 0) w->upside[i] = (float)(w->farthest - w->from_base[i]);
    }
}

static void find_ends(work *w, size_t leaves)
{
    const plm_sketch *s = w->sketch;
    for (size_t k = 0; k < leaves; k++) w->tip[k] = UINT32_MAX;
    for (size_t k = 0; k < w->legs; k++) w->low[k] = UINT32_MAX;
    for (uint32_t i = 0; i < s->working.count; i++) {
        if (!isfinite(w->upside[i])) continue;
        uint32_t *tip = &w->tip[s->leaf[i]];
        if (*tip == UINT32_MAX || w->upside[i] < w->upside[*tip]) *tip = i;
        if (w->leg[i] < 0) continue;
        uint32_t *low = &w->low[w->leg[i]];
        if (*low == UINT32_MAX || w->upside[i] > w->upside[*low]) *low = i;
    }
    for (size_t i = 0; i < s->working.count; i++) {
        if (!isfinite(w->upside[i]) || w->leg[i] < 0) continue;
        float *length = &w->length[w->leg[i]];
        *length = fmaxf(*length, w->upside[w->low[w->leg[i]]] - w->upside[i]);
    }
}

/* Whether a leg begins beside the stem, and where along it. */
static bool find_foot(const work *w, size_t leg, double *along)
{
    plm_stem_place place = {0};
    const double off = clear_of_stem(w->sketch, w->low[leg], &place);
    *along = place.along;
    return off < ON_STEM * place.radius;
}

/* Whether two legs are of two leaves. */
static bool are_apart(const work *w, size_t a, size_t b)
{
    const plm_sketch *s = w->sketch;
    const double size = s->scale.size, shorter = (double)fminf(w->length[a], w->length[b]);
    double first, second;
    if (shorter > FREE_LEG * size && plm_graph_length(&s->graph, w->low[a], w->low[b]) > APART * size) return true;
    return find_foot(w, a, &first) && find_foot(w, b, &second) && fabs(first - second) > NODES * size;
}

static int32_t new_leaf(const work *w, size_t leg, double *foot, size_t *leaves)
{
    foot[*leaves] = w->from_base[w->low[leg]];
    return (int32_t)(*leaves)++;
}

/* The leaf of each leg: the first one of a leaf keeps its number. Where the tip is part of a leg, nothing lies beyond a
 * meeting of legs. */
static void name_legs(work *w, double *foot, size_t *leaves)
{
    const plm_sketch *s = w->sketch;
    const size_t before = *leaves;
    for (size_t k = 0; k < w->legs; k++) {
        const int32_t own = s->leaf[w->low[k]];
        w->leaf[k] = -1;
        if (w->leg[w->tip[own]] >= 0) continue;
        bool is_first = true, is_apart = true;
        for (size_t j = 0; j < k; j++) {
            if (s->leaf[w->low[j]] != own) continue;
            is_first = false;
            is_apart &= are_apart(w, k, j);
        }
        if (is_first)
            w->leaf[k] = own;
        else if (is_apart && *leaves < before + PLM_STRAP_FEET_MOST)
            w->leaf[k] = new_leaf(w, k, foot, leaves);
    }
}

/* How far a point of a leg is from where the leg ends, along the graph. */
static double before_meeting(const work *w, int32_t leg, size_t i)
{
    return (double)w->length[leg] - ((double)w->upside[w->low[leg]] - w->upside[i]);
}

/* Legs become their leaves; what lies about the meeting of legs, beyond it and near the stem waits to be shared out. */
static void take_apart(work *w, size_t before, bool *split, double *foot, bool *beyond)
{
    plm_sketch *s = w->sketch;
    const double unsure = UNSURE * s->scale.radius;
    for (size_t k = 0; k < w->legs; k++)
        if (w->leaf[k] >= (int32_t)before) split[s->leaf[w->low[k]]] = true;
    for (size_t k = 0; k < w->legs; k++) /* the leg that keeps the number stands on its own foot, not on the lowest */
        if (w->leaf[k] >= 0 && w->leaf[k] < (int32_t)before && split[w->leaf[k]])
            foot[w->leaf[k]] = w->from_base[w->low[k]];
    for (size_t i = 0; i < s->working.count; i++) {
        beyond[i] = false;
        if (s->leaf[i] < 0 || s->is_stem[i] || !split[s->leaf[i]]) continue;
        const int32_t leg = w->leg[i];
        beyond[i] = isfinite(w->upside[i]) &&
                    (leg < 0 || before_meeting(w, leg, i) < fmin(unsure, 0.5 * (double)w->length[leg]));
        s->leaf[i] = leg >= 0 && !beyond[i] ? w->leaf[leg] : -1;
    }
}

plm_status plm_strap_feet(plm_sketch *sketch, const float *from_base, bool *beyond, double *foot, size_t *leaves,
                          bool *apart, plm_error *error)
{
    const size_t count = sketch->working.count, before = *leaves;
    plm_scratch scratch = {.error = error};
    work w = {.sketch = sketch,
              .from_base = from_base,
              .upside = plm_scratch_take(&scratch, count, sizeof *w.upside),
              .reach = plm_scratch_take(&scratch, count, sizeof *w.reach),
              .leg = plm_scratch_take(&scratch, count, sizeof *w.leg),
              .tip = plm_scratch_take(&scratch, before + 1, sizeof *w.tip)};
    bool *split = plm_scratch_take(&scratch, before + 1, sizeof *split);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) {
        start_from_feet(&w);
        const plm_merge_rule rule = {.distance = w.upside,
                                     .reach = w.reach,
                                     .apart = sketch->leaf,
                                     .least = (size_t)(LEAST_SHARE * (double)count)};
        status = plm_merge_tree_by(&sketch->graph, &rule, w.leg, &w.legs, error);
    }
    w.low = plm_scratch_take(&scratch, w.legs + 1, sizeof *w.low);
    w.length = plm_scratch_take(&scratch, w.legs + 1, sizeof *w.length);
    w.leaf = plm_scratch_take(&scratch, w.legs + 1, sizeof *w.leaf);
    if (status == PLM_OK && scratch.failed) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        find_ends(&w, before);
        name_legs(&w, foot, leaves);
        if (*leaves > before) take_apart(&w, before, split, foot, beyond);
        *apart = *leaves > before;
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
