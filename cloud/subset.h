/* cloud/subset.h: some of a cloud's points, chosen by a hash of their coordinates, so that the order of rows plays no part.
 * Internal. */
#ifndef PLANTIMETER_CLOUD_SUBSET_H
#define PLANTIMETER_CLOUD_SUBSET_H

#include "cloud/neighbours.h"

/** Rows of about wanted of count points (all of them where there are no more), in row order: a random thinning. Fewer of
 * the same points are among them. row has room for count. Gives how many. */
size_t plm_sample_rows(const float (*xyz)[3], size_t count, size_t wanted, uint32_t *row);

/** Points with their index: all of a cloud, or where they lie far closer than a question needs, some of them. */
typedef struct plm_subset {
    const float (*xyz)[3];
    const plm_index *index;
    size_t count;
    float (*few)[3]; /**< owned, as its index and rows; NULL where all are taken */
    plm_index *few_index;
    uint32_t *few_row; /**< which of all they are */
} plm_subset;

/** Takes a share of count points at random, independently of plm_sample_rows, with an index of their own; all of them where
 * the share is near 1. xyz and index (over xyz) must outlive it; freed by plm_subset_free, which takes {0}
 * too. Its errors are those of memory. */
plm_status plm_subset_take(const plm_index *index, const float (*xyz)[3], size_t count, double share, plm_subset *taken,
                           plm_error *error);
void plm_subset_free(plm_subset *subset);

#endif
