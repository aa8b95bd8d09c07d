/* mesh/leaf_sheet.c: local linear regression with Gaussian weights on a raster (W. S. Cleveland 1979, J. Fan 1993): the
 * points' moments are summed in cells, blurred, and a plane is solved for in each cell. The moments are exact, only the
 * weights see the raster, so a coarse one will do. */
#include "mesh/leaf_sheet.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 2, FIRST_HEIGHT = 6, MOMENTS = 9, MARGIN = 7 /* cells: the blur's reach and one more */ };

static const double cells_per_width = 2.0;
static const double enough_points = 6.0; /* effective number below which the next wider level is asked */
static const double reach = 3.0;         /* SD at which the weights are cut */
static const double flattest = 0.05;     /* smallest spread (in h^2) across which a slope is trusted */
/* More cells than this a point are never needed: it bounds memory where points lie in far clusters. */
static const double cells_per_point = 64.0, cells_at_least = 1 << 16;

/* result += weight * source, shifted by k rows or columns. Inner loops run along memory. */
static void blur_rows(const double *source, size_t columns, size_t rows, const double *kernel, long half,
                      double *result)
{
    memset(result, 0, columns * rows * sizeof *result);
    for (long row = 0; row < (long)rows; row++)
        for (long k = -half; k <= half; k++) {
            if (row + k < 0 || row + k >= (long)rows) continue;
            const double weight = kernel[k + half];
            const double *from = source + (size_t)(row + k) * columns;
            double *to = result + (size_t)row * columns;
            for (size_t i = 0; i < columns; i++) to[i] += weight * from[i];
        }
}

static void blur_columns(const double *source, size_t columns, size_t rows, const double *kernel, long half,
                         double *result)
{
    memset(result, 0, columns * rows * sizeof *result);
    for (size_t row = 0; row < rows; row++)
        for (long k = -half; k <= half; k++) {
            if (k >= (long)columns || -k >= (long)columns) continue;
            const double weight = kernel[k + half];
            const double *from = source + row * columns + (k > 0 ? k : 0);
            double *to = result + row * columns + (k < 0 ? -k : 0);
            const size_t length = columns - (size_t)(k < 0 ? -k : k);
            for (size_t i = 0; i < length; i++) to[i] += weight * from[i];
        }
}

void plm_blur(const double *source, size_t columns, size_t rows, double width, double *scratch, double *result)
{
    enum { LARGEST = 64 };
    double kernel[2 * LARGEST + 1];
    long half = (long)ceil(reach * width);
    if (half > LARGEST) half = LARGEST;
    for (long k = -half; k <= half; k++) kernel[k + half] = exp(-0.5 * (double)(k * k) / (width * width));
    blur_rows(source, columns, rows, kernel, half, scratch);
    blur_columns(scratch, columns, rows, kernel, half, result);
}

static size_t cell_count(const plm_sheet_level *level)
{
    return level->columns * level->rows;
}

static void free_level(plm_sheet_level *level)
{
    plm_free(level->weight);
    plm_free(level->height);
    plm_free(level->slope_u);
    plm_free(level->slope_v);
    *level = (plm_sheet_level){0};
}

/* Lays the raster over the points used. */
static void lay_raster(const double (*uvz)[3], const bool *use, size_t count, double width, plm_sheet_level *level)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        if (use && !use[i]) continue;
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], uvz[i][k]);
            high[k] = fmax(high[k], uvz[i][k]);
        }
    }
    const double most = fmax(cells_at_least, cells_per_point * (double)count);
    const double size[2] = {fmax(high[0] - low[0], 0), fmax(high[1] - low[1], 0)};
    double cell = width / cells_per_width;
    while ((size[0] / cell + 2 * MARGIN) * (size[1] / cell + 2 * MARGIN) > most) cell *= 1.25;
    level->cell = cell;
    level->width = cell * cells_per_width;
    level->columns = (size_t)(size[0] / cell) + 2 * MARGIN + 1;
    level->rows = (size_t)(size[1] / cell) + 2 * MARGIN + 1;
    for (int k = 0; k < 2; k++) level->low[k] = (isfinite(low[k]) ? low[k] : 0) - MARGIN * cell;
}

/* Sums the moments from first on: 1, u, v, uu, uv, vv, then those of the heights z, uz, vz. */
static void sum_moments(const double (*uvz)[3], const bool *use, const double *height, size_t count,
                        const plm_sheet_level *level, int first, double *moment)
{
    const size_t cells = cell_count(level);
    memset(moment + (size_t)first * cells, 0, (size_t)(MOMENTS - first) * cells * sizeof *moment);
    for (size_t i = 0; i < count; i++) {
        if (use && !use[i]) continue;
        const double u = uvz[i][0], v = uvz[i][1], z = height[i];
        const size_t column = (size_t)((u - level->low[0]) / level->cell + 0.5);
        const size_t row = (size_t)((v - level->low[1]) / level->cell + 0.5);
        double *at = moment + row * level->columns + column;
        const double term[MOMENTS] = {1, u, v, u * u, u * v, v * v, z, u * z, v * z};
        for (int m = first; m < MOMENTS; m++) at[(size_t)m * cells] += term[m];
    }
}

static void blur_moments(const plm_sheet_level *level, int first, double *moment)
{
    const size_t cells = cell_count(level);
    double *scratch = moment + MOMENTS * cells, *result = scratch + cells;
    for (int m = first; m < MOMENTS; m++) {
        plm_blur(moment + (size_t)m * cells, level->columns, level->rows, cells_per_width, scratch, result);
        memcpy(moment + (size_t)m * cells, result, cells * sizeof *moment);
    }
}

/* Adds the plane of one cell, from its blurred moments, to what the cell has. */
static void solve_cell(plm_sheet_level *level, const double *moment, size_t cells, size_t at)
{
    const double n = moment[at];
    level->weight[at] = n;
    if (!(n > 1e-9)) return;
    double mean[MOMENTS];
    for (int m = 1; m < MOMENTS; m++) mean[m] = moment[(size_t)m * cells + at] / n;
    const double u = mean[1], v = mean[2], z = mean[FIRST_HEIGHT];
    double uu = fmax(mean[3] - u * u, 0), uv = mean[4] - u * v, vv = fmax(mean[5] - v * v, 0);
    const double uz = mean[7] - u * z, vz = mean[8] - v * z;
    /* A row of points has no slope across it: the smaller spread is filled up to a share of h^2, which damps it. */
    const double half = 0.5 * (uu + vv), root = hypot(0.5 * (uu - vv), uv);
    const double fill = fmax(0, flattest * level->width * level->width - (half - root));
    uu += fill;
    vv += fill;
    const double determinant = uu * vv - uv * uv;
    const double slope_u = determinant > 0 ? (uz * vv - vz * uv) / determinant : 0;
    const double slope_v = determinant > 0 ? (vz * uu - uz * uv) / determinant : 0;
    const double centre[2] = {level->low[0] + (double)(at % level->columns) * level->cell,
                              level->low[1] + (double)(at / level->columns) * level->cell};
    level->slope_u[at] += slope_u;
    level->slope_v[at] += slope_v;
    level->height[at] += z + slope_u * (centre[0] - u) + slope_v * (centre[1] - v);
}

/* Blends what the four cells around a place say of it. */
static plm_sheet_place level_at(const plm_sheet_level *level, double u, double v)
{
    plm_sheet_place place = {.width = level->width};
    const double x = (u - level->low[0]) / level->cell, y = (v - level->low[1]) / level->cell;
    if (!(x >= 0 && y >= 0 && x < (double)(level->columns - 1) && y < (double)(level->rows - 1))) return place;
    const size_t column = (size_t)x, row = (size_t)y;
    const double fx = x - (double)column, fy = y - (double)row;
    double total = 0;
    for (int corner = 0; corner < 4; corner++) {
        const size_t cu = column + (size_t)(corner & 1), cv = row + (size_t)(corner >> 1);
        const size_t at = cv * level->columns + cu;
        const double share = (corner & 1 ? fx : 1 - fx) * (corner >> 1 ? fy : 1 - fy);
        place.weight += share * level->weight[at];
        const double w = level->weight[at] > 1e-9 ? share : 0;
        const double du = u - (level->low[0] + (double)cu * level->cell);
        const double dv = v - (level->low[1] + (double)cv * level->cell);
        place.height += w * (level->height[at] + level->slope_u[at] * du + level->slope_v[at] * dv);
        place.slope_u += w * level->slope_u[at];
        place.slope_v += w * level->slope_v[at];
        total += w;
    }
    if (total > 0) {
        place.height /= total;
        place.slope_u /= total;
        place.slope_v /= total;
    }
    return place;
}

/* Fits the planes, then planes to what is left over, and adds them (twicing, J. W. Tukey 1977): the bias that curvature
 * makes falls from h^2 to h^4. moment: room for MOMENTS + 2 rasters; left: count long. */
static void fit_planes(const double (*uvz)[3], const bool *use, size_t count, plm_sheet_level *level, double *moment,
                       double *left)
{
    const size_t cells = cell_count(level);
    for (size_t i = 0; i < count; i++) left[i] = uvz[i][2];
    for (int round = 0; round < ROUNDS; round++) {
        const int first = round == 0 ? 0 : FIRST_HEIGHT;
        sum_moments(uvz, use, left, count, level, first, moment);
        blur_moments(level, first, moment);
        for (size_t at = 0; at < cells; at++) solve_cell(level, moment, cells, at);
        for (size_t i = 0; i < count && round + 1 < ROUNDS; i++)
            if (!use || use[i]) left[i] = uvz[i][2] - level_at(level, uvz[i][0], uvz[i][1]).height;
    }
}

static plm_status fit_level(const double (*uvz)[3], const bool *use, size_t count, double width, plm_sheet_level *level,
                            plm_error *error)
{
    plm_sheet_level made = {0};
    lay_raster(uvz, use, count, width, &made);
    const size_t cells = cell_count(&made);
    double *moment = plm_alloc(cells, (MOMENTS + 2) * sizeof *moment, error);
    double *left = plm_alloc(count, sizeof *left, error);
    made.weight = plm_alloc(cells, sizeof *made.weight, error);
    made.height = plm_alloc_zero(cells, sizeof *made.height, error);
    made.slope_u = plm_alloc_zero(cells, sizeof *made.slope_u, error);
    made.slope_v = plm_alloc_zero(cells, sizeof *made.slope_v, error);
    const bool good = moment && left && made.weight && made.height && made.slope_u && made.slope_v;
    if (good) fit_planes(uvz, use, count, &made, moment, left);
    plm_free(moment);
    plm_free(left);
    if (good)
        *level = made;
    else
        free_level(&made);
    return good ? PLM_OK : PLM_E_MEMORY;
}

plm_sheet_place plm_leaf_sheet_at(const plm_leaf_sheet *sheet, double u, double v)
{
    plm_sheet_place place = {0};
    for (size_t k = 0; k < sheet->level_count; k++) {
        place = level_at(&sheet->level[k], u, v);
        if (place.weight >= enough_points) break;
    }
    return place;
}

static bool wants_wider(const plm_leaf_sheet *sheet, const double (*uvz)[3], const bool *use, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if ((!use || use[i]) && plm_leaf_sheet_at(sheet, uvz[i][0], uvz[i][1]).weight < enough_points) return true;
    return false;
}

plm_status plm_leaf_sheet_fit(const double (*uvz)[3], const bool *use, size_t count, double width,
                              plm_leaf_sheet *sheet, plm_error *error)
{
    plm_leaf_sheet made = {0};
    plm_status status = PLM_OK;
    do {
        status = fit_level(uvz, use, count, width, &made.level[made.level_count], error);
        if (status != PLM_OK) break;
        width = 2 * made.level[made.level_count++].width;
    } while (made.level_count < PLM_SHEET_LEVELS && wants_wider(&made, uvz, use, count));
    if (status == PLM_OK)
        *sheet = made;
    else
        plm_leaf_sheet_free(&made);
    return status;
}

void plm_leaf_sheet_free(plm_leaf_sheet *sheet)
{
    if (!sheet) return;
    for (size_t k = 0; k < sheet->level_count; k++) free_level(&sheet->level[k]);
    *sheet = (plm_leaf_sheet){0};
}
