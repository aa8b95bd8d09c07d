/* traits/tube_moment.h: the diameter of a tube whose ring noise has blurred. Internal. */
#ifndef PLANTIMETER_TRAITS_TUBE_MOMENT_H
#define PLANTIMETER_TRAITS_TUBE_MOMENT_H

#include "cloud/sampling.h"

enum { PLM_MOMENT_POINTS = 6000 /* at most */ };

/** Voxel means about a place on an organ's axis. */
typedef struct plm_moment_query {
    const double (*xyz)[3];
    size_t count;
    double place[3], along[3];    /**< on the axis, and its direction (unit length) there */
    const plm_sampling *sampling; /**< the plant's */
} plm_moment_query;

/** The diameter (m) by the mean square of the points' distances from the line through their middle that runs along the direction, and its
 * standard error. Points more than three medians off are left out. False where there are too few points or too many, and where they lie in
 * less than 0.7 of the directions about the place: the middle of a part of the ring is not the axis. */
bool plm_tube_moment(const plm_moment_query *query, double *diameter, double *std_error);

#endif
