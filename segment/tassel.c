/* segment/tassel.c: what stands at the top of the stem and parts into several strands, far thinner than the plant's leaves are
 * wide, is a tassel. A leaf has one tip, or some where the scan tore it, and fringes at its rim. (Virtual tassels: 7 to 10 strands, with
 * what they stand on 0.2 to 0.4 of the leaves' width; a real one that was joined with a leaf: 0.4; torn leaves at the top of 137 plants: 0.7 and
 * more.) */
#include "segment/tassel.h"

#include "cloud/neighbours.h"
#include "segment/merge_tree.h"
#include "segment/scratch.h"

#include <math.h>

enum { STRANDS = 4, STRAND_LEAST = 5 /* points */, OTHERS = 3 /* leaves whose widths tell */, SECOND = 2 };
static const double STANDS_OUT = 0.1; /* of the leaf's length, beyond the fork: less is no strand */
static const double THIN = 0.4;       /* width of a strand, of the other leaves' median width */
/* The same, of the median width of all strands, at most: those of a tassel are alike. (A real one: 1.4; the narrow uppermost leaf of that
 * maize, joined with it: 3.6.) */
static const double ALIKE = 2.5;
static const double MEAN = 0.5; /* the same over all strands and what they stand on: a torn rim has thin ends too */
/* Where all its strands are thin: the share of the points that they hold at least. Of virtual tassels half and more, of a narrow
 * leaf with fringes a tenth. */
static const double STRAND_SHARE = 0.25;
static const float SPARSEST = 25; /* of the usual area: points that stand for more are strays */
static const double TOP = 0.9;    /* of the highest foot: leaves from there on may be a tassel */

/* A leaf, or what was taken for one. */
typedef struct blade {
    size_t points, thin, wide; /* thin, wide: strands */
    size_t strand_points;      /* of thin ones */
    double area;               /* that its points stand for */
    double length, strands;    /* strands: length of all of them together */
    float fork, wide_fork;     /* the nearest fork of its thin strands, and of its wide ones */
    bool is_tassel;
} blade;

typedef struct strand {
    size_t points;
    double area;
    float tip, fork;
    int32_t leaf;
    bool is_thin;
} strand;

typedef struct work {
    plm_sketch *sketch;
    const float *from_base;
    const double *foot;
    plm_scratch scratch;
    blade *blade;
    strand *strand;
    float *distance, *reach, *width;
    float *area; /* that each point stands for */
    int32_t *branch;
    size_t blades, strands;
} work;

/* A leaf that was seen seldom, with its points far apart, is not thin for that. The second neighbour's distance is the same on a strand and
 * on a blade. */
static plm_status find_areas(work *w, plm_error *error)
{
    const plm_thinned *points = &w->sketch->working;
    const size_t count = points->count;
    float *squared = plm_scratch_take(&w->scratch, count * SECOND, sizeof *squared);
    if (!squared) return PLM_E_MEMORY;
    if (count <= SECOND) return PLM_OK; /* no leaf */
    const plm_status status = plm_neighbour_table((const float(*)[3])points->xyz, count, SECOND, NULL, squared, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) w->area[i] = squared[i * SECOND + SECOND - 1];
    const float usual = plm_quantile(w->area, count, 0.5); /* it reorders */
    for (size_t i = 0; i < count; i++)
        w->area[i] = fminf(fmaxf(squared[i * SECOND + SECOND - 1], usual), SPARSEST * usual);
    return PLM_OK;
}

static void measure_blades(work *w)
{
    const plm_sketch *s = w->sketch;
    for (size_t i = 0; i < s->working.count; i++) {
        w->distance[i] = w->reach[i] = INFINITY;
        if (s->leaf[i] < 0) continue;
        blade *b = &w->blade[s->leaf[i]];
        w->distance[i] = w->from_base[i];
        b->points++;
        b->area += w->area[i];
        if (isfinite(w->from_base[i])) b->length = fmax(b->length, w->from_base[i] - w->foot[s->leaf[i]]);
    }
    for (size_t i = 0; i < s->working.count; i++)
        if (s->leaf[i] >= 0) w->reach[i] = (float)(STANDS_OUT * w->blade[s->leaf[i]].length);
}

/* The median width of the other leaves, 0 if they are too few; w->width: room for one a leaf. */
static double width_of_others(work *w, size_t leaf)
{
    size_t count = 0;
    for (size_t k = 0; k < w->blades; k++)
        if (k != leaf && w->blade[k].length > 0) w->width[count++] = (float)(w->blade[k].area / w->blade[k].length);
    return count < OTHERS ? 0 : plm_quantile(w->width, count, 0.5);
}

static plm_status find_strands(work *w, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    const plm_merge_rule rule = {.distance = w->distance, .reach = w->reach, .apart = s->leaf, .least = STRAND_LEAST};
    const plm_status status = plm_merge_tree_by(&s->graph, &rule, w->branch, &w->strands, error);
    if (status != PLM_OK) return status;
    const size_t most = w->strands > w->blades ? w->strands : w->blades;
    w->strand = plm_scratch_take(&w->scratch, w->strands + 1, sizeof *w->strand);
    w->width = plm_scratch_take(&w->scratch, most + 1, sizeof *w->width);
    if (!w->strand || !w->width) return PLM_E_MEMORY;
    for (size_t i = 0; i < s->working.count; i++) {
        if (w->branch[i] < 0) continue;
        strand *t = &w->strand[w->branch[i]];
        const float d = w->distance[i];
        if (!t->points || d > t->tip) t->tip = d;
        if (!t->points || d < t->fork) t->fork = d;
        t->leaf = s->leaf[i];
        t->points++;
        t->area += w->area[i];
    }
    return PLM_OK;
}

static bool is_strand(const work *w, const strand *t, size_t leaf)
{
    return t->points && (size_t)t->leaf == leaf && t->tip - t->fork > STANDS_OUT * w->blade[leaf].length;
}

/* The width that no strand of a leaf is thin beyond: strands of a tassel are alike, and a narrow leaf that is joined with them is wider than
 * they are. w->width: room for one a strand. */
static double thin_limit(work *w, size_t leaf, double width)
{
    size_t count = 0;
    for (size_t k = 0; k < w->strands; k++)
        if (is_strand(w, &w->strand[k], leaf))
            w->width[count++] = (float)(w->strand[k].area / (w->strand[k].tip - w->strand[k].fork));
    const double usual = count > STRANDS /* so that a tassel is left */ ? plm_quantile(w->width, count, 0.5) : INFINITY;
    return fmin(THIN * width, ALIKE * usual);
}

/* Scraps that nothing joins with the rest of the leaf are no strands, however thin. */
static void judge_strands(work *w, size_t leaf, double width)
{
    blade *b = &w->blade[leaf];
    const double limit = thin_limit(w, leaf, width);
    b->fork = b->wide_fork = INFINITY;
    for (size_t k = 0; k < w->strands; k++) {
        strand *t = &w->strand[k];
        if (!is_strand(w, t, leaf)) continue;
        t->is_thin = t->area < limit * (t->tip - t->fork);
        float *fork = t->is_thin ? &b->fork : &b->wide_fork;
        *fork = fminf(*fork, t->fork);
        b->strands += t->tip - t->fork;
        b->strand_points += t->is_thin ? t->points : 0;
        if (t->is_thin)
            b->thin++;
        else
            b->wide++;
    }
}

/* Gives whether there is any tassel. */
static bool judge_blades(work *w)
{
    double top = 0;
    bool any = false;
    for (size_t k = 0; k < w->blades; k++)
        if (isfinite(w->foot[k])) top = fmax(top, w->foot[k]);
    for (size_t k = 0; k < w->blades; k++) {
        blade *b = &w->blade[k];
        const double width = width_of_others(w, k);
        if (w->foot[k] < TOP * top || !(width > 0)) continue;
        judge_strands(w, k, width);
        if (b->thin < STRANDS) continue;
        const double length = b->strands + fmax(0, fminf(b->fork, b->wide_fork) - w->foot[k]);
        const bool is_fringed = !b->wide && (double)b->strand_points < STRAND_SHARE * (double)b->points;
        b->is_tassel = !is_fringed && b->area < MEAN * width * length;
        any = any || b->is_tassel;
    }
    return any;
}

/* Of a leaf that the tassel was joined with, the wide strands stay, and what lies below them or below the thin ones. */
static void take_off(work *w, double *foot, size_t *leaves, int32_t *number)
{
    plm_sketch *s = w->sketch;
    size_t kept = 0;
    for (size_t k = 0; k < w->blades; k++) {
        number[k] = w->blade[k].is_tassel && !w->blade[k].wide ? -1 : (int32_t)kept;
        if (number[k] >= 0) foot[kept++] = foot[k];
    }
    *leaves = kept;
    for (size_t i = 0; i < s->working.count; i++) {
        if (s->leaf[i] < 0) continue;
        const blade *b = &w->blade[s->leaf[i]];
        const bool is_thin = w->branch[i] >= 0 && w->strand[w->branch[i]].is_thin;
        const bool is_stalk = w->branch[i] < 0 && !(w->distance[i] < fmaxf(b->fork, b->wide_fork));
        const bool is_tassel = b->is_tassel && (!b->wide || is_thin || is_stalk);
        s->leaf[i] = is_tassel ? -1 : number[s->leaf[i]];
    }
}

plm_status plm_strap_tassel(plm_sketch *sketch, const float *from_base, double *foot, size_t *leaves, plm_error *error)
{
    const size_t count = sketch->working.count;
    work w = {.sketch = sketch, .from_base = from_base, .foot = foot, .scratch = {.error = error}, .blades = *leaves};
    w.blade = plm_scratch_take(&w.scratch, w.blades + 1, sizeof *w.blade);
    w.distance = plm_scratch_take(&w.scratch, count, sizeof *w.distance);
    w.reach = plm_scratch_take(&w.scratch, count, sizeof *w.reach);
    w.area = plm_scratch_take(&w.scratch, count, sizeof *w.area);
    w.branch = plm_scratch_take(&w.scratch, count, sizeof *w.branch);
    int32_t *number = plm_scratch_take(&w.scratch, w.blades + 1, sizeof *number);
    plm_status status = w.scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) status = find_areas(&w, error);
    if (status == PLM_OK) {
        measure_blades(&w);
        status = find_strands(&w, error);
    }
    if (status == PLM_OK && judge_blades(&w)) take_off(&w, foot, leaves, number);
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
