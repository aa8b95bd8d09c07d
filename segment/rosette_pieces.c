/* segment/rosette_pieces.c: a leaf's border with its petiole is told by the way from the core, and what is as far out counts as
 * its blade: so does a piece of another leaf that leans on the petiole, and without noise what
 * looked flat at the petiole's own foot. But a blade is one piece. */
#include "segment/rosette_pieces.h"

#include "cloud/neighbours.h"
#include "cloud/order.h"
#include "segment/graph.h"
#include "segment/leaf_of.h"
#include "segment/scratch.h"
#include "segment/votes.h"

#include <math.h>

/* Of the blade's points: a larger piece is no less the blade than the rest. */
static const double SMALL = 0.3;
/* Points farther from each other than this many usual distances to the FIFTH neighbour are not linked (2 on seven sets of virtual
 * splats: of 1500 points in pieces of three and more one in six is the blade's own, 1.5: one in two). */
static const double LINK = 2;
static const double AMID = 2; /* of the same: what is farther is not beside a piece */
/* Points of a piece that something is beside, at least: what only touches another leaf, as a tip that another leaf hides the way to, is
 * not amid it (0.71 and more of those that moved in 32 virtual rosettes). */
static const double MOST = 0.5;
enum { LINKS = 8, FIFTH = 5, FEWEST = 12, BESIDE = 8 };

typedef struct work {
    const float (*xyz)[3];
    const uint32_t *row;
    size_t count;
    plm_segmentation *out;
    int32_t *piece; /* of each point; -1: it is in none */
    float *reach;   /* of a piece: how far what is beside it may be */
    size_t pieces;
    uint32_t *points, *voters; /* of a piece: its points, those that something is beside */
    /* of one leaf: its blade's points, their places, and in which component each is */
    uint32_t *point;
    float (*place)[3];
    uint32_t *stack, *size;
    int32_t *component, *number;
    float *squared;
    double *fifth;
} work;

static bool is_blade_of(const work *w, size_t i, size_t leaf)
{
    return w->out->label[w->row[i]] == PLM_LABEL_LEAF && (size_t)w->out->organ[w->row[i]] == leaf;
}

static size_t gather_blade(work *w, size_t leaf)
{
    size_t count = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        if (!is_blade_of(w, i, leaf)) continue;
        for (int a = 0; a < 3; a++) w->place[count][a] = w->xyz[i][a];
        w->point[count++] = i;
    }
    return count;
}

static plm_status usual_distance(const work *w, size_t count, double *usual, plm_error *error)
{
    const plm_status status = plm_neighbour_table((const float(*)[3])w->place, count, FIFTH, NULL, w->squared, error);
    for (size_t i = 0; status == PLM_OK && i < count; i++) w->fifth[i] = sqrt(w->squared[i * FIFTH + FIFTH - 1]);
    *usual = status == PLM_OK ? plm_order_median(w->fifth, count) : 0;
    return status;
}

/* Marks the small pieces of a blade. */
static plm_status find_pieces(work *w, size_t leaf, plm_error *error)
{
    const size_t count = gather_blade(w, leaf);
    if (count < FEWEST) return PLM_OK;
    double usual;
    plm_graph graph = {0};
    plm_status status = usual_distance(w, count, &usual, error);
    if (status != PLM_OK || !(usual > 0)) return status;
    status = plm_graph_build((const float(*)[3])w->place, count, LINKS, LINK * usual, &graph, error);
    if (status != PLM_OK) return status;
    const size_t components = plm_graph_components(&graph, NULL, w->component, w->stack);
    size_t largest = 0;
    for (size_t c = 0; c < components; c++) w->size[c] = 0;
    for (size_t j = 0; j < count; j++) w->size[w->component[j]]++;
    for (size_t c = 1; c < components; c++)
        if (w->size[c] > w->size[largest]) largest = c;
    for (size_t c = 0; c < components; c++) {
        const bool small = c != largest && (double)w->size[c] < SMALL * (double)count;
        w->number[c] = small ? (int32_t)w->pieces : -1;
        if (!small) continue;
        w->points[w->pieces] = w->size[c];
        w->reach[w->pieces++] = (float)(AMID * LINK * usual);
    }
    for (size_t j = 0; j < count; j++) w->piece[w->point[j]] = w->number[w->component[j]];
    plm_graph_free(&graph);
    return PLM_OK;
}

static int32_t colour_of(const work *w, size_t i)
{
    return 2 * w->out->organ[w->row[i]] + (w->out->label[w->row[i]] == PLM_LABEL_LEAF);
}

/* Each point of a piece votes for the organs of those beside it that are in none. point: of each of these. */
static size_t gather_votes(const work *w, const plm_index *index, const uint32_t *point, plm_vote *votes)
{
    size_t count = 0;
    for (size_t i = 0; i < w->count; i++) {
        if (w->piece[i] < 0) continue;
        uint32_t row[BESIDE];
        float squared[BESIDE];
        const float reach = w->reach[w->piece[i]];
        const size_t found = plm_index_nearest(index, w->xyz[i], BESIDE, row, squared);
        w->voters[w->piece[i]] += found && squared[0] <= reach * reach;
        for (size_t j = 0; j < found && squared[j] <= reach * reach; j++)
            votes[count++] = (plm_vote){w->piece[i], colour_of(w, point[row[j]])};
    }
    return count;
}

/* Gives the pieces to what they lie amid. */
static plm_status give_pieces(work *w, plm_scratch *scratch, plm_error *error)
{
    size_t pieced = 0, others = 0;
    for (size_t i = 0; i < w->count; i++) pieced += w->piece[i] >= 0;
    plm_vote *votes = plm_scratch_take(scratch, BESIDE * pieced + 1, sizeof *votes);
    int32_t *winner = plm_scratch_take(scratch, w->pieces + 1, sizeof *winner);
    if (scratch->failed) return PLM_E_MEMORY;
    for (uint32_t i = 0; i < w->count; i++) {
        if (w->piece[i] >= 0 || plm_leaf_of(w->out, w->row[i]) < 0) continue;
        for (int a = 0; a < 3; a++) w->place[others][a] = w->xyz[i][a];
        w->point[others++] = i;
    }
    plm_index *index = NULL;
    const plm_status status = plm_index_build((const float(*)[3])w->place, others, &index, error);
    if (status != PLM_OK) return status;
    for (size_t p = 0; p < w->pieces; p++) winner[p] = -1;
    plm_votes_count(votes, gather_votes(w, index, w->point, votes), 0, winner);
    plm_index_free(index);
    for (size_t p = 0; p < w->pieces; p++)
        if (w->voters[p] < MOST * w->points[p]) winner[p] = -1;
    for (size_t i = 0; i < w->count; i++) {
        if (w->piece[i] < 0 || winner[w->piece[i]] < 0) continue;
        const int32_t colour = winner[w->piece[i]];
        w->out->label[w->row[i]] = colour % 2 ? PLM_LABEL_LEAF : PLM_LABEL_PETIOLE;
        w->out->organ[w->row[i]] = colour / 2;
    }
    return PLM_OK;
}

plm_status plm_rosette_pieces(const float (*xyz)[3], const uint32_t *row, size_t count, plm_segmentation *out,
                              plm_error *error)
{
    plm_scratch scratch = {.error = error};
    work w = {.xyz = xyz, .row = row, .count = count, .out = out};
    w.piece = plm_scratch_take(&scratch, count + 1, sizeof *w.piece);
    w.points = plm_scratch_take(&scratch, count + 1, sizeof *w.points);
    w.voters = plm_scratch_take(&scratch, count + 1, sizeof *w.voters);
    w.reach = plm_scratch_take(&scratch, count + 1, sizeof *w.reach);
    w.point = plm_scratch_take(&scratch, count + 1, sizeof *w.point);
    w.place = plm_scratch_take(&scratch, count + 1, sizeof *w.place);
    w.stack = plm_scratch_take(&scratch, count + 1, sizeof *w.stack);
    w.size = plm_scratch_take(&scratch, count + 1, sizeof *w.size);
    w.component = plm_scratch_take(&scratch, count + 1, sizeof *w.component);
    w.number = plm_scratch_take(&scratch, count + 1, sizeof *w.number);
    w.squared = plm_scratch_take(&scratch, FIFTH * count + 1, sizeof *w.squared);
    w.fifth = plm_scratch_take(&scratch, count + 1, sizeof *w.fifth);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    for (size_t i = 0; status == PLM_OK && i < count; i++) w.piece[i] = -1;
    for (size_t k = 0; status == PLM_OK && k < out->leaf_count; k++) status = find_pieces(&w, k, error);
    if (status == PLM_OK && w.pieces) status = give_pieces(&w, &scratch, error);
    plm_scratch_free(&scratch, NULL);
    return status;
}
