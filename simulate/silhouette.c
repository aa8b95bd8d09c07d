/* simulate/silhouette.c: silhouettes on a raster: a cell counts when its middle lies in the projection of a face. */
#include "simulate/truth.h"

#include <math.h>
#include <string.h>

enum { CELLS = 1500 };

typedef struct raster {
    size_t width, height;
    double low[2], cell;
    uint8_t *plant; /* 1: covered */
    int32_t *leaf;  /* the leaf that covered the cell last, -1 for none */
    size_t plant_cells, leaf_cells, leaf_sum;
} raster;

static void mark(raster *image, size_t cell, bool is_leaf, int32_t organ)
{
    if (!image->plant[cell]) image->plant_cells++;
    image->plant[cell] = 1;
    if (!is_leaf) return;
    if (image->leaf[cell] < 0) image->leaf_cells++;
    if (image->leaf[cell] != organ) image->leaf_sum++;
    image->leaf[cell] = organ;
}

/* Cells of one row whose middles lie in the triangle: the interval between its edges at that height. */
static void fill(raster *image, const double corner[3][2], bool is_leaf, int32_t organ)
{
    const double y0 = fmin(corner[0][1], fmin(corner[1][1], corner[2][1]));
    const double y1 = fmax(corner[0][1], fmax(corner[1][1], corner[2][1]));
    const double first = ceil((y0 - image->low[1]) / image->cell - 0.5);
    for (double row = fmax(first, 0); row < (double)image->height; row++) {
        const double y = image->low[1] + (row + 0.5) * image->cell;
        if (y > y1) break;
        double left = INFINITY, right = -INFINITY;
        for (int k = 0; k < 3; k++) {
            const double *p = corner[k], *q = corner[(k + 1) % 3];
            if ((p[1] > y) == (q[1] > y)) continue;
            const double x = p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]);
            left = fmin(left, x);
            right = fmax(right, x);
        }
        const double from = fmax(ceil((left - image->low[0]) / image->cell - 0.5), 0);
        const double to = fmin(floor((right - image->low[0]) / image->cell - 0.5), (double)image->width - 1);
        for (double column = from; column <= to; column++)
            mark(image, (size_t)row * image->width + (size_t)column, is_leaf, organ);
    }
}

static plm_status start(const plm_virtual_plant *plant, int u, int v, raster *image, plm_error *error)
{
    double high[2] = {-INFINITY, -INFINITY};
    *image = (raster){.low = {INFINITY, INFINITY}};
    for (size_t k = 0; k < plant->mesh.vertex_count; k++) {
        const double at[2] = {plant->mesh.vertex[k][u], plant->mesh.vertex[k][v]};
        for (int i = 0; i < 2; i++) {
            image->low[i] = fmin(image->low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
    image->cell = fmax(fmax(high[0] - image->low[0], high[1] - image->low[1]) / CELLS, 1e-12);
    image->width = (size_t)((high[0] - image->low[0]) / image->cell) + 1;
    image->height = (size_t)((high[1] - image->low[1]) / image->cell) + 1;
    image->plant = plm_alloc_zero(image->width * image->height, 1, error);
    image->leaf = plm_alloc(image->width * image->height, sizeof *image->leaf, error);
    if (!image->plant || !image->leaf) return PLM_E_MEMORY;
    memset(image->leaf, 0xff, image->width * image->height * sizeof *image->leaf); /* -1 */
    return PLM_OK;
}

plm_status plm_silhouette(const plm_virtual_plant *plant, int axis, double *area, double *leaf_overlap,
                          plm_error *error)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    raster image;
    const plm_status status = start(plant, u, v, &image, error);
    if (status == PLM_OK) {
        for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
            double corner[3][2];
            for (int k = 0; k < 3; k++) {
                const double *vertex = plant->mesh.vertex[plant->mesh.triangle[f][k]];
                corner[k][0] = vertex[u];
                corner[k][1] = vertex[v];
            }
            fill(&image, (const double(*)[2])corner, plant->face_label[f] == PLM_LABEL_LEAF, plant->mesh.face_organ[f]);
        }
        *area = (double)image.plant_cells * image.cell * image.cell;
        *leaf_overlap = image.leaf_sum ? 1 - (double)image.leaf_cells / (double)image.leaf_sum : 0;
    }
    plm_free(image.plant);
    plm_free(image.leaf);
    return status;
}
