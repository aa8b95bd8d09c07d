/* segment/fruit.c: a leaf is a sheet. What was taken for one and is made of balls is fruit, which with its own stalk is of no organ; balls that
 * a leaf was joined with are taken off it. The leaves are found again without them (and from what is known by then of tubes and blades, which
 * is half of what that gains), as the way to one that touches fruit led over it. Grasses bear no balls, and a furled leaf of theirs may be
 * like one. */
#include "segment/fruit.h"

#include "segment/balls.h"
#include "segment/scratch.h"

#include "cloud/linear.h"

#include <math.h>

/* Radii of fruits: in R, and in SDs of the noise and cells at least; of the plant's size at most: a head is none. */
static const double LEAST = 0.5, LEAST_NOISE = 15, MOST = 2, MOST_SIZE = 0.1;
static const double CELLS = 3; /* of the thinned plant, in the least radius */
/* A leaf is what is left of a truss where its blade has fewer points than the bunches that it touches, and than so much of the usual leaf's. */
static const double REST_OF_LEAF = 0.35;
static const double HOLDS = 0.25; /* of a ball's points: a leaf that has fewer only touches it */

/* Among the plant's points, thinned: a ball needs no more of them than its radius asks for. */
static plm_status find_balls(const plm_sketch *sketch, plm_ball **ball, size_t *balls, plm_error *error)
{
    const plm_scale *scale = &sketch->scale;
    const plm_thinned *working = &sketch->working;
    const double least = fmax(LEAST * scale->radius, fmax(LEAST_NOISE * scale->noise, CELLS * working->cell));
    plm_scratch scratch = {.error = error};
    plm_thinned thin = {0};
    plm_status status = plm_thin((const float(*)[3])working->xyz, working->count, least / CELLS, &thin, error);
    bool *may_be = status == PLM_OK ? plm_scratch_take(&scratch, thin.count, sizeof *may_be) : NULL;
    if (scratch.failed) status = PLM_E_MEMORY;
    for (size_t i = 0; status == PLM_OK && i < working->count; i++)
        if (!sketch->is_stem[i]) may_be[thin.voxels.owner[i]] = true;
    const plm_ball_query query = {.xyz = (const float(*)[3])thin.xyz,
                                  .count = thin.count,
                                  .may_be = may_be,
                                  .cell = thin.cell,
                                  .noise = scale->noise,
                                  .least_radius = least,
                                  .most_radius = fmin(MOST * scale->radius, MOST_SIZE * scale->size)};
    if (status == PLM_OK) status = plm_balls_find(&query, ball, balls, error);
    plm_thinned_free(&thin);
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* The ball that a place is on, the first of several; -1: none. */
static int32_t ball_of(const float xyz[3], const plm_ball *ball, size_t balls)
{
    const double at[3] = {xyz[0], xyz[1], xyz[2]};
    for (size_t b = 0; b < balls; b++)
        if (plm_distance(at, ball[b].centre) <= ball[b].radius + ball[b].thick) return (int32_t)b;
    return -1;
}

static bool may_be_fruit(const plm_sketch *sketch, size_t i)
{
    return !sketch->is_stem[i] && sketch->leaf[i] >= 0;
}

/* A leaf that lies against a fruit holds few of its points: these stay. on: of each point, its ball. */
static plm_status drop_touched(const plm_sketch *s, size_t balls, int32_t *on, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    size_t *held =
        plm_scratch_take(&scratch, s->leaf_count * balls, sizeof *held); /* of each leaf, each ball's points */
    size_t *all = plm_scratch_take(&scratch, balls, sizeof *all);
    for (size_t i = 0; !scratch.failed && i < s->working.count; i++) {
        if (on[i] < 0) continue;
        held[(size_t)s->leaf[i] * balls + (size_t)on[i]]++;
        all[on[i]]++;
    }
    for (size_t i = 0; !scratch.failed && i < s->working.count; i++) {
        if (on[i] < 0) continue;
        if ((double)held[(size_t)s->leaf[i] * balls + (size_t)on[i]] < HOLDS * (double)all[on[i]]) on[i] = -1;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Fruits that touch are a bunch: its points, and which other points touch it. colour: 0 on fruit, else -1. room: as many as points. */
static plm_status find_bunches(const plm_sketch *sketch, const int32_t *colour, uint32_t *room, plm_fruit *fruit,
                               plm_error *error)
{
    const plm_graph *graph = &sketch->graph;
    fruit->bunches = plm_graph_components(graph, colour, fruit->bunch, room);
    fruit->size = plm_alloc_zero(fruit->bunches, sizeof *fruit->size, error);
    size_t touches = 0;
    for (int pass = 0; pass < 2 && fruit->size; pass++) {
        for (uint32_t i = 0; i < graph->count; i++) {
            if (fruit->bunch[i] < 0) continue;
            fruit->size[fruit->bunch[i]] += pass == 0;
            for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++) {
                if (fruit->bunch[graph->edge[e]] >= 0) continue;
                if (pass)
                    fruit->touch[fruit->touches++] = (plm_link){.a = i, .b = graph->edge[e]};
                else
                    touches++;
            }
        }
        if (!pass) fruit->touch = plm_alloc(touches, sizeof *fruit->touch, error);
        if (!fruit->touch) return PLM_E_MEMORY;
    }
    return fruit->size ? PLM_OK : PLM_E_MEMORY;
}

static plm_status mark_fruit(const plm_sketch *sketch, const plm_ball *ball, size_t balls, plm_fruit *fruit,
                             plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    int32_t *colour = plm_scratch_take(&scratch, count, sizeof *colour);
    uint32_t *room = plm_scratch_take(&scratch, count, sizeof *room);
    fruit->bunch = plm_alloc(count, sizeof *fruit->bunch, error);
    plm_status status = scratch.failed || !fruit->bunch ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++)
            colour[i] = may_be_fruit(sketch, i) ? ball_of(sketch->working.xyz[i], ball, balls) : -1;
        status = drop_touched(sketch, balls, colour, error);
    }
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++) colour[i] = colour[i] < 0 ? -1 : 0;
        status = find_bunches(sketch, colour, room, fruit, error);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

plm_status plm_fruit_find(const plm_sketch *sketch, plm_fruit *fruit, plm_error *error)
{
    const bool may_bear = sketch->habit == PLM_HABIT_SIMPLE || sketch->habit == PLM_HABIT_COMPOUND;
    *fruit = (plm_fruit){0};
    if (!may_bear || !sketch->stem.count || !sketch->leaf_count) return PLM_OK;
    plm_ball *ball = NULL;
    size_t balls = 0;
    plm_status status = find_balls(sketch, &ball, &balls, error);
    if (status == PLM_OK && balls) status = mark_fruit(sketch, ball, balls, fruit, error);
    plm_free(ball);
    return status;
}

plm_status plm_fruit_part(plm_sketch *sketch, const plm_fruit *fruit, plm_error *error)
{
    int32_t *colour = plm_alloc(sketch->working.count, sizeof *colour, error);
    if (!colour) return PLM_E_MEMORY;
    for (size_t i = 0; i < sketch->working.count; i++) colour[i] = fruit->bunch[i] >= 0;
    plm_graph_part(&sketch->graph, colour);
    plm_free(colour);
    return PLM_OK;
}

/* ---- Leaves ----------------------------------------------------------------------------------------------------- */

/* Points of a leaf: of fruit that it is or touches, and of its own blade. */
typedef struct share {
    size_t fruit, rest;
    int32_t number; /* of the leaf without those that are fruit; -1: it is */
} share;

static plm_status count_shares(const plm_sketch *sketch, const plm_fruit *fruit, share *leaf, plm_error *error)
{
    const size_t bunches = fruit->bunches;
    bool *hangs = plm_alloc_zero(sketch->leaf_count * bunches, sizeof *hangs, error); /* each leaf: on each bunch */
    if (!hangs) return PLM_E_MEMORY;
    for (size_t i = 0; i < sketch->working.count; i++) {
        if (!may_be_fruit(sketch, i)) continue;
        const size_t k = (size_t)sketch->leaf[i];
        if (fruit->bunch[i] >= 0)
            hangs[k * bunches + (size_t)fruit->bunch[i]] = true;
        else
            leaf[k].rest += !sketch->is_tube[i];
    }
    for (size_t t = 0; t < fruit->touches; t++) {
        const plm_link *touch = &fruit->touch[t];
        if (!may_be_fruit(sketch, touch->b)) continue;
        hangs[(size_t)sketch->leaf[touch->b] * bunches + (size_t)fruit->bunch[touch->a]] = true;
    }
    for (size_t k = 0; k < sketch->leaf_count; k++)
        for (size_t b = 0; b < bunches; b++)
            if (hangs[k * bunches + b]) leaf[k].fruit += fruit->size[b];
    plm_free(hangs);
    return PLM_OK;
}

/* Leaves that are fruit lose their numbers; where all touch fruit, all tell how large one is. value: room for one a leaf. */
static void judge(plm_sketch *sketch, share *leaf, float *value)
{
    size_t whole = 0;
    int32_t kept = 0;
    for (int any = 0; any < 2 && !whole; any++)
        for (size_t k = 0; k < sketch->leaf_count; k++)
            if (any || !leaf[k].fruit) value[whole++] = (float)leaf[k].rest;
    const double usual = plm_quantile(value, whole, 0.5);
    for (size_t k = 0; k < sketch->leaf_count; k++) {
        const bool is_fruit = leaf[k].rest < leaf[k].fruit && (double)leaf[k].rest < REST_OF_LEAF * usual;
        leaf[k].number = is_fruit ? -1 : kept++;
    }
    sketch->leaf_count = (size_t)kept;
}

/* Groups of no leaf that touch fruit are its stalks: no tube of the stem's. */
static plm_status drop_stalks(plm_sketch *sketch, const plm_fruit *fruit, plm_error *error)
{
    int32_t most = -1;
    for (size_t i = 0; i < sketch->working.count; i++)
        if (sketch->group[i] > most) most = sketch->group[i];
    bool *is_stalk = plm_alloc_zero((size_t)(most + 1), sizeof *is_stalk, error);
    if (!is_stalk) return PLM_E_MEMORY;
    for (size_t t = 0; t < fruit->touches; t++) {
        const uint32_t i = fruit->touch[t].b;
        if (!sketch->is_stem[i] && sketch->leaf[i] < 0 && sketch->group[i] >= 0) is_stalk[sketch->group[i]] = true;
    }
    for (size_t i = 0; i < sketch->working.count; i++)
        if (!sketch->is_stem[i] && sketch->leaf[i] < 0 && sketch->group[i] >= 0 && is_stalk[sketch->group[i]])
            sketch->is_tube[i] = false;
    plm_free(is_stalk);
    return PLM_OK;
}

plm_status plm_fruit_take_off(plm_sketch *sketch, const plm_fruit *fruit, plm_error *error)
{
    if (!fruit->bunches) return PLM_OK;
    plm_scratch scratch = {.error = error};
    share *leaf = plm_scratch_take(&scratch, sketch->leaf_count, sizeof *leaf);
    float *value = plm_scratch_take(&scratch, sketch->leaf_count, sizeof *value);
    plm_status status = scratch.failed ? PLM_E_MEMORY : count_shares(sketch, fruit, leaf, error);
    if (status == PLM_OK) judge(sketch, leaf, value);
    for (size_t i = 0; status == PLM_OK && i < sketch->working.count; i++) {
        const bool is_fruit = fruit->bunch[i] >= 0;
        if (sketch->is_stem[i] || (!is_fruit && sketch->leaf[i] < 0)) continue;
        sketch->leaf[i] = is_fruit ? -1 : leaf[sketch->leaf[i]].number;
        if (sketch->leaf[i] >= 0) continue;
        sketch->is_tube[i] = false;
        sketch->leaflet[i] = -1;
    }
    plm_scratch_free(&scratch, NULL);
    return status == PLM_OK ? drop_stalks(sketch, fruit, error) : status;
}

void plm_fruit_free(plm_fruit *fruit)
{
    plm_free(fruit->bunch);
    plm_free(fruit->size);
    plm_free(fruit->touch);
    *fruit = (plm_fruit){0};
}

plm_status plm_sketch_fruit(plm_sketch *sketch, plm_error *error)
{
    plm_fruit fruit;
    plm_status status = plm_fruit_find(sketch, &fruit, error);
    if (status == PLM_OK && fruit.bunches) {
        const plm_habit asked = sketch->asked;
        sketch->asked = sketch->habit; /* which fruit does not change */
        status = plm_fruit_part(sketch, &fruit, error);
        if (status == PLM_OK) status = plm_sketch_leaves(sketch, error);
        if (status == PLM_OK) status = plm_fruit_take_off(sketch, &fruit, error);
        sketch->asked = asked;
    }
    plm_fruit_free(&fruit);
    return status;
}
