/* segment/graph.c: the neighbour graph and Dijkstra's distances along it. */
#include "segment/graph.h"

#include "cloud/neighbours.h"
#include "segment/point_heap.h"
#include "segment/scratch.h"

#include <math.h>
#include <string.h>

double plm_graph_length(const plm_graph *graph, uint32_t a, uint32_t b)
{
    const float *p = graph->xyz[a], *q = graph->xyz[b];
    const double x = (double)p[0] - q[0], y = (double)p[1] - q[1], z = (double)p[2] - q[2];
    return sqrt(x * x + y * y + z * z);
}

static void sort_rows(uint32_t *row, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const uint32_t here = row[i];
        size_t j = i;
        for (; j > 0 && row[j - 1] > here; j--) row[j] = row[j - 1];
        row[j] = here;
    }
}

/* Makes the adjacency lists of the links (both ways, sorted, each neighbour once), beside those of an old graph. */
static plm_status fill(plm_graph *graph, const plm_graph *old, const plm_link *link, size_t link_count,
                       plm_error *error)
{
    const size_t count = graph->count;
    const size_t old_edges = old ? old->first[count] : 0;
    uint32_t *first = plm_alloc_zero(count + 2, sizeof *first, error);
    uint32_t *edge = plm_alloc(old_edges + 2 * link_count, sizeof *edge, error);
    if (!first || !edge) {
        plm_free(first);
        plm_free(edge);
        return PLM_E_MEMORY;
    }
    /* first[i + 2] counts, then first[i + 1] is where the next neighbour of i goes. */
    for (size_t i = 0; old && i < count; i++) first[i + 2] = old->first[i + 1] - old->first[i];
    for (size_t i = 0; i < link_count; i++) first[link[i].a + 2]++, first[link[i].b + 2]++;
    for (size_t i = 2; i <= count + 1; i++) first[i] += first[i - 1];
    for (size_t i = 0; old && i < count; i++)
        for (uint32_t e = old->first[i]; e < old->first[i + 1]; e++) edge[first[i + 1]++] = old->edge[e];
    for (size_t i = 0; i < link_count; i++) {
        edge[first[link[i].a + 1]++] = link[i].b;
        edge[first[link[i].b + 1]++] = link[i].a;
    }
    uint32_t out = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t begin = i ? first[i] : 0, end = first[i + 1], start = out;
        sort_rows(edge + begin, end - begin);
        for (uint32_t e = begin; e < end; e++)
            if (out == start || edge[out - 1] != edge[e]) edge[out++] = edge[e];
        first[i] = start;
        /* The next list begins where this one's raw entries ended; first[i + 1] still says so. */
    }
    first[count] = out;
    graph->first = first;
    graph->edge = edge;
    return PLM_OK;
}

plm_status plm_graph_build(const float (*xyz)[3], size_t count, size_t k, double longest, plm_graph *graph,
                           plm_error *error)
{
    plm_scratch scratch = {.error = error};
    plm_index *index = NULL;
    uint32_t *row = plm_scratch_take(&scratch, count * k, sizeof *row);
    float *squared = plm_scratch_take(&scratch, count * k, sizeof *squared);
    plm_link *link = plm_scratch_take(&scratch, count * k, sizeof *link);
    plm_status status = scratch.failed ? PLM_E_MEMORY : plm_index_build(xyz, count, &index, error);
    if (status == PLM_OK) status = plm_index_table(index, k, row, squared, error);
    if (status == PLM_OK) {
        const double limit = longest * longest;
        size_t links = 0;
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j < k; j++) {
                const uint32_t other = row[i * k + j];
                if (other == PLM_NO_ROW || squared[i * k + j] > limit) break;
                link[links++] = (plm_link){(uint32_t)i, other, 0};
            }
        plm_graph out = {.count = count, .xyz = xyz};
        status = fill(&out, NULL, link, links, error);
        if (status == PLM_OK) *graph = out;
    }
    plm_index_free(index);
    plm_scratch_free(&scratch, NULL);
    return status;
}

plm_status plm_graph_add(plm_graph *graph, const plm_link *link, size_t count, plm_error *error)
{
    plm_graph out = {.count = graph->count, .xyz = graph->xyz};
    const plm_status status = fill(&out, graph, link, count, error);
    if (status != PLM_OK) return status;
    plm_graph_free(graph);
    *graph = out;
    return PLM_OK;
}

void plm_graph_part(plm_graph *graph, const int32_t *colour)
{
    uint32_t out = 0, begin = 0;
    for (size_t i = 0; i < graph->count; i++) {
        const uint32_t end = graph->first[i + 1];
        for (uint32_t e = begin; e < end; e++) {
            const int32_t a = colour[i], b = colour[graph->edge[e]];
            if (a < 0 || b < 0 || a == b) graph->edge[out++] = graph->edge[e];
        }
        graph->first[i + 1] = out;
        begin = end;
    }
}

void plm_graph_free(plm_graph *graph)
{
    if (!graph) return;
    plm_free(graph->first);
    plm_free(graph->edge);
    graph->first = graph->edge = NULL;
}

size_t plm_graph_components(const plm_graph *graph, const int32_t *colour, int32_t *component, uint32_t *stack)
{
    size_t components = 0;
    for (size_t i = 0; i < graph->count; i++) component[i] = -1;
    for (size_t i = 0; i < graph->count; i++) {
        if (component[i] >= 0 || (colour && colour[i] < 0)) continue;
        size_t depth = 0;
        stack[depth++] = (uint32_t)i;
        component[i] = (int32_t)components;
        while (depth) {
            const uint32_t here = stack[--depth];
            for (uint32_t e = graph->first[here]; e < graph->first[here + 1]; e++) {
                const uint32_t next = graph->edge[e];
                if (component[next] >= 0 || (colour && colour[next] != colour[i])) continue;
                component[next] = (int32_t)components;
                stack[depth++] = next;
            }
        }
        components++;
    }
    return components;
}

static void relax(const plm_graph *graph, const plm_walk *walk, plm_point_heap *heap, uint32_t here)
{
    for (uint32_t e = graph->first[here]; e < graph->first[here + 1]; e++) {
        const uint32_t next = graph->edge[e];
        if (walk->allowed && !walk->allowed[next]) continue;
        double length = plm_graph_length(graph, here, next);
        if (walk->weight) length *= 0.5 * ((double)walk->weight[here] + walk->weight[next]);
        const float reached = (float)(walk->distance[here] + length);
        if (!(reached < walk->distance[next]) || (walk->limit > 0 && reached > walk->limit)) continue;
        walk->distance[next] = reached;
        if (walk->parent) walk->parent[next] = here;
        if (walk->origin) walk->origin[next] = walk->origin[here];
        plm_heap_add(heap, next);
    }
}

plm_status plm_graph_walk(const plm_graph *graph, const plm_walk *walk, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    plm_point_heap heap = {0};
    if (plm_heap_start(&heap, walk->distance, graph->count, &scratch)) {
        for (size_t i = 0; i < graph->count; i++) {
            walk->distance[i] = INFINITY;
            if (walk->parent) walk->parent[i] = UINT32_MAX;
            if (walk->origin) walk->origin[i] = -1;
        }
        for (size_t i = 0; i < walk->source_count; i++) {
            const uint32_t source = walk->source[i];
            const float start = walk->start ? walk->start[i] : 0;
            if (!(start < walk->distance[source])) continue;
            walk->distance[source] = start;
            if (walk->origin) walk->origin[source] = (int32_t)i;
            plm_heap_add(&heap, source);
        }
        size_t reached = 0;
        while (heap.count) {
            const uint32_t here = plm_heap_pop(&heap);
            if (walk->order) walk->order[reached] = here;
            reached++;
            relax(graph, walk, &heap, here);
        }
        if (walk->reached) *walk->reached = reached;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
