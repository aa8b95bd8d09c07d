/* segment/rosette_borders.c: the balls by which tubes are told from blades are as wide as noise and spacing ask for, and blades
 * narrower than these look like tubes: in noise petioles of a rosette's young leaves took half of their blades, or all of
 * them. But the leaves of a rosette are alike in shape: the border lies at about the same share of the way from the crown to the tip
 * (within 10 to 15 % of it in virtual rosettes). So the leaves with wide blades tell the share, and the narrower a blade, the
 * nearer its border comes to that; so do those that lie far off it: what is wrong with their border are points of others. */
#include "segment/rosette_borders.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "segment/scratch.h"

#include <math.h>
#include <stdlib.h>

/* Half width of a blade in R, at least, where widths tell its border (0.8 to 1.2 are alike on 24 virtual rosettes). */
static const double WIDE = 0.9;
/* Between these the border is between its own and the usual place: what widths tell comes down to nothing as a blade narrows. */
static const double UNSURE = 0.7, SURE = 1.3;
static const double NOISY = 0.04; /* noise in R: below, balls are as small as blades ask for */
/* Radius of the crown, of the longest way to a tip: petioles begin there (0.03 to 0.05 are alike). What ends nearer to the core than
 * OUT_OF_CROWN of it is no leaf that was seen whole. */
static const double CROWN = 0.04, OUT_OF_CROWN = 2;
static const double FAR_OFF = 0.25;      /* of the usual place of the border (0.2 to 0.3 are alike) */
static const double LEAST_PETIOLE = 0.1; /* of the way to the tip: a border nearer to the core was not found */
static const double TIP = 0.98;          /* quantile of the distances from the core that is the tip's */
enum { FEWEST_POINTS = 12, FEWEST_BLADE = 6, FEWEST_TOLD = 3 };

/** A point of a leaf. */
typedef struct place {
    double off; /* from the core */
    uint32_t point;
    bool is_blade;
} place;

/** A leaf: its places, the nearest to the core first, and what they show. */
typedef struct rosette_leaf {
    place *place;
    size_t count, blade;
    double tip, border; /* from the core */
    double half_width;  /* of what is labelled blade, noise taken off */
} rosette_leaf;

typedef struct work {
    const float (*xyz)[3];
    const uint32_t *row;
    size_t count;
    const plm_scale *scale;
    plm_segmentation *out;
    rosette_leaf *leaf;
    double crown;
} work;

static int nearer(const void *a, const void *b)
{
    const place *p = a, *q = b;
    if (p->off != q->off) return p->off < q->off ? -1 : 1;
    return (p->point > q->point) - (p->point < q->point);
}

static double half_width(const work *w, const rosette_leaf *leaf)
{
    double mean[3] = {0}, moment[6] = {0}, value[3], vector[3][3];
    const double noise = w->scale->noise, each = 1 / (double)leaf->blade;
    for (size_t i = 0; i < leaf->count; i++)
        for (int a = 0; leaf->place[i].is_blade && a < 3; a++) mean[a] += each * w->xyz[leaf->place[i].point][a];
    for (size_t i = 0; i < leaf->count; i++) {
        if (!leaf->place[i].is_blade) continue;
        const float *p = w->xyz[leaf->place[i].point];
        for (int a = 0, m = 0; a < 3; a++)
            for (int b = a; b < 3; b++) moment[m++] += each * (p[a] - mean[a]) * (p[b] - mean[b]);
    }
    plm_eigen3(moment, value, vector);
    return sqrt(fmax(3 * (value[1] - noise * noise), 0)); /* the points are spread evenly across */
}

/* The border is where petiole and blade are parted with the fewest points on the wrong side. */
static void look(const work *w, rosette_leaf *leaf)
{
    if (leaf->count < FEWEST_POINTS) return;
    qsort(leaf->place, leaf->count, sizeof *leaf->place, nearer);
    leaf->tip = leaf->place[(size_t)(TIP * (double)(leaf->count - 1))].off;
    ptrdiff_t petiole = 0, most = 0;
    for (size_t i = 0; i < leaf->count; i++) {
        leaf->blade += leaf->place[i].is_blade;
        petiole += leaf->place[i].is_blade ? -1 : 1;
        if (petiole > most) most = petiole, leaf->border = leaf->place[i].off;
    }
    if (leaf->blade >= FEWEST_BLADE) leaf->half_width = half_width(w, leaf);
}

/* The leaves' places, one leaf's after another's in all. */
static void gather(work *w, const double core[3], place *all)
{
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < w->count; i++) {
            const uint8_t label = w->out->label[w->row[i]];
            const int32_t k = w->out->organ[w->row[i]];
            if (label != PLM_LABEL_PETIOLE && label != PLM_LABEL_LEAF) continue;
            if (k < 0 || (size_t)k >= w->out->leaf_count) continue;
            rosette_leaf *leaf = &w->leaf[k];
            const double at[3] = {w->xyz[i][0], w->xyz[i][1], w->xyz[i][2]};
            if (pass) leaf->place[leaf->count] = (place){plm_distance(at, core), (uint32_t)i, label == PLM_LABEL_LEAF};
            leaf->count++;
        }
        for (size_t k = 0; !pass && k < w->out->leaf_count; k++) {
            w->leaf[k].place = all;
            all += w->leaf[k].count;
            w->leaf[k].count = 0;
        }
    }
}

static bool is_told(const work *w, const rosette_leaf *leaf)
{
    return leaf->half_width > WIDE * w->scale->radius && leaf->border > LEAST_PETIOLE * leaf->tip &&
           leaf->tip > w->crown;
}

/* The usual share of the way from the crown to the tip; NAN where too few leaves tell. share: room for all. */
static double usual_share(const work *w, double *share)
{
    size_t told = 0;
    for (size_t k = 0; k < w->out->leaf_count; k++)
        if (is_told(w, &w->leaf[k])) share[told++] = (w->leaf[k].border - w->crown) / (w->leaf[k].tip - w->crown);
    return told < FEWEST_TOLD ? NAN : plm_order_median(share, told);
}

static void set_border(const work *w, const rosette_leaf *leaf, double share)
{
    double border = w->crown + share * (leaf->tip - w->crown);
    if (leaf->count < FEWEST_POINTS || !(leaf->tip > OUT_OF_CROWN * w->crown)) return;
    if (is_told(w, leaf) && fabs(leaf->border - border) < FAR_OFF * border) {
        const double wide = leaf->half_width / w->scale->radius;
        const double own = (wide - UNSURE) / (SURE - UNSURE); /* above 0, as UNSURE is below WIDE */
        if (own >= 1) return;
        border += own * (leaf->border - border);
    }
    for (size_t i = 0; i < leaf->count; i++)
        w->out->label[w->row[leaf->place[i].point]] = leaf->place[i].off > border ? PLM_LABEL_LEAF : PLM_LABEL_PETIOLE;
}

bool plm_rosette_is_noisy(const plm_scale *scale)
{
    return scale->noise > NOISY * scale->radius;
}

plm_status plm_rosette_borders(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_scale *scale,
                               const double core[3], plm_segmentation *out, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.xyz = xyz, .row = row, .count = count, .scale = scale, .out = out};
    w.leaf = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *w.leaf);
    place *all = plm_scratch_take(&scratch, count + 1, sizeof *all);
    double *share = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *share);
    if (!scratch.failed) {
        gather(&w, core, all);
        double farthest = 0;
        for (size_t k = 0; k < out->leaf_count; k++) {
            look(&w, &w.leaf[k]);
            farthest = fmax(farthest, w.leaf[k].tip);
        }
        w.crown = CROWN * farthest;
        const double usual = usual_share(&w, share);
        for (size_t k = 0; k < out->leaf_count && !isnan(usual); k++) set_border(&w, &w.leaf[k], usual);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
