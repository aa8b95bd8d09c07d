/* segment/surfels.h: a cloud as small patches of surface: one a voxel, with centre, normal and mean colour. Ground,
 * pots and zenith are found on these, as they do not know the density of the points. Internal. */
#ifndef PLANTIMETER_SEGMENT_SURFELS_H
#define PLANTIMETER_SEGMENT_SURFELS_H

#include "cloud/cloud.h"

/** Patches in the order of their voxels (x slowest), so the same for any order of the cloud's rows but for rounding. */
typedef struct plm_surfels {
    size_t count;
    double cell;        /**< edge of a voxel */
    double low[3];      /**< corner of the grid, in the cloud's offsets; a few stray points may lie outside of it */
    int32_t size[3];    /**< voxels along each axis */
    int32_t *slot;      /**< size[0] * size[1] * size[2], x slowest: the voxel's patch or -1 */
    float (*centre)[3]; /**< mean of the voxel's points, relative to low */
    float (*normal)[3]; /**< unit, either sign; zero where the surroundings have no plane */
    float (*colour)[3]; /**< mean of the voxel's points, 0 to 255; NULL without colour */
    uint32_t *points;   /**< how many points a voxel holds */
} plm_surfels;

/** Patches of a cloud. The voxel's edge is 1/resolution of the diagonal of the box (stray points left out), or larger
 * where that would leave less than about three points a voxel. Linear time, memory bounded (24 MB and the patches).
 * PLM_E_DEGENERATE for an empty cloud. */
plm_status plm_surfels_make(const plm_cloud *cloud, double resolution, plm_surfels *surfels, plm_error *error);

/** The voxel of an offset: index into slot, or -1 outside of the grid. */
int64_t plm_surfels_voxel(const plm_surfels *surfels, const float xyz[3]);

void plm_surfels_free(plm_surfels *surfels);

#endif
