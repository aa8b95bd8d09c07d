/* segment/posture.c: how a plant without ground shows where up is: its thick tubes run along the stem, and the stem's
 * low end is bare: one narrow straight piece, where a leaf's tip soon widens. */
#include <math.h>
#include <string.h>

#include "segment/ball_shape.h"
#include "segment/frame.h"
#include "segment/scale.h"
#include "segment/segment.h"
#include "segment/subset.h"
#include "segment/thinning.h"

enum { ENOUGH = 200000, BUDGET = 8000, SLABS = 50, FEWEST = 60 };

static const double stray = 0.002;   /* share of the points beyond the ends */
static const double narrow = 0.15;   /* width of a stem's slab over the plant's */
static const double sidestep = 0.08; /* of a slab against the one below, over the plant's width */
static const double ball_cells = 5;  /* as in segment/scale.c */
static const double linearity = 0.45, roundness = 0.6, thick = 0.75; /* a thick tube; as in segment/scale.c */

/* A thinned copy of the cloud without its floaters. The caller frees it. */
static plm_status thin_and_clean(const plm_cloud *cloud, plm_cloud *copy, plm_error *error)
{
    const uint32_t mask = plm_subset_mask(cloud->count, ENOUGH);
    plm_thinned thinned = {0};
    double cell;
    size_t n = 0;
    bool *keep = NULL;
    float(*some)[3] = plm_alloc(cloud->count, sizeof *some, error);
    plm_status status = some ? PLM_OK : PLM_E_MEMORY;
    for (size_t i = 0; i < cloud->count && status == PLM_OK; i++)
        if ((plm_point_bits(cloud->xyz[i]) & mask) == 0) memcpy(some[n++], cloud->xyz[i], sizeof *some);
    if (status == PLM_OK) status = plm_thin_cell((const float(*)[3])some, n, BUDGET, &cell, error);
    if (status == PLM_OK) status = plm_thin((const float(*)[3])some, n, cell, &thinned, error);
    if (status == PLM_OK) status = plm_cloud_create(thinned.count, 0, copy, error);
    if (status == PLM_OK) {
        memcpy(copy->xyz, thinned.xyz, thinned.count * sizeof *copy->xyz);
        keep = plm_alloc(thinned.count, sizeof *keep, error);
        status = keep ? plm_clean(copy, NULL, keep, NULL, error) : PLM_E_MEMORY;
        if (status != PLM_OK) plm_cloud_free(copy);
    }
    if (status == PLM_OK) {
        copy->count = 0;
        for (size_t i = 0; i < thinned.count; i++)
            if (keep[i]) memcpy(copy->xyz[copy->count++], thinned.xyz[i], sizeof *copy->xyz);
    }
    plm_free(keep);
    plm_free(some);
    plm_thinned_free(&thinned);
    return status;
}

/* ---- Tubes ---------------------------------------------------------------------------------------------------- */

static void add_tubes(const plm_ball_shape *shape, const float (*xyz)[3], size_t count, double stem_radius,
                      plm_posture *posture)
{
    double sum[3] = {0}, total = 0, tube[3] = {0}, other[3] = {0}, tubes = 0, low[3], high[3];
    for (int a = 0; a < 3; a++) low[a] = INFINITY, high[a] = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const float *l = shape[i].value;
        const double radius = sqrt((double)l[1] + l[2]);
        const bool is_tube = l[1] > 0 && 1 - sqrt(l[1] / l[0]) > linearity && sqrt(l[2] / l[1]) > roundness &&
                             radius > thick * stem_radius && radius < 2 * stem_radius;
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], xyz[i][a]), high[a] = fmax(high[a], xyz[i][a]);
            (is_tube ? tube : other)[a] += xyz[i][a];
            if (is_tube) sum[a] += (double)shape[i].axis[a] * shape[i].axis[a] / radius;
        }
        if (is_tube) total += 1 / radius, tubes++; /* patches of equal area: length goes with 1 / radius */
    }
    if (!(tubes > 0)) return;
    for (int a = 0; a < 3; a++) {
        posture->along[a] = sum[a] / total;
        if (tubes >= (double)count || !(high[a] > low[a])) continue;
        posture->leafward[a] = (other[a] / ((double)count - tubes) - tube[a] / tubes) / (high[a] - low[a]);
        posture->leafward[a + 3] = -posture->leafward[a];
    }
}

static plm_status find_tubes(const float (*xyz)[3], size_t count, plm_posture *posture, plm_error *error)
{
    plm_scale scale;
    plm_thinned thinned = {0};
    plm_graph graph = {0};
    plm_ball_shape *shape = NULL;
    plm_status status = plm_find_scale(xyz, count, &scale, error);
    if (status == PLM_E_DEGENERATE) return PLM_OK;
    if (status != PLM_OK || !scale.has_tubes) return status;
    const double cell = scale.radius / ball_cells;
    status = plm_thin(xyz, count, cell, &thinned, error);
    if (status == PLM_OK)
        status = plm_graph_build((const float(*)[3])thinned.xyz, thinned.count, 10, 2.3 * cell, &graph, error);
    if (status == PLM_OK) {
        shape = plm_alloc(thinned.count, sizeof *shape, error);
        status = shape ? plm_ball_shapes(&graph, scale.radius, shape, error) : PLM_E_MEMORY;
    }
    if (status == PLM_OK) add_tubes(shape, (const float(*)[3])thinned.xyz, thinned.count, scale.stem_radius, posture);
    plm_free(shape);
    plm_graph_free(&graph);
    plm_thinned_free(&thinned);
    return status;
}

/* ---- Foot ----------------------------------------------------------------------------------------------------- */

/* Width of the slab [begin, end) of points sorted by height, and its middle: medians across, and twice the distance
 * from there within which nine in ten lie. */
static double slab_width(const float (*xyz)[3], const uint32_t *order, size_t begin, size_t end, const int across[2],
                         float *value, double middle[2])
{
    const size_t n = end - begin;
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < n; i++) value[i] = xyz[order[begin + i]][across[c]];
        middle[c] = plm_quantile(value, n, 0.5);
    }
    for (size_t i = 0; i < n; i++) {
        const float *p = xyz[order[begin + i]];
        value[i] = (float)hypot(p[across[0]] - middle[0], p[across[1]] - middle[1]);
    }
    return 2 * (double)plm_quantile(value, n, 0.9);
}

static double foot_length(const float (*xyz)[3], size_t count, int axis, uint32_t *order, float *value)
{
    const int along = axis % 3, across[2] = {(along + 1) % 3, (along + 2) % 3};
    const double sign = axis < 3 ? 1 : -1;
    double width = 0, before[2] = {0};
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < count; i++) value[i] = xyz[i][across[c]];
        const double low = plm_quantile(value, count, 0.01); /* sorts */
        width = hypot(width, plm_quantile(value, count, 0.99) - low);
    }
    for (size_t i = 0; i < count; i++) value[i] = (float)(sign * xyz[i][along]);
    const double low = plm_quantile(value, count, stray), high = plm_quantile(value, count, 1 - stray);
    if (!(high > low)) return 0;
    size_t first[SLABS + 1] = {0}, place[SLABS];
    for (int turn = 0; turn < 2; turn++) { /* counting sort by slab */
        for (size_t i = 0; i < count; i++) {
            const double b = floor((sign * xyz[i][along] - low) / (high - low) * SLABS);
            if (!(b >= 0 && b < SLABS)) continue;
            if (turn == 0)
                first[(int)b + 1]++;
            else
                order[place[(int)b]++] = (uint32_t)i;
        }
        for (int b = 0; b < SLABS && turn == 0; b++) {
            first[b + 1] += first[b];
            place[b] = first[b];
        }
    }
    int slabs = 0;
    bool started = false;
    for (int b = 0; b < SLABS; b++) {
        double middle[2];
        if (first[b + 1] - first[b] >= 2) {
            if (slab_width(xyz, order, first[b], first[b + 1], across, value, middle) > narrow * width) break;
            if (started && hypot(middle[0] - before[0], middle[1] - before[1]) > sidestep * width) break;
            memcpy(before, middle, sizeof before);
            started = true;
        }
        slabs += started;
    }
    return (double)slabs / SLABS;
}

plm_status plm_find_posture(const plm_cloud *cloud, plm_posture *posture, plm_error *error)
{
    plm_posture found = {0};
    plm_cloud copy = {0};
    plm_status status = cloud->count < FEWEST ? PLM_OK : thin_and_clean(cloud, &copy, error);
    const float(*xyz)[3] = (const float(*)[3])copy.xyz;
    if (status == PLM_OK && copy.count >= FEWEST) {
        uint32_t *order = plm_alloc(copy.count, sizeof *order, error);
        float *value = plm_alloc(copy.count, sizeof *value, error);
        status = order && value ? find_tubes(xyz, copy.count, &found, error) : PLM_E_MEMORY;
        for (int axis = 0; axis < PLM_AXES && status == PLM_OK; axis++)
            found.foot[axis] = foot_length(xyz, copy.count, axis, order, value);
        plm_free(order);
        plm_free(value);
    }
    plm_cloud_free(&copy);
    if (status == PLM_OK) *posture = found;
    return status;
}
