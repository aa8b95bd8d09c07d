/* cloud/candidates.c: the k nearest of a list, without a heap: all that pass a threshold guessed from the last answer are
 * collected, a few more than k; the threshold is then narrowed among these by counting and interpolation; what ties leave
 * over is dropped by rank. */
#include "cloud/candidates.h"

#include <math.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum {
    STEP = 16,         /* distances taken at once; lists are filled up to whole steps */
    MOST_GUESSES = 24, /* of a threshold that k pass; from the farthest possible one down at the latest */
    MOST_CUTS = 6      /* of the threshold; more are only needed for ties */
};

/* Next threshold over the last one: a few neighbours more than k pass (x^1.5 in space, x on surfaces). */
static const float slack = 1.3f;

plm_status plm_candidates_reset(plm_candidates *list, size_t count, plm_error *error)
{
    list->count = 0;
    if (count + STEP <= list->room) return PLM_OK;
    plm_candidates wider = {.room = count + count / 4 + STEP, .guess = list->guess};
    plm_candidates_free(list);
    wider.x = plm_alloc(wider.room, sizeof *wider.x, error);
    wider.y = plm_alloc(wider.room, sizeof *wider.y, error);
    wider.z = plm_alloc(wider.room, sizeof *wider.z, error);
    wider.row = plm_alloc(wider.room, sizeof *wider.row, error);
    wider.squared = plm_alloc(wider.room, sizeof *wider.squared, error);
    wider.chosen = plm_alloc(wider.room, sizeof *wider.chosen, error);
    wider.near = plm_alloc(wider.room, sizeof *wider.near, error);
    const bool complete = wider.x && wider.y && wider.z && wider.row && wider.squared && wider.chosen && wider.near;
    if (!complete) plm_candidates_free(&wider);
    *list = wider;
    return complete ? PLM_OK : PLM_E_MEMORY;
}

void plm_candidates_add(plm_candidates *list, const float *x, const float *y, const float *z, const uint32_t *row,
                        size_t count)
{
    memcpy(list->x + list->count, x, count * sizeof *x);
    memcpy(list->y + list->count, y, count * sizeof *y);
    memcpy(list->z + list->count, z, count * sizeof *z);
    memcpy(list->row + list->count, row, count * sizeof *row);
    list->count += count;
}

void plm_candidates_free(plm_candidates *list)
{
    plm_free(list->x);
    plm_free(list->y);
    plm_free(list->z);
    plm_free(list->row);
    plm_free(list->squared);
    plm_free(list->chosen);
    plm_free(list->near);
    *list = (plm_candidates){0};
}

#ifdef __SSE2__ /* part of every x86-64; what it computes is what the plain loops below do */
static inline __m128 measure_four(const plm_candidates *list, size_t i, const __m128 point[3])
{
    const __m128 dx = _mm_sub_ps(_mm_loadu_ps(list->x + i), point[0]);
    const __m128 dy = _mm_sub_ps(_mm_loadu_ps(list->y + i), point[1]);
    const __m128 dz = _mm_sub_ps(_mm_loadu_ps(list->z + i), point[2]);
    const __m128 squared = _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
    _mm_storeu_ps(list->squared + i, squared);
    return squared;
}

static inline unsigned pass_of_sixteen(__m128 a, __m128 b, __m128 c, __m128 d, float threshold)
{
    const __m128 limit = _mm_set1_ps(threshold);
    const __m128i ab =
        _mm_packs_epi32(_mm_castps_si128(_mm_cmple_ps(a, limit)), _mm_castps_si128(_mm_cmple_ps(b, limit)));
    const __m128i cd =
        _mm_packs_epi32(_mm_castps_si128(_mm_cmple_ps(c, limit)), _mm_castps_si128(_mm_cmple_ps(d, limit)));
    return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(ab, cd));
}

static inline uint64_t measure_step(const plm_candidates *list, size_t i, const float point[3], float threshold)
{
    const __m128 p[3] = {_mm_set1_ps(point[0]), _mm_set1_ps(point[1]), _mm_set1_ps(point[2])};
    return pass_of_sixteen(measure_four(list, i, p), measure_four(list, i + 4, p), measure_four(list, i + 8, p),
                           measure_four(list, i + 12, p), threshold);
}

static inline uint64_t compare_step(const plm_candidates *list, size_t i, float threshold)
{
    const float *value = list->squared + i;
    return pass_of_sixteen(_mm_loadu_ps(value), _mm_loadu_ps(value + 4), _mm_loadu_ps(value + 8),
                           _mm_loadu_ps(value + 12), threshold);
}
#else
static inline uint64_t compare_step(const plm_candidates *list, size_t from, float threshold)
{
    uint64_t bits = 0;
    for (unsigned i = 0; i < STEP; i++) bits |= (uint64_t)(list->squared[from + i] <= threshold) << i;
    return bits;
}

static inline uint64_t measure_step(const plm_candidates *list, size_t from, const float point[3], float threshold)
{
    for (size_t i = from; i < from + STEP; i++) {
        const float dx = list->x[i] - point[0], dy = list->y[i] - point[1], dz = list->z[i] - point[2];
        list->squared[i] = dx * dx + dy * dy + dz * dz;
    }
    return compare_step(list, from, threshold);
}
#endif

/** Fills the last step with points that are infinitely far. */
static void fill_up(plm_candidates *list)
{
    for (size_t i = list->count; i < list->count + STEP; i++) list->x[i] = list->y[i] = list->z[i] = INFINITY;
}

/** Collects all that pass the threshold. With point NULL the distances are there already. */
static inline size_t collect(const plm_candidates *list, const float *point, float threshold)
{
    uint32_t *restrict chosen = list->chosen;
    float *restrict near = list->near;
    const float *restrict squared = list->squared;
    size_t found = 0;
    for (size_t block = 0; block < list->count; block += 64) {
        uint64_t bits = 0; /* of four steps, so that the loop over them ends seldom (and is seldom mispredicted) */
        const size_t end = list->count - block < 64 ? list->count - block : 64;
        for (size_t i = 0; i < end; i += STEP)
            bits |= (point ? measure_step(list, block + i, point, threshold) : compare_step(list, block + i, threshold))
                    << i;
        for (; bits; bits &= bits - 1) {
            const size_t place = block + (size_t)__builtin_ctzll(bits);
            chosen[found] = (uint32_t)place;
            near[found++] = squared[place];
        }
    }
    return found;
}

static size_t count_within(const float *value, size_t count, float threshold)
{
    int32_t within = 0; /* as wide as a float: one vector for both */
    for (size_t i = 0; i < count; i++) within += value[i] <= threshold;
    return (size_t)within;
}

static size_t keep_within(const plm_candidates *list, size_t count, float threshold)
{
    uint32_t *chosen = list->chosen;
    float *near = list->near;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const float squared = near[i];
        chosen[kept] = chosen[i];
        near[kept] = squared;
        kept += squared <= threshold;
    }
    return kept;
}

/** Narrows the threshold until k of the collected ones pass, or a few more where distances are equal. */
static size_t cut(plm_candidates *list, size_t count, size_t k, float *threshold)
{
    float low = 0, high = *threshold, low_count = 0, high_count = (float)count;
    for (int step = 0; step < MOST_CUTS && high_count > (float)k; step++) {
        const float middle = low + (high - low) * (((float)k + 0.5f - low_count) / (high_count - low_count));
        if (!(middle > low && middle < high)) break;
        const float within = (float)count_within(list->near, count, middle);
        if (within >= (float)k)
            high = middle, high_count = within;
        else
            low = middle, low_count = within;
    }
    *threshold = high;
    return keep_within(list, count, high);
}

static bool before(const plm_candidates *list, size_t a, size_t b)
{
    if (list->near[a] != list->near[b]) return list->near[a] < list->near[b];
    return list->row[list->chosen[a]] < list->row[list->chosen[b]];
}

static void swap(plm_candidates *list, size_t a, size_t b)
{
    const uint32_t place = list->chosen[a];
    const float squared = list->near[a];
    list->chosen[a] = list->chosen[b], list->near[a] = list->near[b];
    list->chosen[b] = place, list->near[b] = squared;
}

static void sink(plm_candidates *list, size_t count, size_t root)
{
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && before(list, child, child + 1)) child++;
        if (!before(list, root, child)) break;
        swap(list, root, child);
    }
}

/** The k first of the collected ones to the front. One that is too many is the last; of more, a heap of k keeps the
 * first, in which the others try for the last one's place. */
static void rank(plm_candidates *list, size_t count, size_t k)
{
    if (count == k + 1) {
        size_t last = 0;
        for (size_t i = 1; i < count; i++)
            if (before(list, last, i)) last = i;
        swap(list, last, k);
        return;
    }
    for (size_t root = k / 2; root-- > 0;) sink(list, k, root);
    for (size_t i = k; i < count; i++)
        if (before(list, i, 0)) {
            swap(list, i, 0);
            sink(list, k, 0);
        }
}

bool plm_candidates_nearest(plm_candidates *list, const float point[3], size_t self, size_t k, float limit)
{
    float threshold = list->guess > 0 && list->guess < limit ? list->guess : limit;
    const float own_x = list->x[self];
    fill_up(list);
    list->x[self] = INFINITY;
    size_t found = collect(list, point, threshold);
    list->x[self] = own_x;
    for (int guess = 0; found < k && threshold < limit; guess++) {
        threshold *= fminf(4, slack * (float)k / (float)(found + 1));
        if (!(threshold < limit) || guess == MOST_GUESSES) threshold = limit;
        found = collect(list, NULL, threshold);
    }
    if (found < k) return false;
    if (found > k) found = cut(list, found, k, &threshold);
    if (found > k) rank(list, found, k);
    list->guess = slack * threshold;
    return true;
}
