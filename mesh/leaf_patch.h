/* mesh/leaf_patch.h: the points of one chart of a leaf, smoothed, triangulated in the chart's plane, and trimmed to the
 * leaf. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_PATCH_H
#define PLANTIMETER_MESH_LEAF_PATCH_H

#include "mesh/delaunay_cgal.h"
#include "mesh/leaf_charts.h"
#include "mesh/leaf_sheet.h"

/** What became of a triangle of the patch. */
enum { PLM_TRIANGLE_OUT = 0, PLM_TRIANGLE_IN, PLM_TRIANGLE_HOLE /**< a hole that was filled */ };

/** One chart's surface. Arrays have count rows unless said otherwise. */
typedef struct plm_leaf_patch {
    plm_leaf_chart chart;
    size_t self;         /**< its number */
    size_t count;        /**< points of the chart and of a margin around it, stray ones left out */
    uint32_t *row;       /**< rows of the leaf's points */
    double (*uvz)[3];    /**< in the chart; height smoothed */
    double *secant;      /**< surface area per area of the chart plane */
    double *spacing;     /**< local, on the surface */
    size_t *owner;       /**< chart that the point belongs to */
    size_t member_count; /**< points of this chart */
    double width;        /**< h of the smoothing */
    double noise;        /**< SD of the points off the smooth sheet (robust) */
    double layers;       /**< half the distance of two layers that make most of it; 0: one layer */
    plm_leaf_sheet sheet;
    plm_triangulation triangulation;
    double *circumradius; /**< a triangle, on the surface */
    uint8_t *state;       /**< a triangle: PLM_TRIANGLE_... */
} plm_leaf_patch;

/** Makes the patch of a chart from the points whose rows are given (count of them, one connected part). noise: SD of the
 * points. No triangle is chosen yet (state is PLM_TRIANGLE_OUT). The result is the caller's. */
plm_status plm_leaf_patch_make(const plm_leaf_points *points, const uint32_t *row, size_t count,
                               const plm_leaf_charts *charts, size_t chart, double noise, plm_leaf_patch *patch,
                               plm_error *error);

void plm_leaf_patch_free(plm_leaf_patch *patch);

#endif
