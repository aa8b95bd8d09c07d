/* segment/judge_tubes.h: whether what looked like tubes were petioles and a stem, by the organs that were found with them. Internal. */
#ifndef PLANTIMETER_SEGMENT_JUDGE_TUBES_H
#define PLANTIMETER_SEGMENT_JUDGE_TUBES_H

#include "segment/sketch.h"

/** *believed: whether the sketch's tubes were those of its organs. is_told: who says rosette saw petioles. PLM_E_MEMORY only. */
plm_status plm_judge_tubes(const plm_sketch *sketch, bool is_told, bool *believed, plm_error *error);

#endif
