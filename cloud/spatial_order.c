/* cloud/spatial_order.c: Morton order (G. M. Morton, A computer oriented geodetic data base, 1966) by a radix sort of 63-bit
 * keys. Estimators that take every n-th point, and sums whose last digits depend on the order, then see the same
 * sequence for every order of a file's rows; and trees built over the points are faster (shared notes on performance). */
#include "cloud/spatial_order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AXIS_BITS = 21, DIGIT_BITS = 11, DIGITS = 6, BUCKETS = 1 << DIGIT_BITS };

typedef struct keyed_row {
    uint64_t key;
    uint32_t row;
} keyed_row;

/* Spreads the low 21 bits of value to every third bit. */
static uint64_t spread(uint64_t value)
{
    value &= 0x1fffff;
    value = (value | value << 32) & 0x1f00000000ffffu;
    value = (value | value << 16) & 0x1f0000ff0000ffu;
    value = (value | value << 8) & 0x100f00f00f00f00fu;
    value = (value | value << 4) & 0x10c30c30c30c30c3u;
    value = (value | value << 2) & 0x1249249249249249u;
    return value;
}

static void make_keys(const float (*xyz)[3], size_t count, keyed_row *keyed)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(low[axis], xyz[i][axis]);
            high[axis] = fmax(high[axis], xyz[i][axis]);
        }
    double size = 0;
    for (int axis = 0; axis < 3; axis++) size = fmax(size, high[axis] - low[axis]);
    const double cells = size > 0 ? ((1 << AXIS_BITS) - 1) / size : 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t key = 0;
        for (int axis = 0; axis < 3; axis++) key |= spread((uint64_t)((xyz[i][axis] - low[axis]) * cells)) << axis;
        keyed[i] = (keyed_row){key, (uint32_t)i};
    }
}

/* Least significant digit first; digits that are equal in all keys are passed over. Gives the block that holds the
 * sorted rows. */
static keyed_row *radix_sort(keyed_row *from, keyed_row *to, size_t count, size_t (*bucket)[BUCKETS])
{
    memset(bucket, 0, DIGITS * sizeof *bucket);
    for (size_t i = 0; i < count; i++)
        for (int digit = 0; digit < DIGITS; digit++)
            bucket[digit][from[i].key >> (digit * DIGIT_BITS) & (BUCKETS - 1)]++;
    for (int digit = 0; digit < DIGITS; digit++) {
        size_t *place = bucket[digit];
        const int shift = digit * DIGIT_BITS;
        if (count && place[from[0].key >> shift & (BUCKETS - 1)] == count) continue;
        size_t sum = 0;
        for (int b = 0; b < BUCKETS; b++) {
            const size_t here = place[b];
            place[b] = sum;
            sum += here;
        }
        for (size_t i = 0; i < count; i++) to[place[from[i].key >> shift & (BUCKETS - 1)]++] = from[i];
        keyed_row *swap = from;
        from = to;
        to = swap;
    }
    return from;
}

static bool before(const float a[3], uint32_t row_a, const float b[3], uint32_t row_b)
{
    for (int axis = 0; axis < 3; axis++)
        if (a[axis] != b[axis]) return a[axis] < b[axis];
    return row_a < row_b;
}

/* Rows that share a cell, by coordinates. Heap sort: such a run may be the whole cloud (one far point shrinks all
 * others into one cell), and must not cost its square. */
static void sort_run(const float (*xyz)[3], keyed_row *run, size_t count)
{
    for (size_t end = count, start = count / 2; end > 1;) {
        keyed_row sinking;
        if (start > 0) {
            sinking = run[--start];
        } else {
            sinking = run[--end];
            run[end] = run[0];
        }
        size_t hole = start;
        for (size_t child; (child = 2 * hole + 1) < end; hole = child) {
            if (child + 1 < end &&
                before(xyz[run[child].row], run[child].row, xyz[run[child + 1].row], run[child + 1].row))
                child++;
            if (!before(xyz[sinking.row], sinking.row, xyz[run[child].row], run[child].row)) break;
            run[hole] = run[child];
        }
        run[hole] = sinking;
    }
}

plm_status plm_spatial_order(const float (*xyz)[3], size_t count, uint32_t *order, plm_error *error)
{
    if (count > UINT32_MAX)
        return plm_fail(error, PLM_E_ARGUMENT, "%zu points; at most %u can be put in order", count, UINT32_MAX);
    plm_status status = PLM_E_MEMORY;
    keyed_row *keyed = plm_alloc(count, sizeof *keyed, error);
    keyed_row *scratch = keyed ? plm_alloc(count, sizeof *scratch, error) : NULL;
    size_t(*bucket)[BUCKETS] = scratch ? plm_alloc(DIGITS, sizeof *bucket, error) : NULL;
    if (bucket) {
        make_keys(xyz, count, keyed);
        keyed_row *sorted = radix_sort(keyed, scratch, count, bucket);
        for (size_t begin = 0, end; begin < count; begin = end) {
            for (end = begin + 1; end < count && sorted[end].key == sorted[begin].key;) end++;
            if (end - begin > 1) sort_run(xyz, sorted + begin, end - begin);
        }
        for (size_t i = 0; i < count; i++) order[i] = sorted[i].row;
        status = PLM_OK;
    }
    plm_free(bucket);
    plm_free(scratch);
    plm_free(keyed);
    return status;
}
