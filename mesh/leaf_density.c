/* mesh/leaf_density.c: half-density area. A straight edge that is blurred symmetrically keeps its half level in place,
 * so noise, spacing and layers cancel to first order. The level has to be local: densities differ tenfold over one leaf. */
#include "mesh/leaf_density.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

static const double core_depth = 1.2;   /* widths from the rim at which the interior's density is read ... */
static const double level_window = 3.0; /* ... averaged over so many widths */
static const double furthest_out = 1.5; /* widths beyond the trimmed triangles that may count */
static const double cells_per_width = 2.0;

enum { RASTERS = 9 };

/* Rasters over the cells of the sheet's finest level. */
typedef struct density_rasters {
    double *mask; /* 1 where a chosen triangle covers the cell's centre */
    /* Where a triangle of a filled hole covers the centre: it has no points, and counts. Of the triangle, as the sheet has nothing to go by. */
    double *hole_secant, *hole_height;
    double *density; /* points per surface area, blurred */
    double *level;   /* the interior's density nearby */
    double *scratch, *first, *second, *third;
} density_rasters;

/* Sets value to cover in the cells of a triangle, and height, unless NULL, to the triangle's. */
static void cover_triangle(const plm_sheet_level *grid, const double *a, const double *b, const double *c, double cover,
                           double *value, double *height)
{
    const double low_v = fmin(a[1], fmin(b[1], c[1])), high_v = fmax(a[1], fmax(b[1], c[1]));
    const double low_u = fmin(a[0], fmin(b[0], c[0])), high_u = fmax(a[0], fmax(b[0], c[0]));
    const long row0 = (long)ceil((low_v - grid->low[1]) / grid->cell);
    const long row1 = (long)floor((high_v - grid->low[1]) / grid->cell);
    const long column0 = (long)ceil((low_u - grid->low[0]) / grid->cell);
    const long column1 = (long)floor((high_u - grid->low[0]) / grid->cell);
    for (long row = row0; row <= row1; row++)
        for (long column = column0; column <= column1; column++) {
            const double u = grid->low[0] + (double)column * grid->cell, v = grid->low[1] + (double)row * grid->cell;
            const double ab = (b[0] - a[0]) * (v - a[1]) - (b[1] - a[1]) * (u - a[0]);
            const double bc = (c[0] - b[0]) * (v - b[1]) - (c[1] - b[1]) * (u - b[0]);
            const double ca = (a[0] - c[0]) * (v - c[1]) - (a[1] - c[1]) * (u - c[0]);
            if (!(ab >= 0 && bc >= 0 && ca >= 0)) continue;
            const size_t at = (size_t)row * grid->columns + (size_t)column;
            value[at] = cover;
            if (height && ab + bc + ca > 0) height[at] = (bc * a[2] + ca * b[2] + ab * c[2]) / (ab + bc + ca);
        }
}

/* result is 1 where all cells within radius (in cells) of a cell have source above threshold (erosion), or, dilating,
 * where any has. */
static void grow(const double *source, const plm_sheet_level *grid, double radius, bool dilate, double *result)
{
    const long reach = (long)radius, columns = (long)grid->columns, rows = (long)grid->rows;
    memset(result, 0, grid->columns * grid->rows * sizeof *result);
    for (long row = reach; row < rows - reach; row++)
        for (long column = reach; column < columns - reach; column++) {
            bool met = false; /* a cell that decides */
            for (long y = -reach; y <= reach && !met; y++)
                for (long x = -reach; x <= reach && !met; x++)
                    if ((double)(x * x + y * y) <= radius * radius)
                        met = (source[(row + y) * columns + column + x] > 0) == dilate;
            result[row * columns + column] = met == dilate ? 1 : 0;
        }
}

static double secant_at(const plm_sheet_level *grid, size_t at)
{
    return sqrt(1 + grid->slope_u[at] * grid->slope_u[at] + grid->slope_v[at] * grid->slope_v[at]);
}

/* The interior's density around every cell: mean of density over the core (cells far from the rim), and, where no core
 * is near (narrow leaves), the density over the mask divided by what a blurred mask would have. */
static void find_level(const plm_sheet_level *grid, density_rasters *r)
{
    const size_t cells = grid->columns * grid->rows;
    const double window = level_window * cells_per_width;
    grow(r->mask, grid, core_depth * cells_per_width, false, r->first);
    plm_blur(r->first, grid->columns, grid->rows, window, r->scratch, r->second);
    for (size_t at = 0; at < cells; at++) r->first[at] *= r->density[at];
    plm_blur(r->first, grid->columns, grid->rows, window, r->scratch, r->third);
    for (size_t at = 0; at < cells; at++) r->level[at] = r->second[at] > 1.0 ? r->third[at] / r->second[at] : 0;
    bool complete = true;
    for (size_t at = 0; at < cells && complete; at++) complete = !(r->mask[at] > 0) || r->level[at] > 0;
    if (complete) return;
    /* The mask as the blur sees it, then the same ratio over all of the mask. */
    plm_blur(r->mask, grid->columns, grid->rows, cells_per_width, r->scratch, r->first);
    const double full = 2 * PLM_PI * cells_per_width * cells_per_width;
    for (size_t at = 0; at < cells; at++) r->first[at] *= r->mask[at] / full;
    plm_blur(r->first, grid->columns, grid->rows, window, r->scratch, r->second);
    for (size_t at = 0; at < cells; at++) r->first[at] = r->mask[at] * r->density[at];
    plm_blur(r->first, grid->columns, grid->rows, window, r->scratch, r->third);
    for (size_t at = 0; at < cells; at++)
        if (!(r->level[at] > 0) && r->second[at] > 1e-6) r->level[at] = r->third[at] / r->second[at];
}

static void add_cell(plm_density_areas *areas, double area, const double point[3])
{
    areas->half += area;
    for (int i = 0, k = 0; i < 3; i++) {
        areas->first[i] += area * point[i];
        for (int j = i; j < 3; j++) areas->second[k++] += area * point[i] * point[j];
    }
}

static void sum_half(const plm_leaf_patch *patch, const plm_leaf_charts *charts, const density_rasters *r,
                     plm_density_areas *areas)
{
    const plm_sheet_level *grid = &patch->sheet.level[0];
    for (size_t at = 0; at < grid->columns * grid->rows; at++) {
        const bool dense = r->first[at] > 0 && r->level[at] > 0 && r->density[at] >= 0.5 * r->level[at];
        if (!dense && !(r->hole_secant[at] > 0)) continue;
        const double uvz[3] = {grid->low[0] + (double)(at % grid->columns) * grid->cell,
                               grid->low[1] + (double)(at / grid->columns) * grid->cell,
                               dense ? grid->height[at] : r->hole_height[at]};
        double point[3];
        plm_leaf_chart_lift(&patch->chart, uvz, point);
        if (charts->count > 1 && plm_leaf_chart_of(charts, point) != patch->self) continue;
        add_cell(areas, grid->cell * grid->cell * (dense ? secant_at(grid, at) : r->hole_secant[at]), point);
    }
}

plm_status plm_leaf_density(const plm_leaf_patch *patch, const uint8_t *state, const plm_leaf_charts *charts,
                            plm_density_areas *areas, plm_error *error)
{
    const plm_sheet_level *grid = &patch->sheet.level[0];
    const size_t cells = grid->columns * grid->rows;
    double *room = plm_alloc_zero(cells, RASTERS * sizeof *room, error);
    if (!room) return PLM_E_MEMORY;
    density_rasters r = {.mask = room,
                         .hole_secant = room + cells,
                         .hole_height = room + 2 * cells,
                         .density = room + 3 * cells,
                         .level = room + 4 * cells,
                         .scratch = room + 5 * cells,
                         .first = room + 6 * cells,
                         .second = room + 7 * cells,
                         .third = room + 8 * cells};
    for (size_t t = 0; t < patch->triangulation.count; t++) {
        if (state[t] == PLM_TRIANGLE_OUT) continue;
        const uint32_t *corner = patch->triangulation.corner[t];
        const double *a = patch->uvz[corner[0]], *b = patch->uvz[corner[1]], *c = patch->uvz[corner[2]];
        cover_triangle(grid, a, b, c, 1, r.mask, NULL);
        if (state[t] != PLM_TRIANGLE_HOLE) continue;
        const double secant = (patch->secant[corner[0]] + patch->secant[corner[1]] + patch->secant[corner[2]]) / 3;
        cover_triangle(grid, a, b, c, secant, r.hole_secant, r.hole_height);
    }
    const double area = 2 * PLM_PI * grid->width * grid->width;
    for (size_t at = 0; at < cells; at++) r.density[at] = grid->weight[at] / (area * secant_at(grid, at));
    find_level(grid, &r);
    grow(r.mask, grid, furthest_out * cells_per_width, true, r.first);
    sum_half(patch, charts, &r, areas);
    plm_free(room);
    return PLM_OK;
}
