/* segment/posture.c: how a plant without ground shows where up is. From its foot all of it is reached on ways with few
 * detours, from a leaf's tip it is not; stems, petioles and straps rise more than they spread, blades lie more than they
 * stand; most of a plant is above the middle of its height, and its foot is beneath its middle. */
#include <math.h>
#include <string.h>

#include "cloud/neighbours.h"
#include "segment/ball_shape.h"
#include "segment/frame.h"
#include "segment/scale.h"
#include "segment/scratch.h"
#include "segment/segment.h"
#include "segment/subset.h"
#include "segment/thinning.h"

enum { ENOUGH = 200000, BUDGET = 8000, FEWEST = 60, NEIGHBOURS = 10, FOURTH = 4 };

static const double stray = 0.002; /* share of the points beyond the ends */
/* Of the height: of the points so low, the foot is the one nearest to the axis. */
static const double low_end = 0.2;
static const double apart = 0.15;       /* of the size: ways that count are longer */
static const double no_way = 1;         /* stands for the logarithm of a way that there is none of */
static const double link = 4, ball = 7; /* spacings: longest links of the graph, radius of what shapes are taken from */
static const double bridge = 0.1;       /* of the size: longest link between pieces of the graph, over gaps of a scan */
static const double linearity = 0.45;   /* of a stem, a petiole or a strap; as in segment/scale.c */

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

typedef struct look {
    plm_scratch scratch;
    size_t count;
    const float (*xyz)[3];
    plm_graph graph;
    plm_ball_shape *shape;
    float *height, *value, *distance;
    double size;
} look;

/* The median distance to the fourth neighbour, which voxels that fall together or apart change less than that to the first. */
static plm_status find_spacing(const look *l, double *spacing, plm_error *error)
{
    float *squared = plm_alloc(l->count * FOURTH, sizeof *squared, error);
    if (!squared) return PLM_E_MEMORY;
    const plm_status status = plm_neighbour_table(l->xyz, l->count, FOURTH, NULL, squared, error);
    for (size_t i = 0; i < l->count && status == PLM_OK; i++) l->value[i] = squared[i * FOURTH + FOURTH - 1];
    *spacing = sqrt(plm_quantile(l->value, l->count, 0.5));
    plm_free(squared);
    return status;
}

static plm_status look_start(look *l, const plm_cloud *cloud, plm_error *error)
{
    *l = (look){.scratch = {.error = error}, .count = cloud->count, .xyz = (const float(*)[3])cloud->xyz};
    l->shape = plm_scratch_take(&l->scratch, l->count, sizeof *l->shape);
    l->height = plm_scratch_take(&l->scratch, l->count, sizeof *l->height);
    l->value = plm_scratch_take(&l->scratch, l->count, sizeof *l->value);
    l->distance = plm_scratch_take(&l->scratch, l->count, sizeof *l->distance);
    if (l->scratch.failed) return PLM_E_MEMORY;
    for (int a = 0; a < 3; a++) {
        for (size_t i = 0; i < l->count; i++) l->value[i] = l->xyz[i][a];
        const double low = plm_quantile(l->value, l->count, stray); /* sorts */
        l->size = hypot(l->size, plm_quantile(l->value, l->count, 1 - stray) - low);
    }
    double spacing;
    plm_status status = find_spacing(l, &spacing, error);
    if (status == PLM_OK) status = plm_graph_build(l->xyz, l->count, NEIGHBOURS, link * spacing, &l->graph, error);
    if (status == PLM_OK) status = plm_graph_join(&l->graph, spacing, bridge * l->size, false, error);
    return status == PLM_OK ? plm_ball_shapes(&l->graph, ball * spacing, l->shape, error) : status;
}

/* Along which axes lines run and to which sheets are normal; alike for both directions of an axis. */
static void look_at_shapes(const look *l, plm_posture *posture)
{
    double lines[3] = {0}, flat[3] = {0}, total = 0;
    for (size_t i = 0; i < l->count; i++) {
        const plm_ball_shape *s = &l->shape[i];
        const double linear = s->value[0] > 0 ? 1 - sqrt((double)s->value[1] / s->value[0]) : 0;
        for (int a = 0; a < 3; a++) {
            flat[a] += fabs((double)s->normal[a]);
            if (linear > linearity) lines[a] += linear * s->axis[a] * s->axis[a];
        }
        if (linear > linearity) total += linear;
    }
    for (int axis = 0; axis < PLM_AXES; axis++) {
        posture->sign[axis][PLM_SIGN_LINES] = total > 0 ? lines[axis % 3] / total : 0;
        posture->sign[axis][PLM_SIGN_FLAT] = flat[axis % 3] / (double)l->count;
    }
}

/* Mean logarithm of the way along the graph from the foot over the straight one, of points that are not near the foot. */
static plm_status find_detour(look *l, uint32_t foot, double *detour, plm_error *error)
{
    const plm_walk walk = {.source = &foot, .source_count = 1, .distance = l->distance};
    const plm_status status = plm_graph_walk(&l->graph, &walk, error);
    double sum = 0, far = 0;
    for (size_t i = 0; i < l->count && status == PLM_OK; i++) {
        double straight = 0;
        for (int a = 0; a < 3; a++) straight = hypot(straight, (double)l->xyz[i][a] - l->xyz[foot][a]);
        if (!(straight > apart * l->size)) continue;
        sum += isfinite(l->distance[i]) ? log(l->distance[i] / straight) : no_way;
        far++;
    }
    *detour = far > 0 ? sum / far : no_way;
    return status;
}

/* The signs of one direction of an axis. */
static plm_status look_along(look *l, int axis, double sign[PLM_POSTURE_SIGNS], plm_error *error)
{
    const int across[2] = {(axis + 1) % 3, (axis + 2) % 3};
    double sum = 0, middle[2], width = 0, nearest = INFINITY;
    for (size_t i = 0; i < l->count; i++) {
        l->height[i] = (axis < 3 ? 1 : -1) * l->xyz[i][axis % 3];
        l->value[i] = l->height[i];
        sum += l->height[i];
    }
    const double low = plm_quantile(l->value, l->count, stray), high = plm_quantile(l->value, l->count, 1 - stray);
    sign[PLM_SIGN_DETOUR] = no_way; /* if the plant has no extent along the axis */
    if (!(high > low)) return PLM_OK;
    sign[PLM_SIGN_TOP] = (sum / (double)l->count - (low + high) / 2) / (high - low);
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < l->count; i++) l->value[i] = l->xyz[i][across[c]];
        middle[c] = plm_quantile(l->value, l->count, 0.5); /* sorts */
        const double left = plm_quantile(l->value, l->count, 0.01);
        width = hypot(width, plm_quantile(l->value, l->count, 0.99) - left);
    }
    uint32_t foot = 0;
    for (uint32_t i = 0; i < l->count; i++) {
        if (!(l->height[i] < low + low_end * (high - low))) continue;
        const double off = hypot(l->xyz[i][across[0]] - middle[0], l->xyz[i][across[1]] - middle[1]);
        if (off < nearest) nearest = off, foot = i;
    }
    if (width > 0) sign[PLM_SIGN_ASIDE] = nearest / width;
    return find_detour(l, foot, &sign[PLM_SIGN_DETOUR], error);
}

static plm_status look_at(const plm_cloud *copy, plm_posture *posture, plm_error *error)
{
    look l;
    plm_status status = look_start(&l, copy, error);
    if (status == PLM_OK) look_at_shapes(&l, posture);
    for (int axis = 0; axis < PLM_AXES && status == PLM_OK; axis++)
        status = look_along(&l, axis, posture->sign[axis], error);
    plm_graph_free(&l.graph);
    plm_scratch_free(&l.scratch, NULL);
    posture->is_known = status == PLM_OK;
    return status;
}

plm_status plm_find_posture(const plm_cloud *cloud, plm_posture *posture, plm_error *error)
{
    plm_posture found = {0};
    plm_cloud copy = {0};
    plm_status status = cloud->count < FEWEST ? PLM_OK : thin_and_clean(cloud, &copy, error);
    if (status == PLM_OK && copy.count >= FEWEST) status = look_at(&copy, &found, error);
    plm_cloud_free(&copy);
    if (status == PLM_OK) *posture = found;
    return status;
}
