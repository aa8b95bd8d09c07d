/* segment/pot.h: a pot as a body of revolution (or of any star-shaped outline) around an upright axis. Internal. */
#ifndef PLANTIMETER_SEGMENT_POT_H
#define PLANTIMETER_SEGMENT_POT_H

#include "segment/level.h"

enum { PLM_POT_ROWS = 256 };

/** A pot's wall. Lengths as the stand has them (u, v, w). */
typedef struct plm_pot {
    double centre[2];          /**< of the axis at w = foot */
    double slant[2];           /**< of the axis: u and v gained per w */
    bool round;                /**< shape is 1 everywhere */
    double shape[PLM_OUTLINE]; /**< radius of the outline by direction, mean 1 */
    double foot, rim;          /**< lowest and highest w of the wall */
    double step;               /**< height of a row of radius */
    int rows;
    double radius[PLM_POT_ROWS]; /**< of the wall's outside, row 0 at foot: times shape */
    double scatter;              /**< standard deviation of the wall's patches off it */
    double coverage;             /**< share of the directions in which the wall was seen */
    double filled;               /**< patches inside of the wall, below the soil, as a share of the wall's */
    double lid;                  /**< share of the section that horizontal patches close near the rim */
    double soil;                 /**< w of the soil at the axis; the rim where none is seen */
    bool soil_seen;
} plm_pot;

/** Finds the best pot. levels give outlines for pots that are not round. found is false where nothing is like a pot. */
plm_status plm_find_pot(const plm_stand *stand, const plm_level *level, int levels, bool *found, plm_pot *pot,
                        plm_error *error);

/** Distance from the axis over the outline's shape (so that the wall is at plm_pot_radius everywhere). */
double plm_pot_distance(const plm_pot *pot, const double place[3]);

/** Radius of the wall's outside at a height, kept at the ends' beyond them. */
double plm_pot_radius(const plm_pot *pot, double w);

#endif
