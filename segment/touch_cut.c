/* segment/touch_cut.c: the foot that is nearest along the graph may be that of another leaf: where two leaves touch, the one
 * with the shorter way takes a part of the other's blade, and the border of the two leads through that blade. A touch holds
 * less than a blade: so if far fewer edges are cut where one of the two gives the other all that lies beyond a neck of it,
 * the border is there. The neck is the minimum cut (Dinic's maximum flow) between the giver's part near the trunk and the
 * other organ. Between compound leaves points have a price instead. */
#include "segment/touch_cut.h"

#include "segment/scratch.h"
#include "segment/side_groups.h"

#include <math.h>
#include <stdlib.h>

static const double ROOT = 0.8;    /* of a border's least distance from the trunk: nearer, the giver keeps its points */
static const double GAIN = 0.5;    /* of what holds across the present border, at most */
static const double LEAST_CUT = 5; /* in edges of one cell: a border of less is a touch */
/* A leaflet's point that changes its leaf costs PRICE / present edges, present being what holds across the present border: so it means
 * the same at any spacing, as points grow with the square of the width and edges with the width. */
static const double PRICE = 6;
static const double WORTH = 0.75; /* of what holds across the present border, the new one's edges and prices at most */
static const float SATURATED = 1e-6f;

/* Two organs that border on each other within blades. */
typedef struct organ_border {
    int32_t organ[2];
    float nearest[2]; /* least distance from the trunk of either's points at the border */
} organ_border;

/* The points of two organs and the edges among them, as arcs in both directions. */
typedef struct net {
    const plm_sketch *sketch;
    int32_t *owner;
    size_t nodes;
    uint32_t *point;             /* of a node */
    uint32_t *node;              /* of a point, UINT32_MAX outside of the two organs */
    uint32_t *first, *to, *twin; /* arcs of a node, where they lead, and the arc back */
    float *left;                 /* what an arc still holds */
    float *from, *into;          /* what a node still takes from the source and gives to the sink */
    int32_t *level;              /* steps from the source, -1 where none leads */
    uint32_t *next, *queue, *path;
} net;

static plm_status net_start(net *n, plm_scratch *scratch)
{
    const size_t count = n->sketch->graph.count, arcs = n->sketch->graph.first[count];
    n->point = plm_scratch_take(scratch, count, sizeof *n->point);
    n->node = plm_scratch_take(scratch, count, sizeof *n->node);
    n->first = plm_scratch_take(scratch, count + 1, sizeof *n->first);
    n->to = plm_scratch_take(scratch, arcs + 1, sizeof *n->to);
    n->twin = plm_scratch_take(scratch, arcs + 1, sizeof *n->twin);
    n->left = plm_scratch_take(scratch, arcs + 1, sizeof *n->left);
    n->from = plm_scratch_take(scratch, count, sizeof *n->from);
    n->into = plm_scratch_take(scratch, count, sizeof *n->into);
    n->level = plm_scratch_take(scratch, count, sizeof *n->level);
    n->next = plm_scratch_take(scratch, count, sizeof *n->next);
    n->queue = plm_scratch_take(scratch, count, sizeof *n->queue);
    n->path = plm_scratch_take(scratch, count, sizeof *n->path);
    return scratch->failed ? PLM_E_MEMORY : PLM_OK;
}

/* Longer edges hold less: those of a touch lead across a gap. */
static float capacity(const plm_sketch *sketch, uint32_t i, uint32_t j)
{
    const double cells = plm_graph_length(&sketch->graph, i, j) / sketch->working.cell;
    return cells < 1 ? 1 : (float)(1 / (cells * cells));
}

/* ---- The net of two organs -------------------------------------------------------------------------------------- */

static void find_twins(net *n)
{
    for (uint32_t k = 0; k < n->nodes; k++)
        for (uint32_t e = n->first[k]; e < n->first[k + 1]; e++)
            for (uint32_t f = n->first[n->to[e]]; f < n->first[n->to[e] + 1]; f++)
                if (n->to[f] == k) n->twin[e] = f;
}

static void net_of(net *n, const organ_border *border)
{
    const plm_graph *graph = &n->sketch->graph;
    uint32_t arcs = 0;
    n->nodes = 0;
    for (uint32_t i = 0; i < graph->count; i++) {
        n->node[i] = UINT32_MAX;
        if (n->owner[i] < 0 || (n->owner[i] != border->organ[0] && n->owner[i] != border->organ[1])) continue;
        n->node[i] = (uint32_t)n->nodes;
        n->point[n->nodes++] = i;
    }
    for (size_t k = 0; k < n->nodes; k++) {
        const uint32_t i = n->point[k];
        n->first[k] = arcs;
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++)
            if (n->node[graph->edge[e]] != UINT32_MAX) n->to[arcs++] = n->node[graph->edge[e]];
    }
    n->first[n->nodes] = arcs;
    find_twins(n);
}

static void fill(net *n)
{
    for (size_t k = 0; k < n->nodes; k++)
        for (uint32_t e = n->first[k]; e < n->first[k + 1]; e++)
            n->left[e] = capacity(n->sketch, n->point[k], n->point[n->to[e]]);
}

/* What holds across the border as it is. */
static double present_cut(const net *n, int32_t organ)
{
    double sum = 0;
    for (size_t k = 0; k < n->nodes; k++)
        for (uint32_t e = n->first[k]; e < n->first[k + 1]; e++)
            if (n->owner[n->point[k]] == organ && n->owner[n->point[n->to[e]]] != organ)
                sum += capacity(n->sketch, n->point[k], n->point[n->to[e]]);
    return sum;
}

/* ---- Maximum flow ----------------------------------------------------------------------------------------------- */

/* Steps from the source along arcs that hold; whether one reaches the sink. */
static bool find_levels(net *n)
{
    size_t head = 0, tail = 0;
    bool reached = false;
    for (uint32_t k = 0; k < n->nodes; k++) {
        n->level[k] = n->from[k] > SATURATED ? 0 : -1;
        n->next[k] = n->first[k];
        if (n->level[k] == 0) n->queue[tail++] = k;
    }
    while (head < tail) {
        const uint32_t k = n->queue[head++];
        reached = reached || n->into[k] > SATURATED;
        if (isinf(n->into[k])) continue;
        for (uint32_t e = n->first[k]; e < n->first[k + 1]; e++)
            if (n->level[n->to[e]] < 0 && n->left[e] > SATURATED) {
                n->level[n->to[e]] = n->level[k] + 1;
                n->queue[tail++] = n->to[e];
            }
    }
    return reached;
}

/* A way from a node of the source to the sink, a level a step. */
static bool find_way(net *n, uint32_t start, size_t *length)
{
    size_t depth = 0;
    uint32_t here = start;
    while (!(n->into[here] > SATURATED)) {
        uint32_t *e = &n->next[here];
        while (*e < n->first[here + 1] && !(n->left[*e] > SATURATED && n->level[n->to[*e]] == n->level[here] + 1))
            (*e)++;
        if (*e < n->first[here + 1]) {
            n->path[depth++] = *e;
            here = n->to[*e];
        } else {
            if (!depth) return false;
            here = n->to[n->twin[n->path[--depth]]];
            n->next[here]++;
        }
    }
    *length = depth;
    return true;
}

static double push(net *n, uint32_t start, size_t depth)
{
    const uint32_t end = depth ? n->to[n->path[depth - 1]] : start;
    float least = fminf(n->from[start], n->into[end]);
    for (size_t k = 0; k < depth; k++) least = fminf(least, n->left[n->path[k]]);
    for (size_t k = 0; k < depth; k++) {
        n->left[n->path[k]] -= least;
        n->left[n->twin[n->path[k]]] += least;
    }
    n->from[start] -= least;
    n->into[end] -= least;
    return least;
}

/* The maximum flow, or something above limit. Where it is not above, level[] is not negative
 * then on the source's side of the minimum cut. */
static double find_flow(net *n, double limit)
{
    double flow = 0;
    while (flow <= limit && find_levels(n))
        for (uint32_t k = 0; k < n->nodes; k++)
            for (size_t depth; n->from[k] > SATURATED && find_way(n, k, &depth);) flow += push(n, k, depth);
    return flow;
}

/* ---- Borders ---------------------------------------------------------------------------------------------------- */

static int by_organs(const void *a, const void *b)
{
    const organ_border *p = a, *q = b;
    if (p->organ[0] != q->organ[0]) return p->organ[0] < q->organ[0] ? -1 : 1;
    return (p->organ[1] > q->organ[1]) - (p->organ[1] < q->organ[1]);
}

static bool is_blade(const plm_sketch *sketch, const int32_t *owner, uint32_t i)
{
    return owner[i] >= 0 && !sketch->is_tube[i] && !sketch->is_stem[i];
}

/* Every pair of organs that are neighbours within blades, as they are before any border is moved; list: room for an entry an edge. */
static size_t find_borders(const net *n, const float *distance, organ_border *list)
{
    const plm_graph *graph = &n->sketch->graph;
    size_t edges = 0, borders = 0;
    for (uint32_t i = 0; i < graph->count; i++)
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1] && is_blade(n->sketch, n->owner, i); e++) {
            const uint32_t j = graph->edge[e];
            if (n->owner[j] > n->owner[i] && is_blade(n->sketch, n->owner, j))
                list[edges++] = (organ_border){{n->owner[i], n->owner[j]}, {distance[i], distance[j]}};
        }
    qsort(list, edges, sizeof *list, by_organs);
    for (size_t k = 0; k < edges; k++) {
        if (!borders || by_organs(&list[borders - 1], &list[k]) != 0) list[borders++] = list[k];
        for (int d = 0; d < 2; d++)
            list[borders - 1].nearest[d] = fminf(list[borders - 1].nearest[d], list[k].nearest[d]);
    }
    return borders;
}

/* The neck of a giver. */
typedef struct neck {
    double holds; /* INFINITY: too much, or all of the giver would be beyond */
    bool keeps_blade;
} neck;

static neck find_neck(net *n, const organ_border *border, int giver, const float *distance, double limit)
{
    const plm_sketch *s = n->sketch;
    bool rooted = false;
    for (size_t k = 0; k < n->nodes; k++) {
        const uint32_t i = n->point[k];
        const bool is_root = distance[i] < ROOT * border->nearest[giver];
        const bool gives = n->owner[i] == border->organ[giver];
        n->from[k] = gives && is_root ? INFINITY : 0;
        n->into[k] = gives ? 0 : INFINITY;
        rooted = rooted || n->from[k] > 0;
    }
    if (!rooted) return (neck){INFINITY, false};
    fill(n);
    const double flow = find_flow(n, limit);
    if (flow > limit) return (neck){INFINITY, false};
    size_t blade = 0;
    for (size_t k = 0; k < n->nodes; k++) blade += n->level[k] >= 0 && !s->is_tube[n->point[k]];
    const double area = (double)blade * s->working.cell * s->working.cell;
    return (neck){flow, !(area < plm_blade_least(s))};
}

/* The petiole of the other leaf is a neck too: so rather one behind which the giver keeps a blade. On a stem no other will
 * do: a petiole bears a leaf there. (Young leaves of a rosette may look like tubes from end to end.) */
static bool is_better(const plm_sketch *sketch, const neck *a, const neck *b)
{
    if (!isfinite(a->holds) || (sketch->stem.count && !a->keeps_blade)) return false;
    if (!isfinite(b->holds) || a->keeps_blade != b->keeps_blade) return !isfinite(b->holds) || a->keeps_blade;
    return a->holds < b->holds;
}

/* How many points of blade each of the two organs has: as they are, or as the cut would have it. */
static void count_blade(const net *n, const organ_border *border, bool cut, size_t blade[2])
{
    blade[0] = blade[1] = 0;
    for (size_t k = 0; k < n->nodes; k++) {
        const uint32_t i = n->point[k];
        const bool second = cut ? n->level[k] < 0 : n->owner[i] == border->organ[1];
        if (!n->sketch->is_tube[i]) blade[second]++;
    }
}

/* Between compound leaves the neck may be a rachis, with leaflets on both sides of it. So every point that changes its leaf has a
 * price, and the cheapest border of all is taken (Greig, Porteous and Seheult 1989), if it saves enough of what the present one
 * holds, and leaves both a blade. */
static void move_leaflets(net *n, const organ_border *border, const float *distance, double present)
{
    const float price = (float)(PRICE / present);
    const double cell = n->sketch->working.cell, least = plm_blade_least(n->sketch) / (cell * cell);
    bool rooted[2] = {false, false};
    size_t before[2], after[2];
    for (size_t k = 0; k < n->nodes; k++) {
        const uint32_t i = n->point[k];
        const int side = n->owner[i] == border->organ[1];
        const bool is_root = distance[i] < ROOT * border->nearest[side];
        rooted[side] = rooted[side] || is_root;
        n->from[k] = side ? 0 : is_root ? INFINITY : price;
        n->into[k] = !side ? 0 : is_root ? INFINITY : price;
    }
    if (!rooted[0] || !rooted[1]) return;
    fill(n);
    if (find_flow(n, WORTH * present) > WORTH * present) return;
    count_blade(n, border, false, before);
    count_blade(n, border, true, after);
    for (int side = 0; side < 2; side++)
        if (!((double)before[side] < least) && (double)after[side] < least) return;
    for (size_t k = 0; k < n->nodes; k++) n->owner[n->point[k]] = border->organ[n->level[k] < 0];
}

static void move_border(net *n, const organ_border *border, bool leaflets, const float *distance)
{
    net_of(n, border);
    const double present = present_cut(n, border->organ[0]), limit = GAIN * present;
    if (present < LEAST_CUT) return;
    if (leaflets) {
        move_leaflets(n, border, distance, present);
        return;
    }
    const neck none = {INFINITY, false}, first = find_neck(n, border, 0, distance, limit);
    const neck second = find_neck(n, border, 1, distance, limit);
    const neck *best = is_better(n->sketch, &first, &none) ? &first : &none;
    if (is_better(n->sketch, &second, best)) best = &second;
    if (best == &none) return;
    if (best == &first) find_neck(n, border, 0, distance, limit); /* level[] is the second one's */
    for (size_t k = 0; k < n->nodes; k++)
        if (n->level[k] < 0) n->owner[n->point[k]] = border->organ[best == &first];
}

plm_status plm_touch_cut(const plm_sketch *sketch, bool leaflets, const float *distance, int32_t *owner,
                         plm_error *error)
{
    plm_scratch scratch = {.error = error};
    net n = {.sketch = sketch, .owner = owner};
    organ_border *list = plm_scratch_take(&scratch, sketch->graph.first[sketch->graph.count] / 2 + 1, sizeof *list);
    const size_t borders = list ? find_borders(&n, distance, list) : 0;
    const plm_status status = borders ? net_start(&n, &scratch) : list ? PLM_OK : PLM_E_MEMORY;
    for (size_t b = 0; status == PLM_OK && b < borders; b++) move_border(&n, &list[b], leaflets, distance);
    plm_scratch_free(&scratch, NULL);
    return status;
}
