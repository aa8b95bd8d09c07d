/* segment/halo.h: the far scatter about what noise blurs. Internal. */
#ifndef PLANTIMETER_SEGMENT_HALO_H
#define PLANTIMETER_SEGMENT_HALO_H

#include "segment/scale.h"
#include "segment/thinning.h"

/** Whether noise blurs petioles: it is a large share of the balls in which tubes are told. */
bool plm_has_halo(const plm_scale *scale);

/** Takes out of a thinned plant the voxels about which there are far fewer points than about others nearby: what they stood for
 * goes to the nearest that stays. scale: the plant's, whose noise and spacing say how far that is. All stay of a few hundred points, of a
 * plant little larger than its noise, and where it would be half of them. Parallel. PLM_E_MEMORY. */
plm_status plm_halo_drop(plm_thinned *base, const plm_scale *scale, plm_error *error);

#endif
