/* segment/blade_hills.c: in noise a petiole of a rosette may run down on another one all the way to the core, and where their blades
 * touch too, the two seem one leaf. But each blade has a tip of its own: going out from the core both rise above the place where
 * they touch, while the distance along one blade rises to one tip. */
#include "segment/blade_hills.h"

#include "segment/merge_tree.h"
#include "segment/scratch.h"
#include "segment/side_groups.h"

#include <math.h>

/* How far both tips are beyond the touch, in R: within single blades of 48 rosettes in noise at most 0.6, between two 0.8 to 5. */
static const double RISE = 0.7;
/* Noise in R: petioles of sharper scans part (segment/forked_feet.c), and gaps in them look like touches. */
static const double NOISY = 0.04;

typedef struct work {
    plm_sketch *sketch;
    plm_scratch scratch;
    float *far;
    int32_t *hill, *number, *origin;
    int32_t *owner;  /* of each hill: the group that it is of; -1: no blade */
    size_t *blade;   /* points of blade of each hill */
    bool *has_hill;  /* of each group: one that is a blade */
    bool *is_parted; /* of each group: it has another */
    bool *allowed;
    uint32_t *source;
} work;

static plm_status find_hills(work *w, const float *distance, size_t *hills, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    float *reach = plm_scratch_take(&w->scratch, s->working.count, sizeof *reach);
    if (!reach) return PLM_E_MEMORY;
    for (size_t i = 0; i < s->working.count; i++) {
        w->far[i] = s->group[i] < 0 ? INFINITY : distance[i];
        reach[i] = (float)(RISE * s->scale.radius);
    }
    const plm_merge_rule rule = {
        .distance = w->far, .reach = reach, .apart = s->group, .least = (size_t)plm_blade_least_points(s)};
    return plm_merge_tree_by(&s->graph, &rule, w->hill, hills, error);
}

/* The hills that are blades get numbers of groups: the first of a group its own. */
static void number_hills(work *w, size_t hills, size_t *groups)
{
    const plm_sketch *s = w->sketch;
    for (size_t h = 0; h < hills; h++) w->owner[h] = -1;
    for (size_t i = 0; i < s->working.count; i++) {
        if (w->hill[i] < 0) continue;
        w->owner[w->hill[i]] = s->group[i];
        w->blade[w->hill[i]] += !s->is_tube[i];
    }
    for (size_t h = 0; h < hills; h++) {
        const int32_t group = w->owner[h];
        if ((double)w->blade[h] < plm_blade_least_points(s)) {
            w->owner[h] = -1;
            continue;
        }
        w->is_parted[group] = w->has_hill[group];
        w->number[h] = w->has_hill[group] ? (int32_t)(*groups)++ : group;
        w->has_hill[group] = true;
    }
}

/* Points of a parted group to its hill that is nearest along the graph within it. */
static plm_status share_out(work *w, int32_t group, plm_error *error)
{
    plm_sketch *s = w->sketch;
    size_t sources = 0;
    for (uint32_t i = 0; i < s->working.count; i++) {
        w->allowed[i] = s->group[i] == group;
        if (w->allowed[i] && w->hill[i] >= 0 && w->owner[w->hill[i]] >= 0) w->source[sources++] = i;
    }
    const plm_walk walk = {
        .source = w->source, .source_count = sources, .allowed = w->allowed, .distance = w->far, .origin = w->origin};
    const plm_status status = plm_graph_walk(&s->graph, &walk, error);
    for (size_t i = 0; status == PLM_OK && i < s->working.count; i++)
        if (w->allowed[i] && w->origin[i] >= 0) s->group[i] = w->number[w->hill[w->source[w->origin[i]]]];
    return status;
}

plm_status plm_blade_hills(plm_sketch *sketch, const float *distance, size_t *groups, plm_error *error)
{
    const size_t count = sketch->working.count, before = *groups;
    work w = {.sketch = sketch, .scratch = {.error = error}};
    size_t hills = 0;
    if (sketch->scale.noise < NOISY * sketch->scale.radius) return PLM_OK;
    w.far = plm_scratch_take(&w.scratch, count, sizeof *w.far);
    w.hill = plm_scratch_take(&w.scratch, count, sizeof *w.hill);
    plm_status status = w.scratch.failed ? PLM_E_MEMORY : find_hills(&w, distance, &hills, error);
    if (status == PLM_OK) {
        w.number = plm_scratch_take(&w.scratch, hills + 1, sizeof *w.number);
        w.owner = plm_scratch_take(&w.scratch, hills + 1, sizeof *w.owner);
        w.blade = plm_scratch_take(&w.scratch, hills + 1, sizeof *w.blade);
        w.has_hill = plm_scratch_take(&w.scratch, before + 1, sizeof *w.has_hill);
        w.is_parted = plm_scratch_take(&w.scratch, before + 1, sizeof *w.is_parted);
        w.allowed = plm_scratch_take(&w.scratch, count, sizeof *w.allowed);
        w.origin = plm_scratch_take(&w.scratch, count, sizeof *w.origin);
        w.source = plm_scratch_take(&w.scratch, count, sizeof *w.source);
        status = w.scratch.failed ? PLM_E_MEMORY : PLM_OK;
    }
    if (status == PLM_OK) number_hills(&w, hills, groups);
    for (size_t g = 0; status == PLM_OK && g < before; g++)
        if (w.is_parted[g]) status = share_out(&w, (int32_t)g, error);
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
