/* segment/rosette_links.c: where a petiole is seen sparsely, or leans on another, balls on it look flat, and a piece of it becomes a
 * leaf of its own, with another leaf's blade beyond. But a blade is flat, and where it ends nothing goes on: a long blade
 * nearly half as thick as wide, at whose tip another leaf goes on by more than its length, is a link of that leaf's petiole. */
#include "segment/rosette_links.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "segment/leaf_of.h"
#include "segment/scratch.h"

#include <math.h>

/* SDs of a link: the least over the middle one, the greatest over the middle one, at least. False blades that were looked at have 0.45 and
 * 2.4 and more. True ones have so much at times, but of those of some 140 virtual rosettes none has what goes on beyond it. */
static const double THICK = 0.4, LONG = 2.2;
static const double TIP = 0.9;     /* quantile of the way from the core: farther out is the tip */
static const double BESIDE = 3;    /* SDs across, beyond the tip: what goes on is there, ... */
static const double GOES_ON = 0.2; /* ... so many points for each of the tip's, at least */
/* Quantiles of that way between which a link's length is taken, and up to which a leaf reaches. */
static const double LENGTH_FROM = 0.05, LENGTH_TO = 0.95, REACHES = 0.98;
enum { FEWEST = 8, FEWEST_BEYOND = 3 };

typedef struct work {
    const float (*xyz)[3];
    const uint32_t *row;
    size_t count;
    const plm_segmentation *out;
    double *way;      /* of each point, from the core */
    double *value;    /* scratch */
    uint32_t *beyond; /* of each leaf: its points at the tip of one */
    double *farthest; /* of each leaf: the way to its farthest point */
    bool *looked_at;  /* of each leaf */
    int32_t *owner;   /* of each leaf: whose petiole it is a link of, -1: it is none */
} work;

/* A blade's points: their number, sums and sums of products, from the core. */
typedef struct spread {
    double count, sum[3], product[6];
} spread;

static int32_t leaf_of(const work *w, size_t i)
{
    return plm_leaf_of(w->out, w->row[i]);
}

static bool is_blade_of(const work *w, size_t i, size_t leaf)
{
    return w->out->label[w->row[i]] == PLM_LABEL_LEAF && leaf_of(w, i) == (int32_t)leaf;
}

/* SD across a blade that is long and as thick as wide; 0 of others. */
static double tube_of(const spread *it)
{
    double moment[6], value[3], vector[3][3];
    for (int a = 0, m = 0; a < 3; a++)
        for (int c = a; c < 3; c++, m++)
            moment[m] = it->product[m] / it->count - it->sum[a] / it->count * (it->sum[c] / it->count);
    plm_eigen3(moment, value, vector);
    const double width = sqrt(fmax(value[1], 0)), thickness = sqrt(fmax(value[2], 0));
    return thickness > THICK * width && sqrt(fmax(value[0], 0)) > LONG * width ? width : 0;
}

/* Ways from the core to the points of a leaf, or of its blade alone, into value. */
static size_t ways_of(const work *w, size_t leaf, bool whole)
{
    size_t count = 0;
    for (size_t i = 0; i < w->count; i++)
        if (whole ? leaf_of(w, i) == (int32_t)leaf : is_blade_of(w, i, leaf)) w->value[count++] = w->way[i];
    return count;
}

/* The leaf with the most points that go on at a tip; -1: none that has so many. */
static int32_t find_next(const work *w, size_t leaf, const double tip[3], double reach, double way, double least)
{
    size_t best = leaf;
    for (size_t k = 0; k < w->out->leaf_count; k++) w->beyond[k] = 0;
    for (size_t i = 0; i < w->count; i++) {
        const int32_t other = leaf_of(w, i);
        if (other < 0 || (size_t)other == leaf || !(w->way[i] > way)) continue;
        double squared = 0;
        for (int a = 0; a < 3; a++) squared += (w->xyz[i][a] - tip[a]) * (w->xyz[i][a] - tip[a]);
        w->beyond[other] += squared < reach * reach;
    }
    for (size_t k = 0; k < w->out->leaf_count; k++)
        if (w->beyond[k] > w->beyond[best]) best = k;
    return best != leaf && w->beyond[best] >= fmax(FEWEST_BEYOND, least) ? (int32_t)best : -1;
}

/* A link's owner may be a link too. */
static size_t last_owner(const work *w, size_t leaf)
{
    while (w->owner[leaf] >= 0) leaf = (size_t)w->owner[leaf];
    return leaf;
}

/* Whose petiole a leaf with a blade of such a width is a link of; -1: of none. */
static int32_t owner_of(const work *w, size_t leaf, double width)
{
    const size_t blade = ways_of(w, leaf, false);
    const double tip_from = plm_order_quantile(w->value, blade, TIP);
    const double last = plm_order_quantile(w->value, blade, REACHES);
    const double length =
        plm_order_quantile(w->value, blade, LENGTH_TO) - plm_order_quantile(w->value, blade, LENGTH_FROM);
    double tip[3] = {0}, way = 0, n = 0;
    for (size_t i = 0; i < w->count; i++) {
        if (!is_blade_of(w, i, leaf) || w->way[i] < tip_from) continue;
        for (int a = 0; a < 3; a++) tip[a] += w->xyz[i][a];
        way += w->way[i];
        n++;
    }
    for (int a = 0; a < 3; a++) tip[a] /= n;
    const int32_t next = find_next(w, leaf, tip, last - way / n + BESIDE * width, last, GOES_ON * n);
    if (next < 0) return -1;
    const size_t whole = ways_of(w, last_owner(w, (size_t)next), true);
    return plm_order_quantile(w->value, whole, REACHES) > w->farthest[leaf] + length ? next : -1;
}

/* The leaf that reaches farthest of those that were not looked at yet. */
static size_t next_inwards(const work *w)
{
    size_t best = w->out->leaf_count;
    for (size_t k = 0; k < w->out->leaf_count; k++)
        if (!w->looked_at[k] && (best == w->out->leaf_count || w->farthest[k] > w->farthest[best])) best = k;
    return best;
}

/* From the tips inwards. An owner reaches farther than all of its link, so that it was looked at before; it never owns itself. */
static bool find_links(work *w, const spread *blade)
{
    bool any = false;
    for (size_t k = 0; k < w->out->leaf_count; k++) w->owner[k] = -1;
    for (size_t n = 0; n < w->out->leaf_count; n++) {
        const size_t k = next_inwards(w);
        w->looked_at[k] = true;
        const double width = blade[k].count < FEWEST ? 0 : tube_of(&blade[k]);
        if (width > 0) w->owner[k] = owner_of(w, k, width);
        any = any || w->owner[k] >= 0;
    }
    return any;
}

static void give_links(const work *w, int32_t *number, plm_segmentation *out)
{
    int32_t leaves = 0;
    for (size_t k = 0; k < out->leaf_count; k++) number[k] = w->owner[k] < 0 ? leaves++ : -1;
    for (size_t i = 0; i < w->count; i++) {
        const int32_t leaf = leaf_of(w, i);
        if (leaf < 0) continue;
        if (w->owner[leaf] >= 0) out->label[w->row[i]] = PLM_LABEL_PETIOLE;
        out->organ[w->row[i]] = number[last_owner(w, (size_t)leaf)];
    }
    out->leaf_count = (size_t)leaves;
}

static void gather(work *w, const double middle[3], spread *blade)
{
    for (size_t i = 0; i < w->count; i++) {
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = w->xyz[i][a] - middle[a];
        w->way[i] = sqrt(plm_dot(d, d));
        const int32_t leaf = leaf_of(w, i);
        if (leaf < 0) continue;
        w->farthest[leaf] = fmax(w->farthest[leaf], w->way[i]);
        if (!is_blade_of(w, i, (size_t)leaf)) continue;
        spread *it = &blade[leaf];
        it->count++;
        for (int a = 0, m = 0; a < 3; a++) {
            it->sum[a] += d[a];
            for (int c = a; c < 3; c++) it->product[m++] += d[a] * d[c];
        }
    }
}

plm_status plm_rosette_links(const float (*xyz)[3], const uint32_t *row, size_t count, const double middle[3],
                             plm_segmentation *out, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.xyz = xyz, .row = row, .count = count, .out = out};
    w.way = plm_scratch_take(&scratch, count + 1, sizeof *w.way);
    w.value = plm_scratch_take(&scratch, count + 1, sizeof *w.value);
    w.beyond = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *w.beyond);
    w.owner = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *w.owner);
    w.farthest = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *w.farthest);
    w.looked_at = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *w.looked_at);
    spread *blade = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *blade);
    int32_t *number = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *number);
    if (!scratch.failed) {
        gather(&w, middle, blade);
        if (find_links(&w, blade)) give_links(&w, number, out);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
