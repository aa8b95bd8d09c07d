/* segment/stem_rachis.h: where the way up the stem of a plant of compound leaves ran on into a rachis. Internal. */
#ifndef PLANTIMETER_SEGMENT_STEM_RACHIS_H
#define PLANTIMETER_SEGMENT_STEM_RACHIS_H

#include "segment/side_groups.h"

/** Takes the stem's path out of a rachis, which *done says: straight on where the stem goes on, else it ends there. What hangs on it
 * beyond a sharp turn down counts as leaflets, and so do blades together far beyond the last leaf. groups: what hangs on the
 * path; end: arc length from which on a foot is at its end; petiole: least tube of a leaf's blade. PLM_E_MEMORY. */
plm_status plm_stem_leave_rachis(plm_sketch *sketch, const plm_side_groups *groups, double end, double petiole,
                                 bool *done, plm_error *error);

#endif
