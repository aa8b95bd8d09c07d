/* segment/graph_join.c: a scan with gaps falls to pieces; the shortest links between them make it one plant again. */
#include "cloud/neighbours.h"
#include "segment/graph.h"
#include "segment/scratch.h"
#include "segment/thinning.h"

#include <math.h>
#include <stdlib.h>

/* A link between two components, in the order of Kruskal's rule. */
static int link_order(const void *a, const void *b)
{
    const plm_link *p = a, *q = b;
    if (p->length != q->length) return p->length < q->length ? -1 : 1;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

typedef struct link_list {
    plm_link *link;
    size_t count, room;
} link_list;

static bool link_push(link_list *list, plm_link link, plm_error *error)
{
    if (list->count == list->room) {
        const size_t room = list->room ? 2 * list->room : 256;
        plm_link *grown = plm_realloc(list->link, room, sizeof *grown, error);
        if (!grown) return false;
        list->link = grown;
        list->room = room;
    }
    list->link[list->count++] = link;
    return true;
}

/* The shortest link between points of different components in two coarse voxels, for each pair of components there. */
static bool link_voxels(const plm_graph *graph, const plm_voxels *c, const int32_t *component, uint32_t v, uint32_t w,
                        double longest, link_list *list, plm_error *error)
{
    const size_t before = list->count;
    for (uint32_t i = c->first[v]; i < c->first[v + 1]; i++)
        for (uint32_t j = c->first[w]; j < c->first[w + 1]; j++) {
            const uint32_t a = c->member[i], b = c->member[j];
            if (component[a] == component[b]) continue;
            const float length = (float)plm_graph_length(graph, a, b);
            if (length > longest) continue;
            const plm_link link = {a < b ? a : b, a < b ? b : a, length};
            size_t k = before;
            for (; k < list->count; k++)
                if ((component[list->link[k].a] == component[link.a] &&
                     component[list->link[k].b] == component[link.b]) ||
                    (component[list->link[k].a] == component[link.b] &&
                     component[list->link[k].b] == component[link.a]))
                    break;
            if (k == list->count) {
                if (!link_push(list, link, error)) return false;
            } else if (link_order(&link, &list->link[k]) < 0) {
                list->link[k] = link;
            }
        }
    return true;
}

/* The component of a voxel's points; -1: they are of several. */
static int32_t sole_component(const plm_voxels *c, const int32_t *component, uint32_t v)
{
    const int32_t sole = component[c->member[c->first[v]]];
    for (uint32_t i = c->first[v] + 1; i < c->first[v + 1]; i++)
        if (component[c->member[i]] != sole) return -1;
    return sole;
}

/* Candidate links: coarse voxels near each other, that hold points of different components. */
static plm_status find_links(const plm_graph *graph, const plm_thinned *coarse, const int32_t *component,
                             double longest, link_list *list, plm_error *error)
{
    const plm_voxels *c = &coarse->voxels;
    plm_index *index = NULL;
    plm_status status = plm_index_build((const float(*)[3])c->xyz, c->count, &index, error);
    uint32_t *row = plm_alloc(c->count, sizeof *row, error);
    float *squared = plm_alloc(c->count, sizeof *squared, error);
    int32_t *sole = plm_alloc(c->count, sizeof *sole, error);
    if (status == PLM_OK && (!row || !squared || !sole)) status = PLM_E_MEMORY;
    for (uint32_t v = 0; status == PLM_OK && v < c->count; v++) sole[v] = sole_component(c, component, v);
    /* Means lie within their voxels: two points nearer than longest have means nearer than this. */
    const float reach = (float)(longest + 2 * sqrt(3) * coarse->cell);
    for (uint32_t v = 0; status == PLM_OK && v < c->count; v++) {
        const size_t found = plm_index_ball(index, c->xyz[v], reach, c->count, row, squared);
        for (size_t k = 0; k < found; k++) {
            if (row[k] < v || (sole[v] >= 0 && sole[v] == sole[row[k]])) continue;
            if (!link_voxels(graph, c, component, v, row[k], longest, list, error)) status = PLM_E_MEMORY;
        }
    }
    plm_index_free(index);
    plm_free(row);
    plm_free(squared);
    plm_free(sole);
    return status;
}

plm_status plm_graph_join(plm_graph *graph, double cell, double longest, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    plm_thinned coarse = {0};
    link_list list = {0};
    int32_t *component = plm_scratch_take(&scratch, graph->count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, graph->count, sizeof *stack);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status != PLM_OK) goto done;
    const size_t components = plm_graph_components(graph, NULL, component, stack);
    if (components < 2) goto done;
    status = plm_thin(graph->xyz, graph->count, 4 * cell, &coarse, error);
    if (status != PLM_OK) goto done;
    status = find_links(graph, &coarse, component, longest, &list, error);
    if (status != PLM_OK) goto done;
    if (list.count > 1) qsort(list.link, list.count, sizeof *list.link, link_order);
    for (uint32_t i = 0; i < components; i++) stack[i] = i; /* union-find over components */
    size_t kept = 0;
    for (size_t i = 0; i < list.count; i++) {
        const uint32_t a = root_of(stack, (uint32_t)component[list.link[i].a]);
        const uint32_t b = root_of(stack, (uint32_t)component[list.link[i].b]);
        if (a == b) continue;
        stack[a] = b;
        list.link[kept++] = list.link[i];
    }
    status = plm_graph_add(graph, list.link, kept, error);
done:
    plm_free(list.link);
    plm_thinned_free(&coarse);
    plm_scratch_free(&scratch, NULL);
    return status;
}
