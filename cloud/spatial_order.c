/* cloud/spatial_order.c: Morton order (G. M. Morton, A computer oriented geodetic data base, 1966) by a radix sort of 63-bit
 * keys. Estimators that take every n-th point, and sums whose last digits depend on the order, then see the same
 * sequence for every order of a file's rows; and trees built over the points are faster (shared notes on performance). */
#include "cloud/spatial_order.h"

#include "cloud/morton.h"

#include <math.h>
#include <string.h>

static void make_keys(const float (*xyz)[3], plm_keys *keys)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < keys->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(low[axis], xyz[i][axis]);
            high[axis] = fmax(high[axis], xyz[i][axis]);
        }
    double size = 0;
    for (int axis = 0; axis < 3; axis++) size = fmax(size, high[axis] - low[axis]);
    const double cells = size > 0 ? ((1 << PLM_MORTON_BITS) - 1) / size : 0;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < keys->count; i++) {
        uint64_t number[3];
        for (int axis = 0; axis < 3; axis++) number[axis] = (uint64_t)((xyz[i][axis] - low[axis]) * cells);
        keys->key[i] = plm_morton_key(number[0], number[1], number[2]);
        keys->row[i] = (uint32_t)i;
    }
}

static bool before(const float (*xyz)[3], uint32_t a, uint32_t b)
{
    for (int axis = 0; axis < 3; axis++)
        if (xyz[a][axis] != xyz[b][axis]) return xyz[a][axis] < xyz[b][axis];
    return a < b;
}

/* Rows that share a cell, by coordinates. Heap sort: such a run may be the whole cloud (one far point shrinks all
 * others into one cell), and must not cost its square. */
static void sort_run(const float (*xyz)[3], uint32_t *run, size_t count)
{
    for (size_t end = count, start = count / 2; end > 1;) {
        uint32_t sinking;
        if (start > 0) {
            sinking = run[--start];
        } else {
            sinking = run[--end];
            run[end] = run[0];
        }
        size_t hole = start;
        for (size_t child; (child = 2 * hole + 1) < end; hole = child) {
            if (child + 1 < end && before(xyz, run[child], run[child + 1])) child++;
            if (!before(xyz, sinking, run[child])) break;
            run[hole] = run[child];
        }
        run[hole] = sinking;
    }
}

plm_status plm_spatial_order(const float (*xyz)[3], size_t count, uint32_t *order, plm_error *error)
{
    plm_keys keys = {0};
    plm_status status = plm_keys_create(count, &keys, error);
    if (status != PLM_OK) return status;
    make_keys(xyz, &keys);
    status = plm_keys_sort(&keys, 3 * PLM_MORTON_BITS, error);
    if (status == PLM_OK) {
        for (size_t begin = 0, end; begin < count; begin = end) {
            for (end = begin + 1; end < count && keys.key[end] == keys.key[begin];) end++;
            if (end - begin > 1) sort_run(xyz, keys.row + begin, end - begin);
        }
        memcpy(order, keys.row, count * sizeof *order);
    }
    plm_keys_free(&keys);
    return status;
}
