/* segment/tip_leaf.c: a young leaf that is no wider than the balls which suit the stem looks like tube all over, and standing upright at the
 * top it takes the way up the stem into it. But it is longer than what is left of a stem above its last leaf, and its points lie off
 * the way's line as those of a stem do not. */
#include "segment/tip_leaf.h"

#include "segment/scratch.h"
#include "segment/stem_fit.h"

#include <math.h>

/* In radii of the stem, beyond the last leaf's foot: so much may still be stem, and a leaf is longer than so much. (Of 159 virtual plants in
 * three modes 157 end 3.3 beyond it at most, and two in noise of 0.4 radii 12 and 21; with a leaf on them 6.6 to 18.) */
static const double REST = 1.5, LONG = 5;
/* Three of four of a stem's points lie nearer to its line than so many radii (1.2; of such leaves 1.6 to 4.4), also beside a bare twig in
 * most of so many stretches of the way, ... */
static const double WIDE = 1.4;
enum { STRETCHES = 4, WIDE_LEAST = 3 };
/* ... in noise of so much of its radius, at most: more makes rags about it. (0.07 to 0.18 of three young tomatoes.) */
static const double CLEAR = 0.25;
/* So large a share of the points that the other leaves have, by their median, where so many tell. (0.17 to 0.31 of three young tomatoes; of stems that
 * went astray 0.09 at most.) */
static const double LARGE = 0.13;
enum { OTHERS_LEAST = 2, NODES_LEAST = 4 /* that a path keeps */ };

static double last_foot(const plm_side_groups *groups)
{
    double last = 0;
    for (size_t g = 0; g < groups->count; g++)
        if (groups->group[g].has_foot && groups->group[g].blades) last = fmax(last, groups->group[g].along);
    return last;
}

/* What lies on the way beyond a place along it, and hangs there without a blade. */
typedef struct tip {
    double along, end; /* from where to where on the way */
    bool *beyond;      /* of each point */
    float *off;        /* of those points, stretch by stretch: distance from the way */
    size_t points, first[STRETCHES + 1];
} tip;

static int stretch_of(const tip *t, double along)
{
    const int stretch = (int)((along - t->along) / (t->end - t->along) * STRETCHES);
    return stretch < 0 ? 0 : stretch < STRETCHES ? stretch : STRETCHES - 1;
}

static bool is_beyond(const plm_sketch *s, const plm_side_groups *groups, double along, size_t i, double place)
{
    if (s->is_stem[i]) return place > along;
    const plm_side_group *group = s->group[i] < 0 ? NULL : &groups->group[s->group[i]];
    return group && group->has_foot && !group->blades && group->along > along;
}

static void find_tip(const plm_sketch *s, const plm_side_groups *groups, tip *t, plm_scratch *scratch)
{
    const size_t count = s->working.count;
    t->beyond = plm_scratch_take(scratch, count, sizeof *t->beyond);
    t->off = plm_scratch_take(scratch, count, sizeof *t->off);
    float *off = plm_scratch_take(scratch, count, sizeof *off);
    int *stretch = plm_scratch_take(scratch, count, sizeof *stretch);
    if (scratch->failed) return;
    for (size_t i = 0; i < count; i++) {
        plm_stem_place place = {0};
        off[i] = (float)plm_stem_nearest(&s->stem, s->working.xyz[i], &place);
        stretch[i] = stretch_of(t, place.along);
        t->beyond[i] = is_beyond(s, groups, t->along, i, place.along);
        if (t->beyond[i]) t->points++, t->first[stretch[i] + 1]++;
    }
    size_t next[STRETCHES];
    for (int k = 0; k < STRETCHES; k++) {
        t->first[k + 1] += t->first[k];
        next[k] = t->first[k];
    }
    for (size_t i = 0; i < count; i++)
        if (t->beyond[i]) t->off[next[stretch[i]]++] = off[i];
}

/* Whether it is wider than a stem of radius r along the way. */
static bool is_wide(const tip *t, double r)
{
    int wide = 0;
    for (int k = 0; k < STRETCHES; k++)
        wide += plm_quantile(t->off + t->first[k], t->first[k + 1] - t->first[k], 0.75) > WIDE * r;
    return wide >= WIDE_LEAST;
}

plm_status plm_tip_leaf(plm_sketch *sketch, const plm_side_groups *groups, bool *found, plm_error *error)
{
    plm_stem_path *stem = &sketch->stem;
    *found = false;
    if (stem->count <= NODES_LEAST) return PLM_OK;
    const double r = plm_stem_mean_radius(stem, 0, stem->count), last = last_foot(groups), along = last + REST * r;
    if (!(last > 0) || !(stem->along[stem->count - 1] - last > LONG * r)) return PLM_OK;
    if (!(sketch->scale.noise < CLEAR * r)) return PLM_OK;
    plm_scratch scratch = {.error = error};
    tip t = {.along = along, .end = stem->along[stem->count - 1]};
    size_t *points = plm_scratch_take(&scratch, groups->count + 1, sizeof *points);
    double *value = plm_scratch_take(&scratch, groups->count + 1, sizeof *value), usual = 0;
    if (!scratch.failed) usual = plm_side_groups_usual_points(sketch, groups, OTHERS_LEAST, points, value);
    if (usual > 0) find_tip(sketch, groups, &t, &scratch);
    if (!scratch.failed && usual > 0) {
        const double least = fmax(LARGE * usual, plm_blade_least_points(sketch));
        *found = (double)t.points > least && is_wide(&t, r);
    }
    for (size_t i = 0; *found && i < sketch->working.count; i++)
        if (t.beyond[i]) sketch->is_tube[i] = false;
    while (*found && stem->count > NODES_LEAST && stem->along[stem->count - 1] > along) stem->count--;
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
