/* segment/rosette_stem.c: a rosette has no stem. What was traced may have run up petioles, so that little is left of it once they are
 * taken off, or along one steep leaf, which it then parts into two. */
#include "segment/rosette_stem.h"

#include "segment/side_groups.h"
#include "segment/stem_fit.h"

#include <math.h>

/* Of the size: a stem that rises less is none. 0.22 and more on stems, virtual and real, while ways along petioles of rosettes
 * in noise, cut where they thin, end at 0.1 or less. */
static const double RISE_LEFT = 0.15;
/* A way shorter than this share of the size, with so many leaves (CROWD) about its base (in R) of which one reaches nearly as far
 * and each of the others half as far, and so few beyond, leads along one of a rosette's steep leaves and parts its blade. Stems as
 * short have one leaf there at most (300 clouds, virtual and real); such ways had five and seven. */
static const double SHORT_WAY = 0.5, CROWN = 2.5, AS_FAR = 1 / 1.2, HALF_AS_FAR = 0.5;
enum { CROWD = 4, BEYOND_MOST = 2 };

/* Whether the way is that of a leaf among those of a rosette. */
static plm_status is_leaf_way(plm_sketch *sketch, bool *answer, plm_error *error)
{
    const double length = sketch->stem.along[sketch->stem.count - 1], crown = CROWN * sketch->scale.radius;
    *answer = false;
    if (length >= SHORT_WAY * sketch->scale.size) return PLM_OK;
    plm_side_groups groups;
    plm_status status = plm_side_groups_find(sketch, 1, &groups, error);
    if (status != PLM_OK) return status;
    float *reach = plm_alloc_zero(groups.count + 1, sizeof *reach, error); /* of each group, along the plant */
    if (!reach) status = PLM_E_MEMORY;
    for (size_t i = 0; i < sketch->working.count && reach; i++) {
        const int32_t g = sketch->group[i];
        if (g >= 0 && isfinite(groups.distance[i])) reach[g] = fmaxf(reach[g], groups.distance[i]);
    }
    size_t about = 0, beyond = 0;
    double farthest = 0;
    for (size_t g = 0; g < groups.count && reach; g++) {
        if (!groups.group[g].has_foot || !groups.group[g].blades) continue;
        const bool is_about = groups.group[g].along < crown;
        if (is_about) farthest = fmax(farthest, reach[g]);
        about += is_about && reach[g] >= HALF_AS_FAR * length;
        beyond += !is_about;
    }
    plm_free(reach);
    plm_side_groups_free(&groups);
    *answer = about >= CROWD && beyond <= BEYOND_MOST && farthest >= AS_FAR * length;
    return status;
}

plm_status plm_stem_drop_false(plm_sketch *sketch, plm_error *error)
{
    const plm_stem_path *stem = &sketch->stem;
    bool is_none = stem->node[stem->count - 1][2] - stem->node[0][2] < RISE_LEFT * sketch->scale.size;
    plm_status status = PLM_OK;
    if (!is_none && sketch->asked == PLM_HABIT_UNKNOWN) status = is_leaf_way(sketch, &is_none, error);
    if (status != PLM_OK || !is_none) return status;
    plm_stem_path_free(&sketch->stem);
    for (size_t i = 0; i < sketch->working.count; i++) sketch->is_stem[i] = false;
    return PLM_OK;
}
