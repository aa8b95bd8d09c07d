/* cloud/subset.c: random thinning by a hash of coordinates. */
#include "cloud/subset.h"

#include <math.h>
#include <string.h>

enum { FEWEST = 12 /* points that a hash is trusted to choose: below, most of the cloud is on one spot */ };

/* Share of the points from which on all of them are taken. */
static const double worth_choosing = 0.7;

/* Mixes the bits of a point's coordinates (the finaliser of MurmurHash3): the order of the sample. */
static uint64_t hash_point(const float point[3], uint64_t salt)
{
    uint64_t hash = 0x9e3779b97f4a7c15u ^ salt;
    for (int i = 0; i < 3; i++) {
        const float value = point[i] + 0.0f; /* -0 becomes 0 */
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 33;
    }
    hash *= 0xc4ceb9fe1a85ec53u;
    return hash ^ (hash >> 33);
}

static size_t sample(const float (*xyz)[3], size_t count, size_t wanted, uint64_t salt, uint32_t *row)
{
    const uint64_t limit = count <= wanted ? UINT64_MAX : (uint64_t)((double)wanted / (double)count * 0x1p63) << 1;
    size_t taken = 0;
    for (size_t i = 0; i < count; i++)
        if (hash_point(xyz[i], salt) <= limit) row[taken++] = (uint32_t)i;
    if (taken >= FEWEST) return taken;
    /* Only where most points coincide: by row then. */
    const size_t step = count / wanted + 1;
    taken = 0;
    for (size_t i = 0; i < count; i += step) row[taken++] = (uint32_t)i;
    return taken;
}

size_t plm_sample_rows(const float (*xyz)[3], size_t count, size_t wanted, uint32_t *row)
{
    return sample(xyz, count, wanted, 0, row);
}

/* Salted with the count: a thinning of what was thinned before would else choose the same points again. */
plm_status plm_subset_take(const plm_index *index, const float (*xyz)[3], size_t count, double share, plm_subset *taken,
                           plm_error *error)
{
    *taken = (plm_subset){.xyz = xyz, .index = index, .count = count};
    if (!(share < worth_choosing) || count == 0) return PLM_OK;
    uint32_t *row = plm_alloc(count, sizeof *row, error);
    if (!row) return PLM_E_MEMORY;
    const size_t size = sample(xyz, count, (size_t)fmax(ceil(share * (double)count), 1), count, row);
    float(*few)[3] = plm_alloc(size, sizeof *few, error);
    plm_status status = few ? PLM_OK : PLM_E_MEMORY;
    for (size_t i = 0; few && i < size; i++) memcpy(few[i], xyz[row[i]], sizeof few[i]);
    plm_index *few_index = NULL;
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])few, size, &few_index, error);
    if (status == PLM_OK)
        *taken = (plm_subset){(const float(*)[3])few, few_index, size, few, few_index, row};
    else
        plm_free(few), plm_free(row);
    return status;
}

void plm_subset_free(plm_subset *subset)
{
    plm_index_free(subset->few_index);
    plm_free(subset->few);
    plm_free(subset->few_row);
    *subset = (plm_subset){0};
}
