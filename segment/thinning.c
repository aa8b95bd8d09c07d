/* segment/thinning.c: the voxels that bring a cloud down to a number of points. */
#include "segment/thinning.h"

#include "cloud/morton.h"
#include "cloud/neighbours.h"
#include "segment/scratch.h"

#include <math.h>
#include <string.h>

enum { LEVELS = PLM_MORTON_BITS - 1 };

static double bounds(const float (*xyz)[3], size_t count, double low[3])
{
    double extent = 0;
    for (int axis = 0; axis < 3; axis++) {
        double high = low[axis] = count ? xyz[0][axis] : 0;
        for (size_t i = 1; i < count; i++) {
            if (xyz[i][axis] < low[axis]) low[axis] = xyz[i][axis];
            if (xyz[i][axis] > high) high = xyz[i][axis];
        }
        if (high - low[axis] > extent) extent = high - low[axis];
    }
    return extent;
}

plm_status plm_thin(const float (*xyz)[3], size_t count, double cell, plm_thinned *thinned, plm_error *error)
{
    double low[3];
    const double least = bounds(xyz, count, low) * 0x1p-20;
    if (!(cell > least)) cell = least > 0 ? least : 1;
    plm_thinned out = {.cell = cell};
    const plm_status status = plm_voxel_thin(xyz, count, cell, &out.voxels, error);
    if (status != PLM_OK) return status;
    out.count = out.voxels.count;
    out.xyz = out.voxels.xyz;
    *thinned = out;
    return PLM_OK;
}

/* Occupied voxels at each level of the octree, from where neighbouring keys part. */
static void count_levels(const plm_keys *keys, size_t occupied[LEVELS + 1])
{
    for (int level = 0; level <= LEVELS; level++) occupied[level] = keys->count > 0;
    for (size_t i = 1; i < keys->count; i++) {
        const uint64_t change = keys->key[i] ^ keys->key[i - 1];
        if (!change) continue;
        const int bit = 63 - __builtin_clzll(change);
        for (int level = LEVELS - bit / 3; level <= LEVELS; level++)
            if (level >= 0) occupied[level]++;
    }
}

plm_status plm_thin_cell(const float (*xyz)[3], size_t count, size_t budget, double *cell, plm_error *error)
{
    double low[3], extent = bounds(xyz, count, low);
    if (!(extent > 0)) extent = 1;
    const double finest = extent * 0x1p-20 * 1.000001; /* so that the high side falls into the last cell */
    plm_keys keys = {0};
    plm_status status = plm_keys_create(count, &keys, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < count; i++) {
        uint64_t place[3];
        for (int axis = 0; axis < 3; axis++) place[axis] = (uint64_t)((xyz[i][axis] - low[axis]) / finest);
        keys.key[i] = plm_morton_key(place[0], place[1], place[2]);
        keys.row[i] = (uint32_t)i;
    }
    status = plm_keys_sort(&keys, 3 * PLM_MORTON_BITS, error);
    if (status == PLM_OK) {
        size_t occupied[LEVELS + 1];
        count_levels(&keys, occupied);
        int level = LEVELS;
        while (level > 0 && occupied[level] > budget) level--;
        double edge = finest * ldexp(1, LEVELS - level);
        if (level < LEVELS) { /* between this level and the next, the count is about a power of the edge */
            const double growth = log((double)occupied[level + 1] / (double)occupied[level]);
            edge *= exp2(-log((double)budget / (double)occupied[level]) / growth);
        }
        *cell = edge;
    }
    plm_keys_free(&keys);
    return status;
}

/* The lists of the points of each voxel, from whose they are. */
static void list_members(plm_voxels *voxels, size_t points)
{
    for (size_t v = 0; v <= voxels->count; v++) voxels->first[v] = 0;
    for (size_t i = 0; i < points; i++) voxels->first[voxels->owner[i] + 1]++;
    for (size_t v = 0; v < voxels->count; v++) voxels->size[v] = voxels->first[v + 1];
    for (size_t v = 0; v < voxels->count; v++) voxels->first[v + 1] += voxels->first[v];
    for (size_t i = 0; i < points; i++) voxels->member[voxels->first[voxels->owner[i]]++] = (uint32_t)i;
    for (size_t v = voxels->count; v > 0; v--) voxels->first[v] = voxels->first[v - 1];
    voxels->first[0] = 0;
}

plm_status plm_thinned_keep(plm_thinned *thinned, const bool *keep, plm_error *error)
{
    plm_voxels *voxels = &thinned->voxels;
    size_t kept = 0;
    for (size_t v = 0; v < thinned->count; v++) kept += keep[v];
    if (!kept || kept == thinned->count) return PLM_OK;
    plm_scratch scratch = {.error = error};
    float(*stays)[3] = plm_scratch_take(&scratch, kept, sizeof *stays);
    uint32_t *heir = plm_scratch_take(&scratch, thinned->count, sizeof *heir);
    plm_index *index = NULL;
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    kept = 0;
    for (size_t v = 0; v < thinned->count && status == PLM_OK; v++) {
        if (!keep[v]) continue;
        for (int axis = 0; axis < 3; axis++) stays[kept][axis] = voxels->xyz[v][axis];
        heir[v] = (uint32_t)kept++;
    }
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])stays, kept, &index, error);
    if (status == PLM_OK) {
        const size_t points = voxels->first[voxels->count];
        for (size_t v = 0; v < thinned->count; v++)
            if (!keep[v]) plm_index_nearest(index, voxels->xyz[v], 1, &heir[v], NULL);
        for (size_t i = 0; i < points; i++) voxels->owner[i] = heir[voxels->owner[i]];
        memcpy(voxels->xyz, stays, kept * sizeof *stays);
        thinned->count = voxels->count = kept;
        list_members(voxels, points);
    }
    plm_index_free(index);
    plm_scratch_free(&scratch, NULL);
    return status;
}

void plm_thinned_free(plm_thinned *thinned)
{
    if (!thinned) return;
    plm_voxels_free(&thinned->voxels);
    *thinned = (plm_thinned){0};
}
