/* segment/round_leaves.c: where noise is nearly as wide as leaflets, all of a compound leaf may look like tubes, if not as surely as a
 * branch does, and what hangs on the stem without a blade counts as a branch of it. */
#include "segment/round_leaves.h"

#include "segment/scratch.h"

#include <math.h>

static const double NOISY = 0.15; /* over the stem's radius; the tomatoes that it was seen at have 0.29 */
/* Of the points that the leaves with blades have, by their median: so many has a leaf without one (1.2 and 1.5 those tomatoes'),
 * where there are so many others to go by. */
static const double LARGE = 0.5;
enum { OTHERS_LEAST = 3 };
/* Such a share of it is a tube with less than this probability (0.42 and 0.64 of the tomatoes' leaves), and becomes blade but for
 * the foot, so far (in R) from the trunk. Little more is needed than a seed: where the rachis lies is found anew
 * (segment/junction_labels.c). */
static const float SURE = 0.9F;
static const double UNSURE_SHARE = 0.25, FOOT = 1.6;

typedef struct tally {
    size_t unsure;
    bool is_leaf;
} tally;

static bool is_unsure(const plm_sketch *sketch, const plm_side_groups *groups, size_t i)
{
    return sketch->is_tube[i] && sketch->tube[i] < SURE && groups->distance[i] > FOOT * sketch->scale.radius;
}

/* Whether any group is a leaf that noise makes round. */
static bool judge(const plm_side_groups *groups, double least, const size_t *points, tally *list)
{
    bool any = false;
    for (size_t g = 0; g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        const double all = (double)points[g];
        list[g].is_leaf =
            group->has_foot && !group->blades && all >= least && (double)list[g].unsure >= UNSURE_SHARE * all;
        any |= list[g].is_leaf;
    }
    return any;
}

plm_status plm_round_leaves(plm_sketch *sketch, const plm_side_groups *groups, bool *found, plm_error *error)
{
    *found = false;
    if (!(sketch->scale.noise > NOISY * sketch->scale.stem_radius)) return PLM_OK;
    plm_scratch scratch = {.error = error};
    tally *list = plm_scratch_take(&scratch, groups->count + 1, sizeof *list);
    size_t *points = plm_scratch_take(&scratch, groups->count + 1, sizeof *points);
    double *value = plm_scratch_take(&scratch, groups->count + 1, sizeof *value);
    if (!scratch.failed) {
        const double usual = plm_side_groups_usual_points(sketch, groups, OTHERS_LEAST, points, value);
        for (size_t i = 0; i < sketch->working.count; i++)
            if (sketch->group[i] >= 0) list[sketch->group[i]].unsure += is_unsure(sketch, groups, i);
        *found = usual > 0 && judge(groups, LARGE * usual, points, list);
        for (size_t i = 0; i < sketch->working.count && *found; i++)
            if (sketch->group[i] >= 0 && list[sketch->group[i]].is_leaf && is_unsure(sketch, groups, i))
                sketch->is_tube[i] = false;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
