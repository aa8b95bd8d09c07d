/* cloud/random.h: random numbers as a function of (key, index): any thread may ask for any of them, and the answer
 * never depends on who asked before. SplitMix64's finaliser over key and index (Steele, Lea and Flood, 2014). Internal.
 */
#ifndef PLANTIMETER_CLOUD_RANDOM_H
#define PLANTIMETER_CLOUD_RANDOM_H

#include <math.h>
#include <stdint.h>

static inline uint64_t plm_mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/** A key for a stream of its own. */
static inline uint64_t plm_key(uint64_t seed, uint64_t stream)
{
    return plm_mix(plm_mix(seed + 0x9e3779b97f4a7c15u) + 0xd1b54a32d192ed03u * (stream + 1));
}

/** Uniform in [0, 1) with 53 bits: number index of the stream. */
static inline double plm_uniform_at(uint64_t key, uint64_t index)
{
    return (double)(plm_mix(key + 0x9e3779b97f4a7c15u * (index + 1)) >> 11) * 0x1p-53;
}

/** Standard normal by Box and Muller from numbers 2 * index and 2 * index + 1 of the stream. */
static inline double plm_normal_at(uint64_t key, uint64_t index)
{
    const double u = plm_uniform_at(key, 2 * index), v = plm_uniform_at(key, 2 * index + 1);
    return sqrt(-2 * log(1 - u)) * cos(6.283185307179586 * v);
}

/** The same numbers one after the other, where the order is that of the code. */
typedef struct plm_random {
    uint64_t key, next;
} plm_random;

static inline double plm_draw(plm_random *random)
{
    return plm_uniform_at(random->key, random->next++);
}

static inline double plm_between(plm_random *random, double low, double high)
{
    return low + (high - low) * plm_draw(random);
}

static inline double plm_draw_normal(plm_random *random)
{
    random->next += 2 - random->next % 2; /* an even place: two numbers make one */
    return plm_normal_at(random->key, random->next / 2 - 1);
}

/** 0 to count - 1. */
static inline int plm_draw_index(plm_random *random, int count)
{
    return (int)(plm_draw(random) * count);
}

#endif
