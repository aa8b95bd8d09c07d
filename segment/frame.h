/* segment/frame.h: what speaks for each of the six axes being up. Internal: segment/frame.c weighs it. */
#ifndef PLANTIMETER_SEGMENT_FRAME_H
#define PLANTIMETER_SEGMENT_FRAME_H

#include "cloud/cloud.h"

enum { PLM_AXES = 6 }; /* x, y, z, -x, -y, -z, in the order of plm_up from PLM_UP_X on */

/** The direction of an axis. */
static inline void plm_axis_direction(int axis, double direction[3])
{
    for (int i = 0; i < 3; i++) direction[i] = i == axis % 3 ? (axis < 3 ? 1 : -1) : 0;
}

/** Signs of a standing plant without ground. */
typedef struct plm_posture {
    double along[3]; /**< share of the thick tubes' length that runs along x, y and z (sum 1); 0 without tubes */
    double
        foot[PLM_AXES]; /**< share of the height over which the low end is one narrow straight piece, as a bare stem */
    double leafward[PLM_AXES]; /**< height of the other points' centroid over the tubes', over the extent */
} plm_posture;

/** Looks at a thinned, cleaned copy of the cloud. All zero for clouds that have too few points for organs. */
plm_status plm_find_posture(const plm_cloud *cloud, plm_posture *posture, plm_error *error);

#endif
