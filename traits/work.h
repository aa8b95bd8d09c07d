/* traits/work.h: the points that the stages of a measurement see: a thinned copy of large clouds in canonical order, and
 * the way back to all points. Internal. */
#ifndef PLANTIMETER_TRAITS_WORK_H
#define PLANTIMETER_TRAITS_WORK_H

#include "traits/traits.h"

/** A copy of some or all of a cloud's points. Freed by plm_work_free. */
typedef struct plm_work {
    uint32_t *row; /**< point i of the copy is this row of the cloud */
    size_t count;
    plm_cloud cloud; /**< the copy */
} plm_work;

/** Copies points. Clouds of more than budget points (0: no limit) are thinned to about as many, by a hash of their
 * coordinates: density keeps its proportions, and the order of rows does not matter. */
plm_status plm_work_make(const plm_cloud *cloud, size_t budget, plm_work *work, plm_error *error);

/** Brings the copy into an order that follows from its coordinates alone. */
plm_status plm_work_order(plm_work *work, plm_error *error);

/** Gives all rows of cloud (the one that work was made of, turned as work is) the labels of found, which is of work's points: left-out points
 * take those of the nearest point that was seen, or PLM_LABEL_OTHER beyond five spacings of it; where the cloud came with
 * labels they keep their own. to: the segmentation of all rows, the caller's; leaf_flags of found move there. */
plm_status plm_work_give_labels(const plm_work *work, plm_segmentation *found, plm_cloud *cloud, plm_segmentation *to,
                                plm_error *error);

/** Copies the labels, organs and leaflets of a segmentation of the cloud's own rows into the cloud. */
plm_status plm_segmentation_to_cloud(const plm_segmentation *segmentation, plm_cloud *cloud, plm_error *error);

void plm_work_free(plm_work *work);

#endif
