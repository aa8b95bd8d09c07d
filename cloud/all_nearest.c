/* cloud/all_nearest.c: k nearest neighbours of all points, leaf by leaf of the grid. The points of a leaf share one list
 * of candidates, those of the 3 x 3 x 3 cells around. What lies outside of this block is farther than its nearest face;
 * a point whose k-th neighbour is not nearer than that is asked again one level up, where the block is twice as wide. */
#include "cloud/all_nearest.h"

#include "cloud/candidates.h"
#include "cloud/grid.h"
#include "cloud/morton.h"
#include "cloud/neighbours.h"

#include <math.h>

enum {
    LEAVES_AT_ONCE = 64,
    FEW_POINTS = 64 /* up to which a tree is as good */
};

typedef struct question {
    const plm_grid *grid;
    size_t k;
    plm_neighbour_visit visit;
    void *user;
} question;

/** One thread's room. */
typedef struct workspace {
    plm_candidates near;
    uint32_t *open; /* points of the leaf that are not answered yet, by their place in the grid */
    size_t open_room;
} workspace;

/** A block of 3 x 3 x 3 cells. */
typedef struct block {
    float low[3], high[3]; /* faces; infinite where no points lie beyond */
    float diagonal;        /* longer than any distance within */
    uint32_t own_begin;    /* points of the middle cell begin here in the grid ... */
    size_t own_place;      /* ... and here among the candidates */
} block;

static void set_faces(const plm_grid *grid, unsigned level, const uint64_t middle[3], block *around)
{
    const double edge = ldexp(grid->edge, (int)level);
    const uint64_t last = ((uint64_t)1 << (grid->bits - level)) - 1;
    around->diagonal = (float)(5.25 * edge); /* > sqrt(27) */
    for (int axis = 0; axis < 3; axis++) {
        /* inward by a millionth of a cell: rounding may have put a point on the wrong side of a face */
        const double low = grid->low[axis] + ((double)middle[axis] - 1 + 1e-6) * edge;
        const double high = grid->low[axis] + ((double)middle[axis] + 2 - 1e-6) * edge;
        around->low[axis] = middle[axis] <= 1 ? -INFINITY : nextafterf((float)low, INFINITY);
        around->high[axis] = middle[axis] + 1 >= last ? INFINITY : nextafterf((float)high, -INFINITY);
    }
}

/** The points of the block's cells, as runs in the grid. Gives how many runs there are. */
static size_t find_runs(const plm_grid *grid, unsigned level, const uint64_t middle[3], plm_range run[27])
{
    const uint64_t cells = (uint64_t)1 << (grid->bits - level);
    uint64_t spread[3][3]; /* bits of the key, by axis */
    for (int axis = 0; axis < 3; axis++)
        for (uint64_t i = 0; i < 3; i++) spread[axis][i] = plm_morton_spread(middle[axis] + i - 1) << axis;
    size_t runs = 0;
    for (uint64_t z = 0; z < 3; z++)
        for (uint64_t y = 0; y < 3; y++)
            for (uint64_t x = 0; x < 3; x++) {
                /* -1 wraps around and is beyond, too */
                if (middle[0] + x - 1 >= cells || middle[1] + y - 1 >= cells || middle[2] + z - 1 >= cells) continue;
                const plm_range points = plm_grid_points(grid, level, spread[0][x] | spread[1][y] | spread[2][z]);
                if (points.begin < points.end) run[runs++] = points;
            }
    return runs;
}

static plm_status gather(const plm_grid *grid, unsigned level, uint64_t number, plm_candidates *list, block *around,
                         plm_error *error)
{
    const uint64_t middle[3] = {plm_morton_squeeze(number), plm_morton_squeeze(number >> 1),
                                plm_morton_squeeze(number >> 2)};
    plm_range run[27];
    const size_t runs = find_runs(grid, level, middle, run);
    size_t count = 0;
    for (size_t r = 0; r < runs; r++) count += run[r].end - run[r].begin;
    const plm_status status = plm_candidates_reset(list, count, error);
    if (status != PLM_OK) return status;
    for (size_t r = 0; r < runs; r++) {
        const uint32_t begin = run[r].begin;
        if (grid->key[begin] >> 3 * level == number) around->own_begin = begin, around->own_place = list->count;
        plm_candidates_add(list, grid->x + begin, grid->y + begin, grid->z + begin, grid->row + begin,
                           run[r].end - begin);
    }
    set_faces(grid, level, middle, around);
    return PLM_OK;
}

/** Squared distance that everything outside of the block exceeds. */
static float covered(const block *around, const float point[3])
{
    float nearest = around->diagonal;
    for (int axis = 0; axis < 3; axis++) {
        const float below = point[axis] - around->low[axis], above = around->high[axis] - point[axis];
        nearest = below < nearest ? below : nearest;
        nearest = above < nearest ? above : nearest;
    }
    return nearest > 0 ? nearest * nearest * (1 - 1e-6f) : 0; /* distances are rounded, too */
}

/** Answers one point from the candidates of a block; false where the block is too small. */
static bool answer(const question *asked, uint32_t place, const block *around, plm_candidates *list)
{
    const plm_grid *grid = asked->grid;
    const float point[3] = {grid->x[place], grid->y[place], grid->z[place]};
    const size_t self = around->own_place + (place - around->own_begin);
    if (!plm_candidates_nearest(list, point, self, asked->k, covered(around, point))) return false;
    const plm_neighbourhood found = {.point_row = grid->row[place],
                                     .point = {point[0], point[1], point[2]},
                                     .count = asked->k,
                                     .place = list->chosen,
                                     .squared = list->near,
                                     .x = list->x,
                                     .y = list->y,
                                     .z = list->z,
                                     .row = list->row};
    asked->visit(asked->user, &found);
    return true;
}

static plm_status answer_leaf(const question *asked, const plm_leaf *leaf, workspace *work, plm_error *error)
{
    const plm_grid *grid = asked->grid;
    size_t open = leaf->points.end - leaf->points.begin;
    if (open > work->open_room) {
        uint32_t *room = plm_realloc(work->open, 2 * open, sizeof *room, error);
        if (!room) return PLM_E_MEMORY;
        work->open = room;
        work->open_room = 2 * open;
    }
    for (size_t i = 0; i < open; i++) work->open[i] = leaf->points.begin + (uint32_t)i;
    for (unsigned level = leaf->level; open > 0; level++) { /* ends at the level whose one cell holds all points */
        block around = {0};
        const uint64_t number = grid->key[leaf->points.begin] >> 3 * level;
        const plm_status status = gather(grid, level, number, &work->near, &around, error);
        if (status != PLM_OK) return status;
        size_t still_open = 0;
        for (size_t i = 0; i < open; i++)
            if (!answer(asked, work->open[i], &around, &work->near)) work->open[still_open++] = work->open[i];
        open = still_open;
    }
    return PLM_OK;
}

/** Points of which more are at the same place than can be neighbours: the first of these are all theirs. */
static void answer_echoes(const question *asked)
{
    static const float zero[PLM_MOST_NEIGHBOURS];
    const plm_grid *grid = asked->grid;
    uint32_t first[PLM_MOST_NEIGHBOURS];
    for (uint32_t i = 0; i < asked->k; i++) first[i] = i;
    for (size_t i = 0; i < grid->echo_count; i++) {
        const uint32_t place = grid->echo[i].place;
        const plm_neighbourhood found = {.point_row = grid->echo[i].row,
                                         .point = {grid->x[place], grid->y[place], grid->z[place]},
                                         .count = asked->k,
                                         .place = first,
                                         .squared = zero,
                                         .x = grid->x + place,
                                         .y = grid->y + place,
                                         .z = grid->z + place,
                                         .row = grid->row + place};
        asked->visit(asked->user, &found);
    }
}

static plm_status answer_by_grid(const question *asked, plm_error *error)
{
    const plm_grid *grid = asked->grid;
    plm_status result = PLM_OK;
#pragma omp parallel
    {
        workspace work = {0};
        plm_error own_error = {0};
        plm_status status = PLM_OK;
#pragma omp for schedule(dynamic, LEAVES_AT_ONCE)
        for (size_t i = 0; i < grid->leaf_count; i++)
            if (status == PLM_OK) status = answer_leaf(asked, &grid->leaf[i], &work, &own_error);
        if (status != PLM_OK) {
#pragma omp critical
            {
                result = status;
                if (error) *error = own_error;
            }
        }
        plm_candidates_free(&work.near);
        plm_free(work.open);
    }
    if (result == PLM_OK) answer_echoes(asked);
    return result;
}

/** The same by a k-d tree, for clouds that a grid cannot tell apart. */
static plm_status answer_by_tree(const float (*xyz)[3], size_t count, const question *asked, plm_error *error)
{
    plm_index *index = NULL;
    const plm_status status = plm_index_build(xyz, count, &index, error);
    if (status != PLM_OK) return status;
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < count; i++) {
        uint32_t row[PLM_MOST_NEIGHBOURS], place[PLM_MOST_NEIGHBOURS];
        float x[PLM_MOST_NEIGHBOURS], y[PLM_MOST_NEIGHBOURS], z[PLM_MOST_NEIGHBOURS], squared[PLM_MOST_NEIGHBOURS];
        const size_t known = plm_index_neighbours(index, (uint32_t)i, asked->k, row, squared);
        for (size_t j = 0; j < known; j++) {
            place[j] = (uint32_t)j;
            x[j] = xyz[row[j]][0], y[j] = xyz[row[j]][1], z[j] = xyz[row[j]][2];
        }
        const plm_neighbourhood found = {.point_row = (uint32_t)i,
                                         .point = {xyz[i][0], xyz[i][1], xyz[i][2]},
                                         .count = known,
                                         .place = place,
                                         .squared = squared,
                                         .x = x,
                                         .y = y,
                                         .z = z,
                                         .row = row};
        asked->visit(asked->user, &found);
    }
    plm_index_free(index);
    return PLM_OK;
}

plm_status plm_all_nearest(const float (*xyz)[3], size_t count, size_t k, plm_neighbour_visit visit, void *user,
                           plm_error *error)
{
    if (k == 0 || k > PLM_MOST_NEIGHBOURS)
        return plm_fail(error, PLM_E_ARGUMENT, "%zu neighbours; 1 to %d can be asked for", k, PLM_MOST_NEIGHBOURS);
    plm_grid grid = {0};
    const question asked = {&grid, count == 0 || k < count ? k : count - 1, visit, user};
    bool suited = false;
    plm_status status = PLM_OK;
    if (count > FEW_POINTS) status = plm_grid_build(xyz, count, asked.k, &grid, &suited, error);
    if (status == PLM_OK) status = suited ? answer_by_grid(&asked, error) : answer_by_tree(xyz, count, &asked, error);
    plm_grid_free(&grid);
    return status;
}
