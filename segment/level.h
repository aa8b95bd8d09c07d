/* segment/level.h: the horizontal planes of a cloud: soil, table tops, and the flat leaves that look like them.
 * Works on surface patches turned so that w is up. Internal. */
#ifndef PLANTIMETER_SEGMENT_LEVEL_H
#define PLANTIMETER_SEGMENT_LEVEL_H

#include "segment/surfels.h"

enum { PLM_LEVELS = 8, PLM_OUTLINE = 72 };

/** The patches of a cloud seen along an up direction: u, v, w. */
typedef struct plm_stand {
    const plm_surfels *surfels;
    double rotation[3][3]; /**< rows: the directions of u, v and w in the cloud's axes */
    float (*place)[3];     /**< of each patch, its centre in u, v, w */
    float *upright;        /**< of each patch, |normal . w|; -1 where it has no normal */
    float (*lean)[2];      /**< of each patch, the normal's u and v, made of unit length; 0 where it has none */
    float low[2];          /**< corner of the raster below */
    double cell;           /**< of the raster: twice the edge of a voxel */
    int32_t size[2];
} plm_stand;

/** One connected piece of a horizontal plane. */
typedef struct plm_level {
    double plane[3];            /**< w = plane[0] u + plane[1] v + plane[2] */
    double scatter;             /**< standard deviation of its patches off the plane (robust) */
    double area;                /**< of its raster cells */
    double hull_area;           /**< of their outline */
    double centre[2];           /**< mean of its raster cells */
    double radius[PLM_OUTLINE]; /**< its convex outline around centre, by direction (5 degrees each) */
    double agreement;           /**< mean cosine between the patches' normals and the plane's */
    size_t patches;
    uint8_t *mask; /**< raster of the stand: 1 where the level is seen */
} plm_level;

/** Looks at the patches along up (unit). The caller frees it with plm_stand_free. */
plm_status plm_stand_make(const plm_surfels *surfels, const double up[3], plm_stand *stand, plm_error *error);
void plm_stand_free(plm_stand *stand);

/** The cell of the raster over a place, by rows of v; -1 outside of it. */
int64_t plm_stand_cell(const plm_stand *stand, double u, double v);

/** The place u, v, w of a point of the cloud. */
static inline void plm_stand_place(const plm_stand *stand, const float xyz[3], double place[3])
{
    double d[3];
    for (int i = 0; i < 3; i++) d[i] = (double)xyz[i] - stand->surfels->low[i];
    for (int i = 0; i < 3; i++)
        place[i] = stand->rotation[i][0] * d[0] + stand->rotation[i][1] * d[1] + stand->rotation[i][2] * d[2];
}

/** The direction within some 15 degrees of up to which most normals keep: the normal of soil and table where there are
 * any. Gives the share of the nearly horizontal patches that agree with it within 5 degrees. */
double plm_find_tilt(const plm_surfels *surfels, const double up[3], double direction[3]);

/** Finds at most PLM_LEVELS levels, largest first; count is how many. */
plm_status plm_find_levels(const plm_stand *stand, plm_level level[PLM_LEVELS], int *count, plm_error *error);
void plm_levels_free(plm_level level[PLM_LEVELS], int count);

/** Height of a level's plane over a place. */
static inline double plm_level_height(const plm_level *level, double u, double v)
{
    return level->plane[0] * u + level->plane[1] * v + level->plane[2];
}

/** Distance from the level's centre to its outline in the direction of (du, dv). */
double plm_level_reach(const plm_level *level, double du, double dv);

#endif
