/* cloud/voxel.c: voxel thinning by sorting the points' cells. */
#include "cloud/voxel.h"

#include "cloud/morton.h"

#include <math.h>
#include <string.h>

/* Steps within a cell in which positions are added up: whole numbers, so that the sum has no order. 2^30 steps are finer
 * than a float resolves, and 2^33 points fit in 64 bits. */
static const double steps_of_cell = 0x1p30;

/** The cells' numbers along each axis, from the first one that holds a point. */
typedef struct cell_box {
    double cell;
    double first[3];
    unsigned bits; /* of the largest number along any axis */
} cell_box;

static plm_status measure_box(const float (*xyz)[3], size_t count, double cell, cell_box *box, plm_error *error)
{
    if (!(cell > 0) || !isfinite(cell))
        return plm_fail(error, PLM_E_ARGUMENT, "a voxel edge of %g is not positive", cell);
    *box = (cell_box){.cell = cell};
    double most = 0;
    for (int axis = 0; axis < 3 && count; axis++) {
        float low = xyz[0][axis], high = low;
        for (size_t i = 1; i < count; i++) {
            if (xyz[i][axis] < low) low = xyz[i][axis];
            if (xyz[i][axis] > high) high = xyz[i][axis];
        }
        box->first[axis] = floor(low / cell);
        most = fmax(most, floor(high / cell) - box->first[axis]);
    }
    const double limit = (double)((1 << PLM_MORTON_BITS) - 1);
    if (!(most <= limit))
        return plm_fail(error, PLM_E_ARGUMENT,
                        "a voxel edge of %g cuts the points into %.0f cells; %g is the least that does", cell, most + 1,
                        cell * ((most + 2) / limit));
    while (box->bits < PLM_MORTON_BITS && most >= (double)(1 << box->bits)) box->bits++;
    return PLM_OK;
}

static void cell_of(const cell_box *box, const float point[3], uint64_t number[3])
{
    for (int axis = 0; axis < 3; axis++) number[axis] = (uint64_t)(floor(point[axis] / box->cell) - box->first[axis]);
}

static plm_status sort_by_cell(const float (*xyz)[3], size_t count, const cell_box *box, plm_keys *keys,
                               plm_error *error)
{
    const plm_status status = plm_keys_create(count, keys, error);
    if (status != PLM_OK) return status;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < count; i++) {
        uint64_t number[3];
        cell_of(box, xyz[i], number);
        keys->key[i] = plm_morton_key(number[0], number[1], number[2]);
        keys->row[i] = (uint32_t)i;
    }
    return plm_keys_sort(keys, 3 * box->bits, error);
}

/** Mean of the members of one voxel, added up from the voxel's corner. */
static void mean_of(const float (*xyz)[3], const uint32_t *member, size_t size, double cell, float mean[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const double corner = floor(xyz[member[0]][axis] / cell) * cell;
        int64_t sum = 0;
        for (size_t j = 0; j < size; j++) sum += llrint((xyz[member[j]][axis] - corner) / cell * steps_of_cell);
        mean[axis] = (float)(corner + (double)sum / (double)size * (cell / steps_of_cell));
    }
}

static plm_status fill(const float (*xyz)[3], plm_keys *keys, double cell, plm_voxels *voxels, plm_error *error)
{
    const size_t count = keys->count;
    size_t cells = 0;
    for (size_t i = 0; i < count; i++) cells += i == 0 || keys->key[i] != keys->key[i - 1];
    voxels->count = cells;
    voxels->owner = plm_alloc(count, sizeof *voxels->owner, error);
    voxels->first = plm_alloc(cells + 1, sizeof *voxels->first, error);
    voxels->size = plm_alloc(cells, sizeof *voxels->size, error);
    voxels->xyz = plm_alloc(cells, sizeof *voxels->xyz, error);
    if (!voxels->owner || !voxels->first || !voxels->size || !voxels->xyz) return PLM_E_MEMORY;
    size_t next = 0;
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || keys->key[i] != keys->key[i - 1]) voxels->first[next++] = (uint32_t)i;
        voxels->owner[keys->row[i]] = (uint32_t)(next - 1);
    }
    voxels->first[cells] = (uint32_t)count;
    voxels->member = keys->row;
    keys->row = NULL;
#pragma omp parallel for schedule(static)
    for (size_t v = 0; v < cells; v++) {
        voxels->size[v] = voxels->first[v + 1] - voxels->first[v];
        mean_of(xyz, voxels->member + voxels->first[v], voxels->size[v], cell, voxels->xyz[v]);
    }
    return PLM_OK;
}

plm_status plm_voxel_thin(const float (*xyz)[3], size_t count, double cell, plm_voxels *voxels, plm_error *error)
{
    cell_box box;
    plm_keys keys = {0};
    plm_voxels made = {0};
    plm_status status = measure_box(xyz, count, cell, &box, error);
    if (status == PLM_OK) status = sort_by_cell(xyz, count, &box, &keys, error);
    if (status == PLM_OK) status = fill(xyz, &keys, cell, &made, error);
    if (status == PLM_OK)
        *voxels = made;
    else
        plm_voxels_free(&made);
    plm_keys_free(&keys);
    return status;
}

void plm_voxels_free(plm_voxels *voxels)
{
    if (!voxels) return;
    plm_free(voxels->xyz);
    plm_free(voxels->size);
    plm_free(voxels->owner);
    plm_free(voxels->first);
    plm_free(voxels->member);
    *voxels = (plm_voxels){0};
}
