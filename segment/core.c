/* segment/core.c: the middle of a plant by distances along it. */
#include "segment/core.h"

#include "segment/scratch.h"
#include "segment/stem_fit.h"

#include <math.h>

enum { PROBES = 12 };
static const double DETOUR = 2; /* height that a detour of length 1 takes off */

/* A point of the largest component: floaters are none of the plant. */
static uint32_t point_of_largest(const plm_graph *graph, int32_t *component, uint32_t *stack, uint32_t *size)
{
    const size_t components = plm_graph_components(graph, NULL, component, stack);
    for (size_t c = 0; c < components; c++) size[c] = 0;
    uint32_t best = 0;
    for (uint32_t i = 0; i < graph->count; i++) size[component[i]]++;
    for (uint32_t i = 1; i < graph->count; i++)
        if (size[component[i]] > size[component[best]]) best = i;
    return best;
}

plm_status plm_sketch_core(const plm_sketch *sketch, uint32_t *core, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    float *nearest = plm_scratch_take(&scratch, count, sizeof *nearest);
    float *sum = plm_scratch_take(&scratch, count, sizeof *sum);
    int32_t *component = plm_scratch_take(&scratch, count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, count, sizeof *stack);
    uint32_t *size = plm_scratch_take(&scratch, count, sizeof *size);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    for (size_t i = 0; i < count && status == PLM_OK; i++) nearest[i] = INFINITY;
    uint32_t probe = status == PLM_OK ? point_of_largest(&sketch->graph, component, stack, size) : 0;
    /* Each next one is the point farthest from all before; the first only starts the series. */
    for (int k = 0; k <= PROBES && status == PLM_OK; k++) {
        const plm_walk walk = {.source = &probe, .source_count = 1, .distance = distance};
        status = plm_graph_walk(&sketch->graph, &walk, error);
        float most = -1;
        for (uint32_t i = 0; i < count; i++) {
            if (!isfinite(distance[i])) continue;
            if (k) sum[i] += distance[i];
            if (k && distance[i] < nearest[i]) nearest[i] = distance[i];
            const float here = k ? nearest[i] : distance[i];
            if (here > most) most = here, probe = i;
        }
    }
    *core = UINT32_MAX;
    for (uint32_t i = 0; i < count && status == PLM_OK; i++)
        if (isfinite(nearest[i]) && sketch->is_tube[i] && (*core == UINT32_MAX || sum[i] < sum[*core])) *core = i;
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* The point that is reached from `from` with the largest gain of height (times sign), less the detour on the way. */
static plm_status most_upright(const plm_sketch *sketch, uint32_t from, double sign, uint32_t *to, plm_error *error)
{
    const size_t count = sketch->working.count;
    float *distance = plm_alloc(count, sizeof *distance, error);
    if (!distance) return PLM_E_MEMORY;
    const plm_walk walk = {.source = &from, .source_count = 1, .distance = distance};
    const plm_status status = plm_graph_walk(&sketch->graph, &walk, error);
    double most = -INFINITY;
    for (uint32_t i = 0; i < count && status == PLM_OK; i++) {
        if (!isfinite(distance[i])) continue;
        const double rise = sign * ((double)sketch->working.xyz[i][2] - sketch->working.xyz[from][2]);
        const double gain = rise - DETOUR * (distance[i] - rise);
        if (gain > most) most = gain, *to = i;
    }
    plm_free(distance);
    return status;
}

plm_status plm_upright_ends(const plm_sketch *sketch, uint32_t *base, uint32_t *top, plm_error *error)
{
    uint32_t core;
    plm_status status = plm_sketch_core(sketch, &core, error);
    *base = *top = UINT32_MAX;
    if (status != PLM_OK || core == UINT32_MAX) return status;
    status = most_upright(sketch, core, -1, base, error);
    return status == PLM_OK ? most_upright(sketch, *base, 1, top, error) : status;
}

plm_status plm_sketch_upright_stem(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    uint32_t *parent = plm_scratch_take(&scratch, count, sizeof *parent);
    uint32_t base = UINT32_MAX, top = UINT32_MAX;
    plm_status status = scratch.failed ? PLM_E_MEMORY : plm_upright_ends(sketch, &base, &top, error);
    if (status == PLM_OK && base != UINT32_MAX) {
        const plm_walk walk = {.source = &base, .source_count = 1, .distance = distance, .parent = parent};
        status = plm_graph_walk(&sketch->graph, &walk, error);
        if (status == PLM_OK) status = plm_stem_trace(sketch, parent, base, top, true, error);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
