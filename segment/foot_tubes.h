/* segment/foot_tubes.h: the stem and the petioles about a node as tubes blurred by the noise. Internal. */
#ifndef PLANTIMETER_SEGMENT_FOOT_TUBES_H
#define PLANTIMETER_SEGMENT_FOOT_TUBES_H

#include "segment/sketch.h"

enum { PLM_FOOT_PETIOLES = 3, PLM_FOOT_FEWEST = 15 /* points of a petiole */ };
static const double PLM_FOOT_PETIOLE_REACH = 4; /* in R, about the node: points of a petiole that give its line */

/** A tube about the places origin + s along + s^2 bend; bend is about square to along. */
typedef struct plm_foot_tube {
    double origin[3], along[3], bend[3];
    double radius, density; /**< density: points a metre of length */
} plm_foot_tube;

/** A node: its points, and the tubes that are fitted to them. The arrays are the caller's; scale, path and out are borrowed. */
typedef struct plm_foot {
    const float (*xyz)[3];
    const uint32_t *row; /**< where a point is in out */
    const plm_scale *scale;
    const plm_stem_path *path;
    plm_segmentation *out;
    const uint32_t *point; /**< stem and petiole points about the node */
    size_t count;
    double at[3];                    /**< the place of the way that is looked at, ... */
    double along;                    /**< ... its arc length, ... */
    bool is_tip;                     /**< ... and whether it is the way's end */
    double end;                      /**< of the stem, from there; INFINITY: far. Found where is_tip */
    double blur;                     /**< SD of the points about their tube */
    int32_t leaf[PLM_FOOT_PETIOLES]; /**< of the petioles; the first is the one that is asked about */
    size_t petioles;
    plm_foot_tube tube[1 + PLM_FOOT_PETIOLES]; /**< the stem, then the petioles */
    double foot[PLM_FOOT_PETIOLES];            /**< places on their lines where petioles come out of the stem, ... */
    double last[PLM_FOOT_PETIOLES];            /**< ... and where they were seen last */
    /* at each point: */
    double (*density)[1 + PLM_FOOT_PETIOLES]; /**< of each tube, were the stem endless and did it hide nothing */
    double *outside;                          /**< share of a petiole that the stem leaves there */
    double *place;                            /**< along the stem */
} plm_foot;

/** Fits the tubes, and at the tip the stem's end, by turns. false: points are too few, or do not tell the first petiole from
 * the stem. Source: Poisson likelihood of rings blurred by normal errors. */
bool plm_foot_fit(plm_foot *p);

/** Fills in what the tubes say at each point. */
void plm_foot_densities(plm_foot *p);

/** Which tube a point is of; most: its density there. */
size_t plm_foot_likeliest(const plm_foot *p, size_t i, double *most);

/** The density below which a point is of none of them. */
double plm_foot_elsewhere(const plm_foot *p);

/** Distance of a point from a tube's line; s: place along it. */
double plm_tube_distance(const plm_foot_tube *t, const float xyz[3], double *s);

/** Distance of a point from the node. */
double plm_foot_distance(const plm_foot *p, const float xyz[3]);

#endif
