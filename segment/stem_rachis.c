/* segment/stem_rachis.c: the leaflets of a compound leaf seem to sit on the stem where the way up ran on into their rachis: beyond
 * the last leaf that has a rachis of its own nothing but single blades hangs on the way, at short tubes if at any, or together at
 * the end of a long bare stretch. Where the way turns down it has gone through leaflets that touch, and whatever hangs on it from
 * there on is no leaf on the stem. */
#include "segment/stem_rachis.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "segment/stem_fit.h"

#include <math.h>

static const double BLADES_LEAST = 1.5;   /* a leaf below: the plant has compound leaves */
static const double LEAFLET_TUBE = 0.25;  /* of their tubes: a single blade with less may be a leaflet, ... */
static const double LEAFLETS_TUBE = 0.15; /* ... and some that touch, with less than this */
/* Leaflets that noise makes tube of in part have up to this, however many stand on a foot (of such ones 0.32), ... */
static const double FAR_TUBE = 0.4;
/* ... where the stretch between the last leaf and them is longer than so many times the longest internode (2.2; of 21 plants whose
 * topmost leaves have such tubes 0.3 to 1.1, and 1.6 of one with one such leaf), or than so many times so many R, ... */
static const double FAR = 1.5, INTERNODE_LEAST = 2;
static const double TOGETHER = 0.35;   /* ... and they lie within such a share of that stretch. */
static const double FORK_BEFORE = 1.5; /* the way may leave the stem this far (in R) before the last leaf's foot, ... */
static const double LEAFLET_BEFORE = 1.5; /* ... and rather leaves it this far before the first leaflet's */
static const double BEND = 0.35;          /* turns (radians) and ... */
static const double DROP = 0.25;          /* ... losses of radius that count as one unit of evidence */
static const double EVIDENCE_LEAST = 0.8; /* less tells nothing */
/* A peak of the evidence goes before what rises towards the leaflets if it is such a share of that. (0.92 of a soybean whose way turns
 * into the first leaflet; 0.4 of one that leaves the stem just before it.) */
static const double PEAK = 0.7;
enum {
    COMPOUND_LEAST = 2,
    LEAFLETS_LEAST = 2,
    MARGIN = 3, /* nodes of an arm at least */
};

/* Whether what hangs at a foot may be leaflets of one leaf; usual: tube of the plant's compound leaves. */
static bool are_leaflets(const plm_side_group *group, double usual, bool is_far)
{
    const double share = is_far ? FAR_TUBE : group->blades > 1 ? LEAFLETS_TUBE : LEAFLET_TUBE;
    return group->tube_length < share * usual;
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

/* How much says that the way leaves the stem at a node: INFINITY near its ends, which do not tell. */
static double exit_evidence(const plm_stem_path *stem, size_t n)
{
    if (n < PLM_STEM_NEAR + MARGIN || n + PLM_STEM_NEAR + MARGIN >= stem->count) return INFINITY;
    double below[3], above[3];
    const double before = plm_stem_look(stem, n, -1, below), beyond = plm_stem_look(stem, n, 1, above);
    const double turn = acos(fmax(-1, fmin(1, plm_dot(below, above))));
    return turn / BEND + fmax(1 - beyond / before, 0) / DROP;
}

/* The node between two arc lengths where the way most likely leaves the stem, 0: none. Leaflets may hide that a rachis is thin. is_peak:
 * only where there is no more evidence to either side: near the first leaflet the way may turn into that. */
static size_t best_exit(const plm_stem_path *stem, double from, double to, bool is_peak)
{
    size_t best = 0;
    double most = EVIDENCE_LEAST;
    for (size_t n = PLM_STEM_NEAR + MARGIN; n + PLM_STEM_NEAR + MARGIN < stem->count; n++) {
        if (stem->along[n] < from || stem->along[n] > to) continue;
        const double evidence = exit_evidence(stem, n);
        if (!(evidence > most)) continue;
        if (is_peak && (exit_evidence(stem, n - 1) > evidence || exit_evidence(stem, n + 1) > evidence)) continue;
        most = evidence;
        best = n;
    }
    return best;
}

/* What stands on the way beyond the last leaf that has a rachis. */
typedef struct way_top {
    double usual;           /* tube of the plant's compound leaves */
    bool is_far;            /* leaflets are told as where they stand far beyond the leaves */
    double last;            /* foot of the last leaf, 0: none */
    double lowest, highest; /* feet of the first and of the last leaflet */
    size_t feet, leaflets;
} way_top;

/* Writes all but usual and is_far of top. */
static void find_leaflets(const plm_side_groups *groups, double hairpin, way_top *top)
{
    top->last = top->highest = 0, top->lowest = INFINITY, top->feet = top->leaflets = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along > hairpin) continue;
        if (!are_leaflets(group, top->usual, top->is_far)) top->last = fmax(top->last, group->along);
    }
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along <= top->last) continue;
        top->feet++;
        top->leaflets += group->blades;
        top->lowest = fmin(top->lowest, group->along);
        top->highest = fmax(top->highest, group->along);
    }
}

/* Whether a blade that may be a leaflet stands among the leaves with rachises, up to the last one: then not each leaf has one (straps
 * that noise tore into blades look so). */
static bool has_blade_between(const plm_side_groups *groups, const way_top *top)
{
    double lowest = INFINITY, highest = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || !group->blades || group->along > top->last) continue;
        if (are_leaflets(group, top->usual, top->is_far))
            highest = fmax(highest, group->along);
        else if (group->blades > 1)
            lowest = fmin(lowest, group->along);
    }
    return highest > lowest;
}

/* The longest internode between leaves up to the last one. value: scratch. */
static double longest_internode(const plm_side_groups *groups, double last, float *value)
{
    size_t count = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (group->has_foot && group->blades && group->along <= last) value[count++] = (float)group->along;
    }
    plm_order_sort(value, count);
    double longest = 0;
    for (size_t k = 1; k < count; k++) longest = fmax(longest, (double)value[k] - (double)value[k - 1]);
    return longest;
}

/* Whether the leaflets lie together at the end of a stretch that is longer by far than any internode below. */
static bool are_far(const plm_side_groups *groups, double R, const way_top *top, float *value)
{
    const double bare = top->lowest - top->last;
    const double internode = fmax(longest_internode(groups, top->last, value), INTERNODE_LEAST * R);
    return top->feet > 1 && bare > FAR * internode && top->highest - top->lowest < TOGETHER * bare;
}

/* Finds the leaflets on the way; false: there are none. Near to the leaves they have short tubes. Where noise makes tube of parts
 * of them they are told by their place. value: scratch. */
static bool find_top(const plm_side_groups *groups, double R, double hairpin, way_top *top, float *value)
{
    if (!(top->usual > 0)) return false;
    for (int pass = 0; pass < 2; pass++) {
        top->is_far = pass > 0;
        find_leaflets(groups, hairpin, top);
        if (!(top->last > 0)) return false;
        if (top->leaflets < LEAFLETS_LEAST) continue;
        return !has_blade_between(groups, top) && (!top->is_far || are_far(groups, R, top, value));
    }
    return false;
}

plm_status plm_stem_leave_rachis(plm_sketch *sketch, const plm_side_groups *groups, double end, double petiole,
                                 bool *done, plm_error *error)
{
    const double R = sketch->scale.radius, hairpin = plm_stem_hairpin(&sketch->stem);
    *done = false;
    float *value = plm_alloc(groups->count + 1, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    way_top top = {.usual = usual_rachis(groups, fmin(end, hairpin), petiole, value)};
    const bool found = find_top(groups, R, hairpin, &top, value);
    plm_free(value);
    if (!found) return PLM_OK;
    const double from = top.last - FORK_BEFORE * R;
    size_t node = best_exit(&sketch->stem, from, top.lowest - LEAFLET_BEFORE * R, false);
    const size_t peak = node ? best_exit(&sketch->stem, from, top.lowest - LEAFLET_BEFORE * R, true) : 0;
    if (peak && exit_evidence(&sketch->stem, peak) > PEAK * exit_evidence(&sketch->stem, node)) node = peak;
    if (!node) node = best_exit(&sketch->stem, from, top.lowest, false);
    return node ? plm_stem_straighten(sketch, node, 0, done, error) : PLM_OK;
}
