/* segment/merge_tree.c: the join tree of a distance, as a union of sets that grows from the tips to the base. */
#include "segment/merge_tree.h"

#include "segment/scratch.h"

#include <math.h>
#include <stdlib.h>

enum { NONE = -1 };

/* A set of points that hang together above the level reached so far, at its root. */
typedef struct branch_set {
    float tip; /* the largest distance in it */
    uint32_t size, head, tail;
    bool is_trunk; /* branches have met in it */
} branch_set;

typedef struct work {
    const plm_graph *graph;
    const plm_merge_rule *rule;
    double reach; /* at the present meeting */
    int32_t *branch;
    size_t count;
    uint32_t *parent, *next; /* next: the members of a set as a list */
    branch_set *set;
} work;

int plm_far_first(const void *a, const void *b)
{
    const plm_visit *p = a, *q = b;
    if (p->distance != q->distance) return p->distance > q->distance ? -1 : 1;
    return (p->point > q->point) - (p->point < q->point);
}

static uint32_t root_of(work *w, uint32_t i)
{
    while (w->parent[i] != i) i = w->parent[i] = w->parent[w->parent[i]];
    return i;
}

static bool is_branch(const work *w, const branch_set *set, float level)
{
    return !set->is_trunk && (double)set->tip - level > w->reach && set->size >= w->rule->least;
}

/* The set ends here, as a branch of its own. */
static void end_branch(work *w, const branch_set *set)
{
    uint32_t i = set->head;
    for (uint32_t k = 0; k < set->size; k++, i = w->next[i]) w->branch[i] = (int32_t)w->count;
    w->count++;
}

/* Two sets become one. Members of a trunk are not listed: they are in no branch. */
static uint32_t unite(work *w, uint32_t a, uint32_t b)
{
    branch_set *p = &w->set[a], *q = &w->set[b];
    if (p->is_trunk || q->is_trunk) {
        p->is_trunk = true;
    } else {
        w->next[p->tail] = q->head;
        p->tail = q->tail;
        p->size += q->size;
    }
    p->tip = fmaxf(p->tip, q->tip);
    w->parent[b] = a;
    return a;
}

static void meet(work *w, uint32_t here, uint32_t other, float level)
{
    const uint32_t a = root_of(w, here), b = root_of(w, other);
    if (a == b) return;
    branch_set *p = &w->set[a], *q = &w->set[b];
    const bool first = is_branch(w, p, level), second = is_branch(w, q, level);
    const bool ends = (first && (second || q->is_trunk)) || (second && p->is_trunk);
    if (ends) {
        if (first) end_branch(w, p);
        if (second) end_branch(w, q);
    }
    const uint32_t united = unite(w, a, b);
    if (ends) w->set[united].is_trunk = true;
}

static bool may_meet(const plm_merge_rule *rule, uint32_t a, uint32_t b)
{
    return !rule->apart || rule->apart[a] < 0 || rule->apart[b] < 0 || rule->apart[a] == rule->apart[b];
}

/* Points from far to near, each with those of its neighbours that were seen before. */
static void sweep(work *w, const plm_visit *order, size_t visits)
{
    const plm_graph *graph = w->graph;
    for (size_t k = 0; k < visits; k++) {
        const uint32_t i = order[k].point;
        w->set[i].size = 1; /* seen */
        w->reach = w->rule->reach[i];
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++)
            if (w->set[graph->edge[e]].size && may_meet(w->rule, i, graph->edge[e]))
                meet(w, i, graph->edge[e], order[k].distance);
    }
    for (size_t k = 0; k < visits; k++) {
        const uint32_t i = order[k].point;
        w->reach = w->rule->reach[i];
        if (w->parent[i] == i && is_branch(w, &w->set[i], 0)) end_branch(w, &w->set[i]);
    }
}

plm_status plm_merge_tree_by(const plm_graph *graph, const plm_merge_rule *rule, int32_t *branch, size_t *count,
                             plm_error *error)
{
    plm_scratch scratch = {.error = error};
    plm_visit *order = plm_scratch_take(&scratch, graph->count, sizeof *order);
    work w = {.graph = graph, .rule = rule, .branch = branch};
    w.parent = plm_scratch_take(&scratch, graph->count, sizeof *w.parent);
    w.next = plm_scratch_take(&scratch, graph->count, sizeof *w.next);
    w.set = plm_scratch_take(&scratch, graph->count, sizeof *w.set);
    size_t visits = 0;
    for (uint32_t i = 0; !scratch.failed && i < graph->count; i++) {
        branch[i] = NONE;
        w.parent[i] = i;
        w.set[i] = (branch_set){.tip = rule->distance[i], .head = i, .tail = i, .size = 0};
        if (isfinite(rule->distance[i])) order[visits++] = (plm_visit){rule->distance[i], i};
    }
    if (visits) {
        qsort(order, visits, sizeof *order, plm_far_first);
        sweep(&w, order, visits);
    }
    *count = w.count;
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

plm_status plm_merge_tree(const plm_graph *graph, const float *distance, double reach, size_t least, int32_t *branch,
                          size_t *count, plm_error *error)
{
    float *same = plm_alloc(graph->count, sizeof *same, error);
    if (!same) return PLM_E_MEMORY;
    for (size_t i = 0; i < graph->count; i++) same[i] = (float)reach;
    const plm_merge_rule rule = {.distance = distance, .reach = same, .least = least};
    const plm_status status = plm_merge_tree_by(graph, &rule, branch, count, error);
    plm_free(same);
    return status;
}
