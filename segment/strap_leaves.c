/* segment/strap_leaves.c: a strap leaf wraps the stem at its foot, is round there and as thick as the stem, and may be a
 * tube to the eye of a small ball all along its midrib. So classes do not part it from the stem; the distance along the
 * plant does. */
#include "segment/strap_leaves.h"

#include "segment/merge_tree.h"
#include "segment/scratch.h"
#include "segment/strap_stem.h"
#include "segment/strap_trunk.h"

#include <math.h>

static const double REACH = 0.08;        /* a leaf reaches so far beyond the next fork, in sizes of the plant */
static const double LEAST_SHARE = 0.005; /* of the points that a leaf holds at least */
static const double FOOT = 1.5;          /* the base: points so near to the stem's lowest node, in its radii */

static size_t base_points(const plm_sketch *sketch, uint32_t *source)
{
    size_t count = 0;
    uint32_t nearest = 0;
    double least = INFINITY;
    for (uint32_t i = 0; i < sketch->working.count; i++) {
        double squared = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double d = (double)sketch->working.xyz[i][axis] - sketch->stem.node[0][axis];
            squared += d * d;
        }
        if (squared < least) least = squared, nearest = i;
        if (sqrt(squared) < FOOT * sketch->stem.radius[0]) source[count++] = i;
    }
    if (!count) source[count++] = nearest;
    return count;
}

/* The stem is the trunk as far as its line says so; what else is trunk (lobes and folds that the tree swallowed, and what
 * lies below a touch) goes to the leaf whose surface goes on there, or else to the one that is nearest along the graph
 * without crossing the stem. */
static plm_status mark_stem(plm_sketch *sketch, const float *from_base, uint32_t *source, bool *allowed,
                            float *distance, int32_t *origin, plm_error *error)
{
    const size_t count = sketch->working.count;
    size_t sources = 0;
    plm_status status = plm_strap_trunk(sketch, from_base, error);
    if (status != PLM_OK) return status;
    for (uint32_t i = 0; i < count; i++) {
        allowed[i] = !sketch->is_stem[i] && isfinite(from_base[i]);
        if (sketch->leaf[i] >= 0) source[sources++] = i;
    }
    const plm_walk walk = {
        .source = source, .source_count = sources, .allowed = allowed, .distance = distance, .origin = origin};
    status = plm_graph_walk(&sketch->graph, &walk, error);
    for (size_t i = 0; status == PLM_OK && i < count; i++) {
        if (allowed[i] && sketch->leaf[i] < 0) {
            if (origin[i] >= 0)
                sketch->leaf[i] = sketch->leaf[source[origin[i]]];
            else
                sketch->is_stem[i] = true;
        }
        sketch->is_tube[i] = sketch->is_stem[i];
    }
    return status;
}

plm_status plm_strap_leaves(plm_sketch *sketch, double **along, size_t *leaves, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    uint32_t *source = plm_scratch_take(&scratch, count, sizeof *source);
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    float *nearest = plm_scratch_take(&scratch, count, sizeof *nearest);
    int32_t *origin = plm_scratch_take(&scratch, count, sizeof *origin);
    bool *allowed = plm_scratch_take(&scratch, count, sizeof *allowed);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) {
        const plm_walk walk = {.source = source, .source_count = base_points(sketch, source), .distance = distance};
        status = plm_graph_walk(&sketch->graph, &walk, error);
    }
    if (status == PLM_OK)
        status = plm_merge_tree(&sketch->graph, distance, REACH * sketch->scale.size,
                                (size_t)(LEAST_SHARE * (double)count), sketch->leaf, leaves, error);
    double *foot = NULL;
    if (status == PLM_OK && !(foot = plm_alloc(*leaves + 1, sizeof *foot, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t k = 0; k < *leaves; k++) foot[k] = INFINITY;
        for (size_t i = 0; i < count; i++)
            if (sketch->leaf[i] >= 0) sketch->is_stem[i] = false;
        status = plm_strap_stem(sketch, *leaves, error);
    }
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++) {
            const int32_t leaf = sketch->leaf[i];
            if (leaf >= 0) foot[leaf] = fmin(foot[leaf], (double)distance[i]);
        }
        status = mark_stem(sketch, distance, source, allowed, nearest, origin, error);
        *along = foot;
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
