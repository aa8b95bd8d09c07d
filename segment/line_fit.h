/* segment/line_fit.h: a straight line through places that are known with how far along it they lie. Internal. */
#ifndef PLANTIMETER_SEGMENT_LINE_FIT_H
#define PLANTIMETER_SEGMENT_LINE_FIT_H

#include "cloud/linear.h"

/** Sums over places; {0} at the start. */
typedef struct plm_line_sums {
    double n, t, square, place[3], product[3];
} plm_line_sums;

static inline void plm_line_add(plm_line_sums *sums, double t, const double place[3])
{
    sums->n++, sums->t += t, sums->square += t * t;
    for (int a = 0; a < 3; a++) sums->place[a] += place[a], sums->product[a] += t * place[a];
}

/** Least squares: the place at t = 0 and the unit direction of growing t. false where fewer than four places, or all at one t,
 * tell none. */
static inline bool plm_line_fit(const plm_line_sums *sums, double origin[3], double along[3])
{
    const double n = sums->n, spread = sums->square - sums->t * sums->t / n;
    if (n < 4 || !(spread > 0)) return false;
    for (int a = 0; a < 3; a++) {
        along[a] = (sums->product[a] - sums->t * sums->place[a] / n) / spread;
        origin[a] = (sums->place[a] - sums->t * along[a]) / n;
    }
    return plm_normalise(along) > 0;
}

#endif
