/* segment/min_cut.h: the cheapest cut between some points of a sketch's graph, by maximum flow. Internal. */
#ifndef PLANTIMETER_SEGMENT_MIN_CUT_H
#define PLANTIMETER_SEGMENT_MIN_CUT_H

#include "segment/scratch.h"
#include "segment/sketch.h"

/** Some points and the edges among them, as arcs in both directions. */
typedef struct plm_net {
    const plm_sketch *sketch;
    size_t nodes;
    uint32_t *point;             /* of a node */
    uint32_t *node;              /* of a point, UINT32_MAX outside */
    uint32_t *first, *to, *twin; /* arcs of a node, where they lead, and the arc back */
    float *left;                 /* what an arc still holds */
    float *from, *into; /* what a node still takes from the source and gives to the sink; INFINITY: it is theirs */
    int32_t *level;     /* steps from the source, -1 where none leads */
    uint32_t *next, *queue, *path;
} plm_net;

/** Room for a net of all points, in the scratch. */
plm_status plm_net_start(plm_net *net, const plm_sketch *sketch, plm_scratch *scratch);

/** The net of the points whose colour is one of two, neither of them negative. */
void plm_net_of(plm_net *net, const int32_t *colour, int32_t one, int32_t other);

/** What an edge between two points holds: 1 up to a cell, less where it is longer, as those of a touch lead across a gap. */
float plm_net_capacity(const plm_sketch *sketch, uint32_t i, uint32_t j);

/** The maximum flow from the source to the sink (Dinic 1970) by from and into, which it uses up, or something above limit. Where it is
 * not above, level[] is not negative then on the source's side of the minimum cut. */
double plm_net_flow(plm_net *net, double limit);

#endif
