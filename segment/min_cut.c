/* segment/min_cut.c: Dinic's maximum flow over the points of a sketch. */
#include "segment/min_cut.h"

#include <math.h>

static const float SATURATED = 1e-6f;

plm_status plm_net_start(plm_net *n, const plm_sketch *sketch, plm_scratch *scratch)
{
    *n = (plm_net){.sketch = sketch};
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

float plm_net_capacity(const plm_sketch *sketch, uint32_t i, uint32_t j)
{
    const double cells = plm_graph_length(&sketch->graph, i, j) / sketch->working.cell;
    return cells < 1 ? 1 : (float)(1 / (cells * cells));
}

static void find_twins(plm_net *n)
{
    for (uint32_t k = 0; k < n->nodes; k++)
        for (uint32_t e = n->first[k]; e < n->first[k + 1]; e++)
            for (uint32_t f = n->first[n->to[e]]; f < n->first[n->to[e] + 1]; f++)
                if (n->to[f] == k) n->twin[e] = f;
}

void plm_net_of(plm_net *n, const int32_t *colour, int32_t one, int32_t other)
{
    const plm_graph *graph = &n->sketch->graph;
    uint32_t arcs = 0;
    n->nodes = 0;
    for (uint32_t i = 0; i < graph->count; i++) {
        n->node[i] = UINT32_MAX;
        if (colour[i] != one && colour[i] != other) continue;
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

static void fill(plm_net *n)
{
    for (size_t k = 0; k < n->nodes; k++)
        for (uint32_t e = n->first[k]; e < n->first[k + 1]; e++)
            n->left[e] = plm_net_capacity(n->sketch, n->point[k], n->point[n->to[e]]);
}

/* Steps from the source along arcs that hold; whether one reaches the sink. */
static bool find_levels(plm_net *n)
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
static bool find_way(plm_net *n, uint32_t start, size_t *length)
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

static double push(plm_net *n, uint32_t start, size_t depth)
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

double plm_net_flow(plm_net *n, double limit)
{
    fill(n);
    double flow = 0;
    while (flow <= limit && find_levels(n))
        for (uint32_t k = 0; k < n->nodes; k++)
            for (size_t depth; n->from[k] > SATURATED && find_way(n, k, &depth);) flow += push(n, k, depth);
    return flow;
}
