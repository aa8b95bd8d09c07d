/* segment/forest.h: boosted trees, as bench/accuracy/boosting.py writes them. Internal. */
#ifndef PLANTIMETER_SEGMENT_FOREST_H
#define PLANTIMETER_SEGMENT_FOREST_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

enum { PLM_TREE_NODES = 31 };

/** A full binary tree: children of node n are 2 n + 1 and 2 n + 2; a feature above the threshold goes to the second. */
typedef struct plm_tree {
    uint8_t feature[PLM_TREE_NODES];
    float threshold[PLM_TREE_NODES];
    float leaf[PLM_TREE_NODES + 1]; /**< what it adds to the logarithm of the odds */
} plm_tree;

/** Probability of what the trees tell by the features. */
static inline double plm_forest_probability(double bias, const plm_tree *tree, size_t trees, const float *feature)
{
    double sum = bias;
    for (size_t k = 0; k < trees; k++) {
        size_t node = 0;
        while (node < PLM_TREE_NODES) node = 2 * node + 1 + (feature[tree[k].feature[node]] > tree[k].threshold[node]);
        sum += (double)tree[k].leaf[node - PLM_TREE_NODES];
    }
    return 1 / (1 + exp(-sum));
}

#endif
