/* segment/leaflets.c: rachis, petiolules and leaflets of a compound leaf. Balls see blade on both sides of the rachis where
 * leaflets sit on it, and a tube where noise makes a small leaflet thick. The level sets tell the rachis where no leaflet is;
 * between two such stretches it goes straight on. What hangs on it at one place is a petiolule until it begins to
 * widen, and then a leaflet. */
#include "segment/junction.h"

#include "cloud/linear.h"
#include "segment/merge_tree.h"
#include "segment/scratch.h"

#include <math.h>
#include <stdlib.h>

static const double REACH = 2.2; /* widths of the tube from the rachis' line to its points: the tube's radius is 1.4 */
static const double GAP = 4;     /* in R: a longer way among leaflets need not be straight */
static const double THINNER = 0.75; /* petiolules against the rachis */
static const double BEND = 0.1;     /* the rachis may leave its line by so much of the way on */
static const double HOLE = 2;       /* windows without a tube point, where it ends */
enum {
    RUN = 3,          /* stations of the shortest narrow stretch */
    ENDS = 5,         /* stations that give the place of its end */
    MOST_PARTS = 128, /* of a leaf's blades */
    FEWEST = 12       /* points of what hangs on the rachis: less tells no width */
};
enum { ELSEWHERE = -1, OFF = 0 };

/* What of a blade had one number. */
typedef struct part {
    int32_t component, leaflet;
    size_t size;
    int32_t number;
} part;

typedef struct work {
    plm_sketch *sketch;
    const plm_leaf_way *way;
    int32_t *colour, *component;
    uint32_t *stack, *row; /* row: the leaf's points off the rachis, by component, each by distance */
    size_t *first;         /* of a component in row */
    plm_station *station;
    plm_visit *ahead;
} work;

/* ---- The rachis ------------------------------------------------------------------------------------------------- */

/* Whether no leaflet is in a station. */
static bool is_narrow(const plm_leaf_way *way, size_t k)
{
    return way->station[k].count && way->station[k].width < plm_leaf_wide(way);
}

/* The next stretch of narrow stations from station k on: [*begin, *end). false: there is none before the last. */
static bool next_run(const plm_leaf_way *way, size_t k, size_t last, size_t *begin, size_t *end)
{
    while (k < last) {
        while (k < last && !is_narrow(way, k)) k++;
        *begin = k;
        while (k < last && is_narrow(way, k)) k++;
        *end = k;
        if (*end - *begin >= RUN) return true;
    }
    return false;
}

/* Mean of the middles of stations [begin, end). */
static void mean_middle(const plm_leaf_way *way, size_t begin, size_t end, double middle[3])
{
    for (int a = 0; a < 3; a++) middle[a] = 0;
    for (size_t k = begin; k < end; k++)
        for (int a = 0; a < 3; a++) middle[a] += way->station[k].middle[a] / (double)(end - begin);
}

/* Calls the points near the line between two stretches tube. */
static void fill(work *w, const double from[3], const double to[3])
{
    const plm_leaf_way *way = w->way;
    plm_sketch *s = w->sketch;
    double along[3];
    for (int a = 0; a < 3; a++) along[a] = to[a] - from[a];
    const double length = plm_normalise(along), reach = REACH * way->tube;
    if (!(length > 0) || length > GAP * s->scale.radius) return;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = s->working.xyz[i][a] - from[a];
        const double forward = plm_dot(d, along);
        if (forward < 0 || forward > length || plm_dot(d, d) - forward * forward > reach * reach) continue;
        s->is_tube[i] = true;
        w->colour[i] = ELSEWHERE;
    }
}

/* Points of narrow stretches that lie near their middle are the rachis'. */
static void take_run(work *w, size_t begin, size_t end)
{
    const plm_leaf_way *way = w->way;
    const double reach = REACH * way->tube;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        const double station = way->distance[i] / way->step;
        if (station < (double)begin - 0.5 || station >= (double)end - 0.5) continue;
        double squared = 0;
        for (int a = 0; a < 3; a++) {
            const double d = w->sketch->working.xyz[i][a] - plm_leaf_station(way, way->distance[i])->middle[a];
            squared += d * d;
        }
        if (squared <= reach * reach) w->colour[i] = ELSEWHERE;
    }
}

/* Beyond its last stretch the rachis goes straight on as far as there are tube points ahead. */
static void go_on(work *w, size_t begin, size_t end)
{
    const plm_leaf_way *way = w->way;
    const plm_sketch *s = w->sketch;
    const size_t ends = end - begin < 2 * ENDS ? (end - begin) / 2 : ENDS;
    double from[3], back[3], along[3];
    mean_middle(way, end - ends, end, from);
    mean_middle(way, end - 2 * ends, end - ends, back);
    for (int a = 0; a < 3; a++) along[a] = from[a] - back[a];
    if (!(plm_normalise(along) > 0)) return;
    size_t count = 0;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = s->working.xyz[i][a] - from[a];
        const double forward = plm_dot(d, along), reach = REACH * way->tube + BEND * fmax(forward, 0);
        if (w->colour[i] != OFF || !s->is_tube[i] || forward < 0) continue;
        if (plm_dot(d, d) - forward * forward <= reach * reach) w->ahead[count++] = (plm_visit){(float)-forward, i};
    }
    if (count) qsort(w->ahead, count, sizeof *w->ahead, plm_far_first);
    float last = 0;
    for (size_t k = 0; k < count && -w->ahead[k].distance - last <= HOLE * way->window; k++) {
        last = -w->ahead[k].distance;
        w->colour[w->ahead[k].point] = ELSEWHERE;
    }
}

/* Takes the rachis' points out of the colours. Gives the distance at which it is first clear; INFINITY: nowhere. */
static double find_rachis(work *w)
{
    const plm_leaf_way *way = w->way;
    const size_t junction = (size_t)(way->junction / way->step) + RUN;
    const size_t last = junction < way->station_count ? junction : way->station_count;
    size_t begin, end = 0, next_begin, next_end;
    do {
        if (!next_run(way, end, last, &begin, &end)) return INFINITY;
    } while (!plm_leaf_is_full(way, begin, end));
    const double clear = (double)begin * way->step;
    take_run(w, begin, end);
    for (; next_run(way, end, last, &next_begin, &next_end); begin = next_begin, end = next_end) {
        double from[3], to[3];
        take_run(w, next_begin, next_end);
        mean_middle(way, end - begin > ENDS ? end - ENDS : begin, end, from);
        mean_middle(way, next_begin, next_end - next_begin > ENDS ? next_begin + ENDS : next_end, to);
        fill(w, from, to);
    }
    go_on(w, begin, end);
    return clear;
}

/* ---- What hangs on it ------------------------------------------------------------------------------------------- */

/* Lists the points of each component by distance. */
static void list_points(work *w, size_t components)
{
    const plm_leaf_way *way = w->way;
    for (size_t c = 0; c <= components; c++) w->first[c] = 0;
    for (size_t k = 0; k < way->count; k++)
        if (w->component[way->order[k]] >= 0) w->first[w->component[way->order[k]] + 1]++;
    for (size_t c = 0; c < components; c++) w->first[c + 1] += w->first[c];
    for (size_t k = 0; k < way->count; k++) {
        const int32_t c = w->component[way->order[k]];
        if (c >= 0) w->row[w->first[c]++] = way->order[k];
    }
    for (size_t c = components; c > 0; c--) w->first[c] = w->first[c - 1];
    w->first[0] = 0;
}

/* Number of points before the leaflet widens. */
static size_t split_hanging(work *w, uint32_t *row, size_t count)
{
    const plm_leaf_way *way = w->way;
    const double low = way->distance[row[0]];
    plm_leaf_way hanging = *way;
    hanging.tube *= THINNER;
    hanging.order = row;
    hanging.count = count;
    hanging.station = w->station;
    hanging.station_count = (size_t)((way->distance[row[count - 1]] - low) / way->step) + 1;
    size_t begin = 0, end = 0;
    for (size_t k = 0; k < hanging.station_count; k++) {
        const double from = low + (double)k * way->step - 0.5 * way->window;
        while (begin < count && way->distance[row[begin]] < from) begin++;
        if (end < begin) end = begin;
        while (end < count && way->distance[row[end]] < from + way->window) end++;
        plm_station_measure(w->sketch, row + begin, end - begin, &w->station[k]);
    }
    const double at = low + plm_leaf_change(&hanging, 0, plm_leaf_only_split(&hanging, 0));
    size_t before = 0;
    while (before < count && way->distance[row[before]] < at) before++;
    return before;
}

static void relabel_hanging(work *w, size_t components)
{
    for (size_t c = 0; c < components; c++) {
        uint32_t *row = w->row + w->first[c];
        const size_t count = w->first[c + 1] - w->first[c];
        if (count < FEWEST) continue;
        for (size_t k = split_hanging(w, row, count); k < count; k++) w->sketch->is_tube[row[k]] = false;
    }
}

/* The part of a component that had one leaflet's number; count where the list has no room for another. */
static size_t find_part(part *list, size_t *count, int32_t component, int32_t leaflet)
{
    size_t p = 0;
    while (p < *count && (list[p].component != component || list[p].leaflet != leaflet)) p++;
    if (p == *count && p < MOST_PARTS) list[(*count)++] = (part){component, leaflet, 0, -1};
    return p;
}

/* The largest part of the same component that had a number; the part itself where there is none. */
static size_t largest_beside(const part *list, size_t count, size_t own)
{
    size_t best = own;
    for (size_t p = 0; p < count; p++)
        if (list[p].component == list[own].component && list[p].leaflet >= 0 &&
            (best == own || list[p].size > list[best].size))
            best = p;
    return best;
}

/* Blades that no rachis joins any more are leaflets of their own, as are those that were told apart before though they touch.
 * Numbers go by the distance from the foot. */
static void number_leaflets(work *w)
{
    plm_sketch *s = w->sketch;
    const plm_leaf_way *way = w->way;
    const double cell = s->working.cell;
    part list[MOST_PARTS];
    size_t parts = 0;
    int32_t next = 0;
    for (size_t k = 0; k < way->count; k++) w->colour[way->order[k]] = s->is_tube[way->order[k]] ? ELSEWHERE : OFF;
    plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        const size_t p = w->component[i] < 0 ? MOST_PARTS : find_part(list, &parts, w->component[i], s->leaflet[i]);
        if (p < MOST_PARTS) list[p].size++;
        w->row[k] = (uint32_t)p;
    }
    size_t joined[MOST_PARTS] = {0};
    for (size_t p = 0; p < parts; p++) joined[p] = list[p].leaflet < 0 ? largest_beside(list, parts, p) : p;
    for (size_t k = 0; k < way->count; k++) {
        const size_t p = w->row[k] < MOST_PARTS ? joined[w->row[k]] : MOST_PARTS;
        const bool large = p < MOST_PARTS && (double)list[p].size * cell * cell >= plm_blade_least(s);
        if (large && list[p].number < 0) list[p].number = next++;
        s->leaflet[way->order[k]] = large ? list[p].number : -1;
    }
}

plm_status plm_leaf_leaflets(plm_sketch *sketch, const plm_leaf_way *way, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    work w = {.sketch = sketch,
              .way = way,
              .colour = plm_scratch_take(&scratch, count, sizeof *w.colour),
              .component = plm_scratch_take(&scratch, count, sizeof *w.component),
              .stack = plm_scratch_take(&scratch, count, sizeof *w.stack),
              .row = plm_scratch_take(&scratch, way->count + 1, sizeof *w.row),
              .ahead = plm_scratch_take(&scratch, way->count + 1, sizeof *w.ahead),
              .station = plm_scratch_take(&scratch, way->station_count + 1, sizeof *w.station)};
    size_t components = 0;
    if (!scratch.failed) {
        for (size_t i = 0; i < count; i++) w.colour[i] = ELSEWHERE;
        for (size_t k = 0; k < way->count; k++) w.colour[way->order[k]] = OFF;
        const double clear = find_rachis(&w);
        for (size_t k = 0; k < way->count && way->distance[way->order[k]] < clear; k++)
            w.colour[way->order[k]] = ELSEWHERE;
        components = plm_graph_components(&sketch->graph, w.colour, w.component, w.stack);
        w.first = plm_scratch_take(&scratch, components + 2, sizeof *w.first);
    }
    if (!scratch.failed) {
        list_points(&w, components);
        relabel_hanging(&w, components);
        number_leaflets(&w);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
