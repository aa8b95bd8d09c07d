/* segment/leaves.c: what hangs on one foot at the stem is a side group; a side group is a leaf, or (simple leaves on a
 * common foot) each of its blades is. */
#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/sketch.h"

#include <stdlib.h>
#include <string.h>

static const double COLLAR = 0.35;      /* points this near to the stem's surface (in R) hold a group's foot together */
static const double FOOT_REACH = 2;     /* what a foot is judged by: points of its group within so many R of it */
static const double FOOT_TUBE = 0.4;    /* share of tube in there, at least, to be a petiole's foot */
static const double BLADE_LEAST = 0.5;  /* in R squared: less is no leaf */
static const double STRAP_RADIUS = 0.9; /* of the stem's: side tubes as thick as that are leaf feet */
static const double COMPOUND_BLADES = 2; /* blades a side group, on average */

typedef struct group {
    double along; /**< of the foot, on the stem's line; height where there is no stem */
    double blade_area, tube_area;
    size_t blades;
    bool is_foot_tube;
    float tube_radius; /**< median of its tube points near the foot */
    int32_t leaf;      /**< -1: none */
} group;

typedef struct work {
    plm_sketch *sketch;
    plm_scratch scratch;
    int32_t *colour, *component;
    uint32_t *stack;
    float *distance, *value;
    uint32_t *source;
    int32_t *origin;
    bool *allowed;
    size_t groups;
    group *group;
} work;

static bool work_start(work *w, plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    *w = (work){.sketch = sketch, .scratch = {.error = error}};
    w->colour = plm_scratch_take(&w->scratch, count, sizeof *w->colour);
    w->component = plm_scratch_take(&w->scratch, count, sizeof *w->component);
    w->stack = plm_scratch_take(&w->scratch, count, sizeof *w->stack);
    w->distance = plm_scratch_take(&w->scratch, count, sizeof *w->distance);
    w->value = plm_scratch_take(&w->scratch, count, sizeof *w->value);
    w->source = plm_scratch_take(&w->scratch, count, sizeof *w->source);
    w->origin = plm_scratch_take(&w->scratch, count, sizeof *w->origin);
    w->allowed = plm_scratch_take(&w->scratch, count, sizeof *w->allowed);
    w->group = plm_scratch_take(&w->scratch, count + 1, sizeof *w->group);
    return !w->scratch.failed;
}

/* ---- Feet and side groups ------------------------------------------------------------------------------------- */

static bool touches_stem(const plm_sketch *sketch, size_t i)
{
    for (uint32_t e = sketch->graph.first[i]; e < sketch->graph.first[i + 1]; e++)
        if (sketch->is_stem[sketch->graph.edge[e]]) return true;
    return false;
}

/* Feet: components of the collar around the stem that touch it. sources: points of feet, with component[] their foot. */
static size_t find_feet(work *w)
{
    plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    for (size_t i = 0; i < count; i++) {
        double radius = 0;
        const double d = plm_stem_distance(&s->stem, s->working.xyz[i], &radius, NULL);
        const bool in_collar = d < 1.5 * radius + s->scale.noise + COLLAR * s->scale.radius;
        w->colour[i] = !s->is_stem[i] && (in_collar || touches_stem(s, i)) ? 0 : -1;
    }
    plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    /* Renumber those that touch the stem. */
    for (size_t i = 0; i < count; i++) w->origin[i] = -1;
    for (size_t i = 0; i < count; i++)
        if (w->component[i] >= 0 && touches_stem(s, i)) w->origin[w->component[i]] = 0;
    size_t feet = 0;
    for (size_t c = 0; c < count; c++)
        if (w->origin[c] == 0) w->origin[c] = (int32_t)feet++;
    for (size_t i = 0; i < count; i++)
        if (w->component[i] >= 0) w->component[i] = w->origin[w->component[i]];
    return feet;
}

/* Geodesic Voronoi regions of the feet that are alive. Points that no foot reaches form groups of their own. */
static plm_status grow_groups(work *w, const bool *alive, plm_error *error)
{
    plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++) {
        w->allowed[i] = !s->is_stem[i];
        if (w->component[i] >= 0 && alive[w->component[i]]) w->source[sources++] = i;
    }
    const plm_walk walk = {.source = w->source,
                           .source_count = sources,
                           .allowed = w->allowed,
                           .distance = w->distance,
                           .origin = w->origin};
    const plm_status status = plm_graph_walk(&s->graph, &walk, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) {
        s->group[i] = w->origin[i] >= 0 ? w->component[w->source[w->origin[i]]] : -1;
        w->colour[i] = s->group[i] < 0 && !s->is_stem[i] ? 0 : -1;
    }
    return PLM_OK;
}

/* Judges each foot by the points near it. */
static void judge_feet(work *w, size_t feet)
{
    const plm_sketch *s = w->sketch;
    const double reach = FOOT_REACH * s->scale.radius;
    memset(w->group, 0, feet * sizeof *w->group);
    for (size_t f = 0; f < feet; f++) {
        size_t members = 0, tubes = 0;
        double along = 0;
        size_t collar = 0;
        for (size_t i = 0; i < s->working.count; i++) {
            if (s->group[i] != (int32_t)f || !(w->distance[i] < reach)) continue;
            members++;
            if (s->is_tube[i]) w->value[tubes++] = s->point[i].radius;
            if (w->component[i] != (int32_t)f) continue;
            double at = 0;
            plm_stem_distance(&s->stem, s->working.xyz[i], NULL, &at);
            along += at;
            collar++;
        }
        group *g = &w->group[f];
        g->is_foot_tube = members && (double)tubes >= FOOT_TUBE * (double)members;
        g->along = collar ? along / (double)collar : 0;
        g->tube_radius = plm_quantile(w->value, tubes, 0.5);
    }
}

/* A blade that leans on the stem makes a foot of its own. Where its region borders on that of a petiole's foot, within a
 * blade, it is a touch and no foot. */
static plm_status drop_touches(work *w, size_t feet, bool *alive, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    bool any = false;
    for (size_t f = 0; f < feet; f++) {
        if (w->group[f].is_foot_tube) continue;
        bool borders = false;
        for (size_t i = 0; i < s->working.count && !borders; i++) {
            if (s->group[i] != (int32_t)f || s->is_tube[i]) continue;
            for (uint32_t e = s->graph.first[i]; e < s->graph.first[i + 1]; e++) {
                const int32_t other = s->group[s->graph.edge[e]];
                if (other >= 0 && other != (int32_t)f && w->group[other].is_foot_tube && !s->is_tube[s->graph.edge[e]])
                    borders = true;
            }
        }
        if (borders) alive[f] = false, any = true;
    }
    return any ? grow_groups(w, alive, error) : PLM_OK;
}

static plm_status find_groups(work *w, plm_error *error)
{
    plm_sketch *s = w->sketch;
    const size_t feet = s->stem.count ? find_feet(w) : 0;
    bool *alive = plm_alloc(feet + 1, sizeof *alive, error);
    if (!alive) return PLM_E_MEMORY;
    for (size_t f = 0; f < feet; f++) alive[f] = true;
    plm_status status = PLM_OK;
    if (feet) {
        status = grow_groups(w, alive, error);
        if (status == PLM_OK) judge_feet(w, feet);
        if (status == PLM_OK) status = drop_touches(w, feet, alive, error);
    } else {
        for (size_t i = 0; i < s->working.count; i++) w->colour[i] = s->is_stem[i] ? -1 : 0;
    }
    plm_free(alive);
    if (status != PLM_OK) return status;
    /* What no foot reaches: each piece is a group of its own. */
    const size_t rest = plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    w->groups = feet + rest;
    for (size_t g = feet; g < w->groups; g++) w->group[g] = (group){.along = INFINITY};
    for (size_t i = 0; i < s->working.count; i++)
        if (w->component[i] >= 0) s->group[i] = (int32_t)feet + w->component[i];
    return PLM_OK;
}

/* ---- From groups to leaves ------------------------------------------------------------------------------------ */

/* Blade components within groups: component[] gets them; those too small to be a leaf count as none. */
static size_t find_blades(work *w, double *area)
{
    plm_sketch *s = w->sketch;
    const double cell2 = s->working.cell * s->working.cell;
    for (size_t i = 0; i < s->working.count; i++) w->colour[i] = s->is_tube[i] ? -1 : s->group[i];
    const size_t blades = plm_graph_components(&s->graph, w->colour, w->component, w->stack);
    memset(area, 0, blades * sizeof *area);
    for (size_t i = 0; i < s->working.count; i++) {
        if (w->component[i] >= 0)
            area[w->component[i]] += cell2;
        else if (s->group[i] >= 0)
            w->group[s->group[i]].tube_area += cell2;
    }
    const double least = BLADE_LEAST * s->scale.radius * s->scale.radius;
    for (size_t i = 0; i < s->working.count; i++) {
        const int32_t b = w->component[i];
        if (b < 0 || area[b] < least) continue;
        group *g = &w->group[s->group[i]];
        g->blade_area += cell2;
    }
    for (size_t i = 0; i < s->working.count; i++) { /* first point of each blade */
        const int32_t b = w->component[i];
        if (b < 0 || !(area[b] >= least)) continue;
        w->group[s->group[i]].blades++;
        area[b] = -area[b];
    }
    for (size_t b = 0; b < blades; b++) area[b] = fabs(area[b]);
    return blades;
}

static plm_habit guess_habit(work *w)
{
    const plm_sketch *s = w->sketch;
    size_t blades = 0, leafy = 0, tubes = 0;
    for (size_t g = 0; g < w->groups; g++) {
        if (!w->group[g].blades) continue;
        leafy++;
        blades += w->group[g].blades;
        if (w->group[g].is_foot_tube) w->value[tubes++] = w->group[g].tube_radius;
    }
    if (!leafy) return s->scale.has_tubes ? PLM_HABIT_BARE_STEM : PLM_HABIT_SINGLE_LEAF;
    if (!s->scale.has_tubes) return leafy > 1 ? PLM_HABIT_HEAD : PLM_HABIT_SINGLE_LEAF;
    if (!s->stem.count) return PLM_HABIT_ROSETTE;
    if (tubes && plm_quantile(w->value, tubes, 0.5) > STRAP_RADIUS * s->scale.stem_radius) return PLM_HABIT_STRAP;
    return (double)blades >= COMPOUND_BLADES * (double)leafy ? PLM_HABIT_COMPOUND : PLM_HABIT_SIMPLE;
}

typedef struct place {
    double along, azimuth;
    int32_t leaf;
} place;

static int by_place(const void *a, const void *b)
{
    const place *p = a, *q = b;
    if (p->along != q->along) return p->along < q->along ? -1 : 1;
    if (p->azimuth != q->azimuth) return p->azimuth < q->azimuth ? -1 : 1;
    return (p->leaf > q->leaf) - (p->leaf < q->leaf);
}

/* Numbers the leaves from the base up: by the foot of their group, then by height, then by azimuth. */
static plm_status number_leaves(work *w, size_t leaves, const int32_t *group_of, plm_error *error)
{
    plm_sketch *s = w->sketch;
    plm_scratch scratch = {.error = error};
    double(*mean)[4] = plm_scratch_take(&scratch, leaves + 1, sizeof *mean);
    place *order = plm_scratch_take(&scratch, leaves + 1, sizeof *order);
    int32_t *number = plm_scratch_take(&scratch, leaves + 1, sizeof *number);
    if (!scratch.failed) {
        for (size_t i = 0; i < s->working.count; i++) {
            if (s->leaf[i] < 0) continue;
            double *m = mean[s->leaf[i]];
            for (int axis = 0; axis < 3; axis++) m[axis] += s->working.xyz[i][axis];
            m[3]++;
        }
        for (size_t k = 0; k < leaves; k++) {
            const double along = group_of[k] >= 0 ? w->group[group_of[k]].along : INFINITY;
            const bool seated = isfinite(along);
            order[k] =
                (place){seated ? along : 1e9 + mean[k][2] / mean[k][3], atan2(mean[k][1], mean[k][0]), (int32_t)k};
        }
        qsort(order, leaves, sizeof *order, by_place);
        for (size_t k = 0; k < leaves; k++) number[order[k].leaf] = (int32_t)k;
        for (size_t i = 0; i < s->working.count; i++)
            if (s->leaf[i] >= 0) s->leaf[i] = number[s->leaf[i]];
        s->leaf_count = leaves;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* One leaf a group. */
static plm_status leaves_of_groups(work *w, plm_error *error)
{
    plm_sketch *s = w->sketch;
    int32_t *group_of = plm_alloc(w->groups + 1, sizeof *group_of, error);
    if (!group_of) return PLM_E_MEMORY;
    size_t leaves = 0;
    for (size_t g = 0; g < w->groups; g++) {
        w->group[g].leaf = w->group[g].blades ? (int32_t)leaves : -1;
        if (w->group[g].blades) group_of[leaves++] = (int32_t)g;
    }
    for (size_t i = 0; i < s->working.count; i++) s->leaf[i] = s->group[i] >= 0 ? w->group[s->group[i]].leaf : -1;
    const plm_status status = number_leaves(w, leaves, group_of, error);
    plm_free(group_of);
    return status;
}

/* One leaf a blade; a group's tube goes to the blade that is nearest along it. */
static plm_status leaves_of_blades(work *w, size_t blades, const double *area, plm_error *error)
{
    plm_sketch *s = w->sketch;
    const double least = BLADE_LEAST * s->scale.radius * s->scale.radius;
    int32_t *leaf_of = plm_alloc(blades + 1, sizeof *leaf_of, error);
    int32_t *group_of = plm_alloc(blades + 1, sizeof *group_of, error);
    plm_status status = leaf_of && group_of ? PLM_OK : PLM_E_MEMORY;
    size_t leaves = 0, sources = 0;
    for (size_t b = 0; status == PLM_OK && b < blades; b++) leaf_of[b] = area[b] >= least ? (int32_t)leaves++ : -1;
    for (uint32_t i = 0; status == PLM_OK && i < s->working.count; i++) {
        const int32_t b = w->component[i];
        w->allowed[i] = !s->is_stem[i];
        s->leaf[i] = b >= 0 ? leaf_of[b] : -1;
        if (s->leaf[i] < 0) continue;
        group_of[s->leaf[i]] = s->group[i];
        w->source[sources++] = i;
    }
    if (status == PLM_OK) {
        const plm_walk walk = {.source = w->source,
                               .source_count = sources,
                               .allowed = w->allowed,
                               .distance = w->distance,
                               .origin = w->origin};
        status = plm_graph_walk(&s->graph, &walk, error);
    }
    for (size_t i = 0; status == PLM_OK && i < s->working.count; i++)
        if (s->leaf[i] < 0 && w->origin[i] >= 0 && !s->is_stem[i]) s->leaf[i] = s->leaf[w->source[w->origin[i]]];
    if (status == PLM_OK) status = number_leaves(w, leaves, group_of, error);
    plm_free(leaf_of);
    plm_free(group_of);
    return status;
}

plm_status plm_sketch_leaves(plm_sketch *sketch, plm_habit habit, plm_error *error)
{
    work w;
    double *area = NULL;
    plm_status status = work_start(&w, sketch, error) ? find_groups(&w, error) : PLM_E_MEMORY;
    if (status == PLM_OK && !(area = plm_alloc(sketch->working.count + 1, sizeof *area, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        const size_t blades = find_blades(&w, area);
        sketch->habit = habit != PLM_HABIT_UNKNOWN ? habit : guess_habit(&w);
        if (sketch->habit == PLM_HABIT_COMPOUND || sketch->habit == PLM_HABIT_STRAP)
            status = leaves_of_groups(&w, error);
        else
            status = leaves_of_blades(&w, blades, area, error);
        for (size_t i = 0; status == PLM_OK && i < sketch->working.count; i++)
            if (sketch->habit == PLM_HABIT_STRAP && sketch->leaf[i] >= 0) sketch->is_tube[i] = false;
        for (size_t i = 0; status == PLM_OK && i < sketch->working.count; i++)
            if (sketch->habit == PLM_HABIT_COMPOUND && sketch->leaf[i] >= 0) sketch->leaflet[i] = w.component[i];
    }
    plm_free(area);
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
