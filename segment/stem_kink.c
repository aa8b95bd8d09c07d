/* segment/stem_kink.c: a way that runs on into the petiole of the topmost leaf turns where that petiole leaves the stem.
 * The stem ends there, or goes on straight: as a bare tip, or as internodes whose leaves the way has missed. */
#include "segment/stem_fit.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

static const double KINK = 0.21;        /* radians: a turn that tells a petiole from its stem */
static const double KINK_AT_END = 0.25; /* the same where the way ends before it has straightened again */
static const double HAIRPIN = 1;        /* radians: a turn from up to down that no stem makes */
/* A turn (radians) that no stem makes within the last part of a way, so far (in R) before its end: there it has run into the topmost leaf,
 * which what hangs beyond may hide. (Of 43 large virtual tomatoes seven such ways turn by 0.803 to 1.82, 5.6 R and more before the end, those
 * up the stem by 0.48 at most. Nearer to the end ways turn from a rachis into a leaflet, and lower down real stems turn so.) */
static const double WRONG = 0.8, LAST_PART = 0.85, LEAF_LONG = 5;
static const double PLATEAU = 0.95;          /* of the largest turn: as large */
static const double AROUND = 1.3;            /* points within so many radii (plus noise) of a straight line are on it */
static const double PRESENT = 0.3;           /* of the points that the stem has on such a length: it goes on */
static const double PULL = 0.3, TURN = 0.15; /* how far a step follows the points, and the direction the steps */
static const double THINNER = 0.82;          /* radius beyond a kink over that below: the way has left the stem, ... */
static const double THICKER = 1.15;          /* ... where the tube straight on is so much thicker than the way's */
static const double UNDONE = 0.5; /* of a turn that is left where nodes beside it do not count: else the way zigzags */
enum {
    ARM = 6,
    FAR = 12, /* nodes: what lies farther off does not count */
    RISING = 4,
    BELOW = 8,
    SKIPPED = 2,
    MISSED = 2,
    MOST_STEPS = 2000,
    FORKED = 6,   /* nodes from a fork on which its branches lie apart, */
    COMPARED = 12 /* and those by which they are compared */
};

/* Direction of the path over ARM nodes from n on, up (step 1) or down (-1), pointing up. */
static void direction(const plm_stem_path *stem, size_t n, int step, double out[3])
{
    const size_t last = stem->count - 1;
    const size_t m = step > 0 ? (n + ARM < last ? n + ARM : last) : (n > ARM ? n - ARM : 0);
    for (int axis = 0; axis < 3; axis++) out[axis] = step * (stem->node[m][axis] - stem->node[n][axis]);
    plm_normalise(out);
}

double plm_stem_turn(const plm_stem_path *stem, size_t n)
{
    double below[3], above[3];
    direction(stem, n, -1, below);
    direction(stem, n, 1, above);
    return acos(fmax(-1, fmin(1, plm_dot(below, above))));
}

double plm_stem_look(const plm_stem_path *stem, size_t n, int step, double out[3])
{
    const size_t last = stem->count - 1;
    const size_t low = step > 0 ? n + PLM_STEM_NEAR : n > FAR ? n - FAR : 0;
    const size_t high = step > 0 ? (n + FAR < last ? n + FAR : last) : n - PLM_STEM_NEAR;
    for (int axis = 0; axis < 3; axis++) out[axis] = stem->node[high][axis] - stem->node[low][axis];
    plm_normalise(out);
    return plm_stem_mean_radius(stem, low, high + 1);
}

bool plm_stem_zigzag(const plm_stem_path *stem, size_t n)
{
    double below[3], above[3];
    if (n < PLM_STEM_NEAR + ARM || n + PLM_STEM_NEAR + ARM >= stem->count) return false;
    plm_stem_look(stem, n, -1, below);
    plm_stem_look(stem, n, 1, above);
    return acos(fmax(-1, fmin(1, plm_dot(below, above)))) < UNDONE * plm_stem_turn(stem, n);
}

double plm_stem_hairpin(const plm_stem_path *stem)
{
    const double half = stem->count ? 0.5 * stem->along[stem->count - 1] : 0;
    for (size_t n = ARM; n + ARM < stem->count; n++)
        if (stem->along[n] > half && stem->node[n][2] > stem->node[n - ARM][2] &&
            stem->node[n][2] > stem->node[n + ARM][2] && plm_stem_turn(stem, n) > HAIRPIN)
            return stem->along[n];
    return INFINITY;
}

size_t plm_stem_kink(const plm_stem_path *stem, double from)
{
    size_t best = 0;
    double most = 0;
    for (size_t n = 3; n + 3 < stem->count; n++) {
        if (stem->along[n] < from) continue;
        const double turn = plm_stem_turn(stem, n);
        if (turn > most) {
            most = turn;
            best = n;
        }
        if (most < KINK || n < best + RISING) continue;
        if (plm_stem_turn(stem, best - 1) <= most) return best; /* not the rest of a turn below */
        most = turn;
        best = n;
    }
    if (most < KINK_AT_END || !best) return 0;
    while (best > 3 && stem->along[best - 1] >= from && plm_stem_turn(stem, best - 1) >= PLATEAU * most) best--;
    return best;
}

/* What a stretch of the straight line about a point holds: tube points, and their middle across the line. */
typedef struct stretch {
    size_t count;
    double middle[3];
} stretch;

/* other: a path whose points do not count; NULL: none. */
static stretch look(const plm_sketch *sketch, const double at[3], const double along[3], double half, double reach,
                    const plm_stem_path *other)
{
    stretch found = {0};
    for (size_t i = 0; i < sketch->working.count; i++) {
        if (!sketch->is_tube[i]) continue;
        double d[3];
        for (int axis = 0; axis < 3; axis++) d[axis] = sketch->working.xyz[i][axis] - at[axis];
        const double forward = plm_dot(d, along), off2 = plm_dot(d, d) - forward * forward;
        if (fabs(forward) > half || off2 > reach * reach) continue;
        plm_stem_place place;
        if (other && plm_stem_nearest(other, sketch->working.xyz[i], &place) < sqrt(fmax(off2, 0))) continue;
        for (int axis = 0; axis < 3; axis++) found.middle[axis] += d[axis] - forward * along[axis];
        found.count++;
    }
    for (int axis = 0; axis < 3 && found.count; axis++) found.middle[axis] /= (double)found.count;
    return found;
}

/* The part of a path from node first on. */
static plm_stem_path rest_of(const plm_stem_path *stem, size_t first)
{
    return (plm_stem_path){.count = stem->count - first,
                           .node = stem->node + first,
                           .radius = stem->radius + first,
                           .along = stem->along + first};
}

/* Follows the stem straight on from its node: writes up to MOST_STEPS nodes and gives their number. */
static size_t follow(const plm_sketch *sketch, size_t from, const plm_stem_path *petiole, double step, double radius,
                     double (*node)[3])
{
    const plm_stem_path *stem = &sketch->stem;
    const double reach = AROUND * radius + sketch->scale.noise;
    double along[3], at[3], usual = 0;
    direction(stem, from, -1, along);
    memcpy(at, stem->node[from], sizeof at);
    for (size_t k = 0; k < BELOW && k < from; k++)
        usual += (double)look(sketch, stem->node[from - k], along, step, reach, NULL).count / BELOW;
    size_t count = 0, missed = 0;
    while (count < MOST_STEPS && missed < MISSED) {
        double next[3];
        for (int axis = 0; axis < 3; axis++) next[axis] = at[axis] + step * along[axis];
        const stretch here = look(sketch, next, along, step, reach, petiole);
        missed = (double)here.count < PRESENT * usual ? missed + 1 : 0;
        for (int axis = 0; axis < 3; axis++) {
            if (!missed) next[axis] += PULL * here.middle[axis];
            along[axis] += TURN * ((next[axis] - at[axis]) / step - along[axis]);
        }
        plm_normalise(along);
        memcpy(at, next, sizeof at);
        memcpy(node[count++], next, sizeof next);
    }
    return count - missed;
}

/* The path that leaves a kink straight on, as long as tube points lie along it. Gives that length. */
static plm_status go_straight(const plm_sketch *sketch, size_t kink, plm_stem_path *straight, double *length,
                              plm_error *error)
{
    const plm_stem_path *stem = &sketch->stem, petiole = rest_of(stem, kink);
    const size_t from = kink > SKIPPED ? kink - SKIPPED : 0; /* smoothing has rounded the kink off */
    const double step = stem->along[from + 1] - stem->along[from], radius = stem->radius[from];
    const size_t most = from + 1 + MOST_STEPS;
    *straight = (plm_stem_path){.node = plm_alloc(most, sizeof *straight->node, error),
                                .radius = plm_alloc(most, sizeof *straight->radius, error),
                                .along = plm_alloc(most, sizeof *straight->along, error)};
    if (!straight->node || !straight->radius || !straight->along) {
        plm_stem_path_free(straight);
        return PLM_E_MEMORY;
    }
    const size_t added = follow(sketch, from, &petiole, step, radius, straight->node + from + 1);
    *length = (double)added * step;
    straight->count = from + 1 + (added > SKIPPED ? added : SKIPPED);
    memcpy(straight->node, stem->node, (from + 1) * sizeof *straight->node);
    memcpy(straight->radius, stem->radius, (from + 1) * sizeof *straight->radius);
    memcpy(straight->along, stem->along, (from + 1) * sizeof *straight->along);
    for (size_t n = from + 1; n < straight->count; n++) {
        double d[3];
        for (int axis = 0; axis < 3; axis++) d[axis] = straight->node[n][axis] - straight->node[n - 1][axis];
        straight->along[n] = straight->along[n - 1] + plm_norm(d);
        straight->radius[n] = radius;
    }
    return PLM_OK;
}

/* Typical radius of the balls of the tube points about the nodes [first, end) of a path; 0 where there are none. */
static double typical_ball(const plm_sketch *sketch, const plm_stem_path *path, size_t first, size_t end, float *value)
{
    plm_stem_path part = rest_of(path, first);
    part.count = end - first;
    size_t count = 0;
    for (size_t i = 0; i < sketch->working.count; i++) {
        plm_stem_place place;
        if (!sketch->is_tube[i]) continue;
        const double off = plm_stem_nearest(&part, sketch->working.xyz[i], &place);
        if (off < AROUND * place.radius + sketch->scale.noise) value[count++] = sketch->point[i].radius;
    }
    return count ? plm_quantile(value, count, 0.5) : 0;
}

/* Whether the tube straight on from a kink is thicker than the one that the path turns into, where both have left the fork. */
static plm_status is_thicker(const plm_sketch *sketch, size_t kink, const plm_stem_path *straight, bool *answer,
                             plm_error *error)
{
    const plm_stem_path *stem = &sketch->stem;
    float *value = plm_alloc(sketch->working.count, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    const size_t first = kink + FORKED, last = straight->count < stem->count ? straight->count : stem->count;
    const size_t end = last < first + COMPARED ? last : first + COMPARED;
    *answer = first + 1 < end && typical_ball(sketch, straight, first, end, value) >
                                     THICKER * typical_ball(sketch, stem, first, end, value);
    plm_free(value);
    return PLM_OK;
}

static plm_status take_straight(plm_sketch *sketch, size_t kink, double least, bool if_thicker, bool *done,
                                plm_error *error)
{
    plm_stem_path straight;
    double length;
    *done = false;
    plm_status status = go_straight(sketch, kink, &straight, &length, error);
    if (status != PLM_OK) return status;
    bool taken = length >= least;
    if (taken && if_thicker) status = is_thicker(sketch, kink, &straight, &taken, error);
    if (status == PLM_OK && taken) {
        const plm_stem_path old = sketch->stem;
        sketch->stem = straight;
        straight = old;
        *done = true;
    }
    plm_stem_path_free(&straight);
    return status;
}

plm_status plm_stem_straighten(plm_sketch *sketch, size_t kink, double least, bool *done, plm_error *error)
{
    return take_straight(sketch, kink, least, false, done, error);
}

plm_status plm_stem_leave_thin(plm_sketch *sketch, double least, bool *done, plm_error *error)
{
    *done = false;
    plm_status status = PLM_OK;
    for (size_t n = FORKED + COMPARED; n + FORKED + ARM < sketch->stem.count && !*done && status == PLM_OK; n++) {
        const plm_stem_path *stem = &sketch->stem;
        const double turn = plm_stem_turn(stem, n);
        if (turn < KINK || turn < plm_stem_turn(stem, n - 1) || turn < plm_stem_turn(stem, n + 1)) continue;
        const size_t end = n + FORKED + COMPARED < stem->count ? n + FORKED + COMPARED : stem->count;
        const double below = plm_stem_mean_radius(stem, n - FORKED - COMPARED, n - FORKED);
        if (plm_stem_mean_radius(stem, n + FORKED, end) > THINNER * below) continue;
        status = take_straight(sketch, n, least, true, done, error);
    }
    return status;
}

plm_status plm_stem_leave_turn(plm_sketch *sketch, bool *done, plm_error *error)
{
    const plm_stem_path *stem = &sketch->stem;
    *done = false;
    if (!stem->count) return PLM_OK;
    const double length = stem->along[stem->count - 1], from = LAST_PART * length;
    const double to = length - LEAF_LONG * sketch->scale.radius;
    for (size_t n = ARM; n + ARM < stem->count; n++) {
        const double turn = plm_stem_turn(stem, n);
        if (stem->along[n] < from || stem->along[n] > to || turn < WRONG) continue;
        if (turn >= plm_stem_turn(stem, n - 1) && turn >= plm_stem_turn(stem, n + 1))
            return plm_stem_straighten(sketch, n, 0, done, error);
    }
    return PLM_OK;
}
