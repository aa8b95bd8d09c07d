/* segment/strap_leaves.c: a strap leaf wraps the stem at its foot, is round there and as thick as the stem, and may be a
 * tube to the eye of a small ball all along its midrib. So classes do not part it from the stem; the distance along the
 * plant does. */
#include "segment/strap_leaves.h"

#include "segment/merge_tree.h"
#include "segment/scratch.h"
#include "segment/strap_border.h"
#include "segment/strap_feet.h"
#include "segment/strap_stem.h"
#include "segment/strap_trunk.h"
#include "segment/tassel.h"

#include <math.h>
#include <string.h>

static const double REACH = 0.08;              /* a leaf reaches so far beyond the next fork, in sizes of the plant */
static const double LEAST_SHARE = 0.005;       /* of the points that a leaf holds at least */
static const double EDGE_CELLS[] = {2.2, 2.5}; /* longest edge, in cells: tried before that of the sketch */
static const double LOOSE_SHARE = 0.0025;      /* of the points: a larger piece is a part of a leaf */
static const double FOOT = 1.5;                /* the base: points so near to the stem's lowest node, in its radii */

/* The largest component but one. */
static plm_status second_component(const plm_graph *graph, size_t *second, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    int32_t *component = plm_scratch_take(&scratch, graph->count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, graph->count, sizeof *stack);
    const size_t components = scratch.failed ? 0 : plm_graph_components(graph, NULL, component, stack);
    size_t *size = plm_scratch_take(&scratch, components + 1, sizeof *size), largest = 0;
    *second = 0;
    for (size_t i = 0; !scratch.failed && i < graph->count; i++) size[component[i]]++;
    for (size_t k = 0; !scratch.failed && k < components; k++) {
        const size_t less = size[k] < largest ? size[k] : largest;
        if (size[k] > largest) largest = size[k];
        if (less > *second) *second = less;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Long edges join blades that run side by side, the more so by the stray points of noise between them: the shortest by
 * which no piece of a leaf comes loose are taken. */
static plm_status shorten_edges(plm_sketch *sketch, plm_error *error)
{
    const double most = LOOSE_SHARE * (double)sketch->working.count;
    plm_graph graph = {0};
    plm_status status = PLM_OK;
    for (size_t k = 0; k < sizeof EDGE_CELLS / sizeof *EDGE_CELLS; k++) {
        size_t second = 0;
        status = plm_sketch_link(sketch, EDGE_CELLS[k], &graph, error);
        if (status == PLM_OK) status = second_component(&graph, &second, error);
        if (status != PLM_OK || (double)second <= most) break;
        plm_graph_free(&graph);
    }
    if (status == PLM_OK && graph.first) status = plm_sketch_join(sketch, &graph, false, error);
    if (status == PLM_OK && graph.first) {
        plm_graph_free(&sketch->graph);
        sketch->graph = graph;
    } else {
        plm_graph_free(&graph);
    }
    return status;
}

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
 * lies about a touch) goes to the leaf whose surface goes on there, or else to the one that is nearest along the graph
 * without crossing the stem. beyond: what lies about touches and beyond them; NULL: all lies below. */
static plm_status mark_stem(plm_sketch *sketch, const float *from_base, const bool *beyond, uint32_t *source,
                            bool *allowed, float *distance, int32_t *origin, plm_error *error)
{
    const size_t count = sketch->working.count;
    size_t sources = 0;
    plm_status status = beyond ? plm_strap_beyond(sketch, beyond, error) : plm_strap_trunk(sketch, from_base, error);
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
    bool *beyond = plm_scratch_take(&scratch, count, sizeof *beyond);
    int32_t *origin = plm_scratch_take(&scratch, count, sizeof *origin);
    bool *allowed = plm_scratch_take(&scratch, count, sizeof *allowed);
    int32_t *branch = plm_scratch_take(&scratch, count, sizeof *branch);
    plm_status status = scratch.failed ? PLM_E_MEMORY : shorten_edges(sketch, error);
    if (status == PLM_OK) {
        const plm_walk walk = {.source = source, .source_count = base_points(sketch, source), .distance = distance};
        status = plm_graph_walk(&sketch->graph, &walk, error);
    }
    if (status == PLM_OK)
        status = plm_merge_tree(&sketch->graph, distance, REACH * sketch->scale.size,
                                (size_t)(LEAST_SHARE * (double)count), sketch->leaf, leaves, error);
    if (status == PLM_OK) memcpy(branch, sketch->leaf, count * sizeof *branch);
    double *foot = NULL, shape = INFINITY;
    if (status == PLM_OK && !(foot = plm_alloc(*leaves + PLM_STRAP_FEET_MOST, sizeof *foot, error)))
        status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t k = 0; k < *leaves; k++) foot[k] = INFINITY;
        for (size_t i = 0; i < count; i++)
            if (sketch->leaf[i] >= 0) sketch->is_stem[i] = false;
        status = plm_strap_stem(sketch, *leaves, &shape, error);
    }
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++) {
            const int32_t leaf = sketch->leaf[i];
            if (leaf >= 0) foot[leaf] = fmin(foot[leaf], (double)distance[i]);
        }
        status = mark_stem(sketch, distance, NULL, source, allowed, nearest, origin, error);
    }
    bool apart = false;
    if (status == PLM_OK) status = plm_strap_feet(sketch, distance, branch, beyond, foot, leaves, &apart, error);
    if (status == PLM_OK && apart)
        status = mark_stem(sketch, distance, beyond, source, allowed, nearest, origin, error);
    if (status == PLM_OK) status = plm_strap_border(sketch, shape, error);
    if (status == PLM_OK) status = plm_strap_tassel(sketch, distance, foot, leaves, error);
    if (status == PLM_OK)
        *along = foot;
    else
        plm_free(foot);
    plm_scratch_free(&scratch, NULL);
    return status;
}
