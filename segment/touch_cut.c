/* segment/touch_cut.c: the foot that is nearest along the graph may be that of another leaf: where two leaves touch, the one
 * with the shorter way takes a part of the other's blade, and the border of the two leads through that blade. A touch holds
 * less than a blade: so the border goes where far fewer edges are cut, by minimum cuts (Dinic's maximum flow) in which what is near
 * the trunk keeps its organ and each point that changes its own has a price. Of several prices, and none, the border is taken that is
 * narrowest against the lesser blade beside it: without a price it may be the neck of a petiole. */
#include "segment/touch_cut.h"

#include "segment/min_cut.h"
#include "segment/scratch.h"
#include "segment/side_groups.h"

#include <math.h>
#include <stdlib.h>

static const double ROOT = 0.8;    /* of where a border begins: points nearer to the trunk keep their organ */
static const double BEGIN = 0.03;  /* quantile of its points' distances: near the core single points are no tube */
static const double GAIN = 0.5;    /* of what holds across the present border, and of its narrowness, at most */
static const double LEAST_CUT = 5; /* in edges of one cell: a border of less is a touch */
static const double SMALL = 5;     /* least blades: a leaf that is hardly wider than its foot may have two */
/* A leaflet's point that changes its leaf costs PRICE / present edges, present being what holds across the present border: so it means
 * the same at any spacing, as points grow with the square of the width and edges with the width. */
static const double PRICE = 6;
static const double WORTH = 0.75; /* of what holds across the present border, the new one's edges and prices at most */

/* Two organs that border on each other within blades. */
typedef struct organ_border {
    int32_t organ[2];
    float nearest; /* distance from the trunk at which the border begins */
} organ_border;

/* The points of two organs. */
typedef struct net {
    plm_net flow;
    int32_t *owner;
    bool *second; /* of a node: the second organ's beside the best border so far */
} net;

/* ---- Borders ---------------------------------------------------------------------------------------------------- */

static int by_organs(const void *a, const void *b)
{
    const organ_border *p = a, *q = b;
    if (p->organ[0] != q->organ[0]) return p->organ[0] < q->organ[0] ? -1 : 1;
    if (p->organ[1] != q->organ[1]) return p->organ[1] < q->organ[1] ? -1 : 1;
    return (p->nearest > q->nearest) - (p->nearest < q->nearest);
}

static bool is_blade(const plm_sketch *sketch, const int32_t *owner, uint32_t i)
{
    return owner[i] >= 0 && !sketch->is_tube[i] && !sketch->is_stem[i];
}

/* Every pair of organs that are neighbours within blades, as they are before any border is moved; list: room for an entry an edge. */
static size_t find_borders(const net *n, const float *distance, organ_border *list)
{
    const plm_graph *graph = &n->flow.sketch->graph;
    size_t edges = 0, borders = 0;
    for (uint32_t i = 0; i < graph->count; i++)
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1] && is_blade(n->flow.sketch, n->owner, i); e++) {
            const uint32_t j = graph->edge[e];
            if (n->owner[j] > n->owner[i] && is_blade(n->flow.sketch, n->owner, j))
                list[edges++] = (organ_border){{n->owner[i], n->owner[j]}, distance[i]};
        }
    qsort(list, edges, sizeof *list, by_organs);
    for (size_t k = 0, end; k < edges; k = end) {
        for (end = k; end < edges && list[end].organ[0] == list[k].organ[0] && list[end].organ[1] == list[k].organ[1];)
            end++;
        list[borders++] = list[k + (size_t)(BEGIN * (double)(end - k))]; /* writes behind what is read */
    }
    return borders;
}

/* A border of the two organs of a net. */
typedef struct cut {
    double holds;    /* what the edges across it hold */
    size_t blade[2]; /* points of blade that it leaves to either organ */
    bool moves;      /* a point changes its organ */
} cut;

static bool is_second(const net *n, const organ_border *border, size_t k)
{
    return n->owner[n->flow.point[k]] == border->organ[1];
}

/* The present border. */
static cut present_cut(const net *n, const organ_border *border)
{
    cut c = {0};
    for (size_t k = 0; k < n->flow.nodes; k++) {
        const uint32_t i = n->flow.point[k];
        const bool second = is_second(n, border, k);
        c.blade[second] += !n->flow.sketch->is_tube[i];
        for (uint32_t e = n->flow.first[k]; e < n->flow.first[k + 1] && !second; e++)
            if (is_second(n, border, n->flow.to[e]))
                c.holds += plm_net_capacity(n->flow.sketch, i, n->flow.point[n->flow.to[e]]);
    }
    return c;
}

/* The border that the last flow found: level[] is negative on the second organ's side. */
static cut found_cut(const net *n, const organ_border *border)
{
    cut c = {0};
    for (size_t k = 0; k < n->flow.nodes; k++) {
        const uint32_t i = n->flow.point[k];
        const bool second = n->flow.level[k] < 0;
        c.blade[second] += !n->flow.sketch->is_tube[i];
        c.moves = c.moves || second != is_second(n, border, k);
        for (uint32_t e = n->flow.first[k]; e < n->flow.first[k + 1] && !second; e++)
            if (n->flow.level[n->flow.to[e]] < 0)
                c.holds += plm_net_capacity(n->flow.sketch, i, n->flow.point[n->flow.to[e]]);
    }
    return c;
}

/* The cheapest border where each edge across it and each point that changes its organ has a price (Greig, Porteous and Seheult 1989);
 * points near the trunk keep theirs. price: of a point of either organ, INFINITY: none may change. False where edges and prices come
 * to more than limit, or an organ that may give all has no point near the trunk. */
static bool find_cut(net *n, const organ_border *border, const float *distance, const double price[2], double limit,
                     cut *found)
{
    bool rooted[2] = {isinf(price[0]), isinf(price[1])};
    for (size_t k = 0; k < n->flow.nodes; k++) {
        const bool second = is_second(n, border, k);
        const bool is_root = distance[n->flow.point[k]] < ROOT * border->nearest;
        rooted[second] = rooted[second] || is_root;
        n->flow.from[k] = second ? 0 : is_root ? INFINITY : (float)price[0];
        n->flow.into[k] = !second ? 0 : is_root ? INFINITY : (float)price[1];
    }
    if (!rooted[0] || !rooted[1]) return false;
    if (plm_net_flow(&n->flow, limit) > limit) return false;
    *found = found_cut(n, border);
    return true;
}

/* Whether either organ that had a blade keeps one. */
static bool keeps_blades(const plm_sketch *sketch, const cut *before, const cut *after)
{
    const double least = plm_blade_least_points(sketch);
    for (int side = 0; side < 2; side++)
        if (!((double)before->blade[side] < least) && (double)after->blade[side] < least) return false;
    return true;
}

static size_t lesser_blade(const cut *c)
{
    return c->blade[0] < c->blade[1] ? c->blade[0] : c->blade[1];
}

/* A touch is narrow against the blades that it parts, while a neck of a petiole leaves hardly a blade to one of the two. */
static double narrowness(const cut *c)
{
    const size_t lesser = lesser_blade(c);
    return lesser ? c->holds / sqrt((double)lesser) : INFINITY;
}

static void keep_sides(net *n)
{
    for (size_t k = 0; k < n->flow.nodes; k++) n->second[k] = n->flow.level[k] < 0;
}

/* Between compound leaves the neck may be a rachis, with leaflets on both sides of it. So the border at one price is taken, if it saves
 * enough of what the present one holds. */
static bool find_leaflets(net *n, const organ_border *border, const float *distance, const cut *present)
{
    const double price = PRICE / present->holds;
    cut found;
    if (!find_cut(n, border, distance, (double[2]){price, price}, WORTH * present->holds, &found)) return false;
    keep_sides(n);
    return keeps_blades(n->flow.sketch, present, &found);
}

/* The narrowest border of those at some prices and the necks of both organs (one that gives at no price, while the other keeps all).
 * All of a blade is given only where it is a piece of the other: it hangs on the trunk by a touch, or is small for two feet. */
static bool find_touch(net *n, const organ_border *border, const float *distance, const cut *present)
{
    const double offer[][2] = {{0, INFINITY}, {INFINITY, 0}, {PRICE, PRICE}, {PRICE / 4, PRICE / 4}};
    const double limit = GAIN * present->holds;
    const bool may_lose = !n->flow.sketch->stem.count; /* on a stem a petiole bears a leaf */
    const bool is_small = (double)lesser_blade(present) < SMALL * plm_blade_least_points(n->flow.sketch);
    double narrowest = GAIN * narrowness(present), least = INFINITY;
    bool is_touch = false;
    for (size_t k = 0; k < sizeof offer / sizeof *offer; k++) {
        const double price[2] = {offer[k][0] / present->holds, offer[k][1] / present->holds};
        const bool is_neck = isinf(price[0]) || isinf(price[1]);
        cut found;
        if (!find_cut(n, border, distance, price, is_neck ? limit : INFINITY, &found)) continue;
        if (!found.moves || found.holds > limit) continue;
        if (keeps_blades(n->flow.sketch, present, &found)) {
            if (!(narrowness(&found) < narrowest)) continue;
            narrowest = narrowness(&found);
            is_touch = true;
        } else {
            if (is_touch || !is_neck || !may_lose || !(found.holds < least)) continue;
            if (!is_small && !(found.holds < LEAST_CUT)) continue;
            least = found.holds;
        }
        keep_sides(n);
    }
    return is_touch || isfinite(least);
}

static void move_border(net *n, const organ_border *border, bool leaflets, const float *distance)
{
    plm_net_of(&n->flow, n->owner, border->organ[0], border->organ[1]);
    const cut present = present_cut(n, border);
    if (present.holds < LEAST_CUT) return;
    if (!(leaflets ? find_leaflets : find_touch)(n, border, distance, &present)) return;
    for (size_t k = 0; k < n->flow.nodes; k++) n->owner[n->flow.point[k]] = border->organ[n->second[k]];
}

plm_status plm_touch_cut(const plm_sketch *sketch, bool leaflets, const float *distance, int32_t *owner,
                         plm_error *error)
{
    plm_scratch scratch = {.error = error};
    net n = {.flow = {.sketch = sketch}, .owner = owner};
    organ_border *list = plm_scratch_take(&scratch, sketch->graph.first[sketch->graph.count] / 2 + 1, sizeof *list);
    const size_t borders = list ? find_borders(&n, distance, list) : 0;
    plm_status status = list ? PLM_OK : PLM_E_MEMORY;
    if (borders) status = plm_net_start(&n.flow, sketch, &scratch);
    if (borders) n.second = plm_scratch_take(&scratch, sketch->graph.count, sizeof *n.second);
    if (scratch.failed) status = PLM_E_MEMORY;
    for (size_t b = 0; status == PLM_OK && b < borders; b++) move_border(&n, &list[b], leaflets, distance);
    plm_scratch_free(&scratch, NULL);
    return status;
}
