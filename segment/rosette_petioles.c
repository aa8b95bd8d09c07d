/* segment/rosette_petioles.c: where a young leaf's petiole leans on an elder's, the two are one tube along the graph, and its leaf
 * begins where its blade stands out: the petiole and the base of the blade count as the elder's. But all leaves of a rosette
 * come from its core, and their petioles are nearly straight: so points of a petiole that lie along another leaf's way to the core,
 * and off its own leaf's, are of that other leaf, if it has no petiole. */
#include "segment/rosette_petioles.h"

#include "cloud/linear.h"
#include "segment/leaf_of.h"
#include "segment/scratch.h"

#include <math.h>

/* Of the way to the tip: a leaf that begins farther from the core has no petiole. In virtual splats those with one begin before a
 * quarter, those without beyond a half. */
static const double NO_PETIOLE = 0.3;
static const double INNER = 0.02, TIP = 0.98; /* quantiles of the distances from the core: a leaf's beginning and end */
static const double NEARER = 0.7;             /* of the distance from the own line: near the core lines are alike */
static const double WIDTH = 2; /* of an elder's spread about its own way: a petiole, or the base of a small blade */
/* The same: so far apart two ways are where the young leaf begins; else one tube may be all there is. */
static const double PARTED = 2;
static const double FAR = 2;         /* of the young leaf's length: what tells an elder's line beside it */
static const double MOST_LOST = 0.5; /* of a petiole: one that would lose more has a wrong line */
/* A petiole fills so many steps of the way from the core to its leaf. */
enum { STEPS = 8, LEAST_STEPS = 5 };
enum { FEWEST = 12, ROUNDS = 3 };

/* A leaf's way from the core: place at s is s along + (slope s + bend s^2) across. */
typedef struct course {
    double along[3], across[2][3], slope[2], bend[2];
    double spread; /* of the petiole about it */
} course;

/* A leaf's points are those from its first on. */
typedef struct rosette_leaf {
    size_t first, count, petiole;
    double inner, tip; /* distances from the core */
    bool lacks_petiole;
    course way; /* straight, of one that lacks it */
} rosette_leaf;

typedef struct work {
    const float (*xyz)[3];
    const uint32_t *row;
    const double *core;
    plm_segmentation *out;
    rosette_leaf *leaf;
    uint32_t *point; /* of the leaves, one leaf's after another's */
    int32_t *taker;  /* of a point: the young leaf along whose way it lies best, -1 none */
    float *ratio;    /* how well */
    float *nearest;  /* of a point: distance from the nearest way of a young leaf */
} work;

static int32_t leaf_of(const work *w, size_t i)
{
    return plm_leaf_of(w->out, w->row[i]);
}

static bool is_petiole(const work *w, size_t i)
{
    return w->out->label[w->row[i]] == PLM_LABEL_PETIOLE;
}

static void from_core(const work *w, size_t i, double d[3])
{
    for (int a = 0; a < 3; a++) d[a] = w->xyz[i][a] - w->core[a];
}

/* A straight way. */
static bool set_course(const double towards[3], course *c)
{
    *c = (course){.along = {towards[0], towards[1], towards[2]}};
    if (!(plm_normalise(c->along) > 0)) return false;
    plm_frame_of_axis(c->along, c->across[0], c->across[1]);
    return true;
}

/* Distance of a place from the way; along: out. */
static double off_course(const course *c, const double d[3], double *along)
{
    const double s = *along = plm_dot(d, c->along);
    double off[2];
    for (int e = 0; e < 2; e++) off[e] = plm_dot(d, c->across[e]) - (c->slope[e] + c->bend[e] * s) * s;
    return hypot(off[0], off[1]);
}

static void gather(work *w, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (leaf_of(w, i) >= 0) w->leaf[leaf_of(w, i)].count++;
    for (size_t k = 1; k < w->out->leaf_count; k++) w->leaf[k].first = w->leaf[k - 1].first + w->leaf[k - 1].count;
    for (size_t k = 0; k < w->out->leaf_count; k++) w->leaf[k].count = 0;
    for (size_t i = 0; i < count; i++) {
        const int32_t k = leaf_of(w, i);
        if (k >= 0) w->point[w->leaf[k].first + w->leaf[k].count++] = (uint32_t)i;
    }
}

/* value: scratch. */
static void look(const work *w, rosette_leaf *leaf, float *value)
{
    double towards[3] = {0};
    for (size_t j = 0; j < leaf->count; j++) {
        double d[3];
        from_core(w, w->point[leaf->first + j], d);
        value[j] = (float)plm_norm(d);
        leaf->petiole += is_petiole(w, w->point[leaf->first + j]);
        for (int a = 0; a < 3; a++) towards[a] += d[a];
    }
    leaf->inner = plm_quantile(value, leaf->count, INNER);
    leaf->tip = plm_quantile(value, leaf->count, TIP);
    leaf->lacks_petiole =
        leaf->count >= FEWEST && leaf->inner > NO_PETIOLE * leaf->tip && set_course(towards, &leaf->way);
}

/* ---- Ways -------------------------------------------------------------------------------------------------------- */

/* Normal equations of a way. */
typedef struct course_sums {
    double square[3], product[2][2], off; /* off: squares about the way before */
    size_t count;
} course_sums;

static void add(course_sums *sums, const course *c, const double d[3], double s, double off)
{
    sums->square[0] += s * s, sums->square[1] += s * s * s, sums->square[2] += s * s * s * s;
    for (int e = 0; e < 2; e++) {
        const double place = plm_dot(d, c->across[e]);
        sums->product[e][0] += s * place, sums->product[e][1] += s * s * place;
    }
    sums->off += off * off;
    sums->count++;
}

/* The way by least squares. false: too few points tell it. */
static bool fit(const course_sums *sums, course *c)
{
    const double *m = sums->square, det = m[0] * m[2] - m[1] * m[1];
    if (sums->count < FEWEST || !(det > 1e-9 * m[0] * m[2])) return false;
    c->spread = sqrt(sums->off / (double)sums->count);
    for (int e = 0; e < 2; e++) {
        c->slope[e] = (m[2] * sums->product[e][0] - m[1] * sums->product[e][1]) / det;
        c->bend[e] = (m[0] * sums->product[e][1] - m[1] * sums->product[e][0]) / det;
    }
    return true;
}

/* An elder's way beside a young leaf: by what of it lies beyond the tip of that, and then by what of its petiole is nearer to it than to
 * any young leaf's. */
static bool elder_course(const work *w, const rosette_leaf *elder, double tip, course *c)
{
    double towards[3] = {0}, d[3], s;
    size_t beyond = 0;
    for (size_t j = 0; j < elder->count; j++) {
        from_core(w, w->point[elder->first + j], d);
        if (plm_norm(d) < tip) continue;
        for (int a = 0; a < 3; a++) towards[a] += d[a];
        beyond++;
    }
    if (beyond < FEWEST || !set_course(towards, c)) return false;
    for (int round = 0; round < ROUNDS; round++) {
        course_sums sums = {0};
        for (size_t j = 0; j < elder->count; j++) {
            const uint32_t i = w->point[elder->first + j];
            if (!is_petiole(w, i)) continue;
            from_core(w, i, d);
            const double off = off_course(c, d, &s);
            if (s > 0 && plm_norm(d) < FAR * tip && off < (double)w->nearest[i]) add(&sums, c, d, s, off);
        }
        if (!fit(&sums, c)) return false;
    }
    return true;
}

/* ---- What is taken ----------------------------------------------------------------------------------------------- */

/* Marks what of an elder's petiole lies along a young leaf's way, and better so than along any other young one's. */
static void mark(work *w, int32_t young, const rosette_leaf *elder)
{
    const rosette_leaf *leaf = &w->leaf[young];
    const course *own = &leaf->way;
    course c;
    double d[3], s, t;
    if (!elder_course(w, elder, leaf->tip, &c)) return;
    for (int a = 0; a < 3; a++) d[a] = leaf->inner * own->along[a];
    if (off_course(&c, d, &s) < PARTED * c.spread) return;
    for (size_t j = 0; j < elder->count; j++) {
        const uint32_t i = w->point[elder->first + j];
        if (!is_petiole(w, i)) continue;
        from_core(w, i, d);
        const double off = off_course(own, d, &s), off_elder = off_course(&c, d, &t);
        if (!(s > 0) || s > leaf->tip || off > WIDTH * c.spread || !(off < NEARER * off_elder)) continue;
        const float ratio = (float)(off / off_elder);
        if (w->taker[i] < 0 || ratio < w->ratio[i]) w->taker[i] = young, w->ratio[i] = ratio;
    }
}

/* Takes back what would leave an elder too little. */
static void spare(const work *w, const rosette_leaf *elder)
{
    size_t lost = 0;
    for (size_t j = 0; j < elder->count; j++) lost += w->taker[w->point[elder->first + j]] >= 0;
    if ((double)lost <= MOST_LOST * (double)elder->petiole) return;
    for (size_t j = 0; j < elder->count; j++) w->taker[w->point[elder->first + j]] = -1;
}

/* Whether what is marked leads from a young leaf to the core. */
static bool leads_to_core(const work *w, size_t count, int32_t young)
{
    bool full[STEPS] = {false};
    int steps = 0;
    for (size_t i = 0; i < count; i++) {
        double d[3], s;
        if (w->taker[i] != young) continue;
        from_core(w, i, d);
        off_course(&w->leaf[young].way, d, &s);
        const double step = STEPS * s / w->leaf[young].inner;
        if (step < STEPS) full[(int)step] = true;
    }
    for (int k = 0; k < STEPS; k++) steps += full[k];
    return steps >= LEAST_STEPS;
}

static void find_nearest(work *w, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        double d[3], s;
        from_core(w, i, d);
        w->nearest[i] = INFINITY;
        for (size_t k = 0; k < w->out->leaf_count; k++)
            if (w->leaf[k].lacks_petiole)
                w->nearest[i] = fminf(w->nearest[i], (float)off_course(&w->leaf[k].way, d, &s));
    }
}

static void give_petioles(work *w, size_t count)
{
    const int32_t leaves = (int32_t)w->out->leaf_count;
    for (size_t i = 0; i < count; i++) w->taker[i] = -1;
    find_nearest(w, count);
    for (int32_t k = 0; k < leaves; k++)
        for (int32_t elder = 0; elder < leaves; elder++)
            if (w->leaf[k].lacks_petiole && !w->leaf[elder].lacks_petiole) mark(w, k, &w->leaf[elder]);
    for (int32_t elder = 0; elder < leaves; elder++) spare(w, &w->leaf[elder]);
    for (int32_t k = 0; k < leaves; k++) {
        if (!w->leaf[k].lacks_petiole || !leads_to_core(w, count, k)) continue;
        for (size_t i = 0; i < count; i++)
            if (w->taker[i] == k) w->out->organ[w->row[i]] = k;
    }
}

plm_status plm_rosette_petioles(const float (*xyz)[3], const uint32_t *row, size_t count, const double core[3],
                                plm_segmentation *out, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.xyz = xyz, .row = row, .core = core, .out = out};
    w.leaf = plm_scratch_take(&scratch, out->leaf_count + 1, sizeof *w.leaf);
    w.point = plm_scratch_take(&scratch, count + 1, sizeof *w.point);
    w.taker = plm_scratch_take(&scratch, count + 1, sizeof *w.taker);
    w.ratio = plm_scratch_take(&scratch, count + 1, sizeof *w.ratio);
    w.nearest = plm_scratch_take(&scratch, count + 1, sizeof *w.nearest);
    if (!scratch.failed) {
        bool any = false;
        gather(&w, count);
        for (size_t k = 0; k < out->leaf_count; k++) {
            look(&w, &w.leaf[k], w.ratio);
            any = any || w.leaf[k].lacks_petiole;
        }
        if (any) give_petioles(&w, count);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
