/* tests/support/label_score.h: how well labels and organ numbers agree with known ones. For tests and benchmarks. */
#ifndef PLANTIMETER_TESTS_LABEL_SCORE_H
#define PLANTIMETER_TESTS_LABEL_SCORE_H

#include "cloud/cloud.h"

/** Points whose true label is other or ground are left out throughout: ghost points have no right answer. Intersections
 * over unions are NAN where a class is neither there nor claimed. */
typedef struct label_score {
    size_t points;
    double iou[PLM_LABEL_COUNT]; /**< of stem, petiole and leaf */
    double iou_axis;             /**< of stem and petiole together */
    double iou_mean;             /**< of iou_axis and iou[leaf] */
    size_t leaves, leaves_found; /**< true ones with at least ten points; predicted ones with at least one */
    size_t leaves_matched;       /**< pairs with an intersection over union above 0.5 */
    double worst_leaf; /**< of a true leaf and the predicted one that meets it best: the least; 1 without leaves */
    double f1;         /**< of the leaves; 1 where there are none and none was found */
} label_score;

/** PLM_E_MEMORY only. */
plm_status label_score_compute(size_t count, const uint8_t *true_label, const int32_t *true_organ, const uint8_t *label,
                               const int32_t *organ, label_score *score, plm_error *error);

#endif
