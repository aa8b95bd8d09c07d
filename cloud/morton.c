/* cloud/morton.c: stable radix sort of keys with their rows, least digit first (Knuth, The Art of Computer Programming,
 * volume 3, 5.2.5). Rows are cut into chunks; each chunk counts its digits and then writes where the counts of all
 * chunks before it end, so that chunks run side by side and the order does not depend on how many there are. */
#include "cloud/morton.h"

#include <omp.h>
#include <string.h>

enum {
    DIGIT_BITS = 11,      /* 2048 places to write to: about what the first-level cache and the TLB carry */
    LARGEST_CHUNKS = 32,  /* threads beyond that wait for memory */
    SMALLEST_CHUNK = 8192 /* rows that are worth a thread */
};

plm_status plm_keys_create(size_t count, plm_keys *keys, plm_error *error)
{
    if (count >= UINT32_MAX)
        return plm_fail(error, PLM_E_ARGUMENT, "%zu points are too many to number in 32 bits", count);
    plm_keys made = {.count = count};
    made.key = plm_alloc(count, sizeof *made.key, error);
    made.row = plm_alloc(count, sizeof *made.row, error);
    if (!made.key || !made.row) {
        plm_keys_free(&made);
        return PLM_E_MEMORY;
    }
    *keys = made;
    return PLM_OK;
}

void plm_keys_free(plm_keys *keys)
{
    if (!keys) return;
    plm_free(keys->key);
    plm_free(keys->row);
    *keys = (plm_keys){0};
}

/** One pass: from `from` to `to` by `width` bits above `shift`. next has chunks x 2^width counters. */
static void sort_digit(const plm_keys *from, plm_keys *to, unsigned shift, unsigned width, int chunks, uint32_t *next)
{
    const size_t digits = (size_t)1 << width, size = (from->count + (size_t)chunks - 1) / (size_t)chunks;
    const uint64_t mask = digits - 1;
#pragma omp parallel for schedule(static, 1)
    for (int c = 0; c < chunks; c++) {
        uint32_t *own = next + (size_t)c * digits;
        memset(own, 0, digits * sizeof *own);
        const size_t end = ((size_t)c + 1) * size < from->count ? ((size_t)c + 1) * size : from->count;
        for (size_t i = (size_t)c * size; i < end; i++) own[from->key[i] >> shift & mask]++;
    }
    uint32_t before = 0;
    for (size_t digit = 0; digit < digits; digit++)
        for (int c = 0; c < chunks; c++) {
            const uint32_t count = next[(size_t)c * digits + digit];
            next[(size_t)c * digits + digit] = before;
            before += count;
        }
#pragma omp parallel for schedule(static, 1)
    for (int c = 0; c < chunks; c++) {
        uint32_t *own = next + (size_t)c * digits;
        const size_t end = ((size_t)c + 1) * size < from->count ? ((size_t)c + 1) * size : from->count;
        for (size_t i = (size_t)c * size; i < end; i++) {
            const uint32_t place = own[from->key[i] >> shift & mask]++;
            to->key[place] = from->key[i];
            to->row[place] = from->row[i];
        }
    }
}

plm_status plm_keys_sort(plm_keys *keys, unsigned bits, plm_error *error)
{
    if (keys->count < 2 || bits == 0) return PLM_OK;
    const unsigned passes = (bits + DIGIT_BITS - 1) / DIGIT_BITS, width = (bits + passes - 1) / passes;
    const size_t wanted = keys->count / SMALLEST_CHUNK + 1;
    const int threads = omp_get_max_threads() < LARGEST_CHUNKS ? omp_get_max_threads() : LARGEST_CHUNKS;
    const int chunks = (size_t)threads < wanted ? threads : (int)wanted;
    plm_keys other = {0};
    uint32_t *next = plm_alloc((size_t)chunks << width, sizeof *next, error);
    plm_status status = next ? plm_keys_create(keys->count, &other, error) : PLM_E_MEMORY;
    for (unsigned pass = 0; pass < passes && status == PLM_OK; pass++) {
        sort_digit(keys, &other, pass * width, width, chunks, next);
        const plm_keys sorted = other;
        other = *keys;
        *keys = sorted;
    }
    plm_keys_free(&other);
    plm_free(next);
    return status;
}
