/* segment/graph.h: the neighbour graph of a thinned cloud, its components, and distances along it. Internal. */
#ifndef PLANTIMETER_SEGMENT_GRAPH_H
#define PLANTIMETER_SEGMENT_GRAPH_H

#include "cloud/cloud.h"

/** An undirected graph over count points: the neighbours of i are edge[first[i] .. first[i + 1]), in growing order. xyz
 * is the caller's and must outlive the graph. */
typedef struct plm_graph {
    size_t count;
    const float (*xyz)[3];
    uint32_t *first;
    uint32_t *edge;
} plm_graph;

typedef struct plm_link {
    uint32_t a, b;
    float length;
} plm_link;

/** Joins each point with its k nearest neighbours that are nearer than longest. */
plm_status plm_graph_build(const float (*xyz)[3], size_t count, size_t k, double longest, plm_graph *graph,
                           plm_error *error);

/** Adds links to a graph. */
plm_status plm_graph_add(plm_graph *graph, const plm_link *link, size_t count, plm_error *error);

/** Takes away the edges between points of two different colours, neither of them negative. */
void plm_graph_part(plm_graph *graph, const int32_t *colour);

/** Joins components of the graph by shortest links, none longer than longest (Kruskal's rule). also: adds links between joined ones,
 * at most 1.6 times as long as the shorter of the two pieces' shortest links, so that ways across a blade in pieces are nearly straight.
 * cell is the spacing of the points. */
plm_status plm_graph_join(plm_graph *graph, double cell, double longest, bool also, plm_error *error);

/** Links points of the graph's sparse parts with those near to them by the spacing there, if many such links are missing: plants that are
 * evenly dense lack few. PLM_E_MEMORY only. */
plm_status plm_graph_widen(plm_graph *graph, plm_error *error);

void plm_graph_free(plm_graph *graph);

/** Length of the edge between two points. */
double plm_graph_length(const plm_graph *graph, uint32_t a, uint32_t b);

/** Components of the points of equal colour (NULL: all points; points of a negative colour are left out and get -1).
 * component: out, one a point, numbered by first point. Gives their number. stack: scratch of count rows. */
size_t plm_graph_components(const plm_graph *graph, const int32_t *colour, int32_t *component, uint32_t *stack);

/** Distances along the graph from sources. weight[i] (NULL: 1) multiplies the halves of edges that end at point i.
 * distance: out, INFINITY where not reached; parent (may be NULL): out, UINT32_MAX at sources and where not reached;
 * origin (may be NULL): out, the place in source[] of the source that a point belongs to, -1 where not reached. Ties go
 * to the earlier point. start (may be NULL): distances that the sources begin with. order (may be NULL): out, the points
 * reached, by distance, each after its parent; *reached their number. */
typedef struct plm_walk {
    const uint32_t *source;
    size_t source_count;
    const float *start;
    const float *weight;
    const bool *allowed; /**< NULL: every point may be entered */
    double limit;        /**< 0: none */
    float *distance;
    uint32_t *parent;
    int32_t *origin;
    uint32_t *order;
    size_t *reached;
} plm_walk;

plm_status plm_graph_walk(const plm_graph *graph, const plm_walk *walk, plm_error *error);

#endif
