/* segment/rachis_hills.c: in noise the last leaflets at the sides touch the one at the tip, and no gap parts them. But where they
 * touch is nearer to the line than either's farthest point: a saddle between two hills of the distance from the line. A tooth
 * or a lobe of one leaflet rises little above the notch beside it. */
#include "segment/rachis_hills.h"

#include "segment/merge_tree.h"
#include "segment/scratch.h"

#include <math.h>

static const double RISE = 0.4;       /* of the saddle's distance from the line, and ... */
static const double RISE_CELLS = 1.5; /* ... in cells: what both hills rise above it, at least */
/* In cells, at least: in a narrower strip beside the line gaps between a few points look like saddles (1.5 to 1.99 where halves of
 * the last leaflet were parted, 2.02 to 2.8 where leaflets were). */
static const double LEAST_REACH = 2;
/* Share of a leaflet's points above the saddle: more are below it where a sheet is torn. */
static const double ABOVE = 0.6;
static const double BESIDE_MOST = 0.3; /* share of its points beside the line: a half of the last leaflet has more */
/* Of the way from its first place at the line to the tip: the middle of its places is nearer; a half of the last leaflet has it
 * at a half. */
static const double MIDDLE = 0.25;
static const double FIRST = 0.05; /* quantile of its places: some points are strays */

typedef struct work {
    const plm_leaf_way *way;
    const float *off;
    const uint32_t *station;
    double reach;
    plm_graph graph;  /* of the points off the line, over close links */
    float *distance;  /* of each working point, as all that follow */
    float *rise;      /* INFINITY: not looked at */
    int32_t *hill;    /* above the saddles */
    int32_t *origin;  /* place in source of the nearest point on a hill */
    uint32_t *source; /* points on hills */
    uint32_t *member; /* scratch: places in the way's order */
    float *value;
} work;

static void take_points(work *w, const bool *aside)
{
    const plm_leaf_way *way = w->way;
    const plm_thinned *working = &way->sketch->working;
    for (size_t i = 0; i < working->count; i++) w->distance[i] = w->rise[i] = INFINITY;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        if (w->off[k] < w->reach || aside[k]) continue;
        w->distance[i] = w->off[k];
        w->rise[i] = (float)fmax(RISE * w->off[k], RISE_CELLS * working->cell);
    }
}

static void link_closely(work *w, double longest)
{
    const plm_graph *all = &w->way->sketch->graph;
    uint32_t count = 0;
    for (uint32_t i = 0; i < all->count; i++) {
        w->graph.first[i] = count;
        for (uint32_t e = all->first[i]; e < all->first[i + 1] && isfinite(w->rise[i]); e++) {
            const uint32_t j = all->edge[e];
            if (isfinite(w->rise[j]) && plm_graph_length(all, i, j) <= longest) w->graph.edge[count++] = j;
        }
    }
    w->graph.first[all->count] = count;
}

/* The hills, and for the points below the saddles the hill that is nearest along the graph. */
static plm_status find_hills(work *w, size_t *hills, plm_error *error)
{
    const plm_sketch *sketch = w->way->sketch;
    const plm_merge_rule rule = {
        .distance = w->distance, .reach = w->rise, .least = (size_t)plm_blade_least_points(sketch)};
    plm_status status = plm_merge_tree_by(&w->graph, &rule, w->hill, hills, error);
    size_t sources = 0;
    for (uint32_t i = 0; i < sketch->working.count && status == PLM_OK; i++)
        if (w->hill[i] >= 0) w->source[sources++] = i;
    const plm_walk walk = {.source = w->source, .source_count = sources, .distance = w->distance, .origin = w->origin};
    return status == PLM_OK && sources ? plm_graph_walk(&w->graph, &walk, error) : status;
}

/* Lists the points of a hill and below it, as places in the way's order. Gives how many there are. */
static size_t collect(const work *w, int32_t hill)
{
    size_t count = 0;
    for (size_t k = 0; k < w->way->count; k++) {
        const uint32_t i = w->way->order[k];
        if (isfinite(w->rise[i]) && w->origin[i] >= 0 && w->hill[w->source[w->origin[i]]] == hill)
            w->member[count++] = (uint32_t)k;
    }
    return count;
}

static bool is_side(const work *w, size_t count)
{
    size_t above = 0, beside = 0;
    for (size_t m = 0; m < count; m++) {
        const uint32_t k = w->member[m];
        above += w->hill[w->way->order[k]] >= 0;
        if (w->off[k] < 2 * w->reach) w->value[beside++] = (float)w->station[k];
    }
    if ((double)above < ABOVE * (double)count || !beside || (double)beside >= BESIDE_MOST * (double)count) return false;
    const double first = plm_quantile(w->value, beside, FIRST), middle = plm_quantile(w->value, beside, 0.5);
    return middle < first + MIDDLE * ((double)w->way->station_count - 1 - first);
}

static plm_status take_scratch(work *w, plm_scratch *scratch)
{
    const size_t count = w->way->sketch->working.count;
    const plm_graph *all = &w->way->sketch->graph;
    w->graph = (plm_graph){.count = all->count,
                           .xyz = all->xyz,
                           .first = plm_scratch_take(scratch, all->count + 1, sizeof *all->first),
                           .edge = plm_scratch_take(scratch, all->first[all->count] + 1, sizeof *all->edge)};
    w->distance = plm_scratch_take(scratch, count, sizeof *w->distance);
    w->rise = plm_scratch_take(scratch, count, sizeof *w->rise);
    w->hill = plm_scratch_take(scratch, count, sizeof *w->hill);
    w->origin = plm_scratch_take(scratch, count, sizeof *w->origin);
    w->source = plm_scratch_take(scratch, count, sizeof *w->source);
    w->member = plm_scratch_take(scratch, w->way->count, sizeof *w->member);
    w->value = plm_scratch_take(scratch, w->way->count, sizeof *w->value);
    return scratch->failed ? PLM_E_MEMORY : PLM_OK;
}

plm_status plm_rachis_hills(const plm_leaf_way *way, const float *off, const uint32_t *station, double reach,
                            double longest, bool *aside, plm_error *error)
{
    if (reach < LEAST_REACH * way->sketch->working.cell) return PLM_OK;
    plm_scratch scratch = {.error = error};
    work w = {.way = way, .off = off, .station = station, .reach = reach};
    size_t hills = 0;
    plm_status status = take_scratch(&w, &scratch);
    if (status == PLM_OK) {
        take_points(&w, aside);
        link_closely(&w, longest);
        status = find_hills(&w, &hills, error);
    }
    for (size_t hill = 0; hill < hills && status == PLM_OK; hill++) {
        const size_t count = collect(&w, (int32_t)hill);
        const bool side = is_side(&w, count);
        for (size_t m = 0; m < count && side; m++) aside[w.member[m]] = true;
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
