/* segment/strap_feet.c: where the tip of one blade lies on another, the tree that grows from the tips has one leaf of both.
 * The same tree upside down grows from the feet: where two legs of a leaf meet that are two leaves', the meeting is a touch. Where the tree had
 * both tips, too, but one leaf got all the trunk, each leg goes on in the tip that lies on its arc. */
#include "segment/strap_feet.h"

#include "segment/scratch.h"
#include "segment/strap_legs.h"
#include "segment/strap_match.h"

#include <math.h>

/* In R: a leg ends with the nearest point of the other, which may have gone over to it a little before they meet. */
static const double UNSURE = 0.6;
/* A point is on the nearest arc if it is nearer to it by such a factor than to the next. */
static const double NEARER = 0.5;

typedef struct work {
    plm_sketch *sketch;
    const float *from_base;
    const int32_t *branch; /* of the tree that grows from the tips */
    plm_strap_legs legs;
    int32_t *leaf;    /* of each leg, the leaf that it becomes; -1: none of its own */
    bool *split;      /* leaves that are taken apart, ... */
    bool *has_tip;    /* ... and those whose tip is known for theirs */
    int32_t *nearest; /* of points of those, the leaf whose arc is nearest by far, -1: none is */
} work;

static bool do_touch(const work *w, int32_t a, int32_t b)
{
    const plm_graph *graph = &w->sketch->graph;
    for (size_t i = 0; i < graph->count; i++) {
        if (w->sketch->leaf[i] != a) continue;
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++)
            if (w->sketch->leaf[graph->edge[e]] == b) return true;
    }
    return false;
}

/* Legs that are apart, of one leaf, and the tips that they may go on in: its own first, and those of leaves without a foot that it
 * touches. */
typedef struct knot {
    size_t legs, tips;
    size_t leg[PLM_STRAP_PIECES_MOST];
    int32_t tip[PLM_STRAP_PIECES_MOST];
} knot;

/* Takes the legs out that are parts of the tip: where tips are known, their points are the tip's. */
static void drop_inner_legs(const work *w, int32_t own, knot *k)
{
    size_t kept = 0;
    for (size_t j = 0; j < k->legs; j++) {
        size_t points = 0, inner = 0;
        for (size_t i = 0; i < w->sketch->working.count; i++) {
            if (w->legs.leg[i] != (int32_t)k->leg[j]) continue;
            points++;
            inner += w->branch[i] == own;
        }
        if (2 * inner < points) k->leg[kept++] = k->leg[j];
    }
    k->legs = kept;
}

static knot find_knot(const work *w, int32_t own, size_t leaves)
{
    const plm_sketch *s = w->sketch;
    knot found = {.tips = 1, .tip = {own}};
    /* where the tip is part of a leg, nothing lies beyond a meeting of legs */
    if (w->legs.tip[own] != UINT32_MAX && w->legs.leg[w->legs.tip[own]] >= 0) return found;
    for (size_t k = 0; k < w->legs.legs && found.legs < PLM_STRAP_PIECES_MOST; k++) {
        bool is_apart = s->leaf[w->legs.low[k]] == own && plm_strap_is_wide(&w->legs, k);
        for (size_t j = 0; j < k && is_apart; j++)
            if (s->leaf[w->legs.low[j]] == own && plm_strap_is_wide(&w->legs, j))
                is_apart = plm_strap_are_apart(&w->legs, k, j);
        if (is_apart) found.leg[found.legs++] = k;
    }
    for (size_t k = 0; k < leaves && found.legs > 1 && found.tips < PLM_STRAP_PIECES_MOST; k++)
        if ((int32_t)k != own && !w->split[k] && plm_strap_has_no_foot(&w->legs, k) && do_touch(w, own, (int32_t)k))
            found.tip[found.tips++] = (int32_t)k;
    knot outer = found;
    drop_inner_legs(w, own, &outer);
    if (found.tips > 1 && outer.legs > 1) return outer;
    found.tips = 1;
    return found;
}

/* Way from the base and place of a point, as pieces of blades take them. */
static double measure(const work *w, size_t i, double place[3])
{
    const plm_sketch *s = w->sketch;
    for (int axis = 0; axis < 3; axis++)
        place[axis] = ((double)s->working.xyz[i][axis] - s->stem.node[0][axis]) / s->scale.size;
    return w->from_base[i] / s->scale.size;
}

static void add_pieces(const work *w, const knot *k, plm_strap_piece *leg, plm_strap_piece *tip)
{
    const plm_sketch *s = w->sketch;
    double place[3];
    for (size_t i = 0; i < s->working.count; i++) {
        if (s->leaf[i] < 0 || !isfinite(w->legs.upside[i])) continue;
        const double way = measure(w, i, place);
        const bool is_tip = w->branch[i] == s->leaf[i];
        for (size_t j = 0; j < k->legs && !is_tip; j++)
            if (w->legs.leg[i] == (int32_t)k->leg[j]) plm_strap_piece_add(&leg[j], way, place);
        for (size_t j = 0; j < k->tips && is_tip; j++)
            if (s->leaf[i] == k->tip[j]) plm_strap_piece_add(&tip[j], way, place);
    }
}

/* Points of a knot that lie far nearer to one blade's arc than to any other's. */
static void find_nearest(work *w, const knot *k, const plm_strap_arc *arc, const int32_t *leaf, size_t arcs)
{
    const plm_sketch *s = w->sketch;
    double place[3];
    for (size_t i = 0; i < s->working.count; i++) {
        bool is_member = false;
        for (size_t j = 0; j < k->tips; j++) is_member |= s->leaf[i] == k->tip[j];
        if (!is_member || !isfinite(w->legs.upside[i])) continue;
        const double way = measure(w, i, place);
        double least = INFINITY, second = INFINITY;
        int32_t best = -1;
        for (size_t j = 0; j < arcs; j++) {
            const double d = plm_strap_arc_distance(&arc[j], way, place);
            second = fmin(second, fmax(d, least));
            if (d < least) least = d, best = leaf[j];
        }
        w->nearest[i] = least < NEARER * second ? best : -1;
    }
}

/* Which tip each leg of a knot goes on in, and, where each tip has one and all arcs are known, what lies clearly on the way. */
static void match(work *w, const knot *k, int *tip_of_leg)
{
    plm_strap_piece leg[PLM_STRAP_PIECES_MOST] = {0}, tip[PLM_STRAP_PIECES_MOST] = {0};
    plm_strap_arc arc[PLM_STRAP_PIECES_MOST];
    int32_t leaf[PLM_STRAP_PIECES_MOST];
    size_t arcs = 0;
    add_pieces(w, k, leg, tip);
    plm_strap_match(leg, k->legs, tip, k->tips, tip_of_leg);
    for (size_t j = 0; j < k->legs; j++) {
        if (tip_of_leg[j] < 0 || !plm_strap_find_arc(&leg[j], &tip[tip_of_leg[j]], &arc[arcs])) continue;
        leaf[arcs++] = k->tip[tip_of_leg[j]];
    }
    if (arcs == k->legs && arcs == k->tips) find_nearest(w, k, arc, leaf, arcs);
}

/* The leaf of each leg of a knot: without other tips the first keeps the number. */
static void name_knot(work *w, const knot *k, size_t most, double *foot, size_t *leaves)
{
    int tip_of_leg[PLM_STRAP_PIECES_MOST];
    for (size_t j = 0; j < k->legs; j++) tip_of_leg[j] = j ? -1 : 0;
    if (k->tips > 1) match(w, k, tip_of_leg);
    for (size_t j = 0; j < k->legs; j++) {
        const size_t leg = k->leg[j];
        if (tip_of_leg[j] < 0 && *leaves == most) continue;
        w->leaf[leg] = tip_of_leg[j] < 0 ? (int32_t)(*leaves)++ : k->tip[tip_of_leg[j]];
        foot[w->leaf[leg]] = w->from_base[w->legs.low[leg]]; /* its own, not the lowest of all */
    }
    for (size_t j = 0; j < k->tips; j++) {
        w->split[k->tip[j]] = true;
        w->has_tip[k->tip[j]] = k->tips > 1;
    }
}

/* Names the legs of all leaves, and gives whether any leaf is taken apart. */
static bool name_legs(work *w, double *foot, size_t *leaves)
{
    const size_t before = *leaves;
    bool any = false;
    for (size_t k = 0; k < w->legs.legs; k++) w->leaf[k] = -1;
    for (size_t i = 0; i < w->sketch->working.count; i++) w->nearest[i] = -1;
    for (size_t own = 0; own < before; own++) {
        if (w->split[own]) continue;
        const knot found = find_knot(w, (int32_t)own, before);
        if (found.legs < 2) continue;
        name_knot(w, &found, before + PLM_STRAP_FEET_MOST, foot, leaves);
        any = true;
    }
    return any;
}

/* How far a point of a leg is from where the leg ends, along the graph. */
static double before_meeting(const work *w, int32_t leg, size_t i)
{
    return (double)w->legs.length[leg] - ((double)w->legs.upside[w->legs.low[leg]] - w->legs.upside[i]);
}

/* Legs and known tips become their leaves; what lies about the meeting of legs, beyond it and near the stem waits to be shared out. */
static void take_apart(const work *w, bool *beyond)
{
    plm_sketch *s = w->sketch;
    const double unsure = UNSURE * s->scale.radius;
    for (size_t i = 0; i < s->working.count; i++) {
        const int32_t own = s->leaf[i], leg = w->legs.leg[i];
        beyond[i] = false;
        if (own < 0 || s->is_stem[i] || !w->split[own]) continue;
        if (w->has_tip[own] && w->branch[i] == own) continue;
        const bool is_leg = leg >= 0 && (w->leaf[leg] >= 0 || !w->has_tip[own]);
        beyond[i] = isfinite(w->legs.upside[i]) &&
                    (!is_leg || before_meeting(w, leg, i) < fmin(unsure, 0.5 * (double)w->legs.length[leg]));
        s->leaf[i] = is_leg && !beyond[i] ? w->leaf[leg] : w->nearest[i];
    }
}

plm_status plm_strap_feet(plm_sketch *sketch, const float *from_base, const int32_t *branch, bool *beyond, double *foot,
                          size_t *leaves, bool *apart, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.sketch = sketch,
              .from_base = from_base,
              .branch = branch,
              .split = plm_scratch_take(&scratch, *leaves + 1, sizeof *w.split),
              .has_tip = plm_scratch_take(&scratch, *leaves + 1, sizeof *w.has_tip),
              .nearest = plm_scratch_take(&scratch, sketch->working.count, sizeof *w.nearest)};
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) status = plm_strap_find_legs(sketch, from_base, *leaves, &scratch, &w.legs);
    w.leaf = plm_scratch_take(&scratch, w.legs.legs + 1, sizeof *w.leaf);
    if (status == PLM_OK && scratch.failed) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        *apart = name_legs(&w, foot, leaves);
        if (*apart) take_apart(&w, beyond);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
