/* traits/plant_area.c: the plant's silhouette seen from above. */
#include "traits/families.h"
#include "traits/scene.h"

#include <math.h>
#include <string.h>

enum { MOST_CELLS = 1 << 24 };

/** A raster over the ground plane, a byte a cell. */
typedef struct raster {
    size_t columns, rows;
    double low[2], cell;
    uint8_t *on;
} raster;

static plm_status make_raster(const plm_scene *scene, double cell, double margin, raster *r, plm_error *error)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < scene->plant_count; i++)
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], scene->plant[i][k]);
            high[k] = fmax(high[k], scene->plant[i][k]);
        }
    const double width = high[0] - low[0] + 2 * margin, depth = high[1] - low[1] + 2 * margin;
    cell = fmax(cell, sqrt(width * depth / MOST_CELLS));
    *r = (raster){.columns = (size_t)(width / cell) + 3, .rows = (size_t)(depth / cell) + 3, .cell = cell};
    for (int k = 0; k < 2; k++) r->low[k] = low[k] - margin;
    r->on = plm_alloc_zero(r->columns * r->rows, 1, error);
    return r->on ? PLM_OK : PLM_E_MEMORY;
}

/* Squared distance transform of one line (P. Felzenszwalb and D. Huttenlocher, Theory of Computing 8, 2012), stopped at the
 * radius: all that closing needs is whether a cell lies within it, so two passes of running counts do. Here: cells within
 * `reach` of a set cell are set (set true) or those within reach of an unset one are cleared (set false), by a disc. */
static plm_status spread(raster *r, double reach, bool set, plm_error *error)
{
    const int64_t n = (int64_t)ceil(reach / r->cell);
    uint8_t *from = plm_alloc(r->columns * r->rows, 1, error);
    if (!from) return PLM_E_MEMORY;
    memcpy(from, r->on, r->columns * r->rows);
    const int64_t rows = (int64_t)r->rows, columns = (int64_t)r->columns;
#pragma omp parallel for schedule(static)
    for (int64_t y = 0; y < rows; y++)
        for (int64_t dy = -n; dy <= n; dy++) {
            const int64_t at = y + dy;
            if (at < 0 || at >= rows) continue;
            const double room = reach * reach / (r->cell * r->cell) - (double)(dy * dy);
            if (room < 0) continue;
            const int64_t half = (int64_t)sqrt(room);
            int64_t last = INT64_MIN; /* end of what this row of the disc has set so far */
            for (int64_t x = 0; x < columns; x++) {
                if ((from[at * columns + x] != 0) != set) continue;
                int64_t first = x - half < 0 ? 0 : x - half;
                const int64_t end = x + half >= columns ? columns - 1 : x + half;
                if (first <= last) first = last + 1;
                for (int64_t c = first; c <= end; c++) r->on[y * columns + c] = set;
                last = end;
            }
        }
    plm_free(from);
    return PLM_OK;
}

/* Cells that are on, and the length of their border (4-neighbour edges x pi/4: the mean over directions). */
static double on_area(const raster *r, double *border)
{
    size_t count = 0, edges = 0;
    for (size_t y = 1; y + 1 < r->rows; y++)
        for (size_t x = 1; x + 1 < r->columns; x++) {
            const uint8_t *c = r->on + y * r->columns + x;
            if (!*c) continue;
            count++;
            edges += (size_t)(!c[-1] + !c[1] + !*(c - r->columns) + !c[r->columns]);
        }
    *border = (double)edges * r->cell * 0.785398163397448;
    return (double)count * r->cell * r->cell;
}

/** Area of the silhouette seen from above: points on a raster of half the spacing, gaps closed by a disc of two spacings of the
 * sparser parts. The rim lies a quarter of a spacing inside of the edge without noise (a splat's centres: 0.85 of its
 * scale), and noise pushes it out by about its SD. Condition: border length x spacing over area. */
plm_status plm_trait_projected_area(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    const double s = scene->sampling.spacing, sigma = scene->sampling.noise;
    if (!(s > 0)) return plm_trait_failed(out, "the points are too few to know their spacing");
    double sparse; /* splats are uneven: gaps must be closed at the spacing of the sparser parts */
    plm_status status = plm_spacing_quantile(scene->plant_index, (const float(*)[3])scene->plant, scene->plant_count,
                                             0.9, &sparse, error);
    if (status != PLM_OK) return status;
    const double disc = 2 * fmin(sparse, 4 * s), extent = scene->sampling.extent;
    raster r;
    status = make_raster(scene, s / 2, 3 * disc, &r, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < scene->plant_count; i++) {
        const size_t x = (size_t)((scene->plant[i][0] - r.low[0]) / r.cell);
        const size_t y = (size_t)((scene->plant[i][1] - r.low[1]) / r.cell);
        r.on[y * r.columns + x] = 1;
    }
    status = spread(&r, disc, true, error);
    if (status == PLM_OK) status = spread(&r, disc, false, error);
    if (status == PLM_OK) {
        double border;
        const double area = on_area(&r, &border);
        out->value = fmax(area + border * (0.25 * s + 0.85 * extent - 0.8 * sigma), 0);
        out->std_error = border * sqrt(0.15 * 0.15 * s * s + 0.3 * 0.3 * sigma * sigma + 0.04 * extent * extent +
                                       0.01 * disc * disc);
        out->method = "closed raster";
    }
    plm_free(r.on);
    return status;
}
