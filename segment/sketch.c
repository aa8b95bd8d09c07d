/* segment/sketch.c: from all points of a plant to the thinned copy with tube probabilities. */
#include "segment/sketch.h"

#include "segment/halo.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_BUDGET = 80000, NEIGHBOURS = 10, SMOOTHING_ROUNDS = 2 };
static const double WORKING_CELLS = 12; /* in R */
static const double EDGE_CELLS = 3, JOIN_RADII = 2.5;
/* A point with fewer links than FEW_LINKS lies amid gaps: 0.017 at most of the working points of evenly scanned plants do, 0.11 and
 * more of splats whose stem is dense and whose leaves are sparse (0.37 and more of their points have more than MANY_LINKS; of plants
 * thinly scanned all over 0.27 at most). Distances along such links say little. Where more than LOOSE do amid more than a share DENSE
 * with many, or more than SPARSE do, the cell grows until less than TIGHT do, in steps of CELL_GROWTH to R / LEAST_CELLS. */
static const double LOOSE = 0.1, DENSE = 0.3, SPARSE = 0.2, TIGHT = 0.03, CELL_GROWTH = 1.15, LEAST_CELLS = 6;
enum { FEW_LINKS = 5, MANY_LINKS = 10 };

/* q = (q + mean of the neighbours) / 2 */
static plm_status smooth(const plm_graph *graph, float *value, plm_error *error)
{
    float *old = plm_alloc(graph->count, sizeof *old, error);
    if (!old) return PLM_E_MEMORY;
    for (int round = 0; round < SMOOTHING_ROUNDS; round++) {
        memcpy(old, value, graph->count * sizeof *old);
        for (size_t i = 0; i < graph->count; i++) {
            double sum = 0;
            for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++) sum += old[graph->edge[e]];
            const uint32_t degree = graph->first[i + 1] - graph->first[i];
            if (degree) value[i] = (float)(0.5 * (old[i] + sum / degree));
        }
    }
    plm_free(old);
    return PLM_OK;
}

static plm_status take_arrays(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    sketch->point = plm_alloc_zero(count, sizeof *sketch->point, error);
    sketch->tube = plm_alloc_zero(count, sizeof *sketch->tube, error);
    sketch->is_tube = plm_alloc_zero(count, sizeof *sketch->is_tube, error);
    sketch->is_stem = plm_alloc_zero(count, sizeof *sketch->is_stem, error);
    sketch->group = plm_alloc(count, sizeof *sketch->group, error);
    sketch->leaf = plm_alloc(count, sizeof *sketch->leaf, error);
    sketch->leaflet = plm_alloc(count, sizeof *sketch->leaflet, error);
    if (!sketch->point || !sketch->tube || !sketch->is_tube || !sketch->is_stem || !sketch->group || !sketch->leaf ||
        !sketch->leaflet)
        return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) sketch->group[i] = sketch->leaf[i] = sketch->leaflet[i] = -1;
    return PLM_OK;
}

static plm_status classify(plm_sketch *sketch, plm_error *error)
{
    const plm_status status = plm_tube_points((const float(*)[3])sketch->base.xyz, sketch->base.count, &sketch->working,
                                              &sketch->scale, sketch->point, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < sketch->working.count; i++) sketch->tube[i] = plm_tube_probability(&sketch->point[i]);
    return smooth(&sketch->graph, sketch->tube, error);
}

plm_status plm_sketch_link(const plm_sketch *sketch, double edge_cells, plm_graph *graph, plm_error *error)
{
    return plm_graph_build((const float(*)[3])sketch->working.xyz, sketch->working.count, NEIGHBOURS,
                           edge_cells * sketch->working.cell, graph, error);
}

plm_status plm_sketch_join(const plm_sketch *sketch, plm_graph *graph, bool also, plm_error *error)
{
    return plm_graph_join(graph, sketch->working.cell, JOIN_RADII * sketch->scale.radius, also, error);
}

/* Whether so many points have few links that the cell should grow, or grow further. */
static bool is_loose(const plm_graph *graph, bool has_grown)
{
    size_t few = 0, many = 0;
    for (size_t i = 0; i < graph->count; i++) {
        const uint32_t links = graph->first[i + 1] - graph->first[i];
        few += links < FEW_LINKS;
        many += links > MANY_LINKS;
    }
    const double all = (double)graph->count;
    if (has_grown) return (double)few > TIGHT * all;
    return (double)few > ((double)many > DENSE * all ? LOOSE : SPARSE) * all;
}

/* Thins the base to the working points and links them, in cells that are wide enough for the sparse parts of the plant. */
static plm_status take_working(plm_sketch *sketch, plm_error *error)
{
    double cell = fmax(sketch->scale.radius / WORKING_CELLS, sketch->scale.spacing);
    for (bool has_grown = false;; has_grown = true, cell *= CELL_GROWTH) {
        plm_status status =
            plm_thin((const float(*)[3])sketch->base.xyz, sketch->base.count, cell, &sketch->working, error);
        if (status == PLM_OK) status = plm_sketch_link(sketch, EDGE_CELLS, &sketch->graph, error);
        const bool wider = CELL_GROWTH * cell <= sketch->scale.radius / LEAST_CELLS;
        if (status != PLM_OK || !wider || !is_loose(&sketch->graph, has_grown)) return status;
        plm_thinned_free(&sketch->working);
        plm_graph_free(&sketch->graph);
    }
}

plm_status plm_sketch_make(const float (*xyz)[3], size_t count, size_t point_budget, plm_tubes tubes, plm_sketch *out,
                           plm_error *error)
{
    plm_sketch sketch = {0};
    double cell;
    plm_status status = plm_thin_cell(xyz, count, point_budget ? point_budget : DEFAULT_BUDGET, &cell, error);
    if (status == PLM_OK) status = plm_thin(xyz, count, cell, &sketch.base, error);
    const float(*base)[3] = (const float(*)[3])sketch.base.xyz;
    if (status == PLM_OK) status = plm_find_scale(base, sketch.base.count, &sketch.scale, error);
    if (status == PLM_OK && plm_has_halo(&sketch.scale)) { /* which had made the noise seem larger, too */
        status = plm_halo_drop(&sketch.base, &sketch.scale, error);
        if (status == PLM_OK) status = plm_find_scale(base, sketch.base.count, &sketch.scale, error);
    }
    const bool any = tubes == PLM_TUBES_ANY && sketch.scale.tube_length > 0 && sketch.scale.stem_radius > 0;
    if (any && !sketch.scale.has_tubes) sketch.scale.is_doubtful = true;
    if (tubes >= PLM_TUBES_DOUBTFUL && sketch.scale.is_doubtful) sketch.scale.has_tubes = true;
    if (tubes == PLM_TUBES_NONE) sketch.scale.has_tubes = sketch.scale.is_doubtful = false;
    if (status == PLM_OK) status = take_working(&sketch, error);
    if (status == PLM_OK) status = plm_sketch_join(&sketch, &sketch.graph, true, error);
    if (status == PLM_OK) status = take_arrays(&sketch, error);
    if (status == PLM_OK && sketch.scale.has_tubes) status = classify(&sketch, error);
    for (size_t i = 0; status == PLM_OK && i < sketch.working.count; i++) sketch.is_tube[i] = sketch.tube[i] > 0.5f;
    if (status == PLM_OK)
        *out = sketch;
    else
        plm_sketch_free(&sketch);
    return status;
}

void plm_sketch_free(plm_sketch *sketch)
{
    plm_thinned_free(&sketch->base);
    plm_thinned_free(&sketch->working);
    plm_graph_free(&sketch->graph);
    plm_free(sketch->point);
    plm_free(sketch->tube);
    plm_free(sketch->is_tube);
    plm_free(sketch->is_stem);
    plm_stem_path_free(&sketch->stem);
    plm_free(sketch->group);
    plm_free(sketch->leaf);
    plm_free(sketch->leaflet);
    plm_free(sketch->leaf_flags);
    *sketch = (plm_sketch){0};
}
