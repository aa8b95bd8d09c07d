/* segment/broken_tubes.c: pieces of a plant are joined over gaps in the scan. But where a petiole has a gap and its leaf touches another
 * one, the plant is one piece without it: no link is made, what is left of the petiole bears no blade, and the leaf is taken for a
 * part of the other. The rest of the petiole, or the rachis, tells: it is a tube to which no tube leads. */
#include "segment/broken_tubes.h"

#include "cloud/linear.h"
#include "segment/scratch.h"

#include <math.h>

static const double LONG = 2;      /* in R: what is shorter tells no way ahead */
static const double REACH = 2.5;   /* in R: the widest gap, as between pieces */
static const double ALONG = 0.7;   /* cosine of the angle by which the tube ahead may turn */
static const double WIDTH = 2;     /* of the tube's radius, which the tube ahead may be off its line, ... */
static const double SPREAD = 0.35; /* ... and by so much of the way to it */

/* Tubes that tubes lead to from the stem are another foot's own; loose: out, the others. */
static plm_status find_loose(const plm_sketch *s, bool *loose, plm_error *error)
{
    const size_t count = s->working.count;
    plm_scratch scratch = {.error = error};
    uint32_t *source = plm_scratch_take(&scratch, count, sizeof *source);
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    size_t sources = 0;
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    for (uint32_t i = 0; i < count && status == PLM_OK; i++)
        if (s->is_stem[i]) source[sources++] = i;
    const plm_walk walk = {.source = source, .source_count = sources, .allowed = s->is_tube, .distance = distance};
    if (status == PLM_OK) status = plm_graph_walk(&s->graph, &walk, error);
    for (size_t i = 0; i < count && status == PLM_OK; i++) loose[i] = s->is_tube[i] && isinf(distance[i]);
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* end: out, the point of each group that is farthest from the trunk, UINT32_MAX where it has none. */
static void find_ends(const plm_sketch *s, const plm_side_groups *groups, uint32_t *end)
{
    for (size_t g = 0; g < groups->count; g++) end[g] = UINT32_MAX;
    for (uint32_t i = 0; i < s->working.count; i++) {
        if (s->group[i] < 0) continue;
        uint32_t *last = &end[s->group[i]];
        if (*last == UINT32_MAX || groups->distance[i] > groups->distance[*last]) *last = i;
    }
}

/* Middle of the foot's last R, and the way on from the R before it. false: it has none. */
static bool way_ahead(const plm_sketch *s, const float *distance, uint32_t end, double middle[3], double along[3])
{
    double before[3] = {0}, last[3] = {0}, counts[2] = {0};
    const double R = s->scale.radius;
    for (size_t i = 0; i < s->working.count; i++) {
        const double back = (double)distance[end] - distance[i];
        if (s->group[i] != s->group[end] || !(back < LONG * R)) continue;
        if (plm_graph_length(&s->graph, end, (uint32_t)i) > LONG * R) continue; /* of another branch */
        double *sum = back < 0.5 * LONG * R ? last : before;
        counts[sum == before]++;
        for (int a = 0; a < 3; a++) sum[a] += s->working.xyz[i][a];
    }
    if (!(counts[0] > 0 && counts[1] > 0)) return false;
    for (int a = 0; a < 3; a++) {
        middle[a] = last[a] / counts[0];
        along[a] = middle[a] - before[a] / counts[1];
    }
    return plm_normalise(along) > 0;
}

/* The loose tube's point ahead that is nearest to the foot's end; UINT32_MAX: there is none. */
static uint32_t tube_ahead(const plm_sketch *s, const float *distance, const bool *loose, uint32_t end)
{
    double middle[3], along[3], nearest = REACH * s->scale.radius;
    uint32_t best = UINT32_MAX;
    if (!way_ahead(s, distance, end, middle, along)) return best;
    for (uint32_t j = 0; j < s->working.count; j++) {
        const double gap = plm_graph_length(&s->graph, end, j);
        if (!loose[j] || s->group[j] == s->group[end] || !(gap < nearest)) continue;
        double off[3], axis[3];
        for (int a = 0; a < 3; a++) {
            off[a] = s->working.xyz[j][a] - middle[a];
            axis[a] = s->point[j].axis[a];
        }
        const double forward = plm_dot(off, along), across2 = plm_dot(off, off) - forward * forward;
        const double reach = WIDTH * s->point[end].radius + SPREAD * forward;
        if (!(forward > 0) || across2 > reach * reach || fabs(plm_dot(axis, along)) < ALONG) continue;
        nearest = gap;
        best = j;
    }
    return best;
}

plm_status plm_bridge_tubes(plm_sketch *sketch, const plm_side_groups *groups, size_t *links, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    uint32_t *end = plm_scratch_take(&scratch, groups->count + 1, sizeof *end);
    plm_link *link = plm_scratch_take(&scratch, groups->count + 1, sizeof *link);
    bool *loose = plm_scratch_take(&scratch, sketch->working.count, sizeof *loose), sought = false;
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    *links = 0;
    if (status == PLM_OK) find_ends(sketch, groups, end);
    for (size_t g = 0; status == PLM_OK && g < groups->count; g++) {
        const plm_side_group *group = &groups->group[g];
        if (!group->has_foot || group->blades || end[g] == UINT32_MAX) continue;
        if (!(groups->distance[end[g]] > LONG * sketch->scale.radius)) continue;
        if (!sought) status = find_loose(sketch, loose, error);
        sought = true;
        const uint32_t ahead = status == PLM_OK ? tube_ahead(sketch, groups->distance, loose, end[g]) : UINT32_MAX;
        if (ahead != UINT32_MAX)
            link[(*links)++] = (plm_link){end[g], ahead, (float)plm_graph_length(&sketch->graph, end[g], ahead)};
    }
    if (status == PLM_OK && *links) status = plm_graph_add(&sketch->graph, link, *links, error);
    plm_scratch_free(&scratch, NULL);
    return status;
}
