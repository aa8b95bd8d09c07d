/* segment/habit.c: what kind of plant it is, from the leaves that hang on the stem's sides: their feet, their blades. */
#include "segment/habit.h"

#include "segment/scratch.h"

#include <math.h>

static const double STRAP_TUBE = 0.85;  /* share of tube at a foot: less is no petiole, and ... */
static const double STRAP_RADIUS = 0.9; /* ... side tubes as thick as this, in radii of the stem, are leaf feet */
/* Both weigh half, by the area of the leaves; more than this: strap leaves, ... */
static const double STRAP_EVIDENCE = 0.5;
static const double STRAP_RISING = 0.36; /* ... or than this where larger balls find more tubes: the folds of straps */
static const double TUBE_LEAVES = 0.5;   /* more of what is off the stem is tube: straps, ... */
/* ... unless larger balls find no more tubes, the leaves have many blades (below; three on one foot), and these begin farther from
 * the stem than they are long: noise makes leaflets round (three tomatoes in a quarter of the stem's radius of it: 0.52 to 0.58
 * tube, beginning at 1.87 and more; of straps that larger balls do not make tubes those with many blades begin at 0.29). */
static const double ON_RACHISES = 1;
/* Shares of all points, at least: 0.85 and 0.38 over 30 scans of bare stems; of straps 0.98 at most are tube and 0.38 on the stem,
 * but not both: those with 0.35 on it have 0.66 tube at most. */
static const double BARE_TUBES = 0.76, BARE_STEM = 0.35;
/* Where less than this is on the stem (straps have 0.41 at most), most of the rest must be slimmer than so many of its radii: the
 * median is 0.43 at most of bare stems with so little on the stem (0.57 of one with 0.57 on it), 0.68 at least of 8 straps that noise makes round. */
static const double BARE_ALONE = 0.5, BRANCH_RADIUS = 0.6;
/* A blade of more than this (in R squared) is a leaf, on however dense a stem: noise makes specks of 3.7 at most on 76 scans of bare
 * stems; the largest of four small leaves of a seedling, two thirds of whose points lay on the stem, had 5.9. */
static const double BARE_BLADE = 4.5;
/* Noise thickens blades, and a foot may be a little slimmer than the stem: neither says enough then, and both together do, where
 * feet count from this many radii on (0.98 of a maize that neither told, 0.67 at most over 190 plants with petioles). */
static const double STRAP_SLIM = 0.7, STRAP_WITH_TUBES = 0.73;
/* Straps have one blade, seldom two a leaf where noise tears them: from so many on, straps ask for more than thick feet by
 * themselves give (two real maize of 2.4 and more blades give 0.91 and more), and slim ones say nothing: balls that suit a stem
 * are large for the rachises of many leaves, which then look thick (0.52 and 0.54 of a real and a virtual tomato of 1.6 and 1.8
 * blades; straps that are not folded have 1.5 at most). Not where straps are folded: their feet alone tell. */
static const double MANY_BLADES = 1.55, STRAP_OF_MANY = 0.65;
/* Blades a leaf from which on leaves are compound: simple ones have one (1.17 at most over 90 virtual plants, where a scan
 * tore one), compound ones more even where noise tears them into leaves of their own (1.29 at least). Three on one foot are
 * no tear; without them more is asked for. */
static const double COMPOUND_BLADES = 1.23, COMPOUND_PAIRS = 1.4;
/* Of their length: blades of compound leaves that begin farther from the stem are on petioles or rachises, which noise makes look
 * thick; thick feet alone make straps of them only from so much evidence on (slimmer ones with tubes as before: they told a maize at
 * 0.54). Straps that thick feet tell begin at 0.42 at most, nearly all at less than a third (26 virtual ones from depth cameras, 15
 * real ones); 200 virtual plants with petioles at 0.45 and more. Two of those that begin beyond a half had thick feet: a tomato in
 * noise (0.66), and a real one (0.79) so young that two or three leaves stand on one foot and are better parted as straps. */
static const double ON_PETIOLES = 0.5, STRAP_SURE = 0.75;
/* Single blades that are no longer than this (squared length over area: a disc has 1.27) are no straps either but by as much evidence,
 * tubes off the stem included: short petioles look thick in noise (0.53 and 0.42 of a cucumber and an eggplant of 1.3 and 2.0 from
 * depth cameras, of 280 plants with petioles there). Straps that thick feet tell are longer (2.96 and more but for a seedling of 2.1
 * and 0.95, 15 real and 42 virtual), or torn to several blades a leaf by the noise. */
static const double STRAP_WIDE = 2.2;
/* In noise of a third of the stem's radius straps are as wide, but blades on petioles do not begin that near: 0.40 of their length at
 * least of 250 plants in 0.5 to 6 mm of noise, where seven maize of 1.2 to 2.0 began at 0.09 to 0.26. So wide blades that begin nearer
 * than this, in noise of so many stem radii, are straps'. */
static const double STRAP_START_WIDE = 0.33, STRAP_WIDE_NOISE = 0.25;
/* In noise of so many stem radii straps that touch may pass for the leaflets of a compound plant. Leaflets stand to the sides of their
 * rachis, so that their squared length along the way from the stem over their area is less, and rachises make a plant larger than
 * its stem is thick: its size in R over that elongation is 18.8 at least of 120 tomatoes and soybeans in noise of 0.15 and more, and
 * 9.8 to 15.2 of 14 maize of as many blades a leaf and an elongation of 1.9 and more (six of which nothing else tells). */
static const double STRAP_JOINED_NOISE = 0.2, STRAP_JOINED = 1.6, STRAP_STOUT = 17;
/* They show evidence of straps by slim feet, and blades that look like tubes: both shares together (0.79 and more of fourteen virtual maize; 0
 * of a soybean whose leaflets noise joins). */
static const double STRAP_JOINED_EVIDENCE = 0.4;
/* Noise (at least a tenth of the stem's radius) may hide thick feet, slim ones and tubes. Then the blades' shape tells: those of
 * straps are long (squared length over area, both summed) and begin at the stem, or not far from it where most leaves have less
 * tube at their foot than petioles (counted: noise hides a few large leaves' feet), however many blades a leaf has: noise tears
 * them. Virtual maize in 1.6 to 3.5 mm of noise that was taken for other kinds: noise 0.14 of the radius at least, length 3.3 at
 * least, beginning 0.1 to 0.56, three of five feet and more. 250 virtual scans of other kinds that begin within 0.6: length 2.2 at
 * most; young real tomatoes, whose cotyledons are long: 3.3 to 4.8, but 0.33 at least, and half of their feet at most. */
static const double STRAP_NOISE = 0.1, STRAP_LONG = 2.7, STRAP_START = 0.3, STRAP_START_TUBELESS = 0.6,
                    STRAP_LEAST = 0.15;
/* In less noise feet may be slim where the stem is seen thick (with the sheaths about it, and sparse): long blades that begin
 * nearer than this are straps' then. */
static const double STRAP_START_CLEAR = 0.2;
static const double BLADE_ENDS = 0.02; /* quantile of a blade's distances: some points are strays */

static bool is_tubeless(const plm_side_group *group)
{
    return group->tube_share < STRAP_TUBE;
}

/* How much a leaf looks like a strap: by its feet as thick as the stem, and where slimmer ones count as well. */
static void strap_evidence(const plm_sketch *sketch, const plm_side_group *group, double *thick, double *slim)
{
    const double ratio = group->tube_radius / sketch->scale.stem_radius, tubes = 0.5 * is_tubeless(group);
    const bool is_thick = ratio > STRAP_RADIUS || ratio == 0;
    *thick = tubes + 0.5 * is_thick;
    *slim = tubes + 0.5 * (is_thick ? 1 : fmax((ratio - STRAP_SLIM) / (STRAP_RADIUS - STRAP_SLIM), 0));
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

/* Of the blades, weighed by area; 0 where there are none. */
typedef struct blade_shape {
    double start;      /* where they begin over how long they are */
    double elongation; /* their squared length over area */
} blade_shape;

static plm_status find_blade_shape(const plm_sketch *sketch, const plm_side_groups *groups, blade_shape *shape,
                                   plm_error *error)
{
    *shape = (blade_shape){0};
    plm_scratch scratch = {.error = error};
    const size_t blades = groups->blade_count, count = sketch->working.count;
    float *value = plm_scratch_take(&scratch, count, sizeof *value); /* distances, blade by blade */
    size_t *end = plm_scratch_take(&scratch, blades + 1, sizeof *end);
    double begin = 0, length = 0, squared_length = 0, area_sum = 0;
    for (size_t i = 0; i < count && !scratch.failed; i++)
        if (groups->blade[i] >= 0 && isfinite(groups->distance[i])) end[groups->blade[i] + 1]++;
    for (size_t b = 0; b < blades && !scratch.failed; b++) end[b + 1] += end[b];
    for (size_t i = 0; i < count && !scratch.failed; i++) /* where a blade's rows begin becomes where they end */
        if (groups->blade[i] >= 0 && isfinite(groups->distance[i]))
            value[end[groups->blade[i]]++] = groups->distance[i];
    for (size_t b = 0; b < blades && !scratch.failed; b++) {
        const double area = groups->blade_area[b];
        const size_t first = b ? end[b - 1] : 0, points = end[b] - first;
        if (area < plm_blade_least(sketch) || !points) continue;
        const double low = plm_quantile(value + first, points, BLADE_ENDS),
                     high = plm_quantile(value + first, points, 1 - BLADE_ENDS);
        begin += area * low;
        length += area * (high - low);
        squared_length += (high - low) * (high - low);
        area_sum += area;
    }
    if (length > 0) *shape = (blade_shape){begin / length, squared_length / area_sum};
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* What the leaves look like; evidence is weighed by area, of those that have feet. */
typedef struct leaf_tally {
    size_t leafy, blades, most; /* groups with blades, their blades, those of the group with the most */
    size_t feet, tubeless;      /* groups with feet, those with less tube there than petioles */
    double area, strap, slim_strap;
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
        tally.feet++;
        tally.tubeless += is_tubeless(group);
        tally.area += group->blade_area;
        double thick, slim;
        strap_evidence(sketch, group, &thick, &slim);
        tally.strap += group->blade_area * thick;
        tally.slim_strap += group->blade_area * slim;
    }
    return tally;
}

/* Whether feet are as thick as the stem: straps have no petioles. */
static bool have_thick_feet(const plm_sketch *sketch, const leaf_tally *tally, bool many)
{
    const double least = many ? STRAP_OF_MANY : sketch->scale.rises ? STRAP_RISING : STRAP_EVIDENCE;
    return tally->strap > least * tally->area;
}

/* Whether feet tell something, if not enough. */
static bool may_have_thick_feet(const leaf_tally *tally)
{
    return tally->strap > STRAP_LEAST * tally->area;
}

/* Whether noise makes blades look wide, which begin at the stem all the same. */
static bool are_widened(const plm_sketch *sketch, const blade_shape *shape)
{
    return sketch->scale.noise > STRAP_WIDE_NOISE * sketch->scale.stem_radius && shape->elongation > 0 &&
           shape->start <= STRAP_START_WIDE;
}

/* Whether blades are long and near to the stem, as those of straps, or would be so without the noise. */
static bool have_strap_blades(const plm_sketch *sketch, const leaf_tally *tally, const blade_shape *shape)
{
    const bool is_noisy = sketch->scale.noise > STRAP_NOISE * sketch->scale.stem_radius;
    const bool is_tubeless_mostly = 2 * tally->tubeless > tally->feet;
    if (is_tubeless_mostly && are_widened(sketch, shape)) return true;
    const double latest = !is_noisy ? STRAP_START_CLEAR : is_tubeless_mostly ? STRAP_START_TUBELESS : STRAP_START;
    return shape->elongation > STRAP_LONG && shape->start <= latest;
}

/* Whether what looks like tubes are leaflets that noise makes round. */
static bool are_on_rachises(const leaf_tally *tally, const blade_shape *shape, bool many)
{
    return many && tally->most >= 3 && shape->start > ON_RACHISES;
}

/* Whether what passes for leaflets are straps that noise joins, on a stout plant. tubes: share of what is off the stem. */
static bool are_joined_straps(const plm_sketch *sketch, const leaf_tally *tally, const blade_shape *shape, double tubes)
{
    const plm_scale *scale = &sketch->scale;
    if (!(tally->slim_strap + tubes * tally->area > STRAP_JOINED_EVIDENCE * tally->area)) return false;
    return scale->noise > STRAP_JOINED_NOISE * scale->stem_radius && shape->elongation > STRAP_JOINED &&
           scale->size < STRAP_STOUT * shape->elongation * scale->radius;
}

/* The habit of a plant with a stem and leaves that are no tubes. */
static plm_habit guess_leafy(const plm_sketch *sketch, const leaf_tally *tally, const blade_shape *shape, double tubes,
                             bool many)
{
    const double least = tally->most >= 3 ? COMPOUND_BLADES : COMPOUND_PAIRS;
    const bool compound = (double)tally->blades >= least * (double)tally->leafy;
    const bool slim = !many && tally->slim_strap + tubes * tally->area > STRAP_WITH_TUBES * tally->area;
    bool strap = slim || have_thick_feet(sketch, tally, many);
    if (strap && !slim && tally->strap <= STRAP_SURE * tally->area) {
        const bool wide = shape->elongation > 0 && shape->elongation <= STRAP_WIDE && !are_widened(sketch, shape) &&
                          tally->strap + tubes * tally->area <= STRAP_SURE * tally->area;
        strap = compound ? shape->start <= ON_PETIOLES : !wide;
    }
    strap = strap || (may_have_thick_feet(tally) && have_strap_blades(sketch, tally, shape)) ||
            (compound && are_joined_straps(sketch, tally, shape, tubes));
    return strap ? PLM_HABIT_STRAP : compound ? PLM_HABIT_COMPOUND : PLM_HABIT_SIMPLE;
}

plm_status plm_habit_guess(const plm_sketch *sketch, const plm_side_groups *groups, plm_habit *habit, plm_error *error)
{
    const leaf_tally tally = count_leaves(sketch, groups);
    const double tubes = tube_leaves(sketch);
    const bool many = !sketch->scale.rises && (double)tally.blades >= MANY_BLADES * (double)tally.leafy;
    blade_shape shape = {0};
    const plm_status status = sketch->stem.count ? find_blade_shape(sketch, groups, &shape, error) : PLM_OK;
    if (status != PLM_OK) return status;
    if (is_bare(sketch, groups))
        *habit = PLM_HABIT_BARE_STEM;
    else if (tubes > TUBE_LEAVES && !are_on_rachises(&tally, &shape, many))
        *habit = PLM_HABIT_STRAP;
    else if (!tally.leafy)
        *habit = sketch->scale.has_tubes ? PLM_HABIT_BARE_STEM : PLM_HABIT_SINGLE_LEAF;
    else if (!sketch->scale.has_tubes)
        *habit = tally.leafy > 1 ? PLM_HABIT_HEAD : PLM_HABIT_SINGLE_LEAF;
    else
        *habit = sketch->stem.count ? guess_leafy(sketch, &tally, &shape, tubes, many) : PLM_HABIT_ROSETTE;
    return PLM_OK;
}
