/* segment/relief.h: the height of soil or table as a raster over a plane, and its noise. Internal. */
#ifndef PLANTIMETER_SEGMENT_RELIEF_H
#define PLANTIMETER_SEGMENT_RELIEF_H

#include "segment/level.h"

/** Heights over a plane, on a raster of square cells; read between the cells' middles by bilinear interpolation. */
typedef struct plm_relief {
    double plane[3]; /**< w = plane[0] u + plane[1] v + plane[2] */
    double low[2], cell;
    int32_t size[2];
    double *height; /**< over the plane; 0 where nothing was seen around */
    double sigma;   /**< standard deviation of the points off the relief */
} plm_relief;

/** Says whether a place (u, v, w) may lie on the surface. */
typedef bool (*plm_relief_filter)(const void *context, const double place[3]);

/** Fits the relief to those of count places (u, v, w) that lie within band of the plane and that the filter admits; of
 * very many, to some. The caller frees it with plm_relief_free. Linear time. */
plm_status plm_relief_fit(const plm_stand *stand, const float (*place)[3], size_t count, const double plane[3],
                          double band, plm_relief_filter filter, const void *context, plm_relief *relief,
                          plm_error *error);

/** Height of a place over the relief; positive is above. */
double plm_relief_over(const plm_relief *relief, const double place[3]);

void plm_relief_free(plm_relief *relief);

#endif
