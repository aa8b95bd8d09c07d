/* cloud/candidates.h: a list of points, and the k of them that are nearest to a point. Internal. */
#ifndef PLANTIMETER_CLOUD_CANDIDATES_H
#define PLANTIMETER_CLOUD_CANDIDATES_H

#include "cloud/cloud.h"

/** Candidates by place 0 to count - 1, and what was chosen of them last. Belongs to one thread; all zero is empty. */
typedef struct plm_candidates {
    size_t count, room;
    float *x, *y, *z;
    uint32_t *row;
    float *squared;   /* distances of all of them */
    uint32_t *chosen; /* places of the nearest, in no order ... */
    float *near;      /* ... and their squared distances */
    float guess;      /* what the next threshold may be */
} plm_candidates;

/** Empties the list and makes room for count candidates. */
plm_status plm_candidates_reset(plm_candidates *list, size_t count, plm_error *error);

/** Adds count points; there must be room. */
void plm_candidates_add(plm_candidates *list, const float *x, const float *y, const float *z, const uint32_t *row,
                        size_t count);

void plm_candidates_free(plm_candidates *list);

/** Chooses the k candidates nearest to point, of equally far ones those with the smaller row, none with a squared
 * distance above limit (finite), and never the one at place `self`. Gives false where there are fewer than k. */
bool plm_candidates_nearest(plm_candidates *list, const float point[3], size_t self, size_t k, float limit);

#endif
