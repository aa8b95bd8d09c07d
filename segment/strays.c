/* segment/strays.c: points of a blade or petiole that lie apart from it, amid points of a stem or petiole, are points of
 * those that noise put beside them. Few as they are, they draw a leaf's surface out along the stem. */
#include "segment/scratch.h"
#include "segment/sketch.h"
#include "segment/stem_fit.h"
#include "segment/votes.h"

#include <math.h>

enum { NEIGHBOURS = 8, STEM = 1 }; /* colours: 0 other, 1 stem, 2 leaf + 2 petiole, one more blade */
static const double SMALL = 0.008; /* share of the blade's or petiole's points */
static const double AMID = 0.7;    /* share of the neighbours beside it that are of one organ */
/* SMALL of a piece that lies on the stem: half of its points within so many of its radii plus sigma of its line. The medians of
 * most such pieces are 1.1 to 1.3 of them, those of parts of leaves amid a stem's points (two real maize, a soybean) 1.8 and more. */
static const double LARGE = 0.05, ON_STEM = 1.35;

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
    uint32_t *on_stem;              /* points of a component that lie on the stem */
} stray_work;

static plm_status find_components(const plm_sketch *sketch, plm_scratch *scratch, stray_work *work)
{
    const size_t count = sketch->working.count;
    work->colour = plm_scratch_take(scratch, count, sizeof *work->colour);
    work->component = plm_scratch_take(scratch, count, sizeof *work->component);
    work->winner = plm_scratch_take(scratch, count, sizeof *work->winner);
    work->stack = plm_scratch_take(scratch, count, sizeof *work->stack);
    work->whole = plm_scratch_take(scratch, 2 * sketch->leaf_count + 2, sizeof *work->whole);
    work->size = plm_scratch_take(scratch, count, sizeof *work->size);
    work->on_stem = plm_scratch_take(scratch, count, sizeof *work->on_stem);
    if (scratch->failed) return PLM_E_MEMORY;
    const plm_status status = plm_graph_build((const float(*)[3])sketch->working.xyz, count, NEIGHBOURS, INFINITY,
                                              &work->near, scratch->error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) work->whole[work->colour[i] = colour_of(sketch, i)]++;
    const size_t components = plm_graph_components(&work->near, work->colour, work->component, work->stack);
    for (size_t i = 0; i < count; i++) work->size[work->component[i]]++;
    for (size_t c = 0; c < components; c++) work->winner[c] = -1;
    return PLM_OK;
}

/* Share of its organ's points that a point's component has. */
static double share_of(const stray_work *work, size_t i)
{
    return (double)work->size[work->component[i]] / (double)work->whole[work->colour[i]];
}

/* Votes of the neighbours of components that are less than LARGE; gives how many. */
static size_t gather_votes(const stray_work *work, plm_vote *votes)
{
    const plm_graph *near = &work->near;
    size_t count = 0;
    for (uint32_t i = 0; i < near->count; i++) {
        if (share_of(work, i) >= LARGE) continue;
        for (uint32_t e = near->first[i]; e < near->first[i + 1]; e++)
            if (work->colour[near->edge[e]] != work->colour[i])
                votes[count++] = (plm_vote){work->component[i], work->colour[near->edge[e]]};
    }
    return count;
}

/* Of components that are neither small nor too large. */
static void count_on_stem(const plm_sketch *sketch, stray_work *work)
{
    for (size_t i = 0; sketch->stem.count && i < sketch->working.count; i++) {
        if (share_of(work, i) < SMALL || share_of(work, i) >= LARGE) continue;
        plm_stem_place place;
        const double off = plm_stem_nearest(&sketch->stem, sketch->working.xyz[i], &place);
        work->on_stem[work->component[i]] += off <= ON_STEM * place.radius + sketch->scale.noise;
    }
}

static bool is_stray(const stray_work *work, size_t i, int32_t winner)
{
    const int32_t component = work->component[i];
    const bool lies_on_stem = winner == STEM && 2 * work->on_stem[component] >= work->size[component];
    return share_of(work, i) < (lies_on_stem ? LARGE : SMALL) && yields(work->colour[i], winner);
}

plm_status plm_sketch_strays(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    if (count <= NEIGHBOURS) return PLM_OK;
    stray_work work = {0};
    plm_scratch scratch = {.error = error};
    plm_status status = find_components(sketch, &scratch, &work);
    plm_vote *votes = status == PLM_OK ? plm_scratch_take(&scratch, work.near.first[count] + 1, sizeof *votes) : NULL;
    if (status == PLM_OK && !votes) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        count_on_stem(sketch, &work);
        plm_votes_count(votes, gather_votes(&work, votes), AMID, work.winner);
        for (size_t i = 0; i < count; i++) {
            const int32_t winner = work.winner[work.component[i]];
            if (is_stray(&work, i, winner)) recolour(sketch, i, winner);
        }
    }
    plm_graph_free(&work.near);
    plm_scratch_free(&scratch, NULL);
    return status;
}
