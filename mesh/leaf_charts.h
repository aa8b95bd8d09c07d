/* mesh/leaf_charts.h: pieces of a leaf that are single-valued over a plane each. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_CHARTS_H
#define PLANTIMETER_MESH_LEAF_CHARTS_H

#include "mesh/leaf_points.h"

enum { PLM_LEAF_CHARTS_MAXIMUM = 32 };

/** A plane with axes u, v and normal (right-handed, unit) through origin. */
typedef struct plm_leaf_chart {
    double origin[3], u[3], v[3], normal[3];
    int parent; /**< number of the cut that made it, -1 for the only chart of a part */
} plm_leaf_chart;

/** A plane that parts space in two: points with dot(normal, point) < offset are below. below and above are a chart, or
 * (negative) -1 - the number of another cut. */
typedef struct plm_leaf_cut {
    double normal[3], offset;
    int below, above;
    int parent; /**< the cut above it, -1 for the first */
} plm_leaf_cut;

/** A place on the leaf with its normal. */
typedef struct plm_leaf_probe {
    double place[3], normal[3];
    double along; /**< sort key of a cut */
} plm_leaf_probe;

/** The charts of one connected part. Cuts part all of space, so every point belongs to one chart. */
typedef struct plm_leaf_charts {
    size_t count, cut_count;
    plm_leaf_chart chart[PLM_LEAF_CHARTS_MAXIMUM];
    plm_leaf_cut cut[PLM_LEAF_CHARTS_MAXIMUM];
    size_t probe_count;
    plm_leaf_probe *probe; /**< their normals face one side of the leaf, the upper one */
} plm_leaf_charts;

/** Cuts the part of points whose rows are given (count of them) into charts: while more than 10 % of the normals are
 * beyond 40 degrees from their mean axis, a piece is halved along the axis that parts the normals best. noise: SD of the points. The
 * normals of all charts are on the same side of the leaf. The result is the caller's. */
plm_status plm_leaf_charts_make(const plm_leaf_points *points, const uint32_t *row, size_t count, double noise,
                                plm_leaf_charts *charts, plm_error *error);

void plm_leaf_charts_free(plm_leaf_charts *charts);

/** The leaf's normal at the probe nearest to a point. */
void plm_leaf_chart_normal(const plm_leaf_charts *charts, const double point[3], double normal[3]);

/** The chart that a point belongs to. */
size_t plm_leaf_chart_of(const plm_leaf_charts *charts, const double point[3]);

/** How far a point lies outside the cuts that bound a chart; 0 or less inside. */
double plm_leaf_chart_distance(const plm_leaf_charts *charts, size_t chart, const double point[3]);

/** Coordinates of a point in a chart: u, v and height. */
void plm_leaf_chart_project(const plm_leaf_chart *chart, const double point[3], double uvz[3]);
/** Back again. */
void plm_leaf_chart_lift(const plm_leaf_chart *chart, const double uvz[3], double point[3]);

#endif
