/* segment/stem_kink.c: a way that runs on into the petiole of the topmost leaf turns where that petiole leaves the stem.
 * The stem ends there, or goes on straight: as a bare tip, or as internodes whose leaves the way has missed. */
#include "segment/stem_fit.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

static const double KINK = 0.21;             /* radians: a turn that tells a petiole from its stem */
static const double KINK_AT_END = 0.25;      /* the same where the way ends before it has straightened again */
static const double PLATEAU = 0.95;          /* of the largest turn: as large */
static const double AROUND = 1.3;            /* points within so many radii (plus noise) of a straight line are on it */
static const double PRESENT = 0.3;           /* of the points that the stem has on such a length: it goes on */
static const double PULL = 0.3, TURN = 0.15; /* how far a step follows the points, and the direction the steps */
enum { ARM = 6, RISING = 4, BELOW = 8, SKIPPED = 2, MISSED = 2, MOST_STEPS = 2000 };

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

plm_status plm_stem_straighten(plm_sketch *sketch, size_t kink, double least, bool *done, plm_error *error)
{
    *done = false;
    plm_stem_path *stem = &sketch->stem;
    const size_t from = kink > SKIPPED ? kink - SKIPPED : 0; /* smoothing has rounded the kink off */
    const double step = stem->along[from + 1] - stem->along[from], radius = stem->radius[from];
    const size_t most = from + 1 + MOST_STEPS;
    plm_stem_path longer = {.node = plm_alloc(most, sizeof *longer.node, error),
                            .radius = plm_alloc(most, sizeof *longer.radius, error),
                            .along = plm_alloc(most, sizeof *longer.along, error)};
    if (!longer.node || !longer.radius || !longer.along) {
        plm_stem_path_free(&longer);
        return PLM_E_MEMORY;
    }
    const plm_stem_path petiole = rest_of(stem, kink);
    const size_t added = follow(sketch, from, &petiole, step, radius, longer.node + from + 1);
    if ((double)added * step < least) {
        plm_stem_path_free(&longer);
        return PLM_OK;
    }
    *done = true;
    longer.count = from + 1 + (added > SKIPPED ? added : SKIPPED);
    memcpy(longer.node, stem->node, (from + 1) * sizeof *longer.node);
    memcpy(longer.radius, stem->radius, (from + 1) * sizeof *longer.radius);
    memcpy(longer.along, stem->along, (from + 1) * sizeof *longer.along);
    for (size_t n = from + 1; n < longer.count; n++) {
        double d[3];
        for (int axis = 0; axis < 3; axis++) d[axis] = longer.node[n][axis] - longer.node[n - 1][axis];
        longer.along[n] = longer.along[n - 1] + plm_norm(d);
        longer.radius[n] = radius;
    }
    plm_stem_path_free(stem);
    *stem = longer;
    return PLM_OK;
}
