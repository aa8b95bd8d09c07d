/* cloud/grid.h: points sorted into the cells of an octree, for asking all of them for their nearest neighbours. Internal.
 *
 * A cell is named by its level and its number: level 0 has the finest cells, and a cell's number without its last 3 bits
 * is that of the cell around it one level up. The points of any cell lie side by side, in Morton order. */
#ifndef PLANTIMETER_CLOUD_GRID_H
#define PLANTIMETER_CLOUD_GRID_H

#include "cloud/cloud.h"

/** Points begin to end - 1 of the grid. */
typedef struct plm_range {
    uint32_t begin, end;
} plm_range;

/** A cell whose points are asked together. */
typedef struct plm_leaf {
    plm_range points;
    uint32_t level;
} plm_leaf;

/** An occupied cell; of all levels from `base` up. */
typedef struct plm_cell {
    uint64_t name; /* the number behind a leading 1, whose place tells the level; 0: an empty place of the table */
    plm_range points;
} plm_cell;

/** A point that shares its place with more points than can be neighbours: it is no candidate, and its own neighbours are
 * the first ones of its place, which begin at `place`. */
typedef struct plm_echo {
    uint32_t row, place;
} plm_echo;

typedef struct plm_grid {
    size_t count; /* points but for the echoes */
    float *x, *y, *z;
    uint32_t *row;
    uint64_t *key; /* number of the level 0 cell */
    double low[3], high[3];
    double edge;    /* of a level 0 cell */
    unsigned bits;  /* a cell of this level holds all points */
    unsigned base;  /* finest level with a table of cells */
    unsigned shift; /* of the table's hash */
    plm_cell *cell;
    size_t leaf_count, echo_count;
    plm_leaf *leaf;
    plm_echo *echo;
} plm_grid;

/** Sorts count points for questions about k neighbours (1 to 1024). suited: out,
 * false where cells cannot tell the points apart (one far point shrinks all others into one cell) and a tree does
 * better; the grid is empty then. O(n), parallel, deterministic. */
plm_status plm_grid_build(const float (*xyz)[3], size_t count, size_t k, plm_grid *grid, bool *suited,
                          plm_error *error);

/** NULL and a zeroed grid are allowed. */
void plm_grid_free(plm_grid *grid);

/** Points of a cell; begin == end where it has none. */
plm_range plm_grid_points(const plm_grid *grid, unsigned level, uint64_t number);

#endif
