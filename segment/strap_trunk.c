/* segment/strap_trunk.c: where two blades touch, the merge tree ends both, and what lies below on either is trunk. A surface
 * goes on with its own tangent: from the touch down to the stem, each point of the trunk goes to the leaf whose plane
 * passes nearest to it. */
#include "segment/strap_trunk.h"

#include "cloud/local_plane.h"
#include "segment/merge_tree.h"
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
static double misfit(const plm_sketch *s, const candidate *c, uint32_t centre)
{
    const float(*xyz)[3] = (const float(*)[3])s->working.xyz;
    double far = 0;
    for (int k = 0; k < c->count; k++) far += sqrt((double)c->squared[k]);
    return plm_local_plane_distance(xyz, c->point, (size_t)c->count, xyz[centre], NULL) + NEARNESS * far / c->count;
}

static int32_t choose(const plm_sketch *s, const candidate *list, int count, uint32_t centre)
{
    int32_t best = -1;
    double least = INFINITY;
    for (int k = 0; k < count; k++) {
        if (list[k].count < FEWEST) continue;
        const double value = misfit(s, &list[k], centre);
        if (value < least || (value == least && list[k].leaf < best)) least = value, best = list[k].leaf;
    }
    return best;
}

plm_status plm_strap_trunk(plm_sketch *sketch, const float *from_base, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    work w = {.sketch = sketch,
              .seen = plm_scratch_take(&scratch, count, sizeof *w.seen),
              .queue = plm_scratch_take(&scratch, count, sizeof *w.queue)};
    plm_visit *order = plm_scratch_take(&scratch, count, sizeof *order);
    size_t visits = 0;
    for (uint32_t i = 0; !scratch.failed && i < count; i++)
        if (sketch->leaf[i] < 0 && !sketch->is_stem[i] && isfinite(from_base[i]))
            order[visits++] = (plm_visit){from_base[i], i};
    if (visits) qsort(order, visits, sizeof *order, plm_far_first);
    for (size_t k = 0; k < visits; k++) {
        candidate list[CANDIDATES];
        const int found = find_candidates(&w, order[k].point, list);
        sketch->leaf[order[k].point] = choose(sketch, list, found, order[k].point);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
