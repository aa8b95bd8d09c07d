/* segment/fruit.c: a leaf is a sheet. What was taken for one and is made of balls is fruit, which with its own stalk is of no organ; balls that
 * a leaf was joined with are taken off it. Grasses bear no balls, and a furled leaf of theirs may be like one. */
#include "segment/balls.h"
#include "segment/scratch.h"
#include "segment/sketch.h"

#include "cloud/linear.h"

#include <math.h>

/* Radii of fruits: in R, and in SDs of the noise and cells at least; of the plant's size at most: a head is none. */
static const double LEAST = 0.5, LEAST_NOISE = 15, MOST = 2, MOST_SIZE = 0.1;
static const double CELLS = 3; /* of the thinned plant, in the least radius */
/* A leaf is fruit that has fewer other points than so much of the fruit's, and of the usual leaf's. */
static const double REST = 0.5, REST_OF_LEAF = 0.35;
static const double HOLDS = 0.25; /* of a ball's points: a leaf that has fewer only touches it */

/* Points of a leaf: on balls, and of its blade beside them. */
typedef struct share {
    size_t fruit, rest;
    int32_t number; /* of the leaf without those that are fruit; -1: it is */
} share;

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

/* What a ball and a leaf have in common, and all that is on the ball. */
typedef struct work {
    plm_sketch *sketch;
    size_t balls;
    int32_t *on;  /* of each point: its ball, -1 */
    size_t *held; /* of each leaf, each ball's points */
    size_t *all;  /* of each ball */
    share *leaf;
    float *size; /* room for one a leaf */
} work;

static bool may_be_fruit(const plm_sketch *sketch, size_t i)
{
    return !sketch->is_stem[i] && sketch->leaf[i] >= 0;
}

/* A leaf that lies against a fruit holds few of its points: these stay. */
static void drop_touched(work *w)
{
    const plm_sketch *s = w->sketch;
    for (size_t i = 0; i < s->working.count; i++) {
        if (w->on[i] < 0) continue;
        w->held[(size_t)s->leaf[i] * w->balls + (size_t)w->on[i]]++;
        w->all[w->on[i]]++;
    }
    for (size_t i = 0; i < s->working.count; i++) {
        if (w->on[i] < 0) continue;
        const size_t held = w->held[(size_t)s->leaf[i] * w->balls + (size_t)w->on[i]];
        if ((double)held < HOLDS * (double)w->all[w->on[i]]) w->on[i] = -1;
    }
}

/* Leaves that are fruit lose their numbers. */
static void judge(work *w)
{
    plm_sketch *s = w->sketch;
    size_t whole = 0;
    int32_t kept = 0;
    for (size_t i = 0; i < s->working.count; i++) {
        if (!may_be_fruit(s, i)) continue;
        w->leaf[s->leaf[i]].fruit += w->on[i] >= 0;
        w->leaf[s->leaf[i]].rest += w->on[i] < 0 && !s->is_tube[i];
    }
    for (size_t k = 0; k < s->leaf_count; k++)
        if (!w->leaf[k].fruit) w->size[whole++] = (float)w->leaf[k].rest;
    const double usual = whole ? plm_quantile(w->size, whole, 0.5) : INFINITY;
    for (size_t k = 0; k < s->leaf_count; k++) {
        const double rest = (double)w->leaf[k].rest;
        const bool is_fruit = rest < REST * (double)w->leaf[k].fruit && rest < REST_OF_LEAF * usual;
        w->leaf[k].number = is_fruit ? -1 : kept++;
    }
    s->leaf_count = (size_t)kept;
}

static plm_status take_off(plm_sketch *sketch, const plm_ball *ball, size_t balls, plm_error *error)
{
    const size_t count = sketch->working.count, leaves = sketch->leaf_count;
    plm_scratch scratch = {.error = error};
    work w = {.sketch = sketch, .balls = balls};
    w.on = plm_scratch_take(&scratch, count, sizeof *w.on);
    w.held = plm_scratch_take(&scratch, leaves * balls, sizeof *w.held);
    w.all = plm_scratch_take(&scratch, balls, sizeof *w.all);
    w.leaf = plm_scratch_take(&scratch, leaves, sizeof *w.leaf);
    w.size = plm_scratch_take(&scratch, leaves, sizeof *w.size);
    for (size_t i = 0; !scratch.failed && i < count; i++)
        w.on[i] = may_be_fruit(sketch, i) ? ball_of(sketch->working.xyz[i], ball, balls) : -1;
    if (!scratch.failed) {
        drop_touched(&w);
        judge(&w);
    }
    for (size_t i = 0; !scratch.failed && i < count; i++) {
        if (!may_be_fruit(sketch, i)) continue;
        sketch->leaf[i] = w.on[i] >= 0 ? -1 : w.leaf[sketch->leaf[i]].number;
        if (sketch->leaf[i] >= 0) continue;
        sketch->is_tube[i] = false;
        sketch->leaflet[i] = -1;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

plm_status plm_sketch_fruit(plm_sketch *sketch, plm_error *error)
{
    const bool may_bear = sketch->habit == PLM_HABIT_SIMPLE || sketch->habit == PLM_HABIT_COMPOUND;
    if (!may_bear || !sketch->stem.count || !sketch->leaf_count) return PLM_OK;
    plm_ball *ball = NULL;
    size_t balls = 0;
    plm_status status = find_balls(sketch, &ball, &balls, error);
    if (status == PLM_OK && balls) status = take_off(sketch, ball, balls, error);
    plm_free(ball);
    return status;
}
