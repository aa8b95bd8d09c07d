/* segment/surfels.c: a dense grid of voxels over the cloud; each occupied voxel becomes a patch whose normal comes from
 * the centres in the 5 x 5 x 5 voxels around it. Centres count alike, however many points they stand for: a region that
 * was seen ten times as often weighs no more. */
#include "segment/surfels.h"

#include <math.h>
#include <string.h>

#include "cloud/linear.h"

enum { BINS = 4096, MAXIMUM_VOXELS = 6000000, REACH = 2, MINIMUM_AROUND = 5, ROUNDS = 40 };

static const double stray = 0.001;  /* share of the points that may be cut off at each end of an axis */
static const double fullness = 3;   /* points a voxel */
static const double widening = 1.2; /* of the edge, when voxels are too empty */
static const double margin = 0.02;  /* of the box, added on each side */

/* Bounds along one axis that leave out at most a share of stray points at each end. A second look inside of the first
 * bounds, as one far outlier would put all others in one bin. */
static void trimmed_range(const plm_cloud *cloud, int axis, float low, float high, double range[2])
{
    range[0] = low;
    range[1] = high;
    for (int look = 0; look < 2 && range[1] > range[0]; look++) {
        size_t histogram[BINS] = {0};
        const double origin = range[0], scale = BINS / (range[1] - range[0]);
        for (size_t i = 0; i < cloud->count; i++) {
            const double place = ((double)cloud->xyz[i][axis] - origin) * scale;
            histogram[place < 0 ? 0 : place >= BINS ? BINS - 1 : (int)place]++;
        }
        const size_t share = (size_t)(stray * (double)cloud->count);
        int first = 0, last = BINS - 1;
        for (size_t sum = histogram[first]; sum <= share && first < BINS - 1; sum += histogram[first]) first++;
        for (size_t sum = histogram[last]; sum <= share && last > first; sum += histogram[last]) last--;
        range[0] = origin + first / scale;
        range[1] = origin + (last + 1) / scale;
    }
}

static bool lay_grid(plm_surfels *s, const double range[3][2], double cell)
{
    double voxels = 1;
    s->cell = cell;
    for (int axis = 0; axis < 3; axis++) {
        const double length = range[axis][1] - range[axis][0];
        s->low[axis] = range[axis][0] - margin * length - cell;
        const double n = ceil((1 + 2 * margin) * length / cell) + 2;
        voxels *= n;
        if (voxels > MAXIMUM_VOXELS) return false;
        s->size[axis] = (int32_t)n;
    }
    return true;
}

int64_t plm_surfels_voxel(const plm_surfels *s, const float xyz[3])
{
    int64_t voxel = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double place = floor(((double)xyz[axis] - s->low[axis]) / s->cell);
        if (!(place >= 0 && place < s->size[axis])) return -1;
        voxel = voxel * s->size[axis] + (int64_t)place;
    }
    return voxel;
}

/* Counts the occupied voxels into slot (1 where occupied, else 0) and the points inside of the grid. */
static size_t occupy(plm_surfels *s, const plm_cloud *cloud, size_t *inside)
{
    const size_t voxels = (size_t)s->size[0] * (size_t)s->size[1] * (size_t)s->size[2];
    memset(s->slot, 0, voxels * sizeof *s->slot);
    size_t occupied = 0;
    *inside = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        const int64_t v = plm_surfels_voxel(s, cloud->xyz[i]);
        if (v < 0) continue;
        (*inside)++;
        occupied += !s->slot[v];
        s->slot[v] = 1;
    }
    return occupied;
}

/* Chooses the edge and marks the occupied voxels. */
static plm_status choose_grid(plm_surfels *s, const plm_cloud *cloud, double resolution, plm_error *error)
{
    float low[3], high[3];
    double range[3][2], diagonal = 0;
    plm_status status = plm_cloud_bounds(cloud, low, high, error);
    if (status != PLM_OK) return status;
    for (int axis = 0; axis < 3; axis++) {
        trimmed_range(cloud, axis, low[axis], high[axis], range[axis]);
        diagonal = hypot(diagonal, range[axis][1] - range[axis][0]);
    }
    double cell = diagonal > 0 ? diagonal / resolution : 1; /* all points in one place: one voxel */
    while (!lay_grid(s, (const double(*)[2])range, cell)) cell *= widening;
    const size_t voxels = (size_t)s->size[0] * (size_t)s->size[1] * (size_t)s->size[2];
    s->slot = plm_alloc(voxels, sizeof *s->slot, error);
    if (!s->slot) return PLM_E_MEMORY;
    for (int round = 0; round < ROUNDS; round++) {
        size_t inside;
        s->count = occupy(s, cloud, &inside);
        if ((double)inside >= fullness * (double)s->count || s->count <= 64) break;
        cell *= widening;
        (void)lay_grid(s, (const double(*)[2])range, cell);
    }
    return PLM_OK;
}

static void sum_voxels(plm_surfels *s, const plm_cloud *cloud, double (*sum)[3])
{
    for (size_t i = 0; i < cloud->count; i++) {
        const int64_t v = plm_surfels_voxel(s, cloud->xyz[i]);
        if (v < 0) continue;
        const int32_t k = s->slot[v];
        s->points[k]++;
        for (int axis = 0; axis < 3; axis++) sum[k][axis] += (double)cloud->xyz[i][axis] - s->low[axis];
        if (s->colour)
            for (int c = 0; c < 3; c++) s->colour[k][c] += cloud->rgb[i][c];
    }
    for (size_t k = 0; k < s->count; k++)
        for (int axis = 0; axis < 3; axis++) {
            s->centre[k][axis] = (float)(sum[k][axis] / s->points[k]);
            if (s->colour) s->colour[k][axis] /= (float)s->points[k];
        }
}

static void find_normal(plm_surfels *s, size_t k)
{
    int32_t at[3];
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = (int32_t)(s->centre[k][axis] / s->cell);
        if (at[axis] >= s->size[axis]) at[axis] = s->size[axis] - 1;
    }
    double n = 0, mean[3] = {0}, moment[6] = {0};
    for (int32_t x = at[0] - REACH; x <= at[0] + REACH; x++)
        for (int32_t y = at[1] - REACH; y <= at[1] + REACH; y++)
            for (int32_t z = at[2] - REACH; z <= at[2] + REACH; z++) {
                if (x < 0 || y < 0 || z < 0 || x >= s->size[0] || y >= s->size[1] || z >= s->size[2]) continue;
                const int32_t other = s->slot[((int64_t)x * s->size[1] + y) * s->size[2] + z];
                if (other < 0) continue;
                double d[3];
                for (int axis = 0; axis < 3; axis++) d[axis] = (double)s->centre[other][axis] - s->centre[k][axis];
                n++;
                for (int i = 0, m = 0; i < 3; i++) {
                    mean[i] += d[i];
                    for (int j = i; j < 3; j++) moment[m++] += d[i] * d[j];
                }
            }
    double value[3], vector[3][3];
    for (int i = 0, m = 0; i < 3; i++)
        for (int j = i; j < 3; j++, m++) moment[m] = moment[m] / n - mean[i] / n * (mean[j] / n);
    plm_eigen3(moment, value, vector);
    /* A thin tube or a ball of noise has no normal: the middle spread must be clear of the smallest. */
    const bool plane = n >= MINIMUM_AROUND && value[1] > 2.25 * value[2] && value[1] > 0;
    for (int axis = 0; axis < 3; axis++) s->normal[k][axis] = plane ? (float)vector[2][axis] : 0;
}

plm_status plm_surfels_make(const plm_cloud *cloud, double resolution, plm_surfels *surfels, plm_error *error)
{
    plm_surfels s = {0};
    double(*sum)[3] = NULL;
    plm_status status = choose_grid(&s, cloud, resolution, error);
    if (status == PLM_OK) {
        s.centre = plm_alloc(s.count, sizeof *s.centre, error);
        s.normal = plm_alloc(s.count, sizeof *s.normal, error);
        s.points = plm_alloc_zero(s.count, sizeof *s.points, error);
        sum = plm_alloc_zero(s.count, sizeof *sum, error);
        if (cloud->rgb) s.colour = plm_alloc_zero(s.count, sizeof *s.colour, error);
        if (!s.centre || !s.normal || !s.points || !sum || (cloud->rgb && !s.colour)) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) {
        const int64_t voxels = (int64_t)s.size[0] * s.size[1] * s.size[2];
        int32_t next = 0;
        for (int64_t v = 0; v < voxels; v++) s.slot[v] = s.slot[v] ? next++ : -1;
        sum_voxels(&s, cloud, sum);
#pragma omp parallel for schedule(dynamic, 512)
        for (size_t k = 0; k < s.count; k++) find_normal(&s, k);
        *surfels = s;
    } else {
        plm_surfels_free(&s);
    }
    plm_free(sum);
    return status;
}

void plm_surfels_free(plm_surfels *surfels)
{
    plm_free(surfels->slot);
    plm_free(surfels->centre);
    plm_free(surfels->normal);
    plm_free(surfels->colour);
    plm_free(surfels->points);
    *surfels = (plm_surfels){0};
}
