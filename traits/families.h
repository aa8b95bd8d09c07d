/* traits/families.h: the trait functions, one block a file. Internal. A row of traits/table.c names each of them; their
 * contract is that of plm_trait.measure (traits/traits.h): out comes in as PLM_STATE_OK with value and std_error NAN and
 * point_count that of the organ (plant traits: of the plant). */
#ifndef PLANTIMETER_TRAITS_FAMILIES_H
#define PLANTIMETER_TRAITS_FAMILIES_H

#include "traits/traits.h"

#define PLM_TRAIT_FUNCTION(name)                                                                                       \
    plm_status name(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)

/* traits/counts.c */
PLM_TRAIT_FUNCTION(plm_trait_leaf_count);
PLM_TRAIT_FUNCTION(plm_trait_leaflet_count);

#endif
