/* traits/plant_area.c: the plant's silhouette seen from above. */
#include "cloud/linear.h"
#include "traits/axis.h"
#include "traits/families.h"
#include "traits/plant_mesh.h"

#include <math.h>
#include <string.h>

enum { MOST_CELLS = 1 << 24 };
static const double SLACK = 0.1;  /* of the points' extent: a wild surface beyond it is cut off */
static const double SIDES = 0.02; /* what a tube of plm_scene_mesh may be too wide or narrow, seen from one side */
enum { POINTS = 1, SURFACE = 2 }; /* what a cell is under */

/** A raster over the ground plane, a byte a cell: a set of POINTS and SURFACE. */
typedef struct raster {
    size_t columns, rows;
    double low[2], cell;
    uint8_t *on;
} raster;

/* Room for the points, and for the surfaces up to SLACK beyond them. */
static plm_status make_raster(const plm_scene *scene, const plm_mesh *mesh, double cell, double margin, raster *r,
                              plm_error *error)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < scene->plant_count; i++)
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], scene->plant[i][k]);
            high[k] = fmax(high[k], scene->plant[i][k]);
        }
    for (int k = 0; k < 2; k++) {
        const double least = low[k] - SLACK * (high[k] - low[k]), most = high[k] + SLACK * (high[k] - low[k]);
        for (size_t v = 0; v < mesh->vertex_count; v++) {
            low[k] = fmin(low[k], fmax(mesh->vertex[v][k], least));
            high[k] = fmax(high[k], fmin(mesh->vertex[v][k], most));
        }
    }
    const double width = high[0] - low[0] + 2 * margin, depth = high[1] - low[1] + 2 * margin;
    cell = fmax(cell, sqrt(width * depth / MOST_CELLS));
    *r = (raster){.columns = (size_t)(width / cell) + 3, .rows = (size_t)(depth / cell) + 3, .cell = cell};
    for (int k = 0; k < 2; k++) r->low[k] = low[k] - margin;
    r->on = plm_alloc_zero(r->columns * r->rows, 1, error);
    return r->on ? PLM_OK : PLM_E_MEMORY;
}

/* An empty raster of the same cells. */
static plm_status make_alike(const raster *of, raster *r, plm_error *error)
{
    *r = *of;
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

/** What a raster shows. */
typedef struct shadow {
    double surface; /* area under surfaces */
    double beside;  /* area under closed points and no surface */
    double points;  /* area under closed points */
    double border;  /* of those: 4-neighbour edges x pi/4, the mean over directions */
} shadow;

static shadow measure_shadow(const raster *r)
{
    size_t surface = 0, beside = 0, points = 0, edges = 0;
    for (size_t y = 1; y + 1 < r->rows; y++)
        for (size_t x = 1; x + 1 < r->columns; x++) {
            const uint8_t *c = r->on + y * r->columns + x;
            surface += (*c & SURFACE) != 0;
            beside += *c == POINTS;
            if (!(*c & POINTS)) continue;
            points++;
            edges += (size_t)(!(c[-1] & POINTS) + !(c[1] & POINTS) + !(*(c - r->columns) & POINTS) +
                              !(c[r->columns] & POINTS));
        }
    const double cell2 = r->cell * r->cell;
    return (shadow){(double)surface * cell2, (double)beside * cell2, (double)points * cell2,
                    (double)edges * r->cell * PLM_PI / 4};
}

/* ---- Surfaces ---------------------------------------------------------------------------------------------------- */

/* Where a row of cell middles runs through a triangle: along x, from[0] to from[1]. Degenerate ones have no inside. */
static bool cross_row(const double corner[3][2], double y, double from[2])
{
    from[0] = INFINITY, from[1] = -INFINITY;
    for (int k = 0; k < 3; k++) {
        const double *p = corner[k], *q = corner[(k + 1) % 3];
        if ((p[1] <= y) == (q[1] <= y)) continue;
        const double x = p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]);
        from[0] = fmin(from[0], x);
        from[1] = fmax(from[1], x);
    }
    return from[0] <= from[1];
}

/* Sets the cells whose middles lie under a triangle. */
static void draw(raster *r, const plm_mesh *mesh, const uint32_t triangle[3])
{
    double corner[3][2], low = INFINITY, high = -INFINITY; /* in cells from the first one's middle */
    for (int k = 0; k < 3; k++) {
        for (int axis = 0; axis < 2; axis++)
            corner[k][axis] = (mesh->vertex[triangle[k]][axis] - r->low[axis]) / r->cell - 0.5;
        low = fmin(low, corner[k][1]);
        high = fmax(high, corner[k][1]);
    }
    const double rows = (double)r->rows - 1, columns = (double)r->columns - 1;
    for (double y = fmax(ceil(low), 0); y <= fmin(high, rows); y++) {
        double from[2];
        if (!cross_row((const double(*)[2])corner, y, from)) continue;
        for (double x = fmax(ceil(from[0]), 0); x <= fmin(from[1], columns); x++)
            r->on[(size_t)y * r->columns + (size_t)x] |= SURFACE;
    }
}

/* ---- Points without a surface ------------------------------------------------------------------------------------ */

static uint8_t *cell_of(const raster *r, const float xyz[3])
{
    const size_t x = (size_t)((xyz[0] - r->low[0]) / r->cell), y = (size_t)((xyz[1] - r->low[1]) / r->cell);
    return r->on + y * r->columns + x;
}

/* Points of organs that have a surface: those near its shadow have nothing to add to it. */
static plm_status find_covered(const plm_scene *scene, const raster *drawn, double reach, bool *covered,
                               plm_error *error)
{
    raster near;
    plm_status status = make_alike(drawn, &near, error);
    if (status != PLM_OK) return status;
    memcpy(near.on, drawn->on, near.columns * near.rows);
    status = spread(&near, reach, true, error);
    for (size_t k = 0; status == PLM_OK && k < scene->organ_count; k++) {
        const plm_organ *organ = &scene->organ[k];
        for (size_t i = 0; plm_organ_has_mesh(scene, organ) && i < organ->count; i++)
            covered[organ->row[i]] = *cell_of(&near, organ->xyz[i]) != 0;
    }
    plm_free(near.on);
    return status;
}

/* Sets POINTS in the cells of points that no surface stands for, gaps closed by a disc. */
static plm_status close_points(const plm_scene *scene, double disc, raster *r, plm_error *error)
{
    raster closed = {0};
    bool *covered = plm_alloc_zero(scene->cloud->count, sizeof *covered, error);
    plm_status status = covered ? make_alike(r, &closed, error) : PLM_E_MEMORY;
    if (status == PLM_OK) status = find_covered(scene, r, disc + 3 * scene->sampling.noise, covered, error);
    for (size_t i = 0; status == PLM_OK && i < scene->plant_count; i++)
        if (!covered[scene->plant_row[i]]) *cell_of(&closed, scene->plant[i]) = POINTS;
    if (status == PLM_OK) status = spread(&closed, disc, true, error);
    if (status == PLM_OK) status = spread(&closed, disc, false, error);
    for (size_t c = 0; status == PLM_OK && c < r->columns * r->rows; c++)
        if (closed.on[c]) r->on[c] |= POINTS;
    plm_free(closed.on);
    plm_free(covered);
    return status;
}

/* ---- The trait --------------------------------------------------------------------------------------------------- */

/* Rims of all leaves are off alike, and shadows come out a little too large (0.2 to 0.7 % clean, 1 % in noise): so many standard errors of
 * the leaves' area (288 virtual plants). */
static const double rims_alike = 1.5;

/* Standard error of the surfaces' shadow, which is `area`: that of the leaves' area, and of the tubes' radii; NAN where it is not
 * known. */
static plm_status surface_error(const plm_scene *scene, double area, double *std_error, plm_error *error)
{
    plm_estimate leaves = {.value = NAN};
    const plm_status status = plm_trait_total_leaf_area(scene, NULL, &leaves, error);
    const bool has_leaves = leaves.state == PLM_STATE_OK && leaves.value > 0;
    double squares = has_leaves ? pow(rims_alike * area * leaves.std_error / leaves.value, 2) : 0;
    bool known = has_leaves;
    for (size_t k = 0; k < scene->organ_count; k++) {
        const plm_axis *axis = scene->organ[k].axis;
        if (!axis || !plm_organ_has_mesh(scene, &scene->organ[k]) || !isfinite(axis->radius_error)) continue;
        squares += pow(2 * axis->length * hypot(axis->radius_error, SIDES * axis->radius), 2);
        known = true;
    }
    *std_error = known || !(area > 0) ? sqrt(squares) : NAN;
    return status;
}

/* The rim of closed points lies inside of the edge by what sampling leaves out, and noise pushes it out. */
static plm_status estimate_area(const plm_scene *scene, const shadow *seen, double disc, plm_estimate *out,
                                plm_error *error)
{
    const double s = scene->sampling.spacing, sigma = scene->sampling.noise, extent = scene->sampling.extent;
    const double border = seen->points > 0 ? seen->border * seen->beside / seen->points : 0;
    const double rim_error =
        border * sqrt(0.15 * 0.15 * s * s + 0.3 * 0.3 * sigma * sigma + 0.04 * extent * extent + 0.01 * disc * disc);
    double of_surfaces;
    const plm_status status = surface_error(scene, seen->surface, &of_surfaces, error);
    if (status != PLM_OK) return status;
    out->value = seen->surface + fmax(seen->beside + border * (0.25 * s + 0.85 * extent - 0.8 * sigma), 0);
    out->std_error = hypot(of_surfaces, rim_error);
    return PLM_OK;
}

/** Area of the silhouette seen from above: of leaf surfaces and tubes, and of points that are under neither, on a raster of half the
 * spacing. Gaps between those points are closed by a disc of two spacings of the sparser parts. Their rim lies a quarter of a spacing
 * inside of the edge without noise (a splat's centres: 0.85 of its scale), and noise pushes it out by about its SD. Condition: the
 * leaves' area, and border length x spacing. */
plm_status plm_trait_projected_area(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    const double s = scene->sampling.spacing;
    if (!(s > 0)) return plm_trait_failed(out, "the points are too few to know their spacing");
    double sparse; /* splats are uneven: gaps must be closed at the spacing of the sparser parts */
    plm_status status = plm_spacing_quantile(scene->plant_index, (const float(*)[3])scene->plant, scene->plant_count,
                                             0.9, &sparse, error);
    if (status != PLM_OK) return status;
    plm_mesh mesh;
    status = plm_scene_mesh(scene, true, &mesh, error);
    if (status != PLM_OK) return status;
    const double disc = 2 * fmin(sparse, 4 * s);
    raster r;
    status = make_raster(scene, &mesh, s / 2, 3 * disc, &r, error);
    if (status == PLM_OK) {
        for (size_t f = 0; f < mesh.triangle_count; f++) draw(&r, &mesh, mesh.triangle[f]);
        status = close_points(scene, disc, &r, error);
        const shadow seen = measure_shadow(&r);
        if (status == PLM_OK) status = estimate_area(scene, &seen, disc, out, error);
        out->method = mesh.triangle_count ? "shadow of surfaces and tubes" : "closed raster";
        plm_free(r.on);
    }
    plm_mesh_free(&mesh);
    return status;
}
