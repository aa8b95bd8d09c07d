/* segment/side_groups.c: feet are the pieces of a shell around the trunk; every point beyond belongs to the foot that is
 * nearest along the graph. So two leaves that touch far from the stem are still two; their border is moved to the touch. */
#include "segment/side_groups.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "segment/blade_hills.h"
#include "segment/core.h"
#include "segment/forked_feet.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"
#include "segment/touch_cut.h"

#include <math.h>
#include <string.h>

static const double SHELL_START = 0.6, SHELL_WIDTH = 0.5; /* distance along the graph from the trunk, in R */
static const double FOOT_REACH = 1.6;                     /* a foot is judged by its group's points up to there, in R */
static const double FOOT_TUBE = 0.4;                      /* share of tube among them: less is no petiole's foot */
static const double BLADE_LEAST = 0.5;                    /* in R squared */
static const double CORE = 1.2;                           /* radius of a rosette's core, in R */

typedef struct work {
    plm_sketch *sketch;
    plm_side_groups *out;
    plm_scratch scratch;
    bool *trunk, *allowed;
    int32_t *colour, *component, *origin;
    uint32_t *stack, *source;
    float *distance, *value;
    double blade_cost;
    float *weight; /* of each point on a way to a foot */
} work;

double plm_blade_least(const plm_sketch *sketch)
{
    return BLADE_LEAST * sketch->scale.radius * sketch->scale.radius;
}

double plm_blade_least_points(const plm_sketch *sketch)
{
    return plm_blade_least(sketch) / (sketch->working.cell * sketch->working.cell);
}

double plm_side_groups_usual_points(const plm_sketch *sketch, const plm_side_groups *groups, size_t least,
                                    size_t *points, double *value)
{
    size_t count = 0;
    for (size_t i = 0; i < sketch->working.count; i++)
        if (sketch->group[i] >= 0) points[sketch->group[i]]++;
    for (size_t g = 0; g < groups->count; g++)
        if (groups->group[g].has_foot && groups->group[g].blades) value[count++] = (double)points[g];
    return count < least ? 0 : plm_order_median(value, count);
}

void plm_side_groups_free(plm_side_groups *groups)
{
    plm_free(groups->group);
    plm_free(groups->distance);
    plm_free(groups->blade);
    plm_free(groups->blade_area);
    plm_free(groups->blade_group);
    *groups = (plm_side_groups){0};
}

static plm_status start(work *w, plm_sketch *sketch, double blade_cost, plm_side_groups *out, plm_error *error)
{
    const size_t count = sketch->working.count;
    *w = (work){.sketch = sketch, .out = out, .scratch = {.error = error}, .blade_cost = blade_cost};
    w->trunk = plm_scratch_take(&w->scratch, count, sizeof *w->trunk);
    w->allowed = plm_scratch_take(&w->scratch, count, sizeof *w->allowed);
    w->colour = plm_scratch_take(&w->scratch, count, sizeof *w->colour);
    w->component = plm_scratch_take(&w->scratch, count, sizeof *w->component);
    w->origin = plm_scratch_take(&w->scratch, count, sizeof *w->origin);
    w->stack = plm_scratch_take(&w->scratch, count, sizeof *w->stack);
    w->source = plm_scratch_take(&w->scratch, count, sizeof *w->source);
    w->distance = plm_scratch_take(&w->scratch, count, sizeof *w->distance);
    w->value = plm_scratch_take(&w->scratch, count, sizeof *w->value);
    w->weight = plm_scratch_take(&w->scratch, count, sizeof *w->weight);
    out->distance = plm_alloc(count, sizeof *out->distance, error);
    out->blade = plm_alloc(count, sizeof *out->blade, error);
    return w->scratch.failed || !out->distance || !out->blade ? PLM_E_MEMORY : PLM_OK;
}

/* ---- The trunk ------------------------------------------------------------------------------------------------ */

static plm_status find_core(work *w, plm_error *error)
{
    plm_sketch *s = w->sketch;
    uint32_t core;
    const plm_status status = plm_sketch_core(s, &core, error);
    if (status != PLM_OK || core == UINT32_MAX) return status;
    for (uint32_t i = 0; i < s->working.count; i++)
        w->trunk[i] = plm_graph_length(&s->graph, i, core) < CORE * s->scale.radius;
    return PLM_OK;
}

static plm_status find_trunk(work *w, plm_error *error)
{
    if (!w->sketch->scale.has_tubes) return PLM_OK;
    if (!w->sketch->stem.count) return find_core(w, error);
    memcpy(w->trunk, w->sketch->is_stem, w->sketch->working.count * sizeof *w->trunk);
    return PLM_OK;
}

/* ---- Feet ----------------------------------------------------------------------------------------------------- */

/* weight: of each point, or NULL. */
static plm_status walk_from(work *w, size_t sources, const float *weight, float *distance, plm_error *error)
{
    const plm_walk walk = {.source = w->source,
                           .source_count = sources,
                           .weight = weight,
                           .allowed = w->allowed,
                           .distance = distance,
                           .origin = w->origin};
    return plm_graph_walk(&w->sketch->graph, &walk, error);
}

/* component[]: number of the foot, -1 outside of the shell. */
static plm_status find_feet(work *w, size_t *feet, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    const double start = SHELL_START * s->scale.radius, end = start + SHELL_WIDTH * s->scale.radius;
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++) {
        w->allowed[i] = true;
        if (w->trunk[i]) w->source[sources++] = i;
    }
    const plm_status status = walk_from(w, sources, NULL, w->out->distance, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) {
        const float d = w->out->distance[i];
        w->colour[i] = !w->trunk[i] && d >= start && d < end ? 0 : -1;
    }
    *feet = plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    return PLM_OK;
}

/* Each point to its nearest living foot: first beyond the shell's inner rim, then what lies between it and the trunk. */
static plm_status grow(work *w, const bool *alive, plm_error *error)
{
    plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    const double start = SHELL_START * s->scale.radius;
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++) {
        w->allowed[i] = !w->trunk[i] && !(w->out->distance[i] < start);
        if (w->component[i] >= 0 && alive[w->component[i]]) w->source[sources++] = i;
    }
    for (size_t i = 0; i < count; i++) w->weight[i] = s->is_tube[i] ? 1 : (float)w->blade_cost;
    plm_status status = walk_from(w, sources, w->weight, w->distance, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) s->group[i] = w->origin[i] < 0 ? -1 : w->component[w->source[w->origin[i]]];
    sources = 0;
    for (uint32_t i = 0; i < count; i++) {
        w->allowed[i] = !w->trunk[i];
        if (s->group[i] >= 0) w->source[sources++] = i;
    }
    /* A rosette's core belongs to the petioles that meet there. */
    for (uint32_t i = 0; !s->stem.count && i < count; i++) w->allowed[i] = true;
    status = walk_from(w, sources, NULL, w->distance, error);
    for (size_t i = 0; status == PLM_OK && i < count; i++)
        if (s->group[i] < 0 && w->origin[i] >= 0) s->group[i] = s->group[w->source[w->origin[i]]];
    return status;
}

/* What a foot is like, from the points of its group near the trunk. */
static void judge(work *w, int32_t foot, plm_side_group *group)
{
    const plm_sketch *s = w->sketch;
    const double reach = FOOT_REACH * s->scale.radius;
    size_t members = 0, tubes = 0, rim = 0, radii = 0;
    double along = 0, inmost = 0; /* inmost: of the point nearest to the trunk, where a fork has taken the rim */
    float nearest = INFINITY;
    for (size_t i = 0; i < s->working.count; i++) {
        if (s->group[i] != foot) continue;
        if (w->out->distance[i] < nearest) nearest = w->out->distance[i], inmost = s->working.xyz[i][2];
        /* Nearer to the trunk than R, the ball that the radius is taken from holds points of the trunk. */
        if (s->is_tube[i] && w->out->distance[i] > s->scale.radius) w->value[radii++] = s->point[i].radius;
        if (!(w->out->distance[i] < reach)) continue;
        members++;
        tubes += s->is_tube[i];
        if (w->component[i] != foot) continue;
        plm_stem_place place = {.along = s->working.xyz[i][2]};
        plm_stem_nearest(&s->stem, s->working.xyz[i], &place);
        along += place.along;
        rim++;
    }
    *group = (plm_side_group){.has_foot = true,
                              .along = rim ? along / (double)rim : inmost,
                              .tube_share = members ? (double)tubes / (double)members : 0,
                              .tube_radius = plm_quantile(w->value, radii, 0.5)};
}

/* A blade that leans on the stem makes a foot of its own. Where its region borders on that of a petiole's foot, within a
 * blade, it is a touch and no foot. Gives whether any was found. */
static bool find_touches(work *w, size_t feet, bool *alive)
{
    const plm_sketch *s = w->sketch;
    const plm_graph *graph = &s->graph;
    bool any = false;
    for (size_t i = 0; i < s->working.count; i++) {
        const int32_t own = s->group[i];
        if (own < 0 || s->is_tube[i] || (size_t)own >= feet || !alive[own] ||
            w->out->group[own].tube_share >= FOOT_TUBE)
            continue;
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++) {
            const uint32_t next = graph->edge[e];
            const int32_t other = s->group[next];
            if (other < 0 || other == own || s->is_tube[next] || w->out->group[other].tube_share < FOOT_TUBE) continue;
            alive[own] = false;
            any = true;
            break;
        }
    }
    return any;
}

/* ---- Blades within groups ------------------------------------------------------------------------------------- */

/* Of compound plants blades that are too small each may be a young leaf's leaflets: of a group that has a foot and no larger ones they are
 * one together. (On others they are what noise makes of a petiole: a real tomato that passes for simple got a leaf of it.) */
static plm_status count_specks(work *w)
{
    plm_side_groups *out = w->out;
    double *sum = plm_scratch_take(&w->scratch, out->count + 1, sizeof *sum);
    if (!sum) return PLM_E_MEMORY;
    for (size_t b = 0; b < out->blade_count; b++) sum[out->blade_group[b]] += out->blade_area[b];
    for (size_t g = 0; g < out->count; g++) {
        plm_side_group *group = &out->group[g];
        if (group->blades || !group->has_foot || sum[g] < plm_blade_least(w->sketch)) continue;
        group->blade_area = sum[g];
        group->blades = 1;
    }
    return PLM_OK;
}

static plm_status find_blades(work *w, plm_error *error)
{
    plm_sketch *s = w->sketch;
    plm_side_groups *out = w->out;
    const size_t count = s->working.count;
    const double cell2 = s->working.cell * s->working.cell;
    for (size_t i = 0; i < count; i++) w->colour[i] = s->is_tube[i] || w->trunk[i] ? -1 : s->group[i];
    out->blade_count = plm_graph_components(&s->graph, w->colour, out->blade, w->stack);
    out->blade_area = plm_alloc_zero(out->blade_count, sizeof *out->blade_area, error);
    out->blade_group = plm_alloc_zero(out->blade_count, sizeof *out->blade_group, error);
    if (!out->blade_area || !out->blade_group) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        if (out->blade[i] >= 0) {
            out->blade_area[out->blade[i]] += cell2;
            out->blade_group[out->blade[i]] = s->group[i];
        } else if (s->group[i] >= 0) {
            const double radius = fmax(s->point[i].radius, 0.1 * s->scale.radius);
            out->group[s->group[i]].tube_length += cell2 / (2 * PLM_PI * radius);
        }
    }
    for (size_t b = 0; b < out->blade_count; b++) {
        if (out->blade_area[b] < plm_blade_least(s)) continue;
        plm_side_group *group = &out->group[out->blade_group[b]];
        group->blade_area += out->blade_area[b];
        group->blades++;
    }
    return w->blade_cost > 1 ? count_specks(w) : PLM_OK;
}

/* Pieces that no foot reaches become groups without a foot. */
static plm_status add_loose_groups(work *w, size_t feet, plm_error *error)
{
    plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    for (size_t i = 0; i < count; i++) w->colour[i] = s->group[i] < 0 && !w->trunk[i] ? 0 : -1;
    const size_t loose = plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    plm_side_group *grown = plm_realloc(w->out->group, feet + loose + 1, sizeof *grown, error);
    if (!grown) return PLM_E_MEMORY;
    w->out->group = grown;
    w->out->count = feet + loose;
    for (size_t g = feet; g < w->out->count; g++) grown[g] = (plm_side_group){.along = INFINITY};
    for (size_t i = 0; i < count; i++)
        if (w->component[i] >= 0) s->group[i] = (int32_t)feet + w->component[i];
    return PLM_OK;
}

/* Groups that were parted in some stage get descriptions of their own. */
static plm_status judge_anew(work *w, size_t before, size_t feet, plm_error *error)
{
    if (feet == before) return PLM_OK;
    plm_side_group *grown = plm_realloc(w->out->group, feet + 1, sizeof *grown, error);
    if (!grown) return PLM_E_MEMORY;
    w->out->group = grown;
    for (size_t f = 0; f < feet; f++) judge(w, (int32_t)f, &grown[f]);
    return PLM_OK;
}

/* Petioles of a rosette that share a foot get one each. */
static plm_status split_forks(work *w, size_t *feet, plm_error *error)
{
    const size_t before = *feet;
    const plm_status status = plm_forked_feet(w->sketch, w->out->distance, w->component, feet, error);
    return status == PLM_OK ? judge_anew(w, before, *feet, error) : status;
}

/* So do those whose blades touch too, and their border goes to the touch. */
static plm_status split_hills(work *w, size_t *feet, plm_error *error)
{
    const size_t before = *feet;
    plm_status status = plm_blade_hills(w->sketch, w->out->distance, feet, error);
    if (status != PLM_OK || *feet == before) return status;
    status = plm_touch_cut(w->sketch, false, w->out->distance, w->sketch->group, error);
    return status == PLM_OK ? judge_anew(w, before, *feet, error) : status;
}

static plm_status find_groups(work *w, plm_error *error)
{
    const bool stemless = !w->sketch->stem.count && w->sketch->scale.has_tubes;
    size_t feet = 0;
    plm_status status = stemless ? plm_graph_widen(&w->sketch->graph, error) : PLM_OK;
    if (status == PLM_OK) status = find_trunk(w, error);
    if (status == PLM_OK) status = find_feet(w, &feet, error);
    if (status != PLM_OK) return status;
    bool *alive = plm_scratch_take(&w->scratch, feet + 1, sizeof *alive);
    w->out->group = plm_alloc_zero(feet + 1, sizeof *w->out->group, error);
    if (!alive || !w->out->group) return PLM_E_MEMORY;
    memset(alive, true, feet * sizeof *alive);
    status = grow(w, alive, error);
    for (size_t f = 0; status == PLM_OK && f < feet; f++) judge(w, (int32_t)f, &w->out->group[f]);
    if (status == PLM_OK && find_touches(w, feet, alive)) {
        status = grow(w, alive, error);
        for (size_t f = 0; status == PLM_OK && f < feet; f++)
            if (alive[f]) judge(w, (int32_t)f, &w->out->group[f]);
    }
    if (status == PLM_OK && stemless) status = split_forks(w, &feet, error);
    if (status == PLM_OK)
        status = plm_touch_cut(w->sketch, w->blade_cost > 1, w->out->distance, w->sketch->group, error);
    if (status == PLM_OK && stemless) status = split_hills(w, &feet, error);
    if (status == PLM_OK) status = add_loose_groups(w, feet, error);
    return status == PLM_OK ? find_blades(w, error) : status;
}

plm_status plm_side_groups_find(plm_sketch *sketch, double blade_cost, plm_side_groups *groups, plm_error *error)
{
    work w;
    plm_side_groups out = {0};
    plm_status status = start(&w, sketch, blade_cost, &out, error);
    if (status == PLM_OK) status = find_groups(&w, error);
    if (status == PLM_OK)
        *groups = out;
    else
        plm_side_groups_free(&out);
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
