/* mesh/leaf_points.c: canonical order, thinning and connected parts of a leaf's points. Nothing downstream depends on the
 * order of the input's rows, and neighbours lie near each other in memory. */
#include "mesh/leaf_points.h"

#include "cloud/local_plane.h"
#include "cloud/sampling.h"
#include "cloud/selection.h"
#include "cloud/spatial_order.h"
#include "cloud/subset.h"
#include "mesh/leaf_layers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LINK_NEIGHBOURS = 8,
    SMALLEST_PART = 12, /* points */
    AROUND = 24,        /* points around one that tell the sheet ... */
    FEWEST_AROUND = 6,  /* ... of which so many at least */
    GHOST_ROUNDS = 3
};

static const double smallest_share = 0.001; /* of the points: smaller parts are stray */
/* Edges join a part up to 5 median or 1.5 x 90th percentile of the distance to the 8th neighbour: a fixed small radius
 * loses sparse, half-hidden pieces unseen (study on virtual lettuce: up to 19 % of a leaf). */
static const double link_median = 5.0, link_high = 1.5;
/* Distance to the 8th neighbour against that of the densest tenth of those around: 1.4 at a straight rim, 2 at a right angle. Ghosts
 * have more and lie off the sheet besides: the excess times the distance off it, in SD of those around, is what tells them apart,
 * as a sparse part that goes on in the sheet has the one but not the other. */
static const double usual_reach = 1.2, unlikely = 1.5, densest = 0.1;
/* Of the reach around: scatter below is none, as that of a grid's rounded coordinates. */
static const double exact = 0.02;

/* Copies the points named by row to xyz in canonical order, each place once; gives how many places there are. */
static plm_status order_points(const float (*given)[3], const uint32_t *row, size_t count, float (*xyz)[3],
                               size_t *places, plm_error *error)
{
    uint32_t *order = plm_alloc(count, sizeof *order, error);
    float(*taken)[3] = plm_alloc(count, sizeof *taken, error);
    plm_status status = order && taken ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t j = 0; j < count; j++) memcpy(taken[j], given[row[j]], sizeof *taken);
        status = plm_spatial_order((const float(*)[3])taken, count, order, error);
    }
    size_t kept = 0;
    for (size_t j = 0; status == PLM_OK && j < count; j++) {
        const float *point = taken[order[j]];
        const float *last = kept ? xyz[kept - 1] : NULL;
        if (last && point[0] == last[0] && point[1] == last[1] && point[2] == last[2]) continue;
        memcpy(xyz[kept++], point, sizeof *xyz);
    }
    *places = kept;
    plm_free(order);
    plm_free(taken);
    return status;
}

static uint32_t find_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Joins neighbours that are nearer than limit. parent becomes a forest whose roots are the smallest rows. */
static void join_neighbours(const uint32_t *neighbour, const float *squared, size_t count, float limit,
                            uint32_t *parent)
{
    for (size_t i = 0; i < count; i++) parent[i] = (uint32_t)i;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i * LINK_NEIGHBOURS; j < (i + 1) * LINK_NEIGHBOURS && squared[j] <= limit * limit; j++) {
            const uint32_t a = find_root(parent, (uint32_t)i), b = find_root(parent, neighbour[j]);
            if (a < b)
                parent[b] = a;
            else
                parent[a] = b;
        }
}

typedef struct part {
    size_t size;
    uint32_t root;
} part;

static int compare_parts(const void *a, const void *b)
{
    const part *x = a, *y = b;
    if (x->size != y->size) return x->size > y->size ? -1 : 1;
    return x->root < y->root ? -1 : 1;
}

/* Numbers the trees of the forest by size and drops the small ones. */
static plm_status number_parts(plm_leaf_points *points, uint32_t *parent, plm_error *error)
{
    const size_t n = points->count;
    part *parts = plm_alloc(n, sizeof *parts, error);
    uint32_t *number = plm_alloc(n, sizeof *number, error);
    plm_status status = parts && number ? PLM_OK : PLM_E_MEMORY;
    size_t found = 0, kept = 0;
    if (status == PLM_OK) {
        for (size_t i = 0; i < n; i++) {
            const uint32_t root = find_root(parent, (uint32_t)i);
            if (root == i) {
                number[i] = (uint32_t)found;
                parts[found++] = (part){.root = root};
            }
            parts[number[root]].size++; /* a root is the smallest row of its tree: it was met before */
        }
        qsort(parts, found, sizeof *parts, compare_parts);
        const double smallest = fmax(SMALLEST_PART, smallest_share * (double)n);
        while (kept < found && kept < PLM_LEAF_PARTS_MAXIMUM && (double)parts[kept].size >= smallest) kept++;
        for (size_t p = 0; p < found; p++) number[parts[p].root] = p < kept ? (uint32_t)p : PLM_NO_ROW;
        for (size_t i = 0; i < n; i++) points->component[i] = number[find_root(parent, (uint32_t)i)];
        points->component_size = plm_alloc(kept, sizeof *points->component_size, error);
        if (!points->component_size) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) {
        points->component_count = kept;
        for (size_t p = 0; p < kept; p++) points->component_size[p] = parts[p].size;
    }
    plm_free(parts);
    plm_free(number);
    return status;
}

/* Index and the table of nearest neighbours; reach, whether the points are voxel means, and the median reach. */
static plm_status find_neighbours(plm_leaf_points *points, uint32_t *neighbour, float *squared, double *sorted,
                                  double *median, plm_error *error)
{
    enum { K = LINK_NEIGHBOURS };
    const size_t n = points->count;
    plm_index_free(points->index);
    points->index = NULL;
    plm_status status = plm_index_build((const float(*)[3])points->xyz, n, &points->index, error);
    if (status == PLM_OK) status = plm_index_table(points->index, K, neighbour, squared, error);
    if (status != PLM_OK) return status;
    size_t close = 0;
    for (size_t i = 0; i < n; i++) { /* n > K: fewer points are refused before */
        close += plm_neighbour_is_close(squared + i * K, K);
        sorted[i] = points->reach[i] = sqrtf(squared[i * K + K - 1]);
    }
    points->fused = plm_close_share_is_fused((double)close / (double)n);
    *median = plm_select_quantile(sorted, n, 0.5);
    return PLM_OK;
}

/* Distance of a point from the plane through those of the points around it (not itself) that reach no farther than limit, in SD of
 * these; 0 where they are too few to tell. limit is above 0. */
static double off_sheet(const plm_leaf_points *points, size_t row, const uint32_t *around, size_t count, double limit)
{
    uint32_t used[AROUND];
    size_t n = 0;
    for (size_t j = 0; j < count; j++)
        if (around[j] != row && points->reach[around[j]] <= limit) used[n++] = around[j];
    if (n < FEWEST_AROUND) return 0;
    double scatter;
    const double off = plm_local_plane_distance((const float(*)[3])points->xyz, used, n, points->xyz[row], &scatter);
    return off / fmax(scatter, exact * limit);
}

/* Whether a voxel mean is a ghost: sparser than those around it, and off their sheet. */
static bool is_ghost(const plm_leaf_points *points, size_t row)
{
    uint32_t around[AROUND];
    double reach[AROUND];
    const size_t count = plm_index_nearest(points->index, points->xyz[row], AROUND, around, NULL);
    for (size_t j = 0; j < count; j++) reach[j] = points->reach[around[j]];
    const double excess = points->reach[row] / plm_select_quantile(reach, count, densest) - usual_reach;
    if (!(excess > 0)) return false;
    return excess * off_sheet(points, row, around, count, plm_select_quantile(reach, count, 0.5)) > unlikely;
}

/* Voxel means lie evenly on a leaf, and where the cameras see it from the side they grow sparse little by little, in its sheet;
 * ghosts off its rim scatter along the rays. Leaves the ghosts out; gives how many there were. */
static size_t drop_ghosts(plm_leaf_points *points, double median)
{
    size_t kept = 0;
    for (size_t i = 0; i < points->count; i++) {
        const bool ghost = points->reach[i] > median && is_ghost(points, i);
        kept += !ghost;
        points->component[i] = ghost;
    }
    if (kept < SMALLEST_PART) return 0; /* so few tell nothing about each other */
    const size_t dropped = points->count - kept;
    kept = 0;
    for (size_t i = 0; i < points->count; i++)
        if (!points->component[i]) memmove(points->xyz[kept++], points->xyz[i], sizeof *points->xyz);
    points->count = kept;
    return dropped;
}

static plm_status find_parts(plm_leaf_points *points, int fused, plm_error *error)
{
    enum { K = LINK_NEIGHBOURS };
    const size_t n = points->count;
    uint32_t *neighbour = plm_alloc(n, K * sizeof *neighbour, error);
    float *squared = plm_alloc(n, K * sizeof *squared, error);
    double *sorted = plm_alloc(n, sizeof *sorted, error), median = 0;
    uint32_t *parent = plm_alloc(n, sizeof *parent, error);
    points->reach = plm_alloc(n, sizeof *points->reach, error);
    points->component = plm_alloc(n, sizeof *points->component, error);
    plm_status status =
        neighbour && squared && sorted && parent && points->reach && points->component ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = find_neighbours(points, neighbour, squared, sorted, &median, error);
    if (status == PLM_OK && fused >= 0) points->fused = fused > 0;
    for (int round = 0; round < GHOST_ROUNDS && status == PLM_OK && points->fused; round++) {
        if (drop_ghosts(points, median) == 0) break;
        status = find_neighbours(points, neighbour, squared, sorted, &median, error);
        points->fused = true;
    }
    if (status == PLM_OK) {
        const size_t left = points->count;
        const double limit = fmax(link_median * median, link_high * plm_select_quantile(sorted, left, 0.9));
        join_neighbours(neighbour, squared, left, (float)limit, parent);
        status = number_parts(points, parent, error);
    }
    plm_free(neighbour);
    plm_free(squared);
    plm_free(sorted);
    plm_free(parent);
    return status;
}

plm_status plm_leaf_points_make(const float (*xyz)[3], size_t count, size_t most, int fused, plm_leaf_points *points,
                                plm_error *error)
{
    plm_leaf_points made = {0};
    uint32_t *row = plm_alloc(count, sizeof *row, error);
    const size_t taken = row ? plm_sample_rows(xyz, count, most, row) : 0;
    made.xyz = row ? plm_alloc(taken, sizeof *made.xyz, error) : NULL;
    plm_status status = made.xyz ? order_points(xyz, row, taken, made.xyz, &made.count, error) : PLM_E_MEMORY;
    if (status == PLM_OK && made.count < SMALLEST_PART)
        status = plm_fail(error, PLM_E_DEGENERATE,
                          "%zu points in %zu places are too few for a leaf surface; %d are "
                          "needed",
                          count, made.count, SMALLEST_PART);
    if (status == PLM_OK) status = find_parts(&made, fused, error);
    if (status == PLM_OK) status = plm_leaf_layers_merge(&made, error);
    if (status == PLM_OK && made.component_count == 0)
        status = plm_fail(error, PLM_E_DEGENERATE, "the leaf's %zu points form no part of %d or more", made.count,
                          SMALLEST_PART);
    plm_free(row);
    if (status == PLM_OK)
        *points = made;
    else
        plm_leaf_points_free(&made);
    return status;
}

void plm_leaf_points_free(plm_leaf_points *points)
{
    if (!points) return;
    plm_index_free(points->index);
    plm_free(points->xyz);
    plm_free(points->reach);
    plm_free(points->component);
    plm_free(points->component_size);
    *points = (plm_leaf_points){0};
}
