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

/** Signs of a standing plant, in the order of the weights in segment/frame.c. The foot is the low point nearest to the
 * plant's axis, the line through the median of its points. */
enum {
    PLM_SIGN_DETOUR, /**< mean logarithm of the way along the plant from its foot over the straight one, of points afar */
    PLM_SIGN_TOP,    /**< height of the mean point above the middle of the height, over the height */
    PLM_SIGN_LINES, /**< share of stems, petioles and straps that runs along the axis, 0 to 1 */
    PLM_SIGN_FLAT,  /**< mean share of the normals along the axis, 0 to 1 */
    PLM_SIGN_ASIDE, /**< distance of the foot from the plant's axis, over the plant's width */
    PLM_POSTURE_SIGNS
};

/** What the plant itself says for each axis. */
typedef struct plm_posture {
    bool is_known; /**< false: too few points for organs, all signs are 0 */
    double sign[PLM_AXES][PLM_POSTURE_SIGNS];
} plm_posture;

/** Looks at a thinned, cleaned copy of the cloud. */
plm_status plm_find_posture(const plm_cloud *cloud, plm_posture *posture, plm_error *error);

#endif
