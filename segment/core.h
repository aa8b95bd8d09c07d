/* segment/core.h: the middle of a plant, and the ends of the stem through it. Internal. */
#ifndef PLANTIMETER_SEGMENT_CORE_H
#define PLANTIMETER_SEGMENT_CORE_H

#include "segment/sketch.h"

/** The tube point from which far-apart points of the plant are reached by the shortest ways together; UINT32_MAX where
 * there is none. */
plm_status plm_sketch_core(const plm_sketch *sketch, uint32_t *core, plm_error *error);

/** The ends of a stem that no thickness tells from its leaves: the base is reached from the core going down, and the top
 * from the base going up, with the least detours; a leaf that hangs lower than the base is reached by way of its arch.
 * UINT32_MAX where there is no core. */
plm_status plm_upright_ends(const plm_sketch *sketch, uint32_t *base, uint32_t *top, plm_error *error);

#endif
