/* segment/merge_tree.h: branches of a plant by the distances along it alone, without classes. Internal. */
#ifndef PLANTIMETER_SEGMENT_MERGE_TREE_H
#define PLANTIMETER_SEGMENT_MERGE_TREE_H

#include "segment/graph.h"

/** A point by its distance. */
typedef struct plm_visit {
    float distance;
    uint32_t point;
} plm_visit;

/** For qsort: far points first, then the earlier. */
int plm_far_first(const void *a, const void *b);

/** The branches of a graph, from distance (of each point from the base; points at INFINITY are left out): going from far
 * to near, every farthest point starts a branch; where branches meet that reach more than reach above the meeting, and
 * have at least least points each, they end there, and what lies below is trunk; a lesser one is swallowed by what it
 * meets. branch: out, one a point, -1: trunk or left out. Gives their number in count. Ties go to the earlier point. */
plm_status plm_merge_tree(const plm_graph *graph, const float *distance, double reach, size_t least, int32_t *branch,
                          size_t *count, plm_error *error);

/** What makes a branch, where it is not the same all over. */
typedef struct plm_merge_rule {
    const float *distance;
    const float *reach;   /**< asked of branches that meet at a point; INFINITY: they never end there */
    const int32_t *apart; /**< points of two different colours do not meet; negative: of no colour; NULL: all meet */
    size_t least;
} plm_merge_rule;

/** The same by a rule. */
plm_status plm_merge_tree_by(const plm_graph *graph, const plm_merge_rule *rule, int32_t *branch, size_t *count,
                             plm_error *error);

#endif
