/* segment/rachis_sides.c: parts of a leaf without what is on its line, and how far along the line they go. */
#include "segment/rachis_sides.h"

#include "segment/rachis_hills.h"
#include "segment/scratch.h"

#include <string.h>

/* Medians of the links' lengths: points of one blade are nearer, and gaps are wider; and what parts blades that touch. */
static const double JOINED = 1.5, JOINED_CLOSELY = 1.15;
/* Of the way from its first place on the line to the tip: a leaflet at the side leaves before. */
static const double PART = 0.5;
/* Share of its points beside the line, and stations that it goes on beyond the last place there: what was parted by close links
 * may be torn from the last leaflet, which lies along the line. */
static const double BESIDE_MOST = 0.3;
/* With less in large pieces than this, of the share that the whole leaf has, close links tear blades of uneven points. Measured by the
 * rest alone, halves of sparse last leaflets would pass where large ones hang at the sides. */
static const double WHOLE = 0.9;
enum { BEYOND = 2 };

/* What hangs together off the line. */
typedef struct piece {
    size_t size, beside;  /* points, and those that lie beside the line */
    uint32_t first, last; /* stations at which it does; first > last: nowhere */
    uint32_t end;         /* the last station that is nearest to one of its points */
} piece;

typedef struct work {
    const plm_leaf_way *way;
    uint32_t *place; /* of each working point in the way's order; UINT32_MAX: not in it, on the line, or met */
    uint32_t *member;
    bool *loose;   /* of each working point, whether it has a place at first */
    float *length; /* scratch: a link of each point */
    double longest;
} work;

/* Lists the points that hang together with the one at a place of the way's order, as places; gives how many there are. */
static size_t collect(work *w, uint32_t from)
{
    const plm_sketch *sketch = w->way->sketch;
    const plm_graph *graph = &sketch->graph;
    size_t count = 0;
    w->member[count++] = from;
    w->place[w->way->order[from]] = UINT32_MAX;
    for (size_t k = 0; k < count; k++) {
        const uint32_t i = w->way->order[w->member[k]];
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++) {
            const uint32_t j = graph->edge[e];
            if (w->place[j] == UINT32_MAX || plm_graph_length(graph, i, j) > w->longest) continue;
            w->member[count++] = w->place[j];
            w->place[j] = UINT32_MAX;
        }
    }
    return count;
}

static piece measure(const work *w, size_t count, const float *off, const uint32_t *station, double reach)
{
    piece p = {.size = count, .first = UINT32_MAX};
    for (size_t k = 0; k < count; k++) {
        const uint32_t member = w->member[k];
        if (station[member] > p.end) p.end = station[member];
        if (!(off[member] < 2 * reach)) continue;
        p.beside++;
        if (station[member] < p.first) p.first = station[member];
        if (station[member] > p.last) p.last = station[member];
    }
    return p;
}

static bool is_side(const piece *p, double tip, bool closely)
{
    if (p->first > p->last || (double)p->last >= p->first + PART * (tip - p->first)) return false;
    return !closely || ((double)p->beside < BESIDE_MOST * (double)p->size && p->end >= p->last + BEYOND);
}

/* Takes the points off the line that are not marked yet, and the longest link that holds them together. Gives their number. */
static size_t take_points(work *w, const float *off, double reach, bool closely, const bool *aside)
{
    const plm_leaf_way *way = w->way;
    size_t points = 0;
    for (size_t i = 0; i < way->sketch->working.count; i++) w->place[i] = UINT32_MAX, w->loose[i] = false;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        w->loose[i] = !(off[k] < reach) && !aside[k];
        if (w->loose[i]) w->place[i] = (uint32_t)k, points++;
    }
    w->longest = (closely ? JOINED_CLOSELY : JOINED) * plm_leaf_typical_link(way, w->loose, w->length);
    return points;
}

/* Marks the pieces at the sides among the points that are not marked yet. Gives the share of these in pieces as large as blades. */
static double find_sides(work *w, const float *off, const uint32_t *station, double reach, bool closely, bool *aside)
{
    const plm_leaf_way *way = w->way;
    const double cell = way->sketch->working.cell, tip = (double)way->station_count - 1;
    const size_t points = take_points(w, off, reach, closely, aside);
    size_t large = 0;
    for (size_t k = 0; k < way->count; k++) {
        if (w->place[way->order[k]] == UINT32_MAX) continue;
        const size_t count = collect(w, (uint32_t)k);
        if ((double)count * cell * cell < plm_blade_least(way->sketch)) continue;
        const piece p = measure(w, count, off, station, reach);
        large += count;
        for (size_t m = 0; m < count && is_side(&p, tip, closely); m++) aside[w->member[m]] = true;
    }
    return points ? (double)large / (double)points : 0;
}

plm_status plm_rachis_sides(const plm_leaf_way *way, const float *off, const uint32_t *station, double reach,
                            bool *aside, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.way = way,
              .place = plm_scratch_take(&scratch, way->sketch->working.count, sizeof *w.place),
              .member = plm_scratch_take(&scratch, way->count, sizeof *w.member),
              .loose = plm_scratch_take(&scratch, way->sketch->working.count, sizeof *w.loose),
              .length = plm_scratch_take(&scratch, way->count, sizeof *w.length)};
    bool *parted = plm_scratch_take(&scratch, way->count, sizeof *parted);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) {
        memset(aside, 0, way->count * sizeof *aside);
        const double share = find_sides(&w, off, station, reach, false, aside);
        memcpy(parted, aside, way->count * sizeof *parted);
        if (find_sides(&w, off, station, reach, true, parted) >= WHOLE * share)
            memcpy(aside, parted, way->count * sizeof *aside);
        take_points(&w, off, reach, true, aside);
        status = plm_rachis_hills(way, off, station, reach, w.longest, aside, error);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
