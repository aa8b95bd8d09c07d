/* segment/balls.h: closed round surfaces among points: fruit. Internal. */
#ifndef PLANTIMETER_SEGMENT_BALLS_H
#define PLANTIMETER_SEGMENT_BALLS_H

#include "cloud/cloud.h"

/** A sphere that points lie on. Metres. */
typedef struct plm_ball {
    double centre[3], radius;
    double thick; /**< its points lie within so much of the radius */
} plm_ball;

/** What to look for, and among which points. Lengths in metres. */
typedef struct plm_ball_query {
    const float (*xyz)[3];
    size_t count;
    const bool *may_be; /**< of each point: whether it may lie on a ball; count rows */
    double cell;        /**< a surface has about a point each square of this edge */
    double
        noise; /**< SD of points across their surface; a fifteenth of the least radius at most, or leaves pass as balls */
    double least_radius, most_radius;
} plm_ball_query;

/** Finds spheres of which points cover more than half of the directions, closely, and inside of which there are next to none: a leaf, however it is curled,
 * covers less, or is rough. Beside one that was found, somewhat less than half is enough: fruits hide each other. *ball: *count of them,
 * the caller's (plm_free). PLM_E_MEMORY. */
plm_status plm_balls_find(const plm_ball_query *query, plm_ball **ball, size_t *count, plm_error *error);

#endif
