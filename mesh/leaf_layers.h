/* mesh/leaf_layers.h: the two faces of a leaf, scanned apart, are one sheet. Internal. */
#ifndef PLANTIMETER_MESH_LEAF_LAYERS_H
#define PLANTIMETER_MESH_LEAF_LAYERS_H

#include "mesh/leaf_points.h"

/** Joins connected parts that lie close over or beside a larger part of the same leaf, so that a leaf whose faces were
 * scanned a millimetre apart is not counted twice. Changes component, component_size and component_count. */
plm_status plm_leaf_layers_merge(plm_leaf_points *points, plm_error *error);

#endif
