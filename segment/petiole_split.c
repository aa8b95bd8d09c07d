/* segment/petiole_split.c: petioles of a rosette that lean on each other near the core make one foot, and so do those above
 * the end of a stem's line that ended early. A petiole of a simple leaf bears one blade, so each blade with a way of its own
 * to the trunk is a leaf. */
#include "segment/side_groups.h"

#include "segment/scratch.h"

#include <math.h>

/* Length of a way that no other blade shares, in R: less is one blade, torn. On a stem petioles do not crowd: less than
 * a tube's shortest length is none. */
static const double OWN_WAY = 0.5, OWN_WAY_ON_STEM = 1.5;
/* On a stem petioles lead away from each other, in R at least so far (2.2 and 2.8 of virtual plants); so the way of the later blade is
 * this long, too. What passes for a petiole in a narrow blade that noise makes round runs along the rest of it (0.9 to 1.5). */
static const double APART = 1.8;

typedef struct work {
    plm_sketch *sketch;
    plm_side_groups *groups;
    plm_scratch scratch;
    bool *has_leaf; /* of each group: whether a blade was found to be its leaf */
    uint32_t *source, *parent;
    uint32_t *entry; /* of each blade: its point nearest to the trunk */
    int32_t *way;    /* of each point: the blade whose way to the trunk it is on, -1 */
    int32_t *holder; /* of each blade: the blade whose leaf it belongs to; -1: too small to ask */
    int32_t *number; /* of each blade: its group after the split */
    int32_t *origin;
    float *distance;
} work;

static plm_status start(work *w, plm_sketch *sketch, plm_side_groups *groups, plm_error *error)
{
    const size_t count = sketch->working.count, blades = groups->blade_count;
    *w = (work){.sketch = sketch, .groups = groups, .scratch = {.error = error}};
    w->has_leaf = plm_scratch_take(&w->scratch, groups->count + 1, sizeof *w->has_leaf);
    w->source = plm_scratch_take(&w->scratch, count, sizeof *w->source);
    w->parent = plm_scratch_take(&w->scratch, count, sizeof *w->parent);
    w->way = plm_scratch_take(&w->scratch, count, sizeof *w->way);
    w->origin = plm_scratch_take(&w->scratch, count, sizeof *w->origin);
    w->distance = plm_scratch_take(&w->scratch, count, sizeof *w->distance);
    w->entry = plm_scratch_take(&w->scratch, blades + 1, sizeof *w->entry);
    w->holder = plm_scratch_take(&w->scratch, blades + 1, sizeof *w->holder);
    w->number = plm_scratch_take(&w->scratch, blades + 1, sizeof *w->number);
    return w->scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Ways to the trunk, and where each blade begins. */
static plm_status find_entries(work *w, plm_error *error)
{
    const size_t count = w->sketch->working.count;
    const float *out = w->groups->distance;
    const int32_t *blade = w->groups->blade;
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++)
        if (out[i] <= 0) w->source[sources++] = i;
    const plm_walk walk = {.source = w->source, .source_count = sources, .distance = w->distance, .parent = w->parent};
    const plm_status status = plm_graph_walk(&w->sketch->graph, &walk, error);
    for (size_t b = 0; b < w->groups->blade_count; b++) w->entry[b] = UINT32_MAX;
    for (uint32_t i = 0; i < count; i++) {
        if (blade[i] < 0) continue;
        uint32_t *entry = &w->entry[blade[i]];
        if (*entry == UINT32_MAX || w->distance[i] < w->distance[*entry]) *entry = i;
    }
    return status;
}

/* How far the way of blade b gets from blade other and its way, up to the fork of both. */
static double gap_between(const work *w, int32_t b, int32_t other, uint32_t fork)
{
    const plm_sketch *s = w->sketch;
    double widest = 0;
    for (uint32_t i = w->entry[b]; i != fork; i = w->parent[i]) {
        double nearest = INFINITY;
        for (size_t k = 0; k < s->working.count; k++) {
            if (w->way[k] != other && w->groups->blade[k] != other) continue;
            nearest = fmin(nearest, plm_graph_length(&s->graph, i, (uint32_t)k));
        }
        widest = fmax(widest, nearest);
    }
    return widest;
}

/* The blade in whose leaf a blade is: itself where its way meets no other blade, and no other's way but near the trunk, from which on a
 * stem both lead apart. */
static int32_t find_holder(const work *w, int32_t b)
{
    const plm_sketch *s = w->sketch;
    const int32_t group = w->groups->blade_group[b];
    const double least = (s->stem.count ? OWN_WAY_ON_STEM : OWN_WAY) * s->scale.radius;
    for (uint32_t i = w->parent[w->entry[b]]; i != UINT32_MAX && s->group[i] == group; i = w->parent[i]) {
        const int32_t met = w->groups->blade[i];
        if (met >= 0 && met != b && w->holder[met] >= 0) return w->holder[met];
        const int32_t other = w->way[i];
        if (other < 0) continue;
        const double own = (double)w->distance[w->entry[b]] - w->distance[i];
        const double its = (double)w->distance[w->entry[other]] - w->distance[i];
        const bool parted =
            fmin(own, its) >= least && (!s->stem.count || gap_between(w, b, other, i) >= APART * s->scale.radius);
        return parted ? b : w->holder[other];
    }
    return b;
}

static void mark_way(work *w, int32_t b)
{
    const int32_t group = w->groups->blade_group[b];
    for (uint32_t i = w->entry[b]; i != UINT32_MAX && w->sketch->group[i] == group && w->way[i] < 0; i = w->parent[i])
        w->way[i] = b;
}

/* Gives the number of groups after the split. From the trunk outwards, so that a blade is asked after those before it. */
static size_t split_blades(work *w)
{
    const plm_side_groups *groups = w->groups;
    size_t count = groups->count;
    for (size_t i = 0; i < w->sketch->working.count; i++) w->way[i] = -1;
    for (size_t b = 0; b < groups->blade_count; b++) w->holder[b] = -1;
    for (;;) {
        int32_t next = -1;
        for (int32_t b = 0; b < (int32_t)groups->blade_count; b++) {
            if (w->holder[b] >= 0 || groups->blade_area[b] < plm_blade_least(w->sketch)) continue;
            if (!isfinite(w->distance[w->entry[b]])) continue;
            if (next < 0 || w->distance[w->entry[b]] < w->distance[w->entry[next]]) next = b;
        }
        if (next < 0) return count;
        const int32_t group = groups->blade_group[next];
        w->holder[next] = find_holder(w, next);
        if (w->holder[next] == next) {
            w->number[next] = w->has_leaf[group] ? (int32_t)count++ : group;
            w->has_leaf[group] = true;
        }
        mark_way(w, next);
    }
}

/* Each point of a group that was split to the nearest of its blades and their ways. */
static plm_status share_out(work *w, size_t before, size_t after, plm_error *error)
{
    plm_sketch *s = w->sketch;
    plm_side_groups *groups = w->groups;
    const size_t count = s->working.count;
    plm_side_group *grown = plm_realloc(groups->group, after + 1, sizeof *grown, error);
    if (!grown) return PLM_E_MEMORY;
    groups->group = grown;
    groups->count = after;
    for (size_t b = 0; b < groups->blade_count; b++) {
        if (w->holder[b] != (int32_t)b || (size_t)w->number[b] < before) continue;
        grown[w->number[b]] = grown[groups->blade_group[b]];
        grown[w->number[b]].blades = 0;
        grown[w->number[b]].blade_area = 0;
    }
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++) {
        const int32_t on = groups->blade[i] >= 0 && w->holder[groups->blade[i]] >= 0 ? groups->blade[i] : w->way[i];
        if (on < 0) continue;
        w->source[sources++] = i;
        w->way[i] = w->holder[on];
    }
    const plm_walk walk = {.source = w->source, .source_count = sources, .distance = w->distance, .origin = w->origin};
    const plm_status status = plm_graph_walk(&s->graph, &walk, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) {
        if (s->group[i] < 0 || w->origin[i] < 0) continue;
        const int32_t b = w->way[w->source[w->origin[i]]];
        if (groups->blade_group[b] == s->group[i]) s->group[i] = w->number[b];
    }
    return PLM_OK;
}

/* Blades and their areas by group anew. */
static void count_blades(work *w, size_t before)
{
    plm_side_groups *groups = w->groups;
    for (size_t b = 0; b < groups->blade_count; b++) {
        if (w->holder[b] < 0) continue;
        const int32_t from = groups->blade_group[b], to = w->number[w->holder[b]];
        if (from == to || (size_t)to < before) continue;
        groups->blade_group[b] = to;
        groups->group[from].blades--;
        groups->group[from].blade_area -= groups->blade_area[b];
        groups->group[to].blades++;
        groups->group[to].blade_area += groups->blade_area[b];
    }
}

plm_status plm_side_groups_split(plm_sketch *sketch, plm_side_groups *groups, plm_error *error)
{
    work w;
    const size_t before = groups->count;
    plm_status status = start(&w, sketch, groups, error);
    if (status == PLM_OK) status = find_entries(&w, error);
    const size_t after = status == PLM_OK ? split_blades(&w) : before;
    if (status == PLM_OK && after > before) {
        status = share_out(&w, before, after, error);
        if (status == PLM_OK) count_blades(&w, before);
    }
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
