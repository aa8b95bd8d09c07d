/* traits/cut_end.h: where a tube that is cut off ends. Internal. */
#ifndef PLANTIMETER_TRAITS_CUT_END_H
#define PLANTIMETER_TRAITS_CUT_END_H

#include "cloud/cloud.h"

#include <stdbool.h>
#include <stddef.h>

/** A straight tube with a linear radius, which is cut off at its lower end, and how it was sampled. Metres. */
typedef struct plm_cut_tube {
    double origin[3], axis[3]; /**< a place on the axis; unit, upwards */
    double radius, taper;      /**< at origin; change per length along the axis */
    double noise;              /**< SD of the points across the surface; 0: none */
    bool fused;                /**< the points are means of voxels */
} plm_cut_tube;

/** Height of the lowest place of the tube's lower rim: mean and SD of the posterior.
 * xyz  count points of the tube (at least 2); stray ones among them do no harm if they are few. Of very many every n-th is used.
 *
 * Points lie evenly on the tube above its rim, blurred by a part of the noise, and a few anywhere. The rim lies across the axis,
 * level, or halfway between; where it is, how it slants, and the part of the noise are found together by Bayes' rule, the rim
 * anywhere as likely. PLM_E_MEMORY. */
plm_status plm_cut_end(const double (*xyz)[3], size_t count, const plm_cut_tube *tube, double *end, double *std_error,
                       plm_error *error);

#endif
