/* segment/strap_match.c: a strap leaf bows as a thrown stone flies. Of the ways in which feet and tips of blades that touch can be one
 * another's, that is right in which each foot and its tip lie on one such arc. */
#include "segment/strap_match.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

static const double ABOUT = 0.08; /* of the plant's size: how far ways through another blade are off */
enum { STEPS = 10 };

void plm_strap_piece_add(plm_strap_piece *piece, double way, const double place[3])
{
    double power = 1;
    for (int k = 0; k < 5; k++, power *= way) {
        piece->power[k] += power;
        for (int axis = 0; axis < 3 && k < 3; axis++) piece->product[axis][k] += power * place[axis];
    }
    piece->squares += plm_dot(place, place);
}

/* Sets out on the points of both pieces the arc that fits them best; squares: of what is left. b: NULL for none. */
static bool fit(const plm_strap_piece *a, const plm_strap_piece *b, plm_strap_arc *arc, double *squares)
{
    static const plm_strap_piece none = {0};
    if (!b) b = &none;
    *squares = a->squares + b->squares;
    for (int axis = 0; axis < 3; axis++) {
        double matrix[9], product[3];
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) matrix[3 * i + j] = a->power[i + j] + b->power[i + j];
            arc->gain[axis][i] = product[i] = a->product[axis][i] + b->product[axis][i];
        }
        if (!plm_solve_spd(3, matrix, arc->gain[axis])) return false;
        for (int i = 0; i < 3; i++) *squares -= arc->gain[axis][i] * product[i];
    }
    return true;
}

bool plm_strap_find_arc(const plm_strap_piece *a, const plm_strap_piece *b, plm_strap_arc *arc)
{
    double squares;
    return fit(a, b, arc, &squares);
}

static double misfit(const plm_strap_piece *a, const plm_strap_piece *b)
{
    plm_strap_arc arc;
    double squares;
    return fit(a, b, &arc, &squares) ? squares : INFINITY;
}

double plm_strap_arc_distance(const plm_strap_arc *arc, double way, const double place[3])
{
    double least = INFINITY;
    for (int step = -STEPS; step <= STEPS; step++) {
        const double w = way + ABOUT * step / STEPS;
        double squares = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double *g = arc->gain[axis], d = place[axis] - (g[0] + w * (g[1] + w * g[2]));
            squares += d * d;
        }
        least = fmin(least, squares);
    }
    return sqrt(least);
}

typedef struct search {
    size_t legs, tips;
    double pair[PLM_STRAP_PIECES_MOST][PLM_STRAP_PIECES_MOST], leg_alone[PLM_STRAP_PIECES_MOST],
        tip_alone[PLM_STRAP_PIECES_MOST];
    int chosen[PLM_STRAP_PIECES_MOST], best[PLM_STRAP_PIECES_MOST];
    bool taken[PLM_STRAP_PIECES_MOST];
    double least;
} search;

/* Tries all that the legs from one on can go on in; left: legs that may yet stay without a tip. */
static void try_from(search *s, size_t leg, size_t left, double sum)
{
    if (leg == s->legs) {
        for (size_t k = 0; k < s->tips; k++)
            if (!s->taken[k]) sum += s->tip_alone[k];
        if (!(sum < s->least)) return;
        s->least = sum;
        memcpy(s->best, s->chosen, sizeof s->best);
        return;
    }
    for (size_t k = 0; k < s->tips; k++) {
        if (s->taken[k]) continue;
        s->taken[k] = true;
        s->chosen[leg] = (int)k;
        try_from(s, leg + 1, left, sum + s->pair[leg][k]);
        s->taken[k] = false;
    }
    s->chosen[leg] = -1;
    if (left) try_from(s, leg + 1, left - 1, sum + s->leg_alone[leg]);
}

void plm_strap_match(const plm_strap_piece *leg, size_t legs, const plm_strap_piece *tip, size_t tips, int *tip_of_leg)
{
    search s = {.legs = legs, .tips = tips, .least = INFINITY};
    for (size_t i = 0; i < legs; i++) {
        s.best[i] = -1;
        s.leg_alone[i] = misfit(&leg[i], NULL);
        for (size_t k = 0; k < tips; k++) s.pair[i][k] = misfit(&leg[i], &tip[k]);
    }
    for (size_t k = 0; k < tips; k++) s.tip_alone[k] = misfit(&tip[k], NULL);
    try_from(&s, 0, legs > tips ? legs - tips : 0, 0);
    memcpy(tip_of_leg, s.best, legs * sizeof *tip_of_leg);
}
