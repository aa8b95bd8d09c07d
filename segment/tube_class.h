/* segment/tube_class.h: tube (stem, petiole, rachis) against blade, point by point. Internal. */
#ifndef PLANTIMETER_SEGMENT_TUBE_CLASS_H
#define PLANTIMETER_SEGMENT_TUBE_CLASS_H

#include "segment/ball_shape.h"
#include "segment/scale.h"
#include "segment/thinning.h"

enum { PLM_TUBE_SCALES = 6, PLM_TUBE_FEATURES = 6 };

/** Fewer points in the ball of R are few: amid a blade that is seen densely there are 110 to 230. */
enum { PLM_TUBE_SPARSE = 60 };

/** What is known of the surroundings of one working point. */
typedef struct plm_tube_point {
    float feature[PLM_TUBE_SCALES][PLM_TUBE_FEATURES]; /**< linearity, roundness, three sizes, offset, at 0.35 to 2 R */
    uint32_t count;  /**< of points in the ball of R, at most one a voxel of R / 6 or of the spacing */
    float radius;    /**< of the tube that the point would be on, at R */
    float axis[3];   /**< its direction */
    float normal[3]; /**< of the sheet that the point would be on */
} plm_tube_point;

/** Features of the points of working (thinned from base, which has base_count points): point has working->count rows,
 * the caller's. Balls at each scale are taken in a copy of base of a sixth of their radius, or of the spacing where
 * that is more. Balls of few points are linked as far as sparse parts want. */
plm_status plm_tube_points(const float (*base)[3], size_t base_count, const plm_thinned *working,
                           const plm_scale *scale, plm_tube_point *point, plm_error *error);

/** Probability of being tube: by the trees of segment/sparse_tube_forest.h where few points are around, else by the logistic formula of
 * segment/tube_weights.h. */
float plm_tube_probability(const plm_tube_point *point);

#endif
