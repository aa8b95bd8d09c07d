/* segment/strap_match.h: which of the blades that touch goes on in which. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_MATCH_H
#define PLANTIMETER_SEGMENT_STRAP_MATCH_H

#include <stdbool.h>
#include <stddef.h>

/** A piece of a blade, by sums over its points: enough for the parabola in the way from the base that fits it, or it and another piece. */
typedef struct plm_strap_piece {
    double power[5];      /**< of the way: to the 0th to 4th power */
    double product[3][3]; /**< of place and power of the way, by axis */
    double squares;       /**< of the places */
} plm_strap_piece;

/** Adds a point: its way from the base and its place, both in sizes of the plant and from the stem's base. */
void plm_strap_piece_add(plm_strap_piece *piece, double way, const double place[3]);

enum { PLM_STRAP_PIECES_MOST = 6 };

/** A blade's arc: by axis, what the place gains with each power of the way. */
typedef struct plm_strap_arc {
    double gain[3][3];
} plm_strap_arc;

/** The arc that two pieces lie on, or one (b: NULL); false: their points are too few. */
bool plm_strap_find_arc(const plm_strap_piece *a, const plm_strap_piece *b, plm_strap_arc *arc);

/** Distance of a place from an arc, about such a way along it. */
double plm_strap_arc_distance(const plm_strap_arc *arc, double way, const double place[3]);

/** For each leg (the foot of a blade) the tip that it goes on in, -1: none, as there are more legs than tips (PLM_STRAP_PIECES_MOST of
 * either at most): so that the points lie nearest, in squares, to one parabola a blade. */
void plm_strap_match(const plm_strap_piece *leg, size_t legs, const plm_strap_piece *tip, size_t tips, int *tip_of_leg);

#endif
