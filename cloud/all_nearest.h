/* cloud/all_nearest.h: every point of a cloud with its k nearest neighbours, handed to a visitor. Internal.
 *
 * Nothing is stored for a point once it has been visited, so that a pass over a large cloud costs little memory. The
 * neighbours are exact: the k of smallest squared distance (in float, from float offsets), the point itself left out, and
 * of equally far ones those with the smaller row. */
#ifndef PLANTIMETER_CLOUD_ALL_NEAREST_H
#define PLANTIMETER_CLOUD_ALL_NEAREST_H

#include "cloud/cloud.h"

/** Largest number of neighbours. */
enum { PLM_MOST_NEIGHBOURS = 1024 };

/** A point and its neighbours: number j has the squared distance squared[j], and x, y, z and row at place[j]. Their order
 * does not depend on threads, and must not matter. */
typedef struct plm_neighbourhood {
    uint32_t point_row;
    float point[3];
    size_t count; /* k, or all other points where there are fewer */
    const uint32_t *place;
    const float *squared;
    const float *x, *y, *z;
    const uint32_t *row;
} plm_neighbourhood;

/** Called once for each point, from several threads, in any order. */
typedef void (*plm_neighbour_visit)(void *user, const plm_neighbourhood *found);

/** Visits count points. k is 1 to PLM_MOST_NEIGHBOURS. Parallel; about 3.5 times the bytes of xyz while it runs, a third
 * of a microsecond a point for k = 16. On an error some points may have been visited. */
plm_status plm_all_nearest(const float (*xyz)[3], size_t count, size_t k, plm_neighbour_visit visit, void *user,
                           plm_error *error);

#endif
