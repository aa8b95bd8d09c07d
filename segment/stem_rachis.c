/* segment/stem_rachis.c: the leaflets of a compound leaf seem to sit on the stem where the way up ran on into their rachis: beyond
 * the last leaf that has a rachis of its own nothing but single blades hangs on the way, at short tubes if at any. Where the way
 * turns down it has gone through leaflets that touch, and whatever hangs on it from there on is no leaf on the stem. */
#include "segment/stem_rachis.h"

#include "cloud/linear.h"
#include "segment/stem_fit.h"

#include <math.h>

static const double BLADES_LEAST = 1.5;   /* a leaf below: the plant has compound leaves */
static const double LEAFLET_TUBE = 0.25;  /* of their tubes: a single blade with less may be a leaflet, ... */
static const double LEAFLETS_TUBE = 0.15; /* ... and some that touch, with less than this */
static const double FORK_BEFORE = 1.5; /* the way may leave the stem this far (in R) before the last leaf's foot, ... */
static const double LEAFLET_BEFORE = 1.5; /* ... and rather leaves it this far before the first leaflet's */
static const double BEND = 0.35;          /* turns (radians) and ... */
static const double DROP = 0.25;          /* ... losses of radius that count as one unit of evidence */
static const double EVIDENCE_LEAST = 0.8; /* less tells nothing */
enum {
    COMPOUND_LEAST = 2,
    LEAFLETS_LEAST = 2,
    MARGIN = 3, /* nodes of an arm at least */
};

/* Whether what hangs at a foot may be leaflets of one leaf; usual: tube of the plant's compound leaves. */
static bool are_leaflets(const plm_side_group *group, double usual)
{
    return group->tube_length < (group->blades > 1 ? LEAFLETS_TUBE : LEAFLET_TUBE) * usual;
}

/* Median tube of the compound leaves on the stem; 0: the plant has simple leaves. value: scratch. */
static double usual_rachis(const plm_side_groups *groups, double end, double petiole, float *value)
{
    size_t blades = 0, leaves = 0, count = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along >= end) continue;
        if (group->tube_length < petiole * (double)group->blades) continue;
        blades += group->blades;
        leaves++;
        if (group->blades > 1) value[count++] = (float)group->tube_length;
    }
    if (count < COMPOUND_LEAST || (double)blades < BLADES_LEAST * (double)leaves) return 0;
    return plm_quantile(value, count, 0.5);
}

/* The node between two arc lengths where the way most likely leaves the stem, 0: none. Leaflets may hide that a rachis is thin. */
static size_t best_exit(const plm_stem_path *stem, double from, double to)
{
    size_t best = 0;
    double most = EVIDENCE_LEAST;
    for (size_t n = PLM_STEM_NEAR + MARGIN; n + PLM_STEM_NEAR + MARGIN < stem->count; n++) {
        if (stem->along[n] < from || stem->along[n] > to) continue;
        double below[3], above[3];
        const double before = plm_stem_look(stem, n, -1, below), beyond = plm_stem_look(stem, n, 1, above);
        const double turn = acos(fmax(-1, fmin(1, plm_dot(below, above))));
        const double evidence = turn / BEND + fmax(1 - beyond / before, 0) / DROP;
        if (evidence > most) {
            most = evidence;
            best = n;
        }
    }
    return best;
}

/* Whether a blade that may be a leaflet stands among the leaves with rachises, up to the last one: then not each leaf has one (straps
 * that noise tore into blades look so). */
static bool has_blade_between(const plm_side_groups *groups, double usual, double last)
{
    double lowest = INFINITY, highest = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along > last) continue;
        if (are_leaflets(group, usual))
            highest = fmax(highest, group->along);
        else if (group->blades > 1)
            lowest = fmin(lowest, group->along);
    }
    return highest > lowest;
}

plm_status plm_stem_leave_rachis(plm_sketch *sketch, const plm_side_groups *groups, double end, double petiole,
                                 bool *done, plm_error *error)
{
    const double R = sketch->scale.radius;
    *done = false;
    float *value = plm_alloc(groups->count + 1, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    const double hairpin = plm_stem_hairpin(&sketch->stem);
    const double usual = usual_rachis(groups, fmin(end, hairpin), petiole, value);
    plm_free(value);
    double last = 0, first = INFINITY;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along > hairpin) continue;
        if (!are_leaflets(group, usual)) last = fmax(last, group->along);
    }
    size_t leaflets = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along <= last) continue;
        leaflets += group->blades;
        first = fmin(first, group->along);
    }
    if (!(usual > 0) || !(last > 0) || leaflets < LEAFLETS_LEAST) return PLM_OK;
    if (has_blade_between(groups, usual, last)) return PLM_OK;
    const double from = last - FORK_BEFORE * R;
    size_t node = best_exit(&sketch->stem, from, first - LEAFLET_BEFORE * R);
    if (!node) node = best_exit(&sketch->stem, from, first);
    return node ? plm_stem_straighten(sketch, node, 0, done, error) : PLM_OK;
}
