/* segment/leaflet_stalks.c: the thin stalks of leaflets are seen by few points or none. A leaflet that has lost its own and touches
 * another leaf hangs on that one. Where its base lies tells: a leaflet runs away from its rachis, and is touched at its side. So where
 * a blade lies near another leaf's tube, the piece of it is sought, by minimum cuts, that would be a leaflet there and that its leaf
 * touches at the side only. The cut parts it from that leaf, and a link takes the stalk's place. */
#include "segment/leaflet_stalks.h"

#include "cloud/neighbours.h"
#include "segment/leaflet_shape.h"
#include "segment/min_cut.h"
#include "segment/scratch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double GAP = 1;     /* in R: the longest stalk that is not seen */
static const double APART = 1.5; /* in R: places of one blade that are nearer to each other are one */
/* What is cut off holds all points so near to the base (in R), and each of its points has a price (over the root of the blade's, in
 * edges of a cell): the higher it is, the smaller pieces are tried. */
static const double WITHIN[] = {0.5, 1, 1.5, 2, 3, 4};
static const double PRICE[] = {0, 0.15, 0.25, 0.4, 0.6, 0.8, 1.1, 1.5, 2, 3};
enum {
    MOST = 64,   /* places where a stalk may be */
    ROOM = 4096, /* points about one of a tube */
    SEEN = 8,    /* blades about one of a tube */
    REACHES = sizeof WITHIN / sizeof *WITHIN,
    PRICES = sizeof PRICE / sizeof *PRICE
};

/* A blade near another leaf's tube. */
typedef struct stalk {
    uint32_t tube, base; /* the two points that are nearest */
    int32_t home, guest; /* groups of the tube and of the blade */
    int32_t blade;
    double gap;
} stalk;

typedef struct work {
    plm_sketch *sketch;
    const plm_side_groups *groups;
    stalk stalk[MOST];
    size_t stalks;
    uint32_t *parent; /* of each point, on the way from the stem */
    uint32_t *beyond; /* points of its leaf, but not of its blade, that are reached through it */
    float *from_base; /* distance from the base in work, within its blade */
    plm_net net;      /* the blade in work */
    bool *inside;     /* of a node: it is in the piece in work */
    double (*piece)[3];
    int32_t *colour, *component;
    uint32_t *stack;
    bool *allowed; /* of a point: it is of the blade in work */
    bool *best;    /* of a node: it is in the piece that was found */
    int32_t *part; /* of each point: the number of the leaflet that is parted off, 0 in leaves that lost one, else -1 */
} work;

/* ---- Where blades lie near tubes -------------------------------------------------------------------------------- */

static bool is_joined(const plm_graph *graph, uint32_t a, uint32_t b)
{
    for (uint32_t e = graph->first[a]; e < graph->first[a + 1]; e++)
        if (graph->edge[e] == b) return true;
    return false;
}

static void propose(work *w, uint32_t tube, uint32_t base)
{
    const plm_sketch *s = w->sketch;
    const stalk found = {.tube = tube,
                         .base = base,
                         .home = s->group[tube],
                         .guest = s->group[base],
                         .blade = w->groups->blade[base],
                         .gap = plm_graph_length(&s->graph, tube, base)};
    for (size_t k = 0; k < w->stalks; k++) {
        stalk *old = &w->stalk[k];
        if (old->home != found.home || old->blade != found.blade) continue;
        if (plm_graph_length(&s->graph, old->base, base) > APART * s->scale.radius) continue;
        if (found.gap < old->gap) *old = found;
        return;
    }
    if (w->stalks < MOST) w->stalk[w->stalks++] = found;
}

/* The nearest point of each blade of another leaf about a tube's point, if the two are not joined. */
static void propose_about(work *w, const plm_index *index, uint32_t tube, uint32_t *row, float *squared)
{
    const plm_sketch *s = w->sketch;
    const float reach = (float)(GAP * s->scale.radius);
    const size_t all = plm_index_ball(index, s->working.xyz[tube], reach, ROOM, row, squared);
    const size_t found = all < ROOM ? all : ROOM;
    int32_t seen[SEEN];
    int count = 0;
    for (size_t k = 0; k < found && count < SEEN; k++) {
        const int32_t blade = w->groups->blade[row[k]];
        if (blade < 0 || s->group[row[k]] < 0 || s->group[row[k]] == s->group[tube]) continue;
        if (w->groups->blade_area[blade] < plm_blade_least(s)) continue;
        int known = 0;
        while (known < count && seen[known] != blade) known++;
        if (known < count) continue;
        seen[count++] = blade;
        if (!is_joined(&s->graph, tube, row[k])) propose(w, tube, row[k]);
    }
}

static plm_status propose_all(work *w, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    plm_scratch scratch = {.error = error};
    plm_index *index = NULL;
    uint32_t *row = plm_scratch_take(&scratch, ROOM, sizeof *row);
    float *squared = plm_scratch_take(&scratch, ROOM, sizeof *squared);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])s->working.xyz, s->working.count, &index, error);
    for (uint32_t i = 0; status == PLM_OK && i < s->working.count; i++)
        if (s->is_tube[i] && !s->is_stem[i] && s->group[i] >= 0 && w->groups->group[s->group[i]].has_foot)
            propose_about(w, index, i, row, squared);
    plm_index_free(index);
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* ---- Pieces of a blade ------------------------------------------------------------------------------------------ */

/* The ways from the stem, and what of a leaf they reach through its blades. */
static plm_status find_ways(work *w, double blade_cost, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    plm_scratch scratch = {.error = error};
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    float *weight = plm_scratch_take(&scratch, count, sizeof *weight);
    uint32_t *order = plm_scratch_take(&scratch, count, sizeof *order);
    uint32_t *subtree = plm_scratch_take(&scratch, count, sizeof *subtree);
    size_t sources = 0, reached = 0;
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    for (uint32_t i = 0; status == PLM_OK && i < count; i++) {
        weight[i] = s->is_tube[i] ? 1 : (float)blade_cost;
        if (s->is_stem[i]) w->stack[sources++] = i;
    }
    const plm_walk walk = {.source = w->stack,
                           .source_count = sources,
                           .weight = weight,
                           .distance = distance,
                           .parent = w->parent,
                           .order = order,
                           .reached = &reached};
    if (status == PLM_OK) status = plm_graph_walk(&s->graph, &walk, error);
    for (size_t k = reached; status == PLM_OK && k-- > 0;) {
        const uint32_t i = order[k], up = w->parent[i];
        subtree[i]++;
        if (up == UINT32_MAX || s->group[i] != s->group[up]) continue;
        subtree[up] += subtree[i];
        w->beyond[up] += w->groups->blade[i] == w->groups->blade[up] ? w->beyond[i] : subtree[i];
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

static plm_status walk_from_base(work *w, const stalk *k, plm_error *error)
{
    for (size_t i = 0; i < w->sketch->working.count; i++) w->allowed[i] = w->groups->blade[i] == k->blade;
    const plm_walk walk = {.source = &k->base, .source_count = 1, .allowed = w->allowed, .distance = w->from_base};
    return plm_graph_walk(&w->sketch->graph, &walk, error);
}

/* What a leaf holds of its blade: where its tubes lead into it, and points through which others of the leaf are reached. */
static bool is_held(const work *w, uint32_t i)
{
    const plm_sketch *s = w->sketch;
    const uint32_t up = w->parent[i];
    if (!((double)w->beyond[i] < plm_blade_least_points(s))) return true;
    return up != UINT32_MAX && s->is_tube[up] && s->group[up] == s->group[i];
}

/* Whether a piece that holds what is within reach of the base can be cut off: nothing that the leaf holds is there, but elsewhere. */
static bool can_cut(const work *w, double reach)
{
    bool any = false;
    for (size_t k = 0; k < w->net.nodes; k++) {
        if (!is_held(w, w->net.point[k])) continue;
        if ((double)w->from_base[w->net.point[k]] <= reach) return false;
        any = true;
    }
    return any;
}

/* Writes inside: the cheapest such piece without what the leaf holds, where each point of it has a price. */
static void cut_piece(work *w, double price, double reach)
{
    plm_net *n = &w->net;
    for (size_t k = 0; k < n->nodes; k++) {
        n->from[k] = (double)w->from_base[n->point[k]] <= reach ? INFINITY : 0;
        n->into[k] = is_held(w, n->point[k]) ? INFINITY : (float)price;
    }
    plm_net_flow(n, INFINITY);
    for (size_t k = 0; k < n->nodes; k++) w->inside[k] = n->level[k] >= 0;
}

static bool is_inside(const work *w, uint32_t point)
{
    return w->net.node[point] != UINT32_MAX && w->inside[w->net.node[point]];
}

/* Edges from the piece to the rest of its leaf; middle: out, of their ends in the piece. */
static size_t find_touch(const work *w, int32_t guest, double middle[3])
{
    const plm_sketch *s = w->sketch;
    size_t edges = 0;
    for (int a = 0; a < 3; a++) middle[a] = 0;
    for (size_t k = 0; k < w->net.nodes; k++) {
        const uint32_t i = w->net.point[k];
        for (uint32_t e = s->graph.first[i]; w->inside[k] && e < s->graph.first[i + 1]; e++) {
            if (s->group[s->graph.edge[e]] != guest || is_inside(w, s->graph.edge[e])) continue;
            edges++;
            for (int a = 0; a < 3; a++) middle[a] += s->working.xyz[i][a];
        }
    }
    for (int a = 0; a < 3 && edges; a++) middle[a] /= (double)edges;
    return edges;
}

/* How wide the touch of the piece in work is against it, if it is a leaflet that hangs at the stalk; INFINITY: it is none. */
static double touch_of_leaflet(work *w, const stalk *k)
{
    const plm_sketch *s = w->sketch;
    size_t count = 0;
    for (size_t j = 0; j < w->net.nodes; j++) {
        if (!w->inside[j]) continue;
        for (int a = 0; a < 3; a++) w->piece[count][a] = s->working.xyz[w->net.point[j]][a];
        count++;
    }
    if ((double)count < plm_blade_least_points(s)) return INFINITY;
    const double(*piece)[3] = (const double(*)[3])w->piece;
    const plm_piece_shape shape = plm_piece_shape_of(piece, count);
    double from[3], touch[3];
    for (int a = 0; a < 3; a++) from[a] = s->working.xyz[k->tube][a];
    if (!plm_hangs_at(piece, count, &shape, from)) return INFINITY;
    const size_t edges = find_touch(w, k->guest, touch);
    return edges && plm_is_at_side(&shape, touch) ? (double)edges / sqrt((double)count) : INFINITY;
}

/* Whether the leaf hangs together without the piece in work, but for points too few for a blade. */
static bool leaves_whole(work *w, const stalk *k)
{
    const plm_sketch *s = w->sketch;
    uint32_t largest = 0, all = 0;
    for (uint32_t i = 0; i < s->working.count; i++) w->colour[i] = s->group[i] == k->guest && !is_inside(w, i) ? 0 : -1;
    const size_t pieces = plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    uint32_t *size = w->stack; /* no longer needed */
    for (size_t p = 0; p < pieces; p++) size[p] = 0;
    for (size_t i = 0; i < s->working.count; i++)
        if (w->component[i] >= 0) size[w->component[i]]++, all++;
    for (size_t p = 0; p < pieces; p++)
        if (size[p] > largest) largest = size[p];
    return (double)(all - largest) < plm_blade_least_points(s);
}

/* Keeps the piece in work where it is a leaflet by a narrower touch than the best. */
static void weigh_piece(work *w, const stalk *k, double *narrowest)
{
    const double touch = touch_of_leaflet(w, k);
    if (!(touch < *narrowest) || !leaves_whole(w, k)) return;
    *narrowest = touch;
    memcpy(w->best, w->inside, w->net.nodes * sizeof *w->best);
}

/* The leaflet at a stalk: the whole blade, or a piece of it. Writes best. */
static plm_status find_leaflet(work *w, const stalk *k, bool *found, plm_error *error)
{
    const double R = w->sketch->scale.radius;
    double narrowest = INFINITY;
    const plm_status status = walk_from_base(w, k, error);
    if (status != PLM_OK) return status;
    plm_net_of(&w->net, w->groups->blade, k->blade, k->blade);
    for (size_t j = 0; j < w->net.nodes; j++) w->inside[j] = true;
    weigh_piece(w, k, &narrowest);
    const double root = sqrt((double)w->net.nodes);
    for (int r = 0; r < REACHES && can_cut(w, WITHIN[r] * R); r++)
        for (int p = 0; p < PRICES; p++) {
            cut_piece(w, PRICE[p] / root, WITHIN[r] * R);
            weigh_piece(w, k, &narrowest);
        }
    *found = isfinite(narrowest);
    return PLM_OK;
}

/* ---- Links ------------------------------------------------------------------------------------------------------ */

/* Notes that the piece is parted from its leaf. */
static void part_off(work *w, const stalk *k, int32_t number)
{
    const plm_sketch *s = w->sketch;
    for (size_t i = 0; i < s->working.count; i++)
        if (s->group[i] == k->guest && w->part[i] < 0) w->part[i] = 0;
    for (size_t j = 0; j < w->net.nodes; j++)
        if (w->best[j]) w->part[w->net.point[j]] = number;
}

static int nearest_first(const void *a, const void *b)
{
    const stalk *p = a, *q = b;
    if (p->gap != q->gap) return p->gap < q->gap ? -1 : 1;
    return (p->tube > q->tube) - (p->tube < q->tube);
}

/* One leaflet a leaf: what two cuts together leave of it is not asked. */
static plm_status find_stalks(work *w, plm_link *link, size_t *links, plm_error *error)
{
    plm_status status = PLM_OK;
    if (w->stalks) qsort(w->stalk, w->stalks, sizeof *w->stalk, nearest_first);
    for (size_t k = 0; status == PLM_OK && k < w->stalks; k++) {
        const stalk *here = &w->stalk[k];
        bool found = false;
        if (w->part[here->base] >= 0) continue; /* its leaf has lost one already */
        status = find_leaflet(w, here, &found, error);
        if (status != PLM_OK || !found) continue;
        link[(*links)++] = (plm_link){here->tube, here->base, (float)here->gap};
        part_off(w, here, (int32_t)*links);
    }
    return status;
}

static plm_status work_start(work *w, plm_scratch *scratch)
{
    const size_t count = w->sketch->working.count;
    w->parent = plm_scratch_take(scratch, count, sizeof *w->parent);
    w->beyond = plm_scratch_take(scratch, count, sizeof *w->beyond);
    w->from_base = plm_scratch_take(scratch, count, sizeof *w->from_base);
    w->inside = plm_scratch_take(scratch, count, sizeof *w->inside);
    w->piece = plm_scratch_take(scratch, count, sizeof *w->piece);
    w->colour = plm_scratch_take(scratch, count, sizeof *w->colour);
    w->component = plm_scratch_take(scratch, count, sizeof *w->component);
    w->stack = plm_scratch_take(scratch, count, sizeof *w->stack);
    w->allowed = plm_scratch_take(scratch, count, sizeof *w->allowed);
    w->best = plm_scratch_take(scratch, count, sizeof *w->best);
    w->part = plm_scratch_take(scratch, count, sizeof *w->part);
    for (size_t i = 0; !scratch->failed && i < count; i++) w->part[i] = -1;
    return scratch->failed ? PLM_E_MEMORY : plm_net_start(&w->net, w->sketch, scratch);
}

plm_status plm_leaflet_stalks(plm_sketch *sketch, double blade_cost, plm_side_groups *groups, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.sketch = sketch, .groups = groups};
    plm_link link[MOST];
    size_t links = 0;
    plm_status status = propose_all(&w, error);
    if (status == PLM_OK && w.stalks) {
        status = work_start(&w, &scratch);
        if (status == PLM_OK) status = find_ways(&w, blade_cost, error);
        if (status == PLM_OK) status = find_stalks(&w, link, &links, error);
    }
    if (status == PLM_OK && links) {
        plm_graph_part(&sketch->graph, w.part);
        status = plm_graph_add(&sketch->graph, link, links, error);
    }
    if (status == PLM_OK && links) {
        plm_side_groups_free(groups);
        status = plm_side_groups_find(sketch, blade_cost, groups, error);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
