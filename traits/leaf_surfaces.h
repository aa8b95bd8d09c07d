/* traits/leaf_surfaces.h: what the traits of leaves ask of a surface. Internal. */
#ifndef PLANTIMETER_TRAITS_LEAF_SURFACES_H
#define PLANTIMETER_TRAITS_LEAF_SURFACES_H

#include "traits/scene.h"

/** Flags of a surface as flags of an estimate (PLM_FLAG_...). */
unsigned plm_surface_estimate_flags(const plm_leaf_surface *surface);

/** Standard error of the leaf's area: of its surface, and of where its label begins. m2. */
double plm_leaf_area_error(const plm_organ *leaf);

/** Whether the leaf has a surface; if not, out says why. */
bool plm_leaf_has_surface(const plm_organ *leaf, plm_estimate *out);

#endif
