/* segment/head.c: from sheets to the leaves of a head. Pieces of one leaf, parted where a scan is thin, are joined where
 * they lie in one plane along a border as wide as they are; what is on the stem is no leaf. */
#include "segment/head.h"

#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/sheets.h"

#include <stdlib.h>

static const double JOIN_SHARE = 0.52; /* of the neighbours across a border that lie in one plane, at least */
static const double JOIN_WIDTH = 1.9;  /* points at the border over the root of the lesser sheet's, at least */
static const double ON_STEM = 0.5;     /* share of a sheet on the stem from which on it is stem all over */
static const double MOST = 0.5; /* share of the largest leaf, at most: a larger one is a single leaf with folds */
enum { FEWEST_LEAVES = 3 };

typedef struct head {
    const plm_sheet_surface *surface;
    int32_t *sheet; /* of each point of the surface; -1: none */
    size_t sheets;
    bool *on_stem;
    plm_head_stem stem;
} head;

/* What lies at the borders of sheets: matrices of sheets x sheets. */
typedef struct borders {
    uint32_t *near;   /* pairs of neighbours */
    uint32_t *along;  /* of these, in one plane */
    uint32_t *points; /* of the sheet of the row, with such a neighbour in that of the column */
} borders;

static void count_borders(const head *h, borders *b, uint32_t *seen)
{
    const plm_graph *near = &h->surface->near, *along = &h->surface->graph;
    for (uint32_t i = 0; i < near->count; i++) {
        if (h->sheet[i] < 0) continue;
        const size_t row = (size_t)h->sheet[i] * h->sheets;
        for (uint32_t e = near->first[i]; e < near->first[i + 1]; e++)
            if (h->sheet[near->edge[e]] >= 0) b->near[row + (size_t)h->sheet[near->edge[e]]]++;
        for (uint32_t e = along->first[i]; e < along->first[i + 1]; e++) {
            const int32_t other = h->sheet[along->edge[e]];
            if (other < 0) continue;
            b->along[row + (size_t)other]++;
            if (seen[other] == i + 1) continue;
            seen[other] = i + 1;
            b->points[row + (size_t)other]++;
        }
    }
}

static bool is_one_leaf(const head *h, const borders *b, const size_t *size, size_t p, size_t q)
{
    const size_t there = p * h->sheets + q, back = q * h->sheets + p;
    const double near = (double)b->near[there] + b->near[back], along = (double)b->along[there] + b->along[back];
    const double width = fmin(b->points[there], b->points[back]),
                 lesser = (double)(size[p] < size[q] ? size[p] : size[q]);
    return near > 0 && along >= JOIN_SHARE * near && width >= JOIN_WIDTH * sqrt(lesser);
}

/* number: out, of each sheet, the same for all pieces of a leaf; from 0 on, in the order of their first pieces. Gives how many
 * there are. */
static size_t join_pairs(const head *h, const borders *b, const size_t *size, int32_t *number, int32_t *leaf)
{
    const size_t n = h->sheets;
    size_t leaves = 0;
    for (size_t p = 0; p < n; p++) number[p] = (int32_t)p;
    for (size_t p = 0; p < n; p++)
        for (size_t q = p + 1; q < n; q++) {
            if (number[p] == number[q] || !is_one_leaf(h, b, size, p, q)) continue;
            const int32_t from = number[q], to = number[p];
            for (size_t k = 0; k < n; k++)
                if (number[k] == from) number[k] = to;
        }
    for (size_t p = 0; p < n; p++) leaf[p] = -1;
    for (size_t p = 0; p < n; p++) {
        int32_t *of = &leaf[number[p]];
        if (*of < 0) *of = (int32_t)leaves++;
        number[p] = *of;
    }
    return leaves;
}

/* Joins the pieces of leaves; sheets are numbered anew. */
static plm_status join_pieces(head *h, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    const size_t n = h->sheets, points = h->surface->graph.count;
    borders b = {plm_scratch_take(&scratch, n * n + 1, sizeof *b.near),
                 plm_scratch_take(&scratch, n * n + 1, sizeof *b.along),
                 plm_scratch_take(&scratch, n * n + 1, sizeof *b.points)};
    uint32_t *seen = plm_scratch_take(&scratch, n + 1, sizeof *seen);
    size_t *size = plm_scratch_take(&scratch, n + 1, sizeof *size);
    int32_t *number = plm_scratch_take(&scratch, n + 1, sizeof *number);
    int32_t *leaf = plm_scratch_take(&scratch, n + 1, sizeof *leaf);
    if (!scratch.failed) {
        count_borders(h, &b, seen);
        for (size_t i = 0; i < points; i++)
            if (h->sheet[i] >= 0) size[h->sheet[i]]++;
        h->sheets = join_pairs(h, &b, size, number, leaf);
        for (size_t i = 0; i < points; i++)
            if (h->sheet[i] >= 0) h->sheet[i] = number[h->sheet[i]];
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Marks the points on the stem, and all of a sheet that is mostly there. */
static plm_status mark_stem(head *h, double noise, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    size_t *size = plm_scratch_take(&scratch, h->sheets + 1, sizeof *size);
    size_t *on = plm_scratch_take(&scratch, h->sheets + 1, sizeof *on);
    plm_status status = scratch.failed ? PLM_E_MEMORY : plm_head_find_stem(h->surface, noise, &h->stem, error);
    if (status == PLM_OK && h->stem.count) {
        const plm_thinned *thinned = &h->surface->thinned;
        const double tolerance = fmax(0.5 * h->surface->spacing, 2 * noise);
        for (size_t i = 0; i < thinned->count; i++) {
            h->on_stem[i] = plm_head_is_stem(&h->stem, thinned->xyz[i], tolerance);
            if (h->sheet[i] < 0) continue;
            size[h->sheet[i]]++;
            on[h->sheet[i]] += h->on_stem[i];
        }
        for (size_t i = 0; i < thinned->count; i++)
            if (h->sheet[i] >= 0 && (double)on[h->sheet[i]] >= ON_STEM * (double)size[h->sheet[i]])
                h->on_stem[i] = true;
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

/* Where a leaf comes in the count. */
typedef struct leaf_place {
    double height;
    int32_t sheet;
    size_t size;
} leaf_place;

static int by_height(const void *a, const void *b)
{
    const leaf_place *p = a, *q = b;
    if (p->height != q->height) return p->height < q->height ? -1 : 1;
    return (p->sheet > q->sheet) - (p->sheet < q->sheet);
}

/* Where the leaves are: each sheet's points off the stem, and the height of the one nearest to the plant's middle. nearest: scratch,
 * one a sheet. */
static void find_places(const head *h, leaf_place *place, double *nearest)
{
    const plm_thinned *thinned = &h->surface->thinned;
    double middle[2] = {0, 0};
    for (size_t i = 0; i < thinned->count; i++)
        for (int a = 0; a < 2; a++) middle[a] += thinned->xyz[i][a] / (double)thinned->count;
    for (int a = 0; a < 2 && h->stem.count; a++) middle[a] = h->stem.circle[h->stem.count - 1][a];
    for (size_t k = 0; k < h->sheets; k++) place[k].sheet = (int32_t)k;
    for (size_t i = 0; i < thinned->count; i++) {
        const int32_t sheet = h->sheet[i];
        if (sheet < 0 || h->on_stem[i]) continue;
        const double distance = hypot(thinned->xyz[i][0] - middle[0], thinned->xyz[i][1] - middle[1]);
        if (!place[sheet].size++ || distance < nearest[sheet]) {
            nearest[sheet] = distance;
            place[sheet].height = thinned->xyz[i][2];
        }
    }
}

/* Numbers the leaves from the lowest foot up; sheets without a point off the stem are none. largest: points of the largest leaf, all:
 * of all. */
static plm_status number_leaves(head *h, size_t *largest, size_t *all, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    leaf_place *place = plm_scratch_take(&scratch, h->sheets + 1, sizeof *place);
    double *nearest = plm_scratch_take(&scratch, h->sheets + 1, sizeof *nearest);
    int32_t *number = plm_scratch_take(&scratch, h->sheets + 1, sizeof *number);
    *largest = *all = 0;
    if (!scratch.failed) {
        size_t leaves = 0;
        find_places(h, place, nearest);
        qsort(place, h->sheets, sizeof *place, by_height);
        for (size_t k = 0; k < h->sheets; k++) {
            number[place[k].sheet] = place[k].size ? (int32_t)leaves++ : -1;
            if (place[k].size > *largest) *largest = place[k].size;
            *all += place[k].size;
        }
        for (size_t i = 0; i < h->surface->thinned.count; i++)
            h->sheet[i] = h->sheet[i] < 0 || h->on_stem[i] ? -1 : number[h->sheet[i]];
        h->sheets = leaves;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

static void write_labels(const head *h, const uint32_t *row, size_t count, plm_segmentation *result)
{
    for (size_t i = 0; i < count; i++) {
        const uint32_t at = h->surface->thinned.voxels.owner[i];
        const bool is_stem = h->on_stem[at];
        result->label[row[i]] = is_stem ? PLM_LABEL_STEM : h->sheet[at] < 0 ? PLM_LABEL_OTHER : PLM_LABEL_LEAF;
        result->organ[row[i]] = is_stem ? 0 : h->sheet[at];
    }
    result->leaf_count = h->sheets;
    result->habit = PLM_HABIT_HEAD;
    result->stem_radius = h->stem.count ? h->stem.circle[h->stem.count / 2][2] : 0;
}

plm_status plm_find_head(const float (*xyz)[3], const uint32_t *row, size_t count, double noise,
                         plm_segmentation *result, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    plm_sheet_surface surface = {0};
    head h = {.surface = &surface};
    size_t largest = 0, all = 0;
    plm_error ours = {0};
    plm_status status = plm_sheet_surface_make(xyz, count, noise, &surface, &ours);
    if (status == PLM_E_DEGENERATE) return PLM_OK; /* no sheets: all stays as it is */
    if (status != PLM_OK && error) *error = ours;
    if (status == PLM_OK) {
        h.sheet = plm_scratch_take(&scratch, surface.thinned.count, sizeof *h.sheet);
        h.on_stem = plm_scratch_take(&scratch, surface.thinned.count, sizeof *h.on_stem);
        if (scratch.failed) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) status = plm_find_sheets(&surface, h.sheet, &h.sheets, error);
    if (status == PLM_OK) status = join_pieces(&h, error);
    if (status == PLM_OK) status = mark_stem(&h, noise, error);
    if (status == PLM_OK) status = number_leaves(&h, &largest, &all, error);
    const bool is_head = h.sheets >= FEWEST_LEAVES && (double)largest <= MOST * (double)all;
    if (status == PLM_OK && h.sheets && (is_head || result->habit == PLM_HABIT_HEAD))
        write_labels(&h, row, count, result);
    plm_head_stem_free(&h.stem);
    plm_scratch_free(&scratch, NULL);
    plm_sheet_surface_free(&surface);
    return status;
}
