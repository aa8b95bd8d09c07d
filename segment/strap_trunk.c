/* segment/strap_trunk.c: where two blades touch, the merge tree ends both, and what lies below on either is trunk. A surface
 * goes on with its own tangent: from the touch down to the stem, each point of the trunk goes to the leaf whose plane
 * passes nearest to it. Beyond a touch there is no such order: whichever leaf fits some point best goes on there first, so that a
 * leaf runs along its own surface before another one leaks into it through the touch. */
#include "segment/strap_trunk.h"

#include "cloud/local_plane.h"
#include "segment/merge_tree.h"
#include "segment/point_heap.h"
#include "segment/scratch.h"

#include <math.h>
#include <stdlib.h>

static const double REACH = 0.6;    /* the points of a leaf that give its plane lie so near, in R */
static const double NEARNESS = 0.5; /* weight of the distance along a plane, against that off it */
enum { NEAREST = 16, FEWEST = 8, CANDIDATES = 6 };

/* A leaf near the point in work, with its points that are nearest to it. */
typedef struct candidate {
    int32_t leaf;
    int count;
    float squared[NEAREST];
    uint32_t point[NEAREST];
} candidate;

typedef struct work {
    plm_sketch *sketch;
    uint32_t *seen, *queue;
    uint32_t stamp;
} work;

static bool nearer(float squared, uint32_t point, const candidate *c, int place)
{
    return squared < c->squared[place] || (squared == c->squared[place] && point < c->point[place]);
}

static void candidate_add(candidate *list, int *count, int32_t leaf, uint32_t point, float squared)
{
    int k = 0;
    while (k < *count && list[k].leaf != leaf) k++;
    if (k == *count) {
        if (k == CANDIDATES) return;
        list[(*count)++] = (candidate){.leaf = leaf};
    }
    candidate *c = &list[k];
    if (c->count == NEAREST && !nearer(squared, point, c, NEAREST - 1)) return;
    int place = c->count < NEAREST ? c->count++ : NEAREST - 1;
    for (; place > 0 && nearer(squared, point, c, place - 1); place--) {
        c->squared[place] = c->squared[place - 1];
        c->point[place] = c->point[place - 1];
    }
    c->squared[place] = squared;
    c->point[place] = point;
}

/* The leaves with points joined to a point within reach. */
static int find_candidates(work *w, uint32_t centre, candidate *list)
{
    const plm_sketch *s = w->sketch;
    const plm_graph *graph = &s->graph;
    const double reach = REACH * s->scale.radius;
    size_t queued = 0;
    int found = 0;
    w->queue[queued++] = centre;
    w->seen[centre] = ++w->stamp;
    for (size_t head = 0; head < queued; head++)
        for (uint32_t e = graph->first[w->queue[head]]; e < graph->first[w->queue[head] + 1]; e++) {
            const uint32_t next = graph->edge[e];
            if (w->seen[next] == w->stamp || s->is_stem[next]) continue;
            w->seen[next] = w->stamp;
            const double length = plm_graph_length(graph, centre, next);
            if (length > reach) continue;
            w->queue[queued++] = next;
            if (s->leaf[next] >= 0) candidate_add(list, &found, s->leaf[next], next, (float)(length * length));
        }
    return found;
}

/* How ill a leaf's plane and nearness fit a point. */
static double misfit_of(const plm_sketch *s, const candidate *c, uint32_t centre)
{
    const float(*xyz)[3] = (const float(*)[3])s->working.xyz;
    double far = 0;
    for (int k = 0; k < c->count; k++) far += sqrt((double)c->squared[k]);
    return plm_local_plane_distance(xyz, c->point, (size_t)c->count, xyz[centre], NULL) + NEARNESS * far / c->count;
}

/* The leaf that fits a point best, and how ill it does; -1: none is near. */
static int32_t choose(work *w, uint32_t centre, float *misfit)
{
    candidate list[CANDIDATES];
    const int count = find_candidates(w, centre, list);
    int32_t best = -1;
    double least = INFINITY;
    for (int k = 0; k < count; k++) {
        if (list[k].count < FEWEST) continue;
        const double value = misfit_of(w->sketch, &list[k], centre);
        if (value < least || (value == least && list[k].leaf < best)) least = value, best = list[k].leaf;
    }
    *misfit = (float)least;
    return best;
}

static work work_start(plm_sketch *sketch, plm_scratch *scratch)
{
    const size_t count = sketch->working.count;
    return (work){.sketch = sketch,
                  .seen = plm_scratch_take(scratch, count, sizeof(uint32_t)),
                  .queue = plm_scratch_take(scratch, count, sizeof(uint32_t))};
}

plm_status plm_strap_trunk(plm_sketch *sketch, const float *from_base, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    work w = work_start(sketch, &scratch);
    plm_visit *order = plm_scratch_take(&scratch, count, sizeof *order);
    size_t visits = 0;
    for (uint32_t i = 0; !scratch.failed && i < count; i++)
        if (sketch->leaf[i] < 0 && !sketch->is_stem[i] && isfinite(from_base[i]))
            order[visits++] = (plm_visit){from_base[i], i};
    if (visits) qsort(order, visits, sizeof *order, plm_far_first);
    for (size_t k = 0; k < visits; k++) {
        float misfit;
        sketch->leaf[order[k].point] = choose(&w, order[k].point, &misfit);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Notes the leaf that fits a point best, where it fits better than the one that was noted. */
static void offer(work *w, plm_point_heap *heap, float *misfit, int32_t *leaf, uint32_t point)
{
    float value;
    const int32_t best = choose(w, point, &value);
    if (best < 0 || !(value < misfit[point])) return;
    misfit[point] = value;
    leaf[point] = best;
    plm_heap_add(heap, point);
}

static bool waits(const plm_sketch *s, const bool *beyond, uint32_t point)
{
    return beyond[point] && s->leaf[point] < 0 && !s->is_stem[point];
}

static bool is_beside_leaf(const plm_sketch *s, uint32_t point)
{
    const plm_graph *graph = &s->graph;
    for (uint32_t e = graph->first[point]; e < graph->first[point + 1]; e++)
        if (s->leaf[graph->edge[e]] >= 0) return true;
    return false;
}

plm_status plm_strap_beyond(plm_sketch *sketch, const bool *beyond, plm_error *error)
{
    const plm_graph *graph = &sketch->graph;
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    plm_point_heap heap = {0};
    work w = work_start(sketch, &scratch);
    float *misfit = plm_scratch_take(&scratch, count, sizeof *misfit);
    int32_t *leaf = plm_scratch_take(&scratch, count, sizeof *leaf);
    const bool started = plm_heap_start(&heap, misfit, count, &scratch);
    for (uint32_t i = 0; started && i < count; i++) misfit[i] = INFINITY;
    for (uint32_t i = 0; started && i < count; i++)
        if (waits(sketch, beyond, i) && is_beside_leaf(sketch, i)) offer(&w, &heap, misfit, leaf, i);
    while (heap.count) {
        const uint32_t i = plm_heap_pop(&heap);
        sketch->leaf[i] = leaf[i];
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++)
            if (waits(sketch, beyond, graph->edge[e])) offer(&w, &heap, misfit, leaf, graph->edge[e]);
    }
    plm_scratch_free(&scratch, NULL);
    return started ? PLM_OK : PLM_E_MEMORY;
}
