/* mesh/leaf_layers.c: which connected parts of a leaf are layers of one sheet. */
#include "mesh/leaf_layers.h"

#include <math.h>
#include <string.h>

enum { PROBES = 100 };

/* A part of which this share lies this near to a larger one, in its own radii of gyration, is a layer of it. Leaflets that
 * overlap have much of themselves elsewhere, or lie further apart. */
static const double layer_distance = 0.2, layer_share = 0.8;

/** One part: its points side by side, and how large it is. */
typedef struct part {
    size_t count;
    float (*xyz)[3];
    plm_index *index;
    double gyration;
} part;

static plm_status gather_part(const plm_leaf_points *points, size_t component, part *out, plm_error *error)
{
    out->xyz = plm_alloc(points->component_size[component], sizeof *out->xyz, error);
    if (!out->xyz) return PLM_E_MEMORY;
    double sum[3] = {0, 0, 0}, squares = 0;
    for (size_t i = 0; i < points->count; i++)
        if (points->component[i] == component) {
            memcpy(out->xyz[out->count++], points->xyz[i], sizeof *out->xyz);
            for (int axis = 0; axis < 3; axis++) sum[axis] += points->xyz[i][axis];
        }
    for (size_t i = 0; i < out->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double d = out->xyz[i][axis] - sum[axis] / (double)out->count;
            squares += d * d;
        }
    out->gyration = sqrt(squares / (double)out->count);
    return plm_index_build((const float(*)[3])out->xyz, out->count, &out->index, error);
}

static void free_part(part *p)
{
    plm_index_free(p->index);
    plm_free(p->xyz);
}

/* Whether most of small lies within a share of its own size from large. */
static bool is_layer(const part *small, const part *large)
{
    const double limit = layer_distance * small->gyration;
    const size_t probes = small->count < PROBES ? small->count : PROBES;
    size_t near = 0;
    for (size_t j = 0; j < probes; j++) {
        float squared;
        plm_index_nearest(large->index, small->xyz[j * small->count / probes], 1, NULL, &squared);
        near += squared <= limit * limit;
    }
    return (double)near >= layer_share * (double)probes;
}

/* Numbers the parts that are left, in the order in which they stood: their first ones are the largest. */
static void renumber(plm_leaf_points *points, const size_t *into)
{
    uint32_t number[PLM_LEAF_PARTS_MAXIMUM];
    size_t kept = 0;
    for (size_t p = 0; p < points->component_count; p++) {
        number[p] = into[p] == p ? (uint32_t)kept++ : number[into[p]];
        points->component_size[number[p]] =
            into[p] == p ? points->component_size[p] : points->component_size[number[p]] + points->component_size[p];
    }
    for (size_t i = 0; i < points->count; i++)
        if (points->component[i] != PLM_NO_ROW) points->component[i] = number[points->component[i]];
    points->component_count = kept;
}

plm_status plm_leaf_layers_merge(plm_leaf_points *points, plm_error *error)
{
    const size_t count = points->component_count;
    if (count < 2) return PLM_OK;
    part parts[PLM_LEAF_PARTS_MAXIMUM] = {{0}};
    size_t into[PLM_LEAF_PARTS_MAXIMUM];
    plm_status status = PLM_OK;
    for (size_t p = 0; p < count && status == PLM_OK; p++) status = gather_part(points, p, &parts[p], error);
    if (status == PLM_OK) {
        for (size_t p = 0; p < count; p++) {
            into[p] = p;
            for (size_t q = 0; q < p && into[p] == p; q++)
                if (into[q] == q && is_layer(&parts[p], &parts[q])) into[p] = q;
        }
        renumber(points, into);
    }
    for (size_t p = 0; p < count; p++) free_part(&parts[p]);
    return status;
}
