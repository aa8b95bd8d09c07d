/* segment/leaves.c: from side groups to leaves: what hangs on one foot is one leaf, its blades are leaflets. */
#include "cloud/linear.h"
#include "segment/broken_tubes.h"
#include "segment/habit.h"
#include "segment/junction.h"
#include "segment/leaflet_stalks.h"
#include "segment/rosette_core.h"
#include "segment/round_leaves.h"
#include "segment/scratch.h"
#include "segment/side_groups.h"
#include "segment/strap_leaves.h"
#include "segment/tip_leaf.h"

#include <math.h>
#include <stdlib.h>

/* Tubes without a leaf that are so near, in R, to the petioles of a rosette are their feet. */
static const double FEET = 2;

/* Of a length of leaflet over one of rachis: a leaflet that touches another leaf's is nearer to that one's foot, but its own rachis
 * leads to it without crossing another leaflet. */
static const double LEAFLET_COST = 2;
/* A blade on less than so much tube (in R), smaller than such a share of the leaf that stands on the stem so near (in R), is no
 * leaf of a compound plant but a leaflet: leaves have petioles. */
static const double LEAFLET_TUBE = 0.3, LEAFLET_AREA = 0.25, LEAFLET_REACH = 2;

/* Where a leaf comes in the count. */
typedef struct place {
    double along, azimuth;
    int32_t leaf;
} place;

static int by_place(const void *a, const void *b)
{
    const place *p = a, *q = b;
    if (p->along != q->along) return p->along < q->along ? -1 : 1;
    if (p->azimuth != q->azimuth) return p->azimuth < q->azimuth ? -1 : 1;
    return (p->leaf > q->leaf) - (p->leaf < q->leaf);
}

/* Numbers the leaves from the base up: by foot along the stem, those without a foot (INFINITY) after them by height. */
static plm_status number_leaves(plm_sketch *sketch, const double *along, size_t leaves, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    double(*mean)[4] = plm_scratch_take(&scratch, leaves + 1, sizeof *mean);
    place *order = plm_scratch_take(&scratch, leaves + 1, sizeof *order);
    int32_t *number = plm_scratch_take(&scratch, leaves + 1, sizeof *number);
    if (!scratch.failed) {
        for (size_t i = 0; i < sketch->working.count; i++) {
            if (sketch->leaf[i] < 0) continue;
            double *m = mean[sketch->leaf[i]];
            for (int axis = 0; axis < 3; axis++) m[axis] += sketch->working.xyz[i][axis];
            m[3]++;
        }
        for (size_t k = 0; k < leaves; k++) {
            const double foot = isfinite(along[k]) ? along[k] : 1e3 * sketch->scale.size + mean[k][2] / mean[k][3];
            order[k] = (place){foot, atan2(mean[k][1], mean[k][0]), (int32_t)k};
        }
        qsort(order, leaves, sizeof *order, by_place);
        for (size_t k = 0; k < leaves; k++) number[order[k].leaf] = (int32_t)k;
        for (size_t i = 0; i < sketch->working.count; i++)
            if (sketch->leaf[i] >= 0) sketch->leaf[i] = number[sketch->leaf[i]];
        sketch->leaf_count = leaves;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Leaflets: the blades of a leaf that are large enough, numbered within it. */
static plm_status number_leaflets(plm_sketch *sketch, const plm_side_groups *groups, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    int32_t *number = plm_scratch_take(&scratch, groups->blade_count + 1, sizeof *number);
    int32_t *next = plm_scratch_take(&scratch, groups->count + 1, sizeof *next);
    for (size_t b = 0; !scratch.failed && b < groups->blade_count; b++)
        number[b] = groups->blade_area[b] < plm_blade_least(sketch) ? -1 : next[groups->blade_group[b]]++;
    for (size_t i = 0; !scratch.failed && i < sketch->working.count; i++)
        sketch->leaflet[i] = groups->blade[i] >= 0 && sketch->leaf[i] >= 0 ? number[groups->blade[i]] : -1;
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* A rosette has no stem: tubes at its core that bear no leaf are the feet of the petioles that they touch. What reaches
 * farther hangs below or is a piece of something else, and is no organ. */
static plm_status give_feet(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    uint32_t *source = plm_scratch_take(&scratch, count, sizeof *source);
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    int32_t *origin = plm_scratch_take(&scratch, count, sizeof *origin);
    size_t sources = 0;
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    for (uint32_t i = 0; i < count && status == PLM_OK; i++)
        if (sketch->leaf[i] >= 0) source[sources++] = i;
    const plm_walk walk = {.source = source,
                           .source_count = sources,
                           .limit = FEET * sketch->scale.radius,
                           .distance = distance,
                           .origin = origin};
    if (status == PLM_OK) status = plm_graph_walk(&sketch->graph, &walk, error);
    for (size_t i = 0; i < count && status == PLM_OK; i++) {
        if (sketch->leaf[i] >= 0 || !sketch->is_tube[i]) continue;
        if (origin[i] >= 0)
            sketch->leaf[i] = sketch->leaf[source[origin[i]]];
        else
            sketch->is_tube[i] = false;
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* The group whose leaf a small blade without a petiole is a leaflet of: of those about its place on the stem that have a
 * petiole and a far larger blade the nearest; -1: none. */
static int32_t leaf_of_leaflet(const plm_sketch *sketch, const plm_side_groups *groups, size_t leaflet)
{
    const double R = sketch->scale.radius;
    const plm_side_group *own = &groups->group[leaflet];
    int32_t best = -1;
    double nearest = LEAFLET_REACH * R;
    if (!own->has_foot || own->blades != 1 || own->tube_length > LEAFLET_TUBE * R) return -1;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        const double gap = fabs(group->along - own->along);
        if (!group->has_foot || !group->blades || group->tube_length <= LEAFLET_TUBE * R || !(gap < nearest)) continue;
        if (own->blade_area > LEAFLET_AREA * group->blade_area) continue;
        nearest = gap;
        best = (int32_t)g;
    }
    return best;
}

/* The lowest leaflets of a leaf may lie so near to the stem that they make feet of their own. */
static plm_status join_leaflets(plm_sketch *sketch, plm_side_groups *groups, plm_error *error)
{
    int32_t *to = plm_alloc(groups->count + 1, sizeof *to, error);
    if (!to) return PLM_E_MEMORY;
    for (size_t g = 0; g < groups->count; g++) to[g] = leaf_of_leaflet(sketch, groups, g);
    for (size_t b = 0; b < groups->blade_count; b++) {
        int32_t *group = &groups->blade_group[b];
        if (*group >= 0 && to[*group] >= 0) *group = to[*group];
    }
    for (size_t i = 0; i < sketch->working.count; i++)
        if (sketch->group[i] >= 0 && to[sketch->group[i]] >= 0) sketch->group[i] = to[sketch->group[i]];
    for (size_t g = 0; g < groups->count; g++) {
        if (to[g] < 0) continue;
        plm_side_group *host = &groups->group[to[g]], *own = &groups->group[g];
        host->blades += own->blades, host->blade_area += own->blade_area;
        own->blades = 0, own->blade_area = 0;
    }
    plm_free(to);
    return PLM_OK;
}

/* One leaf a group that has a blade. */
static plm_status leaves_of_groups(plm_sketch *sketch, const plm_side_groups *groups, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    int32_t *leaf_of = plm_scratch_take(&scratch, groups->count + 1, sizeof *leaf_of);
    double *along = plm_scratch_take(&scratch, groups->count + 1, sizeof *along);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) {
        size_t leaves = 0;
        for (size_t g = 0; g < groups->count; g++) {
            leaf_of[g] = groups->group[g].blades ? (int32_t)leaves : -1;
            if (groups->group[g].blades) along[leaves++] = groups->group[g].along;
        }
        for (size_t i = 0; i < sketch->working.count; i++)
            sketch->leaf[i] = sketch->group[i] >= 0 && !sketch->is_stem[i] ? leaf_of[sketch->group[i]] : -1;
        status = number_leaves(sketch, along, leaves, error);
        if (status == PLM_OK && sketch->habit == PLM_HABIT_ROSETTE) status = give_feet(sketch, error);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* All of a bare stem is stem: the branches too, and the specks of blade that noise makes of them. */
static void no_leaves(plm_sketch *sketch)
{
    for (size_t i = 0; i < sketch->working.count; i++) {
        sketch->leaf[i] = -1;
        sketch->is_tube[i] = true;
    }
    sketch->leaf_count = 0;
}

static plm_status leaves_without_petioles(plm_sketch *sketch, plm_error *error)
{
    double *along = NULL;
    size_t leaves = 0;
    plm_status status = plm_sketch_upright_stem(sketch, error);
    if (status == PLM_OK) status = plm_strap_leaves(sketch, &along, &leaves, error);
    if (status == PLM_OK) status = number_leaves(sketch, along, leaves, error);
    plm_free(along);
    return status;
}

static plm_status find_groups_again(plm_sketch *sketch, double blade_cost, plm_side_groups *groups, plm_error *error)
{
    plm_side_groups_free(groups);
    return plm_side_groups_find(sketch, blade_cost, groups, error);
}

/* What hangs on the stem; petioles that a gap parts from their leaves are linked with them first. */
static plm_status find_groups(plm_sketch *sketch, plm_side_groups *groups, plm_error *error)
{
    size_t links = 0;
    plm_status status = plm_side_groups_find(sketch, 1, groups, error);
    if (status == PLM_OK && sketch->stem.count) status = plm_bridge_tubes(sketch, groups, &links, error);
    return status == PLM_OK && links ? find_groups_again(sketch, 1, groups, error) : status;
}

/* Prepares the groups of plants of leaves with petioles, so that each is one leaf; they are found anew where leaves that look like
 * tube got blades, and by the costs that suit compound leaves. */
static plm_status make_groups_leaves(plm_sketch *sketch, plm_side_groups *groups, plm_error *error)
{
    const bool is_compound = sketch->habit == PLM_HABIT_COMPOUND;
    if (sketch->habit != PLM_HABIT_SIMPLE && !is_compound) return PLM_OK;
    bool found = false, has_tip = false;
    plm_status status = plm_tip_leaf(sketch, groups, &has_tip, error);
    if (status == PLM_OK) status = plm_round_leaves(sketch, groups, &found, error);
    found = found || has_tip;
    if (status == PLM_OK && found) status = plm_sketch_tidy(sketch, error);
    if (status == PLM_OK && found) plm_sketch_mark_stem(sketch);
    if (status == PLM_OK && (found || is_compound))
        status = find_groups_again(sketch, is_compound ? LEAFLET_COST : 1, groups, error);
    if (status != PLM_OK) return status;
    /* Where the stem's line ended early, its rest is one foot of several petioles. */
    if (!is_compound) return plm_side_groups_split(sketch, groups, error);
    status = plm_leaflet_stalks(sketch, LEAFLET_COST, groups, error);
    return status == PLM_OK ? join_leaflets(sketch, groups, error) : status;
}

plm_status plm_sketch_leaves(plm_sketch *sketch, plm_error *error)
{
    plm_side_groups groups = {0};
    plm_status status = find_groups(sketch, &groups, error);
    if (status == PLM_OK && sketch->scale.has_tubes && !sketch->stem.count) {
        status = plm_side_groups_split(sketch, &groups, error);
        if (status == PLM_OK) status = plm_side_groups_young(sketch, &groups, error);
    }
    if (status == PLM_OK) {
        sketch->habit = sketch->asked;
        if (sketch->asked == PLM_HABIT_UNKNOWN) status = plm_habit_guess(sketch, &groups, &sketch->habit, error);
    }
    if (status == PLM_OK && sketch->stem.count) status = make_groups_leaves(sketch, &groups, error);
    if (status == PLM_OK) {
        if (sketch->habit == PLM_HABIT_BARE_STEM)
            no_leaves(sketch);
        else if (sketch->habit == PLM_HABIT_STRAP && sketch->stem.count)
            status = leaves_without_petioles(sketch, error);
        else
            status = leaves_of_groups(sketch, &groups, error);
    }
    if (status == PLM_OK && sketch->habit == PLM_HABIT_COMPOUND) status = number_leaflets(sketch, &groups, error);
    if (status == PLM_OK) status = plm_sketch_junctions(sketch, &groups, error);
    if (status == PLM_OK && sketch->habit == PLM_HABIT_ROSETTE && !sketch->stem.count)
        status = plm_rosette_core(sketch, groups.distance, error);
    for (size_t i = 0; status == PLM_OK && i < sketch->working.count; i++)
        if (sketch->habit == PLM_HABIT_STRAP && sketch->leaf[i] >= 0) sketch->is_tube[i] = false;
    plm_side_groups_free(&groups);
    return status;
}
