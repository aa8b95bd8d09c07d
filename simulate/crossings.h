/* simulate/crossings.h: pairs of leaves whose surfaces cut each other. Internal. */
#ifndef PLANTIMETER_SIMULATE_CROSSINGS_H
#define PLANTIMETER_SIMULATE_CROSSINGS_H

#include "simulate/simulate.h"

/** Number of pairs of leaves with a face of one cut by an edge of the other. PLM_E_MEMORY, PLM_E_LIBRARY. */
plm_status plm_leaf_pairs_crossing(const plm_virtual_plant *plant, size_t *pairs, plm_error *error);

#endif
