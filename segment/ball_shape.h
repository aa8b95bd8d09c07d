/* segment/ball_shape.h: the shape of the points around each point: line, sheet, ball. Internal. */
#ifndef PLANTIMETER_SEGMENT_BALL_SHAPE_H
#define PLANTIMETER_SEGMENT_BALL_SHAPE_H

#include "segment/graph.h"

/** Moments of the points of a ball that are connected with its centre inside it. Connected: a leaf that passes near a
 * stem does not spoil it. */
typedef struct plm_ball_shape {
    float value[3];  /**< eigenvalues of the covariance, largest first */
    float axis[3];   /**< unit eigenvector of the largest */
    float normal[3]; /**< unit eigenvector of the smallest */
    float offset;    /**< distance of the centroid from the centre */
    uint32_t count;  /**< points in it */
} plm_ball_shape;

/** Links points, of which there is one a voxel of so wide a cell, so that the balls below tell tubes. PLM_E_MEMORY only. */
plm_status plm_ball_graph(const float (*xyz)[3], size_t count, double cell, plm_graph *graph, plm_error *error);

/** Shapes of the balls of a radius around every point of the graph: shape has graph->count rows, the caller's. Parallel.
 * O(points x points in a ball). */
plm_status plm_ball_shapes(const plm_graph *graph, double radius, plm_ball_shape *shape, plm_error *error);

#endif
