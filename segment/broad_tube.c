/* segment/broad_tube.c: leaflets as small as the balls that classes come from look like tubes where the noise makes them
 * thick. But a petiolule is no thicker than the rachis that bears it: what stands off the rachis and is broader is blade. */
#include "segment/junction.h"

#include "cloud/linear.h"
#include "segment/scratch.h"

#include <math.h>

static const double NEAR = 3.2;   /* points within so many widths of the tube of a station's middle are the rachis' */
static const double BROAD = 1.45; /* SD across, in widths of the tube: more is blade */

typedef struct piece {
    double count, sum[3], moment[6];
    int32_t leaflet; /* that it borders on; -1: none */
    bool is_blade;
} piece;

/* Colours the tube points of the leaf that stand off the rachis 0, all other points -1. */
static void colour_off_rachis(const plm_leaf_way *way, int32_t *colour)
{
    const plm_sketch *s = way->sketch;
    for (size_t i = 0; i < s->working.count; i++) colour[i] = -1;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        if (!s->is_tube[i]) continue;
        const plm_station *station = plm_leaf_station(way, way->distance[i]);
        double squared = 0;
        for (int a = 0; a < 3; a++) {
            const double d = s->working.xyz[i][a] - station->middle[a];
            squared += d * d;
        }
        if (squared > NEAR * NEAR * way->tube * way->tube) colour[i] = 0;
    }
}

/* Moments about the working copy's corner are exact enough: a leaf is some hundred pieces wide. */
static void gather(const plm_leaf_way *way, const int32_t *component, piece *list)
{
    const plm_sketch *s = way->sketch;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        if (component[i] < 0) continue;
        piece *p = &list[component[i]];
        const float *x = s->working.xyz[i];
        p->count++;
        for (int a = 0, m = 0; a < 3; a++) {
            p->sum[a] += x[a];
            for (int b = a; b < 3; b++) p->moment[m++] += (double)x[a] * x[b];
        }
        for (uint32_t e = s->graph.first[i]; e < s->graph.first[i + 1]; e++) {
            const int32_t leaflet = s->leaflet[s->graph.edge[e]];
            if (leaflet >= 0 && s->leaf[s->graph.edge[e]] == s->leaf[i] && p->leaflet < 0) p->leaflet = leaflet;
        }
    }
}

static bool is_broad(const piece *p, double tube)
{
    double moment[6], value[3], vector[3][3];
    for (int a = 0, m = 0; a < 3; a++)
        for (int b = a; b < 3; b++, m++)
            moment[m] = p->moment[m] / p->count - p->sum[a] / p->count * (p->sum[b] / p->count);
    plm_eigen3(moment, value, vector);
    return value[1] > BROAD * BROAD * tube * tube;
}

plm_status plm_leaf_broad_tubes(plm_sketch *sketch, const plm_leaf_way *way, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    int32_t *colour = plm_scratch_take(&scratch, count, sizeof *colour);
    int32_t *component = plm_scratch_take(&scratch, count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, count, sizeof *stack);
    piece *list = NULL;
    size_t pieces = 0;
    if (!scratch.failed) {
        colour_off_rachis(way, colour);
        pieces = plm_graph_components(&sketch->graph, colour, component, stack);
        list = plm_scratch_take(&scratch, pieces + 1, sizeof *list);
    }
    if (list) {
        int32_t next = 0;
        for (size_t p = 0; p < pieces; p++) list[p].leaflet = -1;
        gather(way, component, list);
        for (size_t k = 0; k < way->count; k++)
            if (sketch->leaflet[way->order[k]] >= next) next = sketch->leaflet[way->order[k]] + 1;
        for (size_t p = 0; p < pieces; p++) {
            list[p].is_blade = is_broad(&list[p], way->tube);
            if (list[p].is_blade && list[p].leaflet < 0) list[p].leaflet = next++;
        }
        for (size_t k = 0; k < way->count; k++) {
            const uint32_t i = way->order[k];
            if (component[i] < 0 || !list[component[i]].is_blade) continue;
            sketch->is_tube[i] = false;
            sketch->leaflet[i] = list[component[i]].leaflet;
        }
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
