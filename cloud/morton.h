/* cloud/morton.h: rows in the order of 64-bit keys, and keys that follow space (Morton order, z-curve). Internal. */
#ifndef PLANTIMETER_CLOUD_MORTON_H
#define PLANTIMETER_CLOUD_MORTON_H

#include "cloud/cloud.h"

/** Bits of one axis in a Morton key. */
enum { PLM_MORTON_BITS = 21 };

static inline uint64_t plm_morton_spread(uint64_t x)
{
    x &= 0x1fffff;
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

static inline uint64_t plm_morton_squeeze(uint64_t x)
{
    x &= 0x1249249249249249;
    x = (x | x >> 2) & 0x10c30c30c30c30c3;
    x = (x | x >> 4) & 0x100f00f00f00f00f;
    x = (x | x >> 8) & 0x001f0000ff0000ff;
    x = (x | x >> 16) & 0x001f00000000ffff;
    return (x | x >> 32) & 0x1fffff;
}

/** The bits of x, y and z (21 of each), interlaced: the cells of a coarser grid are the keys without their last 3, 6,
 * ... bits. */
static inline uint64_t plm_morton_key(uint64_t x, uint64_t y, uint64_t z)
{
    return plm_morton_spread(x) | plm_morton_spread(y) << 1 | plm_morton_spread(z) << 2;
}

/** Keys and the rows that they belong to, side by side: what stands at key[i] is the key of row[i]. */
typedef struct plm_keys {
    size_t count;
    uint64_t *key;
    uint32_t *row;
} plm_keys;

/** Room for count keys and rows, not initialised. count must fit in 32 bits. */
plm_status plm_keys_create(size_t count, plm_keys *keys, plm_error *error);

/** NULL and a zeroed plm_keys are allowed. */
void plm_keys_free(plm_keys *keys);

/** Sorts by the low `bits` bits of the keys (all others must be 0); equal keys keep their order. Radix sort, O(n),
 * parallel; the result is the same for any number of threads. */
plm_status plm_keys_sort(plm_keys *keys, unsigned bits, plm_error *error);

#endif
