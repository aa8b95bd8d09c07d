/* simulate/turn.h: sine and cosine for rays. Internal. */
#ifndef PLANTIMETER_SIMULATE_TURN_H
#define PLANTIMETER_SIMULATE_TURN_H

#include "cloud/linear.h"

/** Sine and cosine of a share of the full turn, in [0, 1]: a series to the last digit of a float, without a branch, so that the compiler
 * can take several at once. */
static inline void plm_turn_of(float share, float *sine, float *cosine)
{
    const int quarter = (int)(4 * share + 0.5F);
    const float x = (share - 0.25F * (float)quarter) * (float)(2 * PLM_PI), y = x * x; /* -pi/4 to pi/4 */
    const float s = x + x * y * (-1.F / 6 + y * (1.F / 120 - y * (1.F / 5040)));
    const float c = 1 + y * (-0.5F + y * (1.F / 24 + y * (-1.F / 720 + y * (1.F / 40320))));
    const float swapped_s = quarter & 1 ? c : s, swapped_c = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -swapped_s : swapped_s;
    *cosine = (quarter + 1) & 2 ? -swapped_c : swapped_c;
}

#endif
