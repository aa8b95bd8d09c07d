/* segment/tidy.c: components of tube and of blade that are too small to be what they were called change sides. */
#include "segment/scratch.h"
#include "segment/sketch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 3 };
static const double TUBE_SHORTEST = 1.5;   /* in R */
static const double BLADE_SMALLEST = 0.35; /* in R squared */

typedef struct piece {
    uint32_t component, first_point, count;
    bool is_tube, flips, blocked;
    double length; /* of tubes: between their two ends, straight */
} piece;

static int by_size(const void *a, const void *b)
{
    const piece *p = a, *q = b;
    if (p->count != q->count) return p->count < q->count ? -1 : 1;
    return (p->component > q->component) - (p->component < q->component);
}

/* The point of a component that is farthest from a point. */
static uint32_t farthest(const plm_sketch *sketch, const int32_t *component, int32_t which, uint32_t from,
                         double *length)
{
    uint32_t best = from;
    *length = 0;
    for (uint32_t i = 0; i < sketch->working.count; i++) {
        if (component[i] != which) continue;
        const double d = plm_graph_length(&sketch->graph, from, i);
        if (d > *length) {
            *length = d;
            best = i;
        }
    }
    return best;
}

static bool is_too_small(const plm_sketch *sketch, const int32_t *component, piece *p)
{
    const double R = sketch->scale.radius, cell = sketch->working.cell;
    if (!p->is_tube) return p->count * cell * cell < BLADE_SMALLEST * R * R;
    /* Only a small piece can be short; measuring costs a pass over all points. */
    if (p->count * cell * cell > 12 * R * R) return false;
    const int32_t which = (int32_t)p->component;
    const uint32_t end = farthest(sketch, component, which, p->first_point, &p->length);
    farthest(sketch, component, which, end, &p->length);
    return p->length < TUBE_SHORTEST * R;
}

/* One round: pieces flip, smallest first, unless a neighbour has flipped in this round. */
static bool flip_pieces(plm_sketch *sketch, const int32_t *component, size_t components, piece *list, uint32_t *place)
{
    const plm_graph *graph = &sketch->graph;
    memset(list, 0, components * sizeof *list);
    for (uint32_t i = (uint32_t)graph->count; i-- > 0;) {
        piece *p = &list[component[i]];
        *p = (piece){.component = (uint32_t)component[i],
                     .first_point = i,
                     .count = p->count + 1,
                     .is_tube = sketch->is_tube[i]};
    }
    qsort(list, components, sizeof *list, by_size);
    for (uint32_t k = 0; k < components; k++) place[list[k].component] = k;
    bool any = false;
    for (size_t k = 0; k < components; k++) {
        piece *p = &list[k];
        if (p->blocked || !is_too_small(sketch, component, p)) continue;
        p->flips = any = true;
        for (uint32_t i = 0; i < graph->count; i++) {
            if (component[i] != (int32_t)p->component) continue;
            for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++)
                list[place[component[graph->edge[e]]]].blocked = true;
        }
    }
    for (uint32_t i = 0; i < graph->count; i++)
        if (list[place[component[i]]].flips) sketch->is_tube[i] = !sketch->is_tube[i];
    return any;
}

plm_status plm_sketch_tidy(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    int32_t *colour = plm_scratch_take(&scratch, count, sizeof *colour);
    int32_t *component = plm_scratch_take(&scratch, count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, count, sizeof *stack);
    piece *list = plm_scratch_take(&scratch, count, sizeof *list);
    for (int round = 0; round < ROUNDS && !scratch.failed; round++) {
        for (size_t i = 0; i < count; i++) colour[i] = sketch->is_tube[i];
        const size_t components = plm_graph_components(&sketch->graph, colour, component, stack);
        if (!flip_pieces(sketch, component, components, list, stack)) break;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
