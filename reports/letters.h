/* reports/letters.h: the letters of the pictures, as strokes. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_LETTERS_H
#define PLANTIMETER_REPORTS_LETTERS_H

#include <stddef.h>
#include <stdint.h>

/** A letter: 70 units are the height of a capital, 50 that of an x; the baseline is y = 0, y goes up. */
typedef struct plm_letter {
    uint32_t code;    /**< Unicode */
    int advance;      /**< to the next letter */
    const char *path; /**< strokes: M x y begins one, L x y draws on, A cx cy rx ry from to begins one along an ellipse
                           (degrees, anticlockwise), a ... draws on to an ellipse's beginning and along it */
} plm_letter;

/** The letter of a code; a box where there is none. */
const plm_letter *plm_letter_find(uint32_t code);

/** Reads the code of the first letter of UTF-8 text and moves text behind it; a byte that is no UTF-8 counts as a letter
 * that is not known. */
uint32_t plm_letter_next(const char **text);

/** Reads strokes as short lines: gives the next one as x0, y0, x1, y1 in units, or 0 at the end. *at is the path, and
 * then where reading stands; state is zero at the beginning. */
typedef struct plm_stroke_state {
    double x, y;                        /* the pen */
    double cx, cy, rx, ry, angle, last; /* an ellipse under way */
    int steps;                          /* of it that are left */
} plm_stroke_state;
int plm_stroke_next(const char **at, plm_stroke_state *state, double line[4]);

#endif
