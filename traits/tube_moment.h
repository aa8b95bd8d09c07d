/* traits/tube_moment.h: the diameter of a tube whose ring noise has blurred. Internal. */
#ifndef PLANTIMETER_TRAITS_TUBE_MOMENT_H
#define PLANTIMETER_TRAITS_TUBE_MOMENT_H

#include "cloud/sampling.h"

/** The diameter (m) by the mean square of the points' distances from the line through their middle that runs along a direction (unit
 * length), and its standard error. Points are voxel means, 6000 at most; sampling: the plant's. Points more than three medians off are left
 * out. False where there are too few points. */
bool plm_tube_moment(const double (*xyz)[3], size_t count, const double along[3], const plm_sampling *sampling,
                     double *diameter, double *std_error);

#endif
