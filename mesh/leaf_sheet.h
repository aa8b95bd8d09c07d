/* mesh/leaf_sheet.h: a smooth height field through scattered points over a plane. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_SHEET_H
#define PLANTIMETER_MESH_LEAF_SHEET_H

#include "cloud/cloud.h"

enum { PLM_SHEET_LEVELS = 4 };

/** A raster of local planes of one width. Cell (column, row) has its centre at low + (column, row) * cell. */
typedef struct plm_sheet_level {
    double width; /**< h: SD of the Gaussian weights */
    double cell;  /**< h / 2 */
    double low[2];
    size_t columns, rows;
    double *weight;                     /**< sum of the points' weights, 1 for a point at the cell's centre */
    double *height, *slope_u, *slope_v; /**< of the local plane at the cell's centre */
} plm_sheet_level;

/** Local planes at every place near points. The finest level that has points enough counts. */
typedef struct plm_leaf_sheet {
    size_t level_count;
    plm_sheet_level level[PLM_SHEET_LEVELS]; /**< each of twice the width of the one before */
} plm_leaf_sheet;

/** The sheet at a place. */
typedef struct plm_sheet_place {
    double height, slope_u, slope_v;
    double weight; /**< effective number of points behind it; 0: none, and the rest is 0 too */
    double width;  /**< of the level used */
} plm_sheet_place;

/** Fits planes with Gaussian weights of SD width (and wider where points are few) to heights uvz[i][2] over uvz[i][0..2);
 * points with use[i] false (use may be NULL) are left out. The result is the caller's. */
plm_status plm_leaf_sheet_fit(const double (*uvz)[3], const bool *use, size_t count, double width,
                              plm_leaf_sheet *sheet, plm_error *error);

void plm_leaf_sheet_free(plm_leaf_sheet *sheet);

/** Height and slopes at a place, blended between the four cells around it. */
plm_sheet_place plm_leaf_sheet_at(const plm_leaf_sheet *sheet, double u, double v);

/** Sum over cells of source times a Gaussian of SD width (in cells; peak 1, cut at 3 SD); result and scratch have the
 * same columns * rows cells as source. source and result may not be the same. */
void plm_blur(const double *source, size_t columns, size_t rows, double width, double *scratch, double *result);

#endif
