/* cloud/neighbours.h: exact nearest neighbours and radius queries over a fixed set of points. Internal.
 *
 * Results never depend on the order of the points' rows in memory beyond their row numbers: neighbours come sorted by
 * distance, and of equal distances the smaller row comes first (and wins the last place). Distances are squared, in the
 * unit of xyz squared, computed in float from float offsets: centre a cloud first. */
#ifndef PLANTIMETER_CLOUD_NEIGHBOURS_H
#define PLANTIMETER_CLOUD_NEIGHBOURS_H

#include "cloud/cloud.h"

/** No such row: fills the places of neighbours that do not exist (fewer points than asked for). */
#define PLM_NO_ROW UINT32_MAX

typedef struct plm_index plm_index;

/** Builds an index over count points, which must stay in place and unchanged until plm_index_free. count 0 is allowed:
 * queries then find nothing. Finite coordinates are the caller's duty. O(n log n). */
plm_status plm_index_build(const float (*xyz)[3], size_t count, plm_index **index, plm_error *error);

/** NULL is allowed. */
void plm_index_free(plm_index *index);

/** The k nearest points to query: row[0..k), squared[0..k) (either may be NULL), sorted. Gives how many there are (k, or
 * the number of points where that is less); places beyond are filled with PLM_NO_ROW and INFINITY. k at most 1024. No
 * allocation; any number of threads may ask one index at once. */
size_t plm_index_nearest(const plm_index *index, const float query[3], size_t k, uint32_t *row, float *squared);

/** The k nearest neighbours of the indexed point `point`, itself left out; else as plm_index_nearest. */
size_t plm_index_neighbours(const plm_index *index, uint32_t point, size_t k, uint32_t *row, float *squared);

/** All points with squared distance <= radius * radius from query, sorted by distance, at most room of them written.
 * Gives the number of points in the ball, which may be larger than room (then the room nearest ones are NOT guaranteed:
 * call again with more). */
size_t plm_index_ball(const plm_index *index, const float query[3], float radius, size_t room, uint32_t *row,
                      float *squared);

/** k nearest neighbours (1 to 1024) of every one of count points, the point itself left out: row[i * k + j],
 * squared[i * k + j] (either may be NULL), each line of the table sorted; duplicates of a point are neighbours at distance
 * 0. Needs no index. Parallel. */
plm_status plm_neighbour_table(const float (*xyz)[3], size_t count, size_t k, uint32_t *row, float *squared,
                               plm_error *error);

/** The same for the points of an index. */
plm_status plm_index_table(const plm_index *index, size_t k, uint32_t *row, float *squared, plm_error *error);

#endif
