/* segment/strays.c: points of a blade or petiole that lie apart from it, amid points of a stem or petiole, are points of
 * those that noise put beside them. Few as they are, they draw a leaf's surface out along the stem. */
#include "segment/scratch.h"
#include "segment/sketch.h"
#include "segment/votes.h"

#include <math.h>

enum { NEIGHBOURS = 8, STEM = 1 }; /* colours: 0 other, 1 stem, 2 leaf + 2 petiole, one more blade */
static const double SMALL = 0.008; /* share of the organ's points */
static const double AMID = 0.7;    /* share of the neighbours beside it that are of one organ */

static int32_t colour_of(const plm_sketch *sketch, size_t i)
{
    if (sketch->is_stem[i]) return STEM;
    return sketch->leaf[i] < 0 ? 0 : 2 * sketch->leaf[i] + 2 + !sketch->is_tube[i];
}

static bool is_blade(int32_t colour)
{
    return colour > STEM && colour % 2 == 1;
}

/* Blades yield to stem and petioles, petioles to the stem. */
static bool yields(int32_t colour, int32_t to)
{
    return is_blade(colour) ? to > 0 && !is_blade(to) : colour > STEM && to == STEM;
}

static void recolour(plm_sketch *sketch, size_t i, int32_t colour)
{
    sketch->is_tube[i] = true;
    sketch->is_stem[i] = colour == STEM;
    sketch->leaf[i] = colour == STEM ? -1 : colour / 2 - 1;
    sketch->leaflet[i] = -1;
}

/* What the passes share; arrays of a row each point. */
typedef struct stray_work {
    plm_graph near;
    int32_t *colour, *component, *winner;
    uint32_t *stack, *whole, *size; /* whole: points of a colour; size: of a component */
    bool *is_small;
} stray_work;

static plm_status find_small(const plm_sketch *sketch, plm_scratch *scratch, stray_work *work)
{
    const size_t count = sketch->working.count;
    work->colour = plm_scratch_take(scratch, count, sizeof *work->colour);
    work->component = plm_scratch_take(scratch, count, sizeof *work->component);
    work->winner = plm_scratch_take(scratch, count, sizeof *work->winner);
    work->stack = plm_scratch_take(scratch, count, sizeof *work->stack);
    work->whole = plm_scratch_take(scratch, 2 * sketch->leaf_count + 2, sizeof *work->whole);
    work->size = plm_scratch_take(scratch, count, sizeof *work->size);
    work->is_small = plm_scratch_take(scratch, count, sizeof *work->is_small);
    if (scratch->failed) return PLM_E_MEMORY;
    const plm_status status = plm_graph_build((const float(*)[3])sketch->working.xyz, count, NEIGHBOURS, INFINITY,
                                              &work->near, scratch->error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) work->whole[work->colour[i] = colour_of(sketch, i)]++;
    const size_t components = plm_graph_components(&work->near, work->colour, work->component, work->stack);
    for (size_t i = 0; i < count; i++) work->size[work->component[i]]++;
    for (size_t i = 0; i < count; i++)
        work->is_small[i] = work->size[work->component[i]] < SMALL * (double)work->whole[work->colour[i]];
    for (size_t c = 0; c < components; c++) work->winner[c] = -1;
    return PLM_OK;
}

/* Votes of the neighbours of small components; gives how many. */
static size_t gather_votes(const stray_work *work, plm_vote *votes)
{
    const plm_graph *near = &work->near;
    size_t count = 0;
    for (uint32_t i = 0; i < near->count; i++) {
        if (!work->is_small[i]) continue;
        for (uint32_t e = near->first[i]; e < near->first[i + 1]; e++)
            if (work->colour[near->edge[e]] != work->colour[i])
                votes[count++] = (plm_vote){work->component[i], work->colour[near->edge[e]]};
    }
    return count;
}

plm_status plm_sketch_strays(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    if (count <= NEIGHBOURS) return PLM_OK;
    stray_work work = {0};
    plm_scratch scratch = {.error = error};
    plm_status status = find_small(sketch, &scratch, &work);
    plm_vote *votes = status == PLM_OK ? plm_scratch_take(&scratch, work.near.first[count] + 1, sizeof *votes) : NULL;
    if (status == PLM_OK && !votes) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        plm_votes_count(votes, gather_votes(&work, votes), AMID, work.winner);
        for (size_t i = 0; i < count; i++) {
            const int32_t winner = work.winner[work.component[i]];
            if (work.is_small[i] && yields(work.colour[i], winner)) recolour(sketch, i, winner);
        }
    }
    plm_graph_free(&work.near);
    plm_scratch_free(&scratch, NULL);
    return status;
}
