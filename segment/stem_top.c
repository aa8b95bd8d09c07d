/* segment/stem_top.c: the stem ends where the way from the base has been thick for the longest, unless hardly a blade hangs there
 * and most do on another way. */
#include "segment/stem_top.h"

#include "segment/scratch.h"

#include <math.h>

static const double THIN_WAY = 0.6; /* of the radius on the way so far (over MEMORY, in R): thinner is no stem, ... */
static const double MEMORY = 6, TAPER = 0.65; /* which falls along the way, at most to this share of the lower stem's */
static const double THIN_LOSS = 2;            /* ... and a length of it takes off so many */
static const double LOWER_SHARE = 0.6;        /* of the way: where the lower stem's radius is taken from */
/* A way on which no more than LITTLE of the blades' points hang beyond the fork is no stem where more than MOST hang on the other branch
 * (the largest leaf of virtual plants has 0.48, a soybean's); but where that is worth less than WORSE of the best way, it leads through
 * blades. */
static const double MOST = 0.6, LITTLE = 0.1, WORSE = 0.5;
static const double BLADES = 0.25; /* of all points, at least: less are specks on bare branches */

/* Typical radius of the tube points on the lower part of the way from a point to the base. */
static double lower_radius(const plm_sketch *sketch, uint32_t top, const uint32_t *parent, float *value)
{
    size_t length = 0, count = 0, k = 0;
    for (uint32_t i = top; i != UINT32_MAX; i = parent[i]) length++;
    for (uint32_t i = top; i != UINT32_MAX; i = parent[i], k++)
        if ((double)(length - k) < LOWER_SHARE * (double)length && sketch->is_tube[i])
            value[count++] = sketch->point[i].radius;
    return count ? plm_quantile(value, count, 0.5) : sketch->scale.stem_radius;
}

/* How long the way to each point is, what is thin on it taken off twice. A length counts by the square of its radius over the way's so far:
 * a long petiole, hardly slimmer than the stem, would else win over the rest of the stem. usual: scratch, a row a point. */
static void weigh_ways(const plm_sketch *sketch, const plm_tube_ways *ways, uint32_t top, float *gain, float *usual)
{
    const uint32_t *parent = ways->parent;
    const float lower = (float)lower_radius(sketch, top, parent, gain);
    const double memory = MEMORY * sketch->scale.radius;
    for (size_t i = 0; i < sketch->working.count; i++) gain[i] = 0, usual[i] = lower;
    for (size_t k = 0; k < ways->reached; k++) {
        const uint32_t i = ways->order[k];
        if (parent[i] == UINT32_MAX) continue;
        const double length = plm_graph_length(&sketch->graph, i, parent[i]), radius = sketch->point[i].radius;
        const double before = usual[parent[i]], share = fmin(length / memory, 1);
        const bool is_stout = sketch->is_tube[i] && radius >= THIN_WAY * before;
        const double slimmer = fmax(before + share * (fmin(radius, before) - before), TAPER * lower);
        const double thick = fmin(radius / before, 1);
        gain[i] = gain[parent[i]] + (float)(length * (is_stout ? thick * thick : -THIN_LOSS));
        usual[i] = (float)(is_stout ? slimmer : before);
    }
}

/* Points of blades beyond each point, itself among them; gives how many there are. beyond: zeros before. */
static size_t count_beyond(const plm_sketch *sketch, const plm_tube_ways *ways, uint32_t *beyond)
{
    size_t all = 0;
    for (size_t k = ways->reached; k-- > 0;) {
        const uint32_t i = ways->order[k];
        beyond[i] += !sketch->is_tube[i];
        all += !sketch->is_tube[i];
        if (ways->parent[i] != UINT32_MAX) beyond[ways->parent[i]] += beyond[i];
    }
    return all;
}

/* The last tube point that most of the blades' points hang beyond; UINT32_MAX: none. (Two ways cannot both bear more than half, so that of
 * these points each lies beyond the one before.) */
static uint32_t last_bearer(const plm_sketch *sketch, const plm_tube_ways *ways, const uint32_t *beyond, size_t all)
{
    uint32_t last = UINT32_MAX;
    if ((double)all < BLADES * (double)ways->reached) return last;
    for (size_t k = 0; k < ways->reached; k++) {
        const uint32_t i = ways->order[k];
        if (sketch->is_tube[i] && (double)beyond[i] > MOST * (double)all) last = i;
    }
    return last;
}

/* How many hang on the way to a point beyond where it leaves the way to the bearer; on_way: scratch, false before. */
static size_t count_aside(const plm_tube_ways *ways, const uint32_t *beyond, uint32_t bearer, uint32_t end,
                          bool *on_way)
{
    size_t aside = 0;
    for (uint32_t i = bearer; i != UINT32_MAX; i = ways->parent[i]) on_way[i] = true;
    for (uint32_t i = end; i != UINT32_MAX && !on_way[i]; i = ways->parent[i]) aside = beyond[i];
    return aside;
}

/* The best way's end that lies beyond a point. is_beyond: out, of each point, false before. */
static uint32_t best_beyond(const plm_tube_ways *ways, uint32_t bearer, const float *gain, bool *is_beyond)
{
    uint32_t best = bearer;
    for (size_t k = 0; k < ways->reached; k++) {
        const uint32_t i = ways->order[k];
        is_beyond[i] = i == bearer || (ways->parent[i] != UINT32_MAX && is_beyond[ways->parent[i]]);
        if (is_beyond[i] && gain[i] > gain[best]) best = i;
    }
    return best;
}

/* The highest thick point may stand on a petiole that rises beyond the stem's tip; and where points are so few that their radii scatter, the
 * thickest way may end at a node below most of the leaves. */
plm_status plm_stem_top(const plm_sketch *sketch, const plm_tube_ways *ways, uint32_t *top, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    float *gain = plm_scratch_take(&scratch, count, sizeof *gain);
    float *usual = plm_scratch_take(&scratch, count, sizeof *usual);
    uint32_t *beyond = plm_scratch_take(&scratch, count, sizeof *beyond);
    bool *on_way = plm_scratch_take(&scratch, count, sizeof *on_way);
    bool *is_beyond = plm_scratch_take(&scratch, count, sizeof *is_beyond);
    if (!scratch.failed) {
        weigh_ways(sketch, ways, *top, gain, usual);
        uint32_t best = *top;
        for (uint32_t i = 0; i < count; i++)
            if (isfinite(ways->distance[i]) && gain[i] > gain[best]) best = i;
        const size_t all = count_beyond(sketch, ways, beyond);
        const uint32_t bearer = last_bearer(sketch, ways, beyond, all);
        if (bearer != UINT32_MAX) {
            const uint32_t other = best_beyond(ways, bearer, gain, is_beyond);
            const double aside = (double)count_aside(ways, beyond, bearer, best, on_way);
            if (!is_beyond[best] && aside <= LITTLE * (double)all && gain[other] >= WORSE * gain[best]) best = other;
        }
        *top = best;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
