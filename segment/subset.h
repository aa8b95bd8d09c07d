/* segment/subset.h: some of many points, the same ones whatever the order of the rows is. Internal. */
#ifndef PLANTIMETER_SEGMENT_SUBSET_H
#define PLANTIMETER_SEGMENT_SUBSET_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** A number made of a point's bits. */
static inline uint32_t plm_point_bits(const float xyz[3])
{
    uint32_t word[3], mixed = 0;
    memcpy(word, xyz, sizeof word);
    for (int i = 0; i < 3; i++) {
        mixed = (mixed ^ word[i]) * UINT32_C(0x9E3779B1);
        mixed ^= mixed >> 15;
    }
    return mixed;
}

/** The mask under which about at most `most` of count points have no bit: a point belongs to the subset when
 * (plm_point_bits(xyz) & mask) == 0. 0 (all points) when count is not above most. */
static inline uint32_t plm_subset_mask(size_t count, size_t most)
{
    uint32_t mask = 0;
    while (count / ((size_t)mask + 1) > most && mask < UINT32_MAX / 2) mask = 2 * mask + 1;
    return mask;
}

#endif
