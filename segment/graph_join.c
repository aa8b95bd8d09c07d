/* segment/graph_join.c: a scan with gaps falls to pieces; the shortest links between them make it one plant again,
 * and others beside these keep ways straight. */
#include "cloud/neighbours.h"
#include "segment/graph.h"
#include "segment/scratch.h"
#include "segment/thinning.h"

#include <math.h>
#include <stdlib.h>

/* A sparse blade falls to many pieces, and along a tree of links between them ways take turns that no blade has. So they get
 * more links, up to so many times the shorter of the two pieces' shortest ones. (Of 220 virtual plants of 5 000 to 200 000
 * points F1 0.964 before and 0.973; of 64 rosettes 1.2 mends half as much, and 2.5 joins leaves side by side.) */
static const float ALSO = 1.6F;

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

/* Takes from a list, shortest first, the links that join and those that go beside them. parent, nearest: scratch, one a component. */
static size_t keep_links(const int32_t *component, size_t components, bool also, link_list *list, uint32_t *parent,
                         float *nearest)
{
    for (uint32_t i = 0; i < components; i++) {
        parent[i] = i; /* union-find over components */
        nearest[i] = INFINITY;
    }
    for (size_t i = 0; i < list->count; i++) {
        const plm_link *l = &list->link[i];
        nearest[component[l->a]] = fminf(nearest[component[l->a]], l->length);
        nearest[component[l->b]] = fminf(nearest[component[l->b]], l->length);
    }
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        const plm_link link = list->link[i];
        const int32_t p = component[link.a], q = component[link.b];
        const uint32_t a = root_of(parent, (uint32_t)p), b = root_of(parent, (uint32_t)q);
        if (a == b && (!also || link.length > ALSO * fminf(nearest[p], nearest[q]))) continue;
        parent[a] = b;
        list->link[kept++] = link;
    }
    return kept;
}

plm_status plm_graph_join(plm_graph *graph, double cell, double longest, bool also, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    plm_thinned coarse = {0};
    link_list list = {0};
    int32_t *component = plm_scratch_take(&scratch, graph->count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, graph->count, sizeof *stack);
    float *nearest = plm_scratch_take(&scratch, graph->count, sizeof *nearest);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status != PLM_OK) goto done;
    const size_t components = plm_graph_components(graph, NULL, component, stack);
    if (components < 2) goto done;
    status = plm_thin(graph->xyz, graph->count, 4 * cell, &coarse, error);
    if (status != PLM_OK) goto done;
    status = find_links(graph, &coarse, component, longest, &list, error);
    if (status != PLM_OK) goto done;
    if (list.count > 1) qsort(list.link, list.count, sizeof *list.link, link_order);
    status = plm_graph_add(graph, list.link, keep_links(component, components, also, &list, stack, nearest), error);
done:
    plm_free(list.link);
    plm_thinned_free(&coarse);
    plm_scratch_free(&scratch, NULL);
    return status;
}
