/* cloud/grid.c: the cells and leaves of cloud/grid.h.
 *
 * The base cell is chosen such that a block of 3 x 3 x 3 cells nearly always holds the k nearest neighbours of the points
 * in its middle: by measuring how many points occupied cells hold, because clouds of plants are neither flat nor full.
 * From there leaves go finer where points are denser and coarser where they are thinner. */
#include "cloud/grid.h"

#include "cloud/morton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FINER_LEVELS = 3,   /* below the base cell: densities of 8^3 to 1 in space, 4^3 to 1 on surfaces */
    SIZE_ROUNDS = 6,    /* of measuring occupancy; 2 or 3 are the rule */
    CROWD = 64,         /* points in a finest cell that are worth a look for duplicates */
    NUMBER_BITS = 58,   /* of a cell's number in its name: levels above the base need no more */
    WORST_CROWDING = 40 /* times the wanted work, from which on a tree is faster */
};

/* A leaf is cut while its parts still hold this share of the wanted occupancy (study in bench/bench_neighbours.cpp). */
static const double least_part = 0.6;

/** Points a cell should hold: the ball of k neighbours, and 2.5 sigma more, in a radius of one cell. */
static double wanted_occupancy(size_t k)
{
    const double count = (double)k + 2.5 * sqrt((double)k) + 1;
    return fmax(count / 3.6, 3.0); /* between 4/3 pi (space) and pi (surface) */
}

static void measure_bounds(const float (*xyz)[3], size_t count, plm_grid *grid)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
#pragma omp parallel for schedule(static) reduction(min : low[:3]) reduction(max : high[:3])
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = xyz[i][axis] < low[axis] ? xyz[i][axis] : low[axis];
            high[axis] = xyz[i][axis] > high[axis] ? xyz[i][axis] : high[axis];
        }
    for (int axis = 0; axis < 3; axis++) grid->low[axis] = low[axis], grid->high[axis] = high[axis];
}

/** How many cells of the given edge hold points: by linear counting (Whang, Vander-Zanden and Taylor 1990), a bit for
 * each hash of a cell. Good to 1 % where there are 2 bits a point. */
static double count_occupied(const float (*xyz)[3], size_t count, const double low[3], double edge, uint64_t *bitmap,
                             unsigned bitmap_bits)
{
    const double scale = 1 / edge;
    memset(bitmap, 0, (size_t)1 << (bitmap_bits - 3));
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < count; i++) {
        uint64_t hash = 0;
        for (int axis = 0; axis < 3; axis++)
            hash = (hash ^ (uint64_t)((xyz[i][axis] - low[axis]) * scale)) * 0x9e3779b97f4a7c15u;
        hash = (hash ^ hash >> 29) * 0xbf58476d1ce4e5b9u >> (64 - bitmap_bits);
        const uint64_t bit = (uint64_t)1 << (hash & 63);
        uint64_t word;
#pragma omp atomic read
        word = bitmap[hash >> 6];
        if (word & bit) continue;
#pragma omp atomic
        bitmap[hash >> 6] |= bit;
    }
    size_t set = 0;
    for (size_t i = 0; i < (size_t)1 << (bitmap_bits - 6); i++) set += (size_t)__builtin_popcountll(bitmap[i]);
    const double places = ldexp(1, (int)bitmap_bits);
    return places * -log1p(-fmin((double)set, places - 1) / places);
}

/** Edge of the cells that hold about `wanted` points each. One extrapolation can miss by four times: measured anew until
 * it fits. */
static plm_status choose_edge(const float (*xyz)[3], size_t count, const plm_grid *grid, double wanted, double *edge,
                              plm_error *error)
{
    unsigned bitmap_bits = 10;
    while (bitmap_bits < 40 && (size_t)1 << bitmap_bits < 2 * count) bitmap_bits++;
    uint64_t *bitmap = plm_alloc((size_t)1 << (bitmap_bits - 6), sizeof *bitmap, error);
    if (!bitmap) return PLM_E_MEMORY;
    double side[3], most = 0, volume = 1;
    for (int axis = 0; axis < 3; axis++) most = fmax(most, side[axis] = grid->high[axis] - grid->low[axis]);
    for (int axis = 0; axis < 3; axis++) volume *= fmax(side[axis], most * 1e-3);
    const double finest = most * 0x1p-21;
    double size = fmax(cbrt(volume * wanted / (double)count), finest), dimension = 2, before = 0, held_before = 0;
    for (int round = 0; round < SIZE_ROUNDS && most > 0; round++) {
        const double held = (double)count / count_occupied(xyz, count, grid->low, size, bitmap, bitmap_bits);
        if (held > 0.85 * wanted && held < 1.2 * wanted) break;
        if (round && size != before) dimension = fmin(3, fmax(1, log(held / held_before) / log(size / before)));
        before = size, held_before = held;
        size = fmin(most, fmax(finest, size * pow(wanted / held, 1 / dimension)));
    }
    plm_free(bitmap);
    *edge = most > 0 ? size : 1;
    return PLM_OK;
}

/** Lays the levels: base cells of the given edge, finer ones below, as far as 21 bits carry. */
static void lay_levels(plm_grid *grid, double base_edge)
{
    double most = 0;
    for (int axis = 0; axis < 3; axis++) most = fmax(most, grid->high[axis] - grid->low[axis]);
    grid->base = FINER_LEVELS;
    for (;;) {
        grid->edge = ldexp(base_edge, -(int)grid->base);
        for (grid->bits = grid->base; grid->bits <= PLM_MORTON_BITS; grid->bits++)
            if (most * (1 + 1e-9) < ldexp(grid->edge, (int)grid->bits)) return;
        if (grid->base > 0)
            grid->base--;
        else
            base_edge *= 2;
    }
}

static plm_status sort_points(const float (*xyz)[3], size_t count, plm_grid *grid, plm_error *error)
{
    plm_keys keys;
    plm_status status = plm_keys_create(count, &keys, error);
    if (status != PLM_OK) return status;
    const double scale = 1 / grid->edge;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < count; i++) {
        uint64_t number[3];
        for (int axis = 0; axis < 3; axis++) number[axis] = (uint64_t)((xyz[i][axis] - grid->low[axis]) * scale);
        keys.key[i] = plm_morton_key(number[0], number[1], number[2]);
        keys.row[i] = (uint32_t)i;
    }
    status = plm_keys_sort(&keys, 3 * grid->bits, error);
    if (status == PLM_OK) {
        grid->x = plm_alloc(count, sizeof *grid->x, error);
        grid->y = plm_alloc(count, sizeof *grid->y, error);
        grid->z = plm_alloc(count, sizeof *grid->z, error);
        if (!grid->x || !grid->y || !grid->z) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) {
        grid->count = count;
        grid->key = keys.key;
        grid->row = keys.row;
        keys = (plm_keys){0};
#pragma omp parallel for schedule(static)
        for (size_t i = 0; i < count; i++) {
            const uint32_t from = grid->row[i];
            grid->x[i] = xyz[from][0], grid->y[i] = xyz[from][1], grid->z[i] = xyz[from][2];
        }
    }
    plm_keys_free(&keys);
    return status;
}

typedef struct placed_row {
    float place[3];
    uint32_t row;
} placed_row;

static int compare_places(const void *a, const void *b)
{
    const placed_row *p = a, *q = b;
    for (int axis = 0; axis < 3; axis++)
        if (p->place[axis] != q->place[axis]) return p->place[axis] < q->place[axis] ? -1 : 1;
    return (p->row > q->row) - (p->row < q->row);
}

static bool same_place(const placed_row *a, const placed_row *b)
{
    return a->place[0] == b->place[0] && a->place[1] == b->place[1] && a->place[2] == b->place[2];
}

/** Moves the points of one crowded cell to `to` (at or before where they stand), and those that have `most` others at
 * their place and in front of them to the echoes. Gives where the next point goes. */
static size_t thin_cell(plm_grid *grid, plm_range run, size_t to, size_t most, placed_row *scratch)
{
    const size_t count = run.end - run.begin;
    const uint64_t key = grid->key[run.begin];
    for (size_t i = 0; i < count; i++) {
        const size_t from = run.begin + i;
        scratch[i] = (placed_row){{grid->x[from], grid->y[from], grid->z[from]}, grid->row[from]};
    }
    qsort(scratch, count, sizeof *scratch, compare_places);
    size_t place = to, alike = 0;
    for (size_t i = 0; i < count; i++) {
        alike = i > 0 && same_place(&scratch[i], &scratch[i - 1]) ? alike + 1 : 0;
        if (alike == 0) place = to;
        if (alike >= most) {
            grid->echo[grid->echo_count++] = (plm_echo){scratch[i].row, (uint32_t)place};
            continue;
        }
        grid->x[to] = scratch[i].place[0], grid->y[to] = scratch[i].place[1], grid->z[to] = scratch[i].place[2];
        grid->row[to] = scratch[i].row;
        grid->key[to++] = key;
    }
    return to;
}

/** Of points at one place only the first k + 1 rows can be anybody's neighbours; all others become echoes, so that any
 * number of duplicates costs no more than k. */
static plm_status drop_echoes(plm_grid *grid, size_t k, plm_error *error)
{
    const size_t crowd = 2 * (k + 1) > CROWD ? 2 * (k + 1) : CROWD;
    size_t longest = 0, crowded = 0;
    for (size_t begin = 0, end; begin < grid->count; begin = end) {
        for (end = begin + 1; end < grid->count && grid->key[end] == grid->key[begin];) end++;
        if (end - begin <= crowd) continue;
        crowded += end - begin;
        if (end - begin > longest) longest = end - begin;
    }
    if (!crowded) return PLM_OK;
    placed_row *scratch = plm_alloc(longest, sizeof *scratch, error);
    grid->echo = plm_alloc(crowded, sizeof *grid->echo, error);
    if (!scratch || !grid->echo) {
        plm_free(scratch);
        return PLM_E_MEMORY;
    }
    size_t to = 0;
    for (size_t begin = 0, end; begin < grid->count; begin = end) {
        for (end = begin + 1; end < grid->count && grid->key[end] == grid->key[begin];) end++;
        if (end - begin > crowd) {
            to = thin_cell(grid, (plm_range){(uint32_t)begin, (uint32_t)end}, to, k + 1, scratch);
            continue;
        }
        for (size_t i = begin; i < end; i++, to++) {
            grid->x[to] = grid->x[i], grid->y[to] = grid->y[i], grid->z[to] = grid->z[i];
            grid->row[to] = grid->row[i], grid->key[to] = grid->key[i];
        }
    }
    grid->count = to;
    plm_free(scratch);
    return PLM_OK;
}

static uint64_t name_of(const plm_grid *grid, unsigned level, uint64_t number)
{
    return (uint64_t)1 << 3 * (grid->bits - level) | number;
}

static size_t place_of(const plm_grid *grid, uint64_t name)
{
    return name * 0x9e3779b97f4a7c15u >> grid->shift;
}

static void put_cell(plm_grid *grid, unsigned level, uint32_t begin, uint32_t end)
{
    const size_t mask = SIZE_MAX >> grid->shift;
    const uint64_t name = name_of(grid, level, grid->key[begin] >> 3 * level);
    size_t place = place_of(grid, name);
    while (grid->cell[place].name) place = (place + 1) & mask;
    grid->cell[place] = (plm_cell){name, {begin, end}};
}

/** Puts the cells of all levels from the base up into the table, or only counts them where there is none yet. A cell
 * ends where the key before and the next one differ at its level or above. */
static size_t gather_cells(plm_grid *grid)
{
    uint32_t begin[PLM_MORTON_BITS + 1] = {0};
    size_t cells = 0;
    for (size_t i = 1; i <= grid->count; i++) {
        unsigned top = grid->bits;
        if (i < grid->count) {
            const uint64_t difference = (grid->key[i] ^ grid->key[i - 1]) >> 3 * grid->base;
            if (!difference) continue;
            top = grid->base + (unsigned)(63 - __builtin_clzll(difference)) / 3;
        }
        for (unsigned level = grid->base; level <= top; level++, cells++) {
            if (grid->cell) put_cell(grid, level, begin[level], (uint32_t)i);
            begin[level] = (uint32_t)i;
        }
    }
    return cells;
}

static plm_status make_table(plm_grid *grid, plm_error *error)
{
    const size_t cells = gather_cells(grid);
    unsigned table_bits = 4;
    while ((size_t)1 << table_bits < cells + cells / 2) table_bits++;
    grid->shift = 64 - table_bits;
    grid->cell = plm_alloc_zero((size_t)1 << table_bits, sizeof *grid->cell, error);
    if (!grid->cell) return PLM_E_MEMORY;
    gather_cells(grid);
    return PLM_OK;
}

/** First point of the range whose key is not below the given one. */
static uint32_t lower_bound(const uint64_t *key, plm_range range, uint64_t least)
{
    while (range.begin < range.end) {
        const uint32_t middle = range.begin + (range.end - range.begin) / 2;
        if (key[middle] < least)
            range.begin = middle + 1;
        else
            range.end = middle;
    }
    return range.begin;
}

plm_range plm_grid_points(const plm_grid *grid, unsigned level, uint64_t number)
{
    const unsigned table_level = level < grid->base ? grid->base : level;
    const uint64_t name = name_of(grid, table_level, number >> 3 * (table_level - level));
    const size_t mask = SIZE_MAX >> grid->shift;
    size_t place = place_of(grid, name);
    while (grid->cell[place].name != name) {
        if (!grid->cell[place].name) return (plm_range){0, 0};
        place = (place + 1) & mask;
    }
    plm_range range = grid->cell[place].points;
    if (level == table_level) return range;
    range.begin = lower_bound(grid->key, range, number << 3 * level);
    range.end = lower_bound(grid->key, range, (number + 1) << 3 * level);
    return range;
}

/** Leaves as they are cut; their number is not known before. */
typedef struct leaf_list {
    plm_leaf *leaf;
    size_t count, room;
    double least;
} leaf_list;

static plm_status add_leaf(leaf_list *list, plm_range points, unsigned level, plm_error *error)
{
    if (list->count == list->room) {
        const size_t room = list->room + list->room / 2 + 64;
        plm_leaf *wider = plm_realloc(list->leaf, room, sizeof *wider, error);
        if (!wider) return PLM_E_MEMORY;
        list->leaf = wider;
        list->room = room;
    }
    list->leaf[list->count++] = (plm_leaf){points, level};
    return PLM_OK;
}

/** Cuts a cell into leaves, in order. */
static plm_status cut(const plm_grid *grid, plm_range points, unsigned level, leaf_list *list, plm_error *error)
{
    uint32_t bound[9] = {points.begin};
    const double size = points.end - points.begin;
    int parts = 0;
    if (level > 0 && size > list->least)
        for (unsigned part = 0; part < 8; part++) {
            const uint64_t next = ((grid->key[points.begin] >> 3 * level << 3) | part) + 1;
            bound[part + 1] = lower_bound(grid->key, (plm_range){bound[part], points.end}, next << 3 * (level - 1));
            parts += bound[part + 1] > bound[part];
        }
    if (parts == 0 || size < list->least * parts) return add_leaf(list, points, level, error);
    plm_status status = PLM_OK;
    for (unsigned part = 0; part < 8 && status == PLM_OK; part++)
        if (bound[part + 1] > bound[part])
            status = cut(grid, (plm_range){bound[part], bound[part + 1]}, level - 1, list, error);
    return status;
}

static plm_status make_leaves(plm_grid *grid, double wanted, bool *suited, plm_error *error)
{
    leaf_list list = {.least = least_part * wanted};
    const plm_range all = {0, (uint32_t)grid->count};
    const plm_status status = grid->count ? cut(grid, all, grid->bits, &list, error) : PLM_OK;
    grid->leaf = list.leaf;
    grid->leaf_count = list.count;
    double work = 0;
    for (size_t i = 0; i < list.count; i++) {
        const double size = list.leaf[i].points.end - list.leaf[i].points.begin;
        work += size * size;
    }
    *suited = work <= WORST_CROWDING * wanted * (double)grid->count;
    return status;
}

plm_status plm_grid_build(const float (*xyz)[3], size_t count, size_t k, plm_grid *grid, bool *suited, plm_error *error)
{
    plm_grid made = {0};
    const double wanted = wanted_occupancy(k);
    double edge = 1;
    *suited = true;
    if (count) measure_bounds(xyz, count, &made);
    plm_status status = count ? choose_edge(xyz, count, &made, wanted, &edge, error) : PLM_OK;
    if (status == PLM_OK) {
        lay_levels(&made, edge);
        status = sort_points(xyz, count, &made, error);
    }
    if (status == PLM_OK) status = drop_echoes(&made, k, error);
    if (status == PLM_OK) status = make_leaves(&made, wanted, suited, error);
    if (status == PLM_OK && *suited) status = make_table(&made, error);
    if (status != PLM_OK || !*suited) plm_grid_free(&made);
    if (status == PLM_OK) *grid = made;
    return status;
}

void plm_grid_free(plm_grid *grid)
{
    if (!grid) return;
    plm_free(grid->x);
    plm_free(grid->y);
    plm_free(grid->z);
    plm_free(grid->row);
    plm_free(grid->key);
    plm_free(grid->cell);
    plm_free(grid->leaf);
    plm_free(grid->echo);
    *grid = (plm_grid){0};
}
