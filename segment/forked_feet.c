/* segment/forked_feet.c: where petioles of a rosette lean on each other near the core they make one foot, and where their
 * blades touch too, they seem one leaf. But between the two they are apart: so a foot that farther out is two strands or
 * more, each of which leads to a blade, is as many feet. */
#include "segment/forked_feet.h"

#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/side_groups.h"

#include <math.h>
#include <string.h>

static const double FIRST = 1.1, STEP = 0.5, LAST = 4.2; /* distances of the shells that are looked at, in R */
static const double TUBE_BELOW = 0.7; /* share of tube on this side of a shell, at least: else a blade has begun */
static const double TUBE_SHELL = 0.6; /* and of a piece of the shell that is a petiole; else it is a blade's base */
/* Of their middles, in R: the sides of one petiole are nearer, where it is torn, and so are those of one blade's base beside its
 * petiole. Two bases may be one blade that a gap parts. */
static const double APART = 0.8, BLADES_APART = 1.3;
enum { PIECE_LEAST = 4 }; /* points of such a piece */

/* A connected piece of the shell. */
typedef struct piece {
    size_t points, tubes;
    int32_t foot;
    double mean[3];
    double blade;   /* area beyond it */
    int32_t number; /* of the foot that it becomes, -1: none */
} piece;

typedef struct work {
    plm_sketch *sketch;
    const float *distance;
    size_t feet, pieces;
    plm_scratch scratch;
    bool *allowed;
    int32_t *colour, *piece_of, *origin;
    uint32_t *stack, *source, *tubes, *members;
    float *far;
    piece *piece;
    int32_t *first; /* of each foot: its first piece that leads to a blade; -1 */
} work;

static plm_status start(work *w)
{
    const size_t count = w->sketch->working.count;
    w->allowed = plm_scratch_take(&w->scratch, count, sizeof *w->allowed);
    w->colour = plm_scratch_take(&w->scratch, count, sizeof *w->colour);
    w->piece_of = plm_scratch_take(&w->scratch, count, sizeof *w->piece_of);
    w->origin = plm_scratch_take(&w->scratch, count, sizeof *w->origin);
    w->stack = plm_scratch_take(&w->scratch, count, sizeof *w->stack);
    w->source = plm_scratch_take(&w->scratch, count, sizeof *w->source);
    w->tubes = plm_scratch_take(&w->scratch, count + 1, sizeof *w->tubes);
    w->members = plm_scratch_take(&w->scratch, count + 1, sizeof *w->members);
    w->far = plm_scratch_take(&w->scratch, count, sizeof *w->far);
    w->piece = plm_scratch_take(&w->scratch, count + 1, sizeof *w->piece);
    w->first = plm_scratch_take(&w->scratch, count + 1, sizeof *w->first);
    return w->scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* The pieces of the shell, of feet whose blades have not begun on this side of it. */
static void find_pieces(work *w, double low, double high)
{
    const plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    memset(w->tubes, 0, w->feet * sizeof *w->tubes);
    memset(w->members, 0, w->feet * sizeof *w->members);
    for (size_t i = 0; i < count; i++) {
        if (s->group[i] < 0 || !(w->distance[i] < low)) continue;
        w->members[s->group[i]]++;
        w->tubes[s->group[i]] += s->is_tube[i];
    }
    for (size_t i = 0; i < count; i++) {
        const int32_t foot = s->group[i];
        const bool in_shell = foot >= 0 && w->distance[i] >= low && w->distance[i] < high;
        w->colour[i] = in_shell && w->tubes[foot] >= TUBE_BELOW * w->members[foot] ? foot : -1;
    }
    w->pieces = plm_graph_components(&s->graph, w->colour, w->piece_of, w->stack);
    for (size_t p = 0; p < w->pieces; p++) w->piece[p] = (piece){.number = -1};
    for (size_t i = 0; i < count; i++) {
        if (w->piece_of[i] < 0) continue;
        piece *p = &w->piece[w->piece_of[i]];
        p->foot = s->group[i];
        p->points++;
        p->tubes += s->is_tube[i];
        for (int axis = 0; axis < 3; axis++) p->mean[axis] += s->working.xyz[i][axis];
    }
    for (size_t p = 0; p < w->pieces; p++)
        for (int axis = 0; axis < 3; axis++) w->piece[p].mean[axis] /= (double)w->piece[p].points;
}

static bool is_strand(const piece *p)
{
    return p->points >= PIECE_LEAST;
}

static bool is_petiole(const piece *p)
{
    return (double)p->tubes >= TUBE_SHELL * (double)p->points;
}

/* origin[]: the piece that is nearest to each point beyond low; only such as are numbered, if asked for. */
static plm_status walk_from(work *w, double low, bool numbered, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    size_t sources = 0;
    for (uint32_t i = 0; i < s->working.count; i++) {
        w->allowed[i] = s->group[i] >= 0 && !(w->distance[i] < low);
        if (w->piece_of[i] < 0) continue;
        const piece *p = &w->piece[w->piece_of[i]];
        if (numbered ? p->number >= 0 : is_strand(p)) w->source[sources++] = i;
    }
    const plm_walk walk = {
        .source = w->source, .source_count = sources, .allowed = w->allowed, .distance = w->far, .origin = w->origin};
    const plm_status status = plm_graph_walk(&s->graph, &walk, error);
    for (size_t i = 0; status == PLM_OK && i < s->working.count; i++)
        if (w->origin[i] >= 0) w->origin[i] = w->piece_of[w->source[w->origin[i]]];
    return status;
}

/* Whether a piece is apart from those of its foot that were taken before it. */
static bool is_apart(const work *w, const piece *own)
{
    const double R = w->sketch->scale.radius;
    for (const piece *p = w->piece + w->first[own->foot]; p < own; p++) {
        const double d[3] = {p->mean[0] - own->mean[0], p->mean[1] - own->mean[1], p->mean[2] - own->mean[2]};
        const bool is_taken = p->number >= 0 || p == w->piece + w->first[own->foot];
        const int petioles = is_petiole(p) + is_petiole(own);
        const double least = petioles == 2 ? APART * R : petioles ? BLADES_APART * R : INFINITY;
        if (p->foot == own->foot && is_taken && plm_norm(d) < least) return false;
    }
    return true;
}

/* Pieces that lead to blades, of the same foot: those that are apart from the ones before them become feet of their own.
 * Gives whether there are any. */
static bool number_pieces(work *w)
{
    const plm_sketch *s = w->sketch;
    const double cell2 = s->working.cell * s->working.cell;
    const size_t before = w->feet;
    for (size_t i = 0; i < s->working.count; i++) {
        const int32_t p = w->origin[i];
        if (p >= 0 && !s->is_tube[i] && s->group[i] == w->piece[p].foot) w->piece[p].blade += cell2;
    }
    for (size_t f = 0; f < before; f++) w->first[f] = -1;
    for (size_t p = 0; p < w->pieces; p++) {
        piece *own = &w->piece[p];
        if (!is_strand(own) || own->blade < plm_blade_least(s)) continue;
        if (w->first[own->foot] < 0) {
            w->first[own->foot] = (int32_t)p;
            continue;
        }
        if (!is_apart(w, own)) continue;
        w->piece[w->first[own->foot]].number = own->foot;
        own->number = (int32_t)w->feet++;
    }
    return w->feet > before;
}

plm_status plm_forked_feet(plm_sketch *sketch, const float *distance, int32_t *component, size_t *feet,
                           plm_error *error)
{
    work w = {.sketch = sketch, .distance = distance, .feet = *feet, .scratch = {.error = error}};
    const double R = sketch->scale.radius;
    plm_status status = start(&w);
    for (double low = FIRST * R; status == PLM_OK && low < LAST * R; low += STEP * R) {
        find_pieces(&w, low, low + STEP * R);
        status = walk_from(&w, low, false, error);
        if (status != PLM_OK || !number_pieces(&w)) continue;
        status = walk_from(&w, 0, true, error);
        for (size_t i = 0; status == PLM_OK && i < sketch->working.count; i++) {
            const int32_t foot = sketch->group[i], p = w.origin[i];
            if (foot < 0 || p < 0 || w.piece[p].foot != foot) continue;
            sketch->group[i] = w.piece[p].number;
            if (component[i] == foot) component[i] = w.piece[p].number;
        }
    }
    *feet = w.feet;
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
