/* traits/blurred_end.h: where a row of points along a line ends, with noise and gaps between them. Internal. */
#ifndef PLANTIMETER_TRAITS_BLURRED_END_H
#define PLANTIMETER_TRAITS_BLURRED_END_H

#include <stddef.h>

/** An end and its standard error, in the unit of the positions. */
typedef struct plm_end {
    double position, std_error;
} plm_end;

/** The upper end of points that lie evenly up to an edge and carry normal noise of SD sigma along the line.
 *
 * The highest of them overshoots the edge where many points lie within sigma of it, and falls short where the gaps are
 * wider than sigma. With lambda points per length inside, the number of points expected beyond edge + z sigma is
 * lambda sigma (phi(z) - z Q(z)); the median of the highest is where that is ln 2. Solved for the edge; lambda is that of
 * the last points. position: count values, at least 2, reordered. sigma may be 0. */
plm_end plm_blurred_end(double *position, size_t count, double sigma);

#endif
