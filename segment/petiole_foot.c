/* segment/petiole_foot.c: the border between stem and petioles at all points of the plant. The sketch calls stem what is near
 * to its line, and the way that gives that line may follow the topmost petiole for some millimetres; here each point goes to
 * the likelier of the tubes about its node (foot_tubes.c). */
#include "segment/petiole_foot.h"

#include "cloud/order.h"
#include "segment/foot_tubes.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"
#include "segment/subset.h"

#include <math.h>
#include <string.h>

/* Lengths in R. */
static const double REACH = 5; /* about a node: what is looked at */
static const double AT_END = 1.5,
                    NEAR = 0.5;      /* from the way's end: points tell which leaf is there, the nearer the better */
static const double SHARPEST = 0.15; /* blur in stem radii, at least: tubes are not quite round and straight */
static const double CLEAR = 2.5;     /* SDs beyond the petiole's surface: not of it */
static const double GAP = 12;        /* points that a petiole has on a length: it is not without any */
static const double LEAST_GAP = 0.3; /* a petiole seen in rings or thinly has gaps, too */
enum { FEWEST_NODES = 12, MOST_POINTS = 6000 };

/* Blocks as long as the plant, shared by its nodes. */
typedef struct blocks {
    uint32_t *point;
    float *value;
    size_t *number;
    double *near;
} blocks;

/* Where the petiole begins, going down its line: before the first gap that its density does not explain. value: scratch. */
static double begin_of(const plm_foot *p, float *value)
{
    size_t count = 0;
    double s, most;
    for (size_t i = 0; i < p->count; i++)
        if (plm_foot_likeliest(p, i, &most) == 1 && most > plm_foot_elsewhere(p)) {
            plm_tube_distance(&p->tube[1], p->xyz[p->point[i]], &s);
            value[count++] = (float)s;
        }
    if (!count) return INFINITY;
    plm_order_sort(value, count);
    size_t k = count / 2;
    const double gap = fmax(GAP / p->tube[1].density, LEAST_GAP * p->scale->radius);
    while (k > 0 && (double)(value[k] - value[k - 1]) < gap) k--;
    return (double)value[k];
}

/* Whether a point called stem may be a petiole's. On a compound plant what lies off the stem's line is a tube without a leaf: small
 * leaflets that noise makes thick. */
static bool may_be_petiole(const plm_foot *p, const float xyz[3])
{
    plm_stem_place place;
    return p->out->habit != PLM_HABIT_COMPOUND ||
           plm_stem_nearest(p->path, xyz, &place) < p->scale->stem_radius + CLEAR * p->blur;
}

static void relabel(const plm_foot *p, double begin)
{
    for (size_t i = 0; i < p->count; i++) {
        const uint32_t at = p->row[p->point[i]];
        double most, s;
        const size_t likeliest = plm_foot_likeliest(p, i, &most);
        if (most < plm_foot_elsewhere(p) || likeliest > 1) continue;
        if (p->out->label[at] == PLM_LABEL_PETIOLE && p->out->organ[at] != p->leaf[0]) continue;
        const double off = plm_tube_distance(&p->tube[1], p->xyz[p->point[i]], &s) - p->tube[1].radius;
        if (likeliest && (off > CLEAR * p->blur || s < begin)) continue;
        const bool is_petiole = likeliest > 0;
        if (is_petiole && p->out->label[at] == PLM_LABEL_STEM && !may_be_petiole(p, p->xyz[p->point[i]])) continue;
        p->out->label[at] = is_petiole ? PLM_LABEL_PETIOLE : PLM_LABEL_STEM;
        p->out->organ[at] = is_petiole ? p->leaf[0] : 0;
    }
}

/* The leaf at the way's end; -1: none. near: scratch, zeros. */
static int32_t leaf_at_end(const plm_foot *p, size_t count, double *near)
{
    const plm_segmentation *out = p->out;
    int32_t best = -1;
    for (size_t i = 0; i < count; i++) {
        const uint8_t label = out->label[p->row[i]];
        const int32_t leaf = out->organ[p->row[i]];
        if ((label != PLM_LABEL_PETIOLE && label != PLM_LABEL_LEAF) || leaf < 0 || (size_t)leaf >= out->leaf_count)
            continue;
        const double distance = plm_foot_distance(p, p->xyz[i]) / p->scale->radius;
        if (distance > AT_END) continue;
        near[leaf] += exp(-distance * distance / (NEAR * NEAR));
        if (best < 0 || near[leaf] > near[best]) best = leaf;
    }
    return best;
}

/* The leaves whose petioles are looked at: a leaf's own, then those with most points near to it. number: scratch. */
static void choose_leaves(plm_foot *p, size_t count, int32_t own, size_t *number)
{
    const plm_segmentation *out = p->out;
    memset(number, 0, out->leaf_count * sizeof *number);
    for (size_t i = 0; i < count; i++) {
        const int32_t leaf = out->organ[p->row[i]];
        if (out->label[p->row[i]] != PLM_LABEL_PETIOLE || leaf < 0 || (size_t)leaf >= out->leaf_count) continue;
        number[leaf] += plm_foot_distance(p, p->xyz[i]) < PLM_FOOT_PETIOLE_REACH * p->scale->radius;
    }
    p->leaf[0] = own, number[own] = 0;
    for (p->petioles = 1; p->petioles < PLM_FOOT_PETIOLES; p->petioles++) {
        int32_t best = -1;
        for (size_t leaf = 0; leaf < out->leaf_count; leaf++)
            if (number[leaf] >= PLM_FOOT_FEWEST && (best < 0 || number[leaf] > number[best])) best = (int32_t)leaf;
        if (best < 0) return;
        p->leaf[p->petioles] = best;
        number[best] = 0;
    }
}

/* The place of the way that the leaf's petiole comes nearest to. false: it has none. */
static bool find_node(plm_foot *p, size_t count, int32_t leaf)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < count; i++) {
        plm_stem_place place;
        if (p->out->label[p->row[i]] != PLM_LABEL_PETIOLE || p->out->organ[p->row[i]] != leaf) continue;
        const double distance = plm_stem_nearest(p->path, p->xyz[i], &place);
        if (!(distance < nearest)) continue;
        nearest = distance;
        p->along = place.along;
        for (int a = 0; a < 3; a++) p->at[a] = (double)p->xyz[i][a] - place.offset[a];
    }
    return isfinite(nearest);
}

static bool is_near(const plm_foot *p, size_t i)
{
    const uint8_t label = p->out->label[p->row[i]];
    bool chosen = label == PLM_LABEL_STEM;
    for (size_t k = 0; k < p->petioles && label == PLM_LABEL_PETIOLE; k++)
        chosen |= p->out->organ[p->row[i]] == p->leaf[k];
    return chosen && plm_foot_distance(p, p->xyz[i]) < REACH * p->scale->radius;
}

/* Stem and petiole points about the node; those that give the tubes, some where they are many, stand first. Gives their number. */
static size_t gather(plm_foot *p, size_t count, uint32_t *point)
{
    size_t all = 0, first = 0;
    for (size_t i = 0; i < count; i++)
        if (is_near(p, i)) point[all++] = (uint32_t)i;
    const uint32_t mask = plm_subset_mask(all, MOST_POINTS);
    for (size_t k = 0; k < all; k++) {
        const uint32_t i = point[k];
        if (plm_point_bits(p->xyz[i]) & mask) continue;
        point[k] = point[first];
        point[first++] = i;
    }
    p->point = point;
    p->count = all;
    return first;
}

static plm_status set_border(plm_foot *p, size_t count, int32_t leaf, blocks *room, plm_error *error)
{
    choose_leaves(p, count, leaf, room->number);
    const size_t first = gather(p, count, room->point), all = p->count;
    plm_scratch scratch = {.error = error};
    p->density = plm_scratch_take(&scratch, all + 1, sizeof *p->density);
    p->outside = plm_scratch_take(&scratch, all + 1, sizeof *p->outside);
    p->place = plm_scratch_take(&scratch, all + 1, sizeof *p->place);
    p->count = first;
    const double begin = !scratch.failed && plm_foot_fit(p) ? begin_of(p, room->value) : INFINITY;
    if (isfinite(begin)) {
        p->count = all;
        plm_foot_densities(p);
        relabel(p, begin);
    }
    const plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    plm_scratch_free(&scratch, NULL);
    return status;
}

plm_status plm_petiole_feet(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_sketch *sketch,
                            plm_segmentation *out, plm_error *error)
{
    const plm_stem_path *path = &sketch->stem;
    if (path->count < FEWEST_NODES || !(sketch->scale.stem_radius > 0)) return PLM_OK;
    plm_scratch scratch = {.error = error};
    blocks room = {.point = plm_scratch_take(&scratch, count + 1, sizeof *room.point),
                   .value = plm_scratch_take(&scratch, count + 1, sizeof *room.value),
                   .number = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *room.number),
                   .near = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *room.near)};
    plm_foot p = {.xyz = xyz,
                  .row = row,
                  .scale = &sketch->scale,
                  .path = path,
                  .out = out,
                  .along = path->along[path->count - 1],
                  .is_tip = true,
                  .blur = fmax(sketch->scale.noise, SHARPEST * sketch->scale.stem_radius)};
    memcpy(p.at, path->node[path->count - 1], sizeof p.at);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    const int32_t topmost = status == PLM_OK ? leaf_at_end(&p, count, room.near) : -1;
    if (topmost >= 0) status = set_border(&p, count, topmost, &room, error);
    p.is_tip = false;
    p.end = INFINITY;
    for (int32_t leaf = 0; (size_t)leaf < out->leaf_count && status == PLM_OK; leaf++)
        if (leaf != topmost && find_node(&p, count, leaf)) status = set_border(&p, count, leaf, &room, error);
    plm_scratch_free(&scratch, NULL);
    return status;
}
