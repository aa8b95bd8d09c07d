/* segment/strap_legs.c: where two legs of a leaf meet that are long and end apart, or stand on the stem at two nodes, it is two leaves. A blade
 * of which a strip was not seen has two legs as well, of which one at least is far narrower than a leaf. */
#include "segment/strap_legs.h"

#include "segment/merge_tree.h"
#include "segment/stem_fit.h"

#include <math.h>

static const double LEG = 0.07; /* length of a leg below the meeting, in sizes of the plant, ... */
static const double LEG_OF_TIP =
    0.03; /* ... and, of all legs of a leaf that touches one without a foot, so much: that one's may be soon over */
static const double LEAST_SHARE = 0.005; /* of the points that a leg holds at least */
static const double CLEAR = 2;           /* nearer to the stem's line, in its radii, feet wrap the stem and touch */
/* Two legs are two leaves if so long as this, their lower ends so far apart, both in sizes: else a leaf with a slit, ... */
static const double FREE_LEG = 0.1, APART = 0.08;
/* ... or both begin so near to what is cleared away about the stem (radii), so far apart along it (sizes). */
static const double ON_STEM = 1, NODES = 0.05;
/* Width over the leaves' median, at least. (Parts of blades on two real maize: 0.37 to 0.39; legs of two leaves on six virtual
 * ones: 0.87 and more.) */
static const double NARROW = 0.6;

/* How far a point is outside of what feet wrap; below 0 within it. */
static double clear_of_stem(const plm_sketch *s, uint32_t i, plm_stem_place *place)
{
    const double off = plm_stem_nearest(&s->stem, s->working.xyz[i], place);
    return off - CLEAR * place->radius - 2 * s->scale.noise;
}

static void start_from_feet(plm_strap_legs *l, const float *from_base)
{
    const plm_sketch *s = l->sketch;
    double farthest = 0;
    for (size_t i = 0; i < s->working.count; i++)
        if (isfinite(from_base[i])) farthest = fmax(farthest, from_base[i]);
    for (uint32_t i = 0; i < s->working.count; i++) {
        plm_stem_place place = {0};
        l->upside[i] = INFINITY;
        if (s->leaf[i] < 0 || s->is_stem[i] || !isfinite(from_base[i])) continue;
        if (clear_of_stem(s, i, &place) > 0) l->upside[i] = (float)(farthest - from_base[i]);
    }
}

static void find_ends(plm_strap_legs *l, size_t leaves)
{
    const plm_sketch *s = l->sketch;
    for (size_t k = 0; k < leaves; k++) l->tip[k] = l->end[k] = UINT32_MAX;
    for (uint32_t i = 0; i < s->working.count; i++) {
        if (!isfinite(l->upside[i])) continue;
        uint32_t *tip = &l->tip[s->leaf[i]], *end = &l->end[s->leaf[i]];
        if (*tip == UINT32_MAX || l->upside[i] < l->upside[*tip]) *tip = i;
        if (*end == UINT32_MAX || l->upside[i] > l->upside[*end]) *end = i;
    }
}

/* How long the legs of each point's leaf are at least. touches: a flag for each leaf. */
static void find_reach(const plm_strap_legs *l, bool *touches, float *reach)
{
    const plm_sketch *s = l->sketch;
    for (size_t i = 0; i < s->working.count; i++)
        for (uint32_t e = s->graph.first[i]; s->leaf[i] >= 0 && e < s->graph.first[i + 1]; e++) {
            const int32_t other = s->leaf[s->graph.edge[e]];
            if (other >= 0 && other != s->leaf[i] && plm_strap_has_no_foot(l, (size_t)other))
                touches[s->leaf[i]] = true;
        }
    for (size_t i = 0; i < s->working.count; i++)
        reach[i] = (float)((s->leaf[i] >= 0 && touches[s->leaf[i]] ? LEG_OF_TIP : LEG) * s->scale.size);
}

static void find_lows(plm_strap_legs *l)
{
    for (size_t k = 0; k < l->legs; k++) l->low[k] = UINT32_MAX;
    for (uint32_t i = 0; i < l->sketch->working.count; i++) {
        if (!isfinite(l->upside[i]) || l->leg[i] < 0) continue;
        uint32_t *low = &l->low[l->leg[i]];
        if (*low == UINT32_MAX || l->upside[i] > l->upside[*low]) *low = i;
    }
}

/* value, legs: room for one a leaf. Leaves of several legs, which may be joined, do not tell how wide one is. */
static void measure_legs(plm_strap_legs *l, size_t leaves, float *value, size_t *legs)
{
    const plm_sketch *s = l->sketch;
    for (size_t k = 0; k < leaves; k++) value[k] = 0;
    for (size_t i = 0; i < s->working.count; i++) {
        if (!isfinite(l->upside[i])) continue;
        value[s->leaf[i]]++;
        const int32_t leg = l->leg[i];
        if (leg < 0) continue;
        l->length[leg] = fmaxf(l->length[leg], l->upside[l->low[leg]] - l->upside[i]);
        l->width[leg]++;
    }
    for (size_t k = 0; k < l->legs; k++) l->width[k] = l->length[k] > 0 ? l->width[k] / l->length[k] : 0;
    for (size_t k = 0; k < l->legs; k++) legs[l->sketch->leaf[l->low[k]]]++;
    size_t known = 0;
    for (size_t k = 0; k < leaves; k++) {
        if (legs[k] > 1) continue;
        const float length = l->end[k] != UINT32_MAX ? l->upside[l->end[k]] - l->upside[l->tip[k]] : 0;
        if (length > 0) value[known++] = value[k] / length;
    }
    l->usual = plm_quantile(value, known, 0.5);
}

plm_status plm_strap_find_legs(const plm_sketch *sketch, const float *from_base, size_t leaves, plm_scratch *scratch,
                               plm_strap_legs *legs)
{
    const size_t count = sketch->working.count;
    float *reach = plm_scratch_take(scratch, count, sizeof *reach);
    bool *touches = plm_scratch_take(scratch, leaves + 1, sizeof *touches);
    float *value = plm_scratch_take(scratch, leaves + 1, sizeof *value);
    size_t *legs_of = plm_scratch_take(scratch, leaves + 1, sizeof *legs_of);
    *legs = (plm_strap_legs){.sketch = sketch,
                             .upside = plm_scratch_take(scratch, count, sizeof *legs->upside),
                             .leg = plm_scratch_take(scratch, count, sizeof *legs->leg),
                             .tip = plm_scratch_take(scratch, leaves + 1, sizeof *legs->tip),
                             .end = plm_scratch_take(scratch, leaves + 1, sizeof *legs->end)};
    if (scratch->failed) return PLM_E_MEMORY;
    start_from_feet(legs, from_base);
    find_ends(legs, leaves);
    find_reach(legs, touches, reach);
    const plm_merge_rule rule = {.distance = legs->upside,
                                 .reach = reach,
                                 .apart = sketch->leaf,
                                 .least = (size_t)(LEAST_SHARE * (double)count)};
    const plm_status status = plm_merge_tree_by(&sketch->graph, &rule, legs->leg, &legs->legs, scratch->error);
    if (status != PLM_OK) return status;
    legs->low = plm_scratch_take(scratch, legs->legs + 1, sizeof *legs->low);
    legs->length = plm_scratch_take(scratch, legs->legs + 1, sizeof *legs->length);
    legs->width = plm_scratch_take(scratch, legs->legs + 1, sizeof *legs->width);
    if (scratch->failed) return PLM_E_MEMORY;
    find_lows(legs);
    measure_legs(legs, leaves, value, legs_of);
    return PLM_OK;
}

/* Whether a leg begins beside the stem, and where along it. */
static bool find_foot(const plm_strap_legs *l, size_t leg, double *along)
{
    plm_stem_place place = {0};
    const double off = clear_of_stem(l->sketch, l->low[leg], &place);
    *along = place.along;
    return off < ON_STEM * place.radius;
}

bool plm_strap_is_wide(const plm_strap_legs *legs, size_t leg)
{
    return legs->width[leg] >= NARROW * legs->usual;
}

bool plm_strap_are_apart(const plm_strap_legs *legs, size_t a, size_t b)
{
    const plm_sketch *s = legs->sketch;
    const double size = s->scale.size, shorter = (double)fminf(legs->length[a], legs->length[b]);
    double first, second;
    if (shorter > FREE_LEG * size && plm_graph_length(&s->graph, legs->low[a], legs->low[b]) > APART * size)
        return true;
    return find_foot(legs, a, &first) && find_foot(legs, b, &second) && fabs(first - second) > NODES * size;
}

bool plm_strap_has_no_foot(const plm_strap_legs *legs, size_t leaf)
{
    plm_stem_place place = {0};
    if (legs->end[leaf] == UINT32_MAX) return false;
    return clear_of_stem(legs->sketch, legs->end[leaf], &place) > ON_STEM * place.radius;
}
