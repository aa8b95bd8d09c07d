/* segment/stem_end.c: where the stem ends. The way through thick tubes may run on into the petiole of the topmost leaf:
 * then the blades at its end seem to sit on the stem without the petioles that the other leaves have. */
#include "segment/rosette_stem.h"
#include "segment/side_groups.h"
#include "segment/stem_fit.h"
#include "segment/stem_rachis.h"

#include <math.h>

static const double END_REACH = 2;      /* feet this near to the path's end (in R) are at its end */
static const double SESSILE = 0.4;      /* of the other leaves' petioles: a shorter tube is none */
static const double PETIOLES_LEAST = 2; /* median length of the others' tubes in R: else the plant has no petioles */
static const double PETIOLES_FOR_KINK = 0.6; /* the same where the path turns */
static const double INTERNODE_LEAST = 2;     /* the stem goes on beyond a turn with leaves on it, in R */
enum { ROUNDS = 3, ARM = 6 };
static const double SHARP_TURN = 0.5; /* radians; stems turn less at a node, ... */
static const double SHARP_REACH = 2;  /* ... and the turn is within so many R of the foot */
static const double BARE_LEAST = 2;   /* a stretch without feet before the end, in R: the petiole */
static const double STUB = 0.7;       /* a side tube without blade this long (in R) is a foot as well */
static const double CUT_BEYOND = 0.3; /* the cut is so far (in R) beyond the last foot when nothing tells better, ... */
static const double CUT_END = 1.25;   /* ... and so far before the path's end, where its direction is not known */
static const double BEND = 0.35;      /* kinks (radians) and ... */
static const double DROP = 0.25;      /* ... losses of radius that count as one unit of evidence */
static const double EVIDENCE_LEAST = 0.8; /* less tells nothing: ... */
static const double AS_THICK = 0.88;      /* ... then a stretch with so much of the radius that the path has ... */
static const double THICK_BELOW = 6;      /* ... over so many R below is the stem's last internode */

static double tube_of_blade(const plm_side_group *group)
{
    return group->tube_length / (double)group->blades;
}

/* Median tube length of a blade, of the leafy groups that do not stand at the path's end. */
static double typical_petiole(const plm_side_groups *groups, double end, float *value)
{
    size_t count = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (group->has_foot && group->blades && group->along < end) value[count++] = (float)tube_of_blade(group);
    }
    return plm_quantile(value, count, 0.5);
}

/* The node between two arc lengths at which the path turns and thins the most; told: enough to say that it leaves the stem there. */
static size_t best_cut(const plm_stem_path *stem, double from, double to, double fallback, bool *told)
{
    size_t best = 0;
    double most = EVIDENCE_LEAST;
    for (size_t n = 3; n + 3 < stem->count; n++) {
        if (stem->along[n] < from || stem->along[n] > to) continue;
        const double bend = plm_stem_turn(stem, n);
        const double beyond = plm_stem_mean_radius(stem, n, n + ARM < stem->count ? n + ARM : stem->count);
        const double drop = 1 - beyond / plm_stem_mean_radius(stem, n + 1 > ARM ? n + 1 - ARM : 0, n + 1);
        const double evidence = bend / BEND + drop / DROP;
        if (evidence > most) {
            most = evidence;
            best = n;
        }
    }
    *told = most > EVIDENCE_LEAST;
    while (!best || (!*told && best + 1 < stem->count && stem->along[best] < fallback)) best++;
    return best;
}

/* The last foot before the end, of a leaf with a petiole (least: its tube's least length) or of a tube without blade. What has
 * none may be leaflets of the petiole that the path ran into. */
static double last_foot(const plm_side_groups *groups, double end, double stub, double least)
{
    double last = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !(group->along < end)) continue;
        if (group->blades ? tube_of_blade(group) >= least : group->tube_length >= stub) last = fmax(last, group->along);
    }
    return last;
}

/* Leaves at least whose feet stand beyond a place: blades without petioles of their own may be leaflets of one. */
static size_t leaves_beyond(const plm_side_groups *groups, double place, double least)
{
    size_t count = 0, sessile = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along <= place) continue;
        if (tube_of_blade(group) >= least)
            count++;
        else
            sessile = 1;
    }
    return count + sessile;
}

/* What stands on the stem, as far as its end goes. */
typedef struct stem_top {
    plm_side_groups groups;
    double end;     /* arc length from which on a foot is at the path's end */
    double typical; /* median tube length of the other leaves' blades */
} stem_top;

/* Whether what stands on the way beyond a place begins with a leaf that has a petiole of its own: then the way is the stem there.
 * A petiole bears leaflets first. */
static bool is_stem_beyond(const stem_top *top, double place, double least)
{
    double petioled = INFINITY, sessile = INFINITY;
    for (size_t g = 0; g < top->groups.count; g++) {
        const plm_side_group *group = &top->groups.group[g];
        if (!group->has_foot || !group->blades || group->along <= place) continue;
        double *nearest = tube_of_blade(group) >= least ? &petioled : &sessile;
        *nearest = fmin(*nearest, fmin(group->along, top->end)); /* at the end there is no order */
    }
    return isfinite(petioled) && petioled <= sessile;
}

static plm_status find_top(plm_sketch *sketch, stem_top *top, plm_error *error)
{
    const plm_stem_path *stem = &sketch->stem;
    *top = (stem_top){.end = stem->along[stem->count - 1] - END_REACH * sketch->scale.radius};
    plm_status status = plm_side_groups_find(sketch, 1, &top->groups, error);
    if (status != PLM_OK) return status;
    float *value = plm_alloc(top->groups.count + 1, sizeof *value, error);
    if (!value) {
        plm_side_groups_free(&top->groups);
        return PLM_E_MEMORY;
    }
    top->typical = typical_petiole(&top->groups, top->end, value);
    plm_free(value);
    return PLM_OK;
}

/* The node about the last foot where the path turns as sharply as only petioles leave a stem: then what seems to stand
 * there may be the rest of the stem. 0: none. */
static size_t sharp_turn(const plm_stem_path *stem, double foot, double R)
{
    size_t best = 0;
    double most = SHARP_TURN;
    for (size_t n = 3; n + 3 < stem->count; n++) {
        if (fabs(stem->along[n] - foot) > SHARP_REACH * R) continue;
        const double turn = plm_stem_turn(stem, n);
        if (turn > most) most = turn, best = n;
    }
    return best;
}

/* Takes the path out of a petiole that it turned into at or beyond the last foot. A leaf beyond the turn beside the one
 * that the path ran into must stand on the straight continuation. */
static plm_status leave_petiole(plm_sketch *sketch, const stem_top *top, bool *done, plm_error *error)
{
    const double R = sketch->scale.radius, least = SESSILE * top->typical,
                 last = last_foot(&top->groups, top->end, STUB * R, least);
    *done = false;
    if (top->typical < PETIOLES_FOR_KINK * R || !(last > 0)) return PLM_OK;
    const size_t sharp = sharp_turn(&sketch->stem, last, R), bend = plm_stem_kink(&sketch->stem, last);
    const size_t kink = bend && plm_stem_zigzag(&sketch->stem, bend) ? 0 : bend;
    plm_status status = PLM_OK;
    if (sharp && (!kink || (sharp < kink && !is_stem_beyond(top, sketch->stem.along[sharp] + SHARP_REACH * R, least))))
        status = plm_stem_straighten(sketch, sharp, INTERNODE_LEAST * R, done, error);
    if (status == PLM_OK && !*done && kink) {
        const bool has_leaves = leaves_beyond(&top->groups, sketch->stem.along[kink] + 0.5 * R, least) > 1;
        status = plm_stem_straighten(sketch, kink, has_leaves ? INTERNODE_LEAST * R : 0, done, error);
    }
    if (*done) plm_sketch_mark_stem(sketch);
    return status;
}

/* Whether the path is as thick between two arc lengths as below. */
static bool is_as_thick(const plm_stem_path *stem, double from, double to, double below)
{
    double sum[2] = {0};
    size_t count[2] = {0};
    for (size_t n = 0; n < stem->count; n++) {
        const double along = stem->along[n];
        const int which = along > from && along < to ? 1 : along > from - below && along < from ? 0 : -1;
        if (which >= 0) sum[which] += stem->radius[n], count[which]++;
    }
    return count[0] && count[1] && sum[1] / (double)count[1] > AS_THICK * sum[0] / (double)count[0];
}

/* Cuts the path before a last stretch without feet, where the leaf at its end lacks the petiole that the others have. */
static void leave_sessile_end(plm_sketch *sketch, const stem_top *top)
{
    plm_stem_path *stem = &sketch->stem;
    const double R = sketch->scale.radius, length = stem->along[stem->count - 1];
    if (top->typical < PETIOLES_LEAST * R) return;
    bool is_sessile = false, has_petiole = false;
    double last = 0;
    for (size_t g = 0; g < top->groups.count; g++) {
        const plm_side_group *group = &top->groups.group[g];
        if (!group->has_foot || (!group->blades && group->tube_length < STUB * R)) continue;
        const bool sessile = group->blades && tube_of_blade(group) < SESSILE * top->typical;
        if (group->along >= top->end && sessile)
            is_sessile = true;
        else
            last = fmax(last, group->along);
        has_petiole |= group->along >= top->end && group->blades && !sessile;
    }
    if (!is_sessile || has_petiole || length - last <= BARE_LEAST * R) return;
    bool told;
    const size_t cut = best_cut(stem, last, length - CUT_END * R, last + CUT_BEYOND * R, &told);
    if (!told && is_as_thick(stem, last, length - CUT_END * R, THICK_BELOW * R)) return;
    stem->count = cut + 1;
    plm_sketch_mark_stem(sketch);
}

plm_status plm_sketch_stem_end(plm_sketch *sketch, plm_error *error)
{
    if (!sketch->stem.count) return PLM_OK;
    bool again = true, turned = false, forked, strayed = false;
    plm_status status = plm_stem_leave_thin(sketch, INTERNODE_LEAST * sketch->scale.radius, &forked, error);
    if (status == PLM_OK) status = plm_stem_leave_turn(sketch, &strayed, error);
    if (status == PLM_OK && (forked || strayed)) plm_sketch_mark_stem(sketch);
    for (int round = 0; round <= ROUNDS && again && status == PLM_OK; round++) {
        stem_top top;
        status = find_top(sketch, &top, error);
        if (status != PLM_OK) return status;
        bool left = false;
        again = false;
        /* A turn taken in the last round may have led into a rachis. */
        if (round == 0 || turned)
            status = plm_stem_leave_rachis(sketch, &top.groups, top.end, SESSILE * top.typical, &left, error);
        if (left) plm_sketch_mark_stem(sketch);
        if (status == PLM_OK && !left && round < ROUNDS) status = leave_petiole(sketch, &top, &again, error);
        if (status == PLM_OK && round == 0 && !left && !again) leave_sessile_end(sketch, &top);
        turned = again;
        again |= left && round == 0;
        plm_side_groups_free(&top.groups);
    }
    return status == PLM_OK ? plm_stem_drop_false(sketch, error) : status;
}
