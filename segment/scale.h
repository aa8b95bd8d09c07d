/* segment/scale.h: the one length that carries the segmentation: R, about three stem radii. Internal. */
#ifndef PLANTIMETER_SEGMENT_SCALE_H
#define PLANTIMETER_SEGMENT_SCALE_H

#include "cloud/cloud.h"

typedef struct plm_scale {
    double size;             /**< diagonal of the box of the 0.5 to 99.5 % quantiles */
    double spacing;          /**< median distance of nearest neighbours, thinned */
    double noise;            /**< sigma across surfaces */
    double pitch, gathering; /**< of voxel means (cloud/sampling.h), where a stage asked for them; else 0 */
    double radius;           /**< R */
    double stem_radius;      /**< 75 % quantile of the radii of tube-like points */
    double tube_length;      /**< of all tube-like points together, at R */
    bool has_tubes;          /**< long enough, and with enough of them on rings */
    bool
        is_doubtful; /**< so few tubes, or so noisy ones, that they may be folds and rims of a single leaf or a head as well (judge_tubes.h);
                        then has_tubes is false as found here */
    bool is_blurred; /**< so few and noisy points for the size that a rosette's petioles hardly show as tubes */
    bool rises;      /**< tube length still grew at the largest R: leaves may pass as stems */
} plm_scale;

/** Finds the scale of count points (offsets near their middle; thinned to some 10^4 to 10^5 points, for the time).
 * PLM_E_DEGENERATE below 20 points or without extent. */
plm_status plm_find_scale(const float (*xyz)[3], size_t count, plm_scale *scale, plm_error *error);

/** Value at a quantile (0 to 1) of count values; reorders them. */
float plm_quantile(float *value, size_t count, double quantile);

#endif
