/* segment/young_leaves.c: the youngest leaves of a rosette are hardly wider than their petioles, so that the whole of them
 * passes as tube and their feet lie within those of their elders. In a rosette all that leaves the core ends in a leaf: so
 * an end of the plant that stands out beyond the fork where it meets others, and that has no blade, is a young leaf. */
#include "segment/side_groups.h"

#include "segment/core.h"
#include "segment/merge_tree.h"
#include "segment/scratch.h"

#include <math.h>

static const double STANDS_OUT = 0.5; /* length beyond the fork, in R: less is a bump of a petiole */
static const double TOGETHER = 2; /* nearer to the core than this, in R, feet are not parted yet: leaves meet there */
static const double BLADE = 0.85; /* share of a young leaf's length beyond the fork that is blade, from its tip */
static const double MOSTLY = 0.5; /* share of an end's points that its blades hold at least, if they are all of it */

/* An end of the plant. */
typedef struct plant_end {
    uint32_t points, blade; /* blade: in such as are large enough to be leaves */
    uint32_t top;           /* its tip */
    float tip, fork;        /* its farthest and its nearest distance from the core */
} plant_end;

typedef struct work {
    plm_sketch *sketch;
    plm_side_groups *groups;
    plm_scratch scratch;
    float *distance, *reach;
    int32_t *apart, *branch;
    plant_end *end;
    size_t ends;
} work;

/* The ends by the merge tree of the distance from the core. Within a blade nothing ends: what meets there is lobes. */
static plm_status find_ends(work *w, uint32_t core, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    const double R = s->scale.radius;
    const plm_walk walk = {.source = &core, .source_count = 1, .distance = w->distance};
    plm_status status = plm_graph_walk(&s->graph, &walk, error);
    for (size_t i = 0; i < s->working.count; i++) {
        w->reach[i] = s->is_tube[i] ? (float)(STANDS_OUT * R) : INFINITY;
        w->apart[i] = w->distance[i] > TOGETHER * R ? s->group[i] : -1;
    }
    const plm_merge_rule rule = {
        .distance = w->distance, .reach = w->reach, .apart = w->apart, .least = (size_t)plm_blade_least_points(s)};
    if (status == PLM_OK) status = plm_merge_tree_by(&s->graph, &rule, w->branch, &w->ends, error);
    return status;
}

static plm_status judge_ends(work *w)
{
    const plm_sketch *s = w->sketch;
    w->end = plm_scratch_take(&w->scratch, w->ends + 1, sizeof *w->end);
    if (!w->end) return PLM_E_MEMORY;
    for (uint32_t i = 0; i < s->working.count; i++) {
        if (w->branch[i] < 0) continue;
        plant_end *end = &w->end[w->branch[i]];
        const float d = w->distance[i];
        const int32_t blade = w->groups->blade[i];
        if (!end->points || d > end->tip) end->tip = d, end->top = i;
        if (!end->points || d < end->fork) end->fork = d;
        end->blade += blade >= 0 && !(w->groups->blade_area[blade] < plm_blade_least(s));
        end->points++;
    }
    return PLM_OK;
}

/* The group of each end that is a young leaf, -1 for others. What hangs below the core is the foot of the plant, or what
 * is left of the soil. */
static plm_status number_ends(work *w, uint32_t core, int32_t *number, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    plm_side_groups *groups = w->groups;
    plm_side_group *grown = plm_realloc(groups->group, groups->count + w->ends + 1, sizeof *grown, error);
    if (!grown) return PLM_E_MEMORY;
    groups->group = grown;
    for (size_t e = 0; e < w->ends; e++) {
        const plant_end *end = &w->end[e];
        const int32_t group = s->group[end->top];
        const bool is_young =
            group >= 0 && end->blade < MOSTLY * end->points && s->working.xyz[end->top][2] > s->working.xyz[core][2];
        number[e] = is_young ? group : -1;
        if (!is_young || end->blade) continue;
        if (grown[group].blades) {
            number[e] = (int32_t)groups->count++;
            grown[number[e]] = grown[group];
        }
        grown[number[e]].blades = 1;
        grown[number[e]].blade_area = BLADE * end->points * s->working.cell * s->working.cell;
    }
    return PLM_OK;
}

static void label_ends(work *w, const int32_t *number)
{
    plm_sketch *s = w->sketch;
    for (size_t i = 0; i < s->working.count; i++) {
        const int32_t e = w->branch[i];
        if (e < 0 || number[e] < 0) continue;
        s->group[i] = number[e];
        if (w->distance[i] > w->end[e].tip - BLADE * (w->end[e].tip - w->end[e].fork)) s->is_tube[i] = false;
    }
}

/* A plant without any blade is no rosette, but a stem that lies, or was not found: its branches bear nothing. */
static bool has_leaves(const plm_side_groups *groups)
{
    for (size_t g = 0; g < groups->count; g++)
        if (groups->group[g].blades) return true;
    return false;
}

plm_status plm_side_groups_young(plm_sketch *sketch, plm_side_groups *groups, plm_error *error)
{
    const size_t count = sketch->working.count;
    if (!has_leaves(groups)) return PLM_OK;
    uint32_t core;
    plm_status status = plm_sketch_core(sketch, &core, error);
    if (status != PLM_OK || core == UINT32_MAX) return status;
    work w = {.sketch = sketch, .groups = groups, .scratch = {.error = error}};
    w.distance = plm_scratch_take(&w.scratch, count, sizeof *w.distance);
    w.reach = plm_scratch_take(&w.scratch, count, sizeof *w.reach);
    w.apart = plm_scratch_take(&w.scratch, count, sizeof *w.apart);
    w.branch = plm_scratch_take(&w.scratch, count, sizeof *w.branch);
    status = w.scratch.failed ? PLM_E_MEMORY : find_ends(&w, core, error);
    if (status == PLM_OK) status = judge_ends(&w);
    int32_t *number = plm_scratch_take(&w.scratch, w.ends + 1, sizeof *number);
    if (status == PLM_OK) status = number ? number_ends(&w, core, number, error) : PLM_E_MEMORY;
    if (status == PLM_OK) label_ends(&w, number);
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
