/* segment/sparse_tips.h: a leaf's sparse tip, or a stem's sparse foot, is no ghost. Internal. */
#ifndef PLANTIMETER_SEGMENT_SPARSE_TIPS_H
#define PLANTIMETER_SEGMENT_SPARSE_TIPS_H

#include "cloud/neighbours.h"

#include "segment/segment.h"

/** Finds what was dropped (drop[i]) though it goes on where the kept surface ends: less than three times as far off as its points
 * there are from each other, and in its plane or on its tube, or anywhere in scans without noise of which few points were dropped,
 * none of them far off: tip[i], of count points. Not for voxel means, whose ghosts leave rims just so. index is over the points of
 * xyz, kept and dropped. PLM_E_MEMORY only. */
plm_status plm_sparse_tips(const plm_index *index, const float (*xyz)[3], size_t count, const bool *drop, bool *tip,
                           plm_error *error);

/** Whether the points are voxel means, which keep apart. cell: edge of voxels that hold one or few of them. */
plm_status plm_are_voxel_means(const float (*xyz)[3], size_t count, double cell, bool *answer, plm_error *error);

/** As plm_clean, and tip[i] (count of cloud) is true for what it drops though it is a leaf's sparse tip, a stem's sparse foot,
 * or the like (plm_sparse_tips): true of none in clouds of voxel means. Organs are better found without them, as the way along a
 * sparse rim is no petiole. Where they are more than 0.004 of what is kept they are whole leaves that were seen seldom: then they are kept,
 * and none is a tip. tip may be NULL: what is sparse is dropped. */
plm_status plm_clean_but_tips(const plm_cloud *cloud, const uint8_t *label, bool *keep, bool *tip, double *spacing,
                              plm_error *error);

/** Gives sparse tips the label, organ and leaflet of the nearest point that was segmented. keep and tip: as above. */
plm_status plm_label_tips(const plm_cloud *cloud, const bool *keep, const bool *tip, plm_segmentation *segmentation,
                          plm_error *error);

#endif
