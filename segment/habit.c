/* segment/habit.c: what kind of plant it is, from the leaves that hang on the stem's sides: their feet, their blades. */
#include "segment/habit.h"

#include "segment/scratch.h"

#include <math.h>

/* Straps are wide from their foot on, where petioles and rachises are narrow: so much of a leaf lies within the first NEAR of how far
 * it reaches from the stem, in shares of its points. What is nearer than OFF_STEM (in R) may be the stem's, thrown out by noise. Below
 * PETIOLES a leaf has a petiole, whatever noise makes of that; from SURE on it has none. (600 virtual plants with petioles, from 4 000
 * points and in 0 to 3 mm of noise: 0.02 to 0.206, large tomatoes in noise to 0.29; 90 maize 0.168 to 0.47; real maize and sorghum 0.21
 * to 0.45; real young tomatoes, whose cotyledons are long, 0.10 to 0.25, and from 0.2 on are better parted as straps.) */
static const double NEAR = 0.3, OFF_STEM = 0.25, PETIOLES = 0.15, SURE = 0.26;
/* Single blades have none from this on; compound leaves, whose lowest leaflets may be near, if feet and tubes (below) say so as well
 * (0.72 and more of two real tomatoes and a maize; 0 of a virtual tomato). */
static const double STRAPS = 0.2, STRAP_OF_MANY = 0.4;
/* Below that, too, single blades on feet as thick as the stem, without a petiole's tubes, are straps: both weigh half, by the area of the
 * leaves. (Of compound leaves feet alone say nothing: noise thickens rachises, 0.66 of a tomato.) */
static const double STRAP_TUBE = 0.85;  /* share of tube at a foot: less is no petiole, and ... */
static const double STRAP_RADIUS = 0.9; /* ... side tubes as thick as this, in radii of the stem, are leaf feet */
static const double STRAP_EVIDENCE = 0.5;
/* In less noise than this (in radii of the stem) what looks like tubes are no blades that it makes round. Their share off the stem then
 * says folds: it and what feet say, summed (0.75 of a real tomato of long cotyledons; 0.62 at most of others, 0.25 of virtual plants with
 * petioles). */
static const double CLEAR_NOISE = 0.2, STRAP_WITH_TUBES = 0.7;
/* More than this by themselves: straps that look like it, where no blade has a foot; or so few points that nothing tells petioles, as the
 * balls that hold enough of them are large against the plant (large tomatoes of 1 600 and 5 600 points, 0.074 and 0.054 of its size: F1 0.9
 * and 0.7 as straps, 0.6 and 0.3 with petioles; 0.03 is usual). */
static const double TUBE_LEAVES = 0.5, LARGE_BALLS = 0.04;
/* In more noise than this it hides feet, and parts what hangs far out from straps that touch at theirs, so that less of them seems near.
 * Their blades are long (squared length over area, both summed: 2.1 to 2.5 of six maize in 0.36 radii and more, 0.95 at most of plants with
 * petioles), and feet and tubes say something, summed (0.36 to 0.83; 0 of a pepper of 2.2). */
static const double STRAP_NOISE = 0.33, STRAP_LONG = 1.5, STRAP_HINT = 0.2;
/* Shares of all points, at least: 0.85 and 0.38 over 30 scans of bare stems; of straps 0.98 at most are tube and 0.38 on the stem,
 * but not both: those with 0.35 on it have 0.66 tube at most. */
static const double BARE_TUBES = 0.76, BARE_STEM = 0.35;
/* Where less than this is on the stem (straps have 0.41 at most), most of the rest must be slimmer than so many of its radii: the
 * median is 0.43 at most of bare stems with so little on the stem (0.57 of one with 0.57 on it), 0.68 at least of 8 straps that noise makes round. */
static const double BARE_ALONE = 0.5, BRANCH_RADIUS = 0.6;
/* A blade of more than this (in R squared) is a leaf, on however dense a stem: noise makes specks of 3.7 at most on 76 scans of bare
 * stems; the largest of four small leaves of a seedling, two thirds of whose points lay on the stem, had 5.9. */
static const double BARE_BLADE = 4.5;
/* Blades a leaf from which on leaves are compound: simple ones have one (1.17 at most over 90 virtual plants, where a scan
 * tore one), compound ones more even where noise tears them into leaves of their own (1.29 at least). Three on one foot are
 * no tear; without them more is asked for. */
static const double COMPOUND_BLADES = 1.23, COMPOUND_PAIRS = 1.4;
static const double ENDS = 0.02; /* quantile of distances: some points are strays */

/* How much a leaf looks like a strap by its foot. */
static double strap_evidence(const plm_sketch *sketch, const plm_side_group *group)
{
    const double ratio = group->tube_radius / sketch->scale.stem_radius;
    return 0.5 * (group->tube_share < STRAP_TUBE) + 0.5 * (ratio > STRAP_RADIUS || ratio == 0);
}

static void count_tubes(const plm_sketch *sketch, size_t *tubes, size_t *stem)
{
    *tubes = *stem = 0;
    for (size_t i = 0; i < sketch->working.count; i++) {
        *tubes += sketch->is_tube[i];
        *stem += sketch->is_stem[i];
    }
}

bool plm_leaves_look_like_tubes(const plm_sketch *sketch)
{
    size_t tubes, stem;
    count_tubes(sketch, &tubes, &stem);
    return sketch->scale.rises && 2 * tubes > sketch->working.count;
}

/* Share of what is off the stem that looks like tubes: petioles and branches are no half of it, blades are. Where more is,
 * tubes are folded straps, or blades that noise makes round. Where most of the tubes are on the stem, it is a bare one: 0. */
static double tube_leaves(const plm_sketch *sketch)
{
    size_t tubes, stem;
    count_tubes(sketch, &tubes, &stem);
    if (!sketch->stem.count || 2 * stem >= tubes) return 0;
    return (double)(tubes - stem) / (double)(sketch->working.count - stem);
}

/* Most of what is off the stem is as thick as branches of it are, if tubes. */
static bool has_slim_branches(const plm_sketch *sketch, size_t off)
{
    size_t slim = 0;
    for (size_t i = 0; i < sketch->working.count; i++)
        slim += !sketch->is_stem[i] && sketch->point[i].radius < BRANCH_RADIUS * sketch->scale.stem_radius;
    return 2 * slim >= off;
}

/* Nearly all is tube, and much of it on one stem: branches without leaves, among which noise makes specks of blade. Straps that
 * pass for tubes have far less on their stem, or are as broad as it in noise that makes them round. */
static bool is_bare(const plm_sketch *sketch, const plm_side_groups *groups)
{
    size_t tubes, stem;
    count_tubes(sketch, &tubes, &stem);
    const double leaf = BARE_BLADE * sketch->scale.radius * sketch->scale.radius;
    for (size_t b = 0; b < groups->blade_count; b++)
        if (groups->blade_area[b] > leaf) return false;
    const double all = (double)sketch->working.count;
    if ((double)tubes < BARE_TUBES * all || (double)stem < BARE_STEM * all) return false;
    return (double)stem >= BARE_ALONE * all || has_slim_branches(sketch, sketch->working.count - stem);
}

/* Distances from the stem, part by part: part k's are value[end[k - 1]] to value[end[k]]. */
typedef struct distances {
    float *value;
    size_t *end;
} distances;

/* part: of each point, -1: none; end: parts + 1, all 0 before. */
static void gather_distances(const plm_sketch *sketch, const plm_side_groups *groups, const int32_t *part, size_t parts,
                             distances *out)
{
    const size_t count = sketch->working.count;
    for (size_t i = 0; i < count; i++)
        if (part[i] >= 0 && isfinite(groups->distance[i])) out->end[part[i] + 1]++;
    for (size_t k = 0; k < parts; k++) out->end[k + 1] += out->end[k];
    for (size_t i = 0; i < count; i++) /* where a part's rows begin becomes where they end */
        if (part[i] >= 0 && isfinite(groups->distance[i])) out->value[out->end[part[i]]++] = groups->distance[i];
}

/* Rows of part k, and how many. */
static float *rows_of(const distances *all, size_t k, size_t *count)
{
    const size_t first = k ? all->end[k - 1] : 0;
    *count = all->end[k] - first;
    return all->value + first;
}

/* Squared length of the blades along the way from the stem over their area, both summed; 0 where there are none. */
static double blade_elongation(const plm_sketch *sketch, const plm_side_groups *groups, const distances *blades)
{
    double squared = 0, area = 0;
    for (size_t b = 0; b < groups->blade_count; b++) {
        size_t points;
        float *value = rows_of(blades, b, &points);
        if (groups->blade_area[b] < plm_blade_least(sketch) || !points) continue;
        const double length = plm_quantile(value, points, 1 - ENDS) - plm_quantile(value, points, ENDS);
        squared += length * length;
        area += groups->blade_area[b];
    }
    return area > 0 ? squared / area : 0;
}

/* Share of the leaves' points that lies within NEAR of how far their leaf reaches; STRAPS where none tells. */
static double near_share(const plm_sketch *sketch, const plm_side_groups *groups, const distances *leaves)
{
    const double off = OFF_STEM * sketch->scale.radius;
    size_t near = 0, all = 0;
    for (size_t g = 0; g < groups->count; g++) {
        size_t points;
        float *value = rows_of(leaves, g, &points);
        if (!groups->group[g].has_foot || !groups->group[g].blades) continue;
        const double reach = plm_quantile(value, points, 1 - ENDS) - off;
        for (size_t k = 0; k < points; k++) {
            if (value[k] < off) continue;
            near += value[k] - off < NEAR * reach;
            all++;
        }
    }
    return all ? (double)near / (double)all : STRAPS;
}

typedef struct leaf_shape {
    double elongation, near;
} leaf_shape;

static plm_status find_leaf_shape(const plm_sketch *sketch, const plm_side_groups *groups, leaf_shape *shape,
                                  plm_error *error)
{
    plm_scratch scratch = {.error = error};
    const size_t count = sketch->working.count;
    distances blades = {.value = plm_scratch_take(&scratch, count, sizeof *blades.value),
                        .end = plm_scratch_take(&scratch, groups->blade_count + 1, sizeof *blades.end)};
    distances leaves = {.value = plm_scratch_take(&scratch, count, sizeof *leaves.value),
                        .end = plm_scratch_take(&scratch, groups->count + 1, sizeof *leaves.end)};
    if (!scratch.failed) {
        gather_distances(sketch, groups, groups->blade, groups->blade_count, &blades);
        gather_distances(sketch, groups, sketch->group, groups->count, &leaves);
        shape->elongation = blade_elongation(sketch, groups, &blades);
        shape->near = near_share(sketch, groups, &leaves);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* What the leaves look like; evidence is weighed by area, of those that have feet. */
typedef struct leaf_tally {
    size_t leafy, blades, most; /* groups with blades, their blades, those of the group with the most */
    double area, strap;
} leaf_tally;

static leaf_tally count_leaves(const plm_sketch *sketch, const plm_side_groups *groups)
{
    leaf_tally tally = {0};
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->blades) continue;
        tally.leafy++;
        tally.blades += group->blades;
        if (group->blades > tally.most) tally.most = group->blades;
        if (!group->has_foot) continue;
        tally.area += group->blade_area;
        tally.strap += group->blade_area * strap_evidence(sketch, group);
    }
    return tally;
}

static bool are_compound(const leaf_tally *tally)
{
    const double least = tally->most >= 3 ? COMPOUND_BLADES : COMPOUND_PAIRS;
    return (double)tally->blades >= least * (double)tally->leafy;
}

static bool are_straps(const plm_sketch *sketch, const leaf_tally *tally, const leaf_shape *shape)
{
    const plm_scale *scale = &sketch->scale;
    const double tubes = tube_leaves(sketch);
    const bool is_clear = scale->noise < CLEAR_NOISE * scale->stem_radius;
    const bool is_sparse = is_clear && scale->radius > LARGE_BALLS * scale->size;
    if (!(tally->area > 0) || (is_sparse && tubes > TUBE_LEAVES)) return tubes > TUBE_LEAVES;
    if (shape->near < PETIOLES || shape->near > SURE) return shape->near > SURE;
    const double feet = tally->strap / tally->area;
    const bool is_noisy = scale->noise > STRAP_NOISE * scale->stem_radius;
    if (is_noisy && shape->elongation > STRAP_LONG && feet + tubes > STRAP_HINT) return true;
    if (are_compound(tally)) return shape->near > STRAPS && feet + tubes > STRAP_OF_MANY;
    return shape->near > STRAPS || feet > STRAP_EVIDENCE || (is_clear && feet + tubes > STRAP_WITH_TUBES);
}

plm_status plm_habit_guess(const plm_sketch *sketch, const plm_side_groups *groups, plm_habit *habit, plm_error *error)
{
    if (is_bare(sketch, groups)) {
        *habit = PLM_HABIT_BARE_STEM;
        return PLM_OK;
    }
    const leaf_tally tally = count_leaves(sketch, groups);
    leaf_shape shape = {0};
    const plm_status status = sketch->stem.count ? find_leaf_shape(sketch, groups, &shape, error) : PLM_OK;
    if (status != PLM_OK) return status;
    if (sketch->stem.count && are_straps(sketch, &tally, &shape))
        *habit = PLM_HABIT_STRAP;
    else if (!tally.leafy)
        *habit = sketch->scale.has_tubes ? PLM_HABIT_BARE_STEM : PLM_HABIT_SINGLE_LEAF;
    else if (!sketch->scale.has_tubes)
        *habit = tally.leafy > 1 ? PLM_HABIT_HEAD : PLM_HABIT_SINGLE_LEAF;
    else if (!sketch->stem.count)
        *habit = PLM_HABIT_ROSETTE;
    else
        *habit = are_compound(&tally) ? PLM_HABIT_COMPOUND : PLM_HABIT_SIMPLE;
    return PLM_OK;
}
