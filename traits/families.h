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

/* traits/leaf_area.c */
PLM_TRAIT_FUNCTION(plm_trait_leaf_area);
PLM_TRAIT_FUNCTION(plm_trait_total_leaf_area);
PLM_TRAIT_FUNCTION(plm_trait_leaf_alpha);
PLM_TRAIT_FUNCTION(plm_trait_leaf_alpha_sensitivity);

/* traits/leaf_inclination.c */
PLM_TRAIT_FUNCTION(plm_trait_leaf_inclination);
PLM_TRAIT_FUNCTION(plm_trait_facet_inclination_mean);
PLM_TRAIT_FUNCTION(plm_trait_facet_inclination_sd);
PLM_TRAIT_FUNCTION(plm_trait_leaf_flatness);

/* traits/leaf_size.c */
PLM_TRAIT_FUNCTION(plm_trait_leaf_length);
PLM_TRAIT_FUNCTION(plm_trait_leaf_width);
PLM_TRAIT_FUNCTION(plm_trait_leaf_azimuth);
PLM_TRAIT_FUNCTION(plm_trait_leaf_azimuth_from_stem);
/* traits/stem_traits.c */
PLM_TRAIT_FUNCTION(plm_trait_stem_diameter);
PLM_TRAIT_FUNCTION(plm_trait_stem_length);
PLM_TRAIT_FUNCTION(plm_trait_stem_inclination);

/* traits/petiole_traits.c */
PLM_TRAIT_FUNCTION(plm_trait_petiole_inclination);
PLM_TRAIT_FUNCTION(plm_trait_petiole_length);
PLM_TRAIT_FUNCTION(plm_trait_petiole_diameter);
PLM_TRAIT_FUNCTION(plm_trait_leaf_insertion_angle);
PLM_TRAIT_FUNCTION(plm_trait_internode_length);

/* traits/plant_height.c */
PLM_TRAIT_FUNCTION(plm_trait_plant_height);
PLM_TRAIT_FUNCTION(plm_trait_height_above_ground);
PLM_TRAIT_FUNCTION(plm_trait_height_p98);
PLM_TRAIT_FUNCTION(plm_trait_height_p99);
PLM_TRAIT_FUNCTION(plm_trait_height_top10);

/* traits/plant_extent.c */
PLM_TRAIT_FUNCTION(plm_trait_plant_width);
PLM_TRAIT_FUNCTION(plm_trait_box_x);
PLM_TRAIT_FUNCTION(plm_trait_box_y);
PLM_TRAIT_FUNCTION(plm_trait_box_z);
PLM_TRAIT_FUNCTION(plm_trait_pca1);
PLM_TRAIT_FUNCTION(plm_trait_pca2);
PLM_TRAIT_FUNCTION(plm_trait_pca3d_1);
PLM_TRAIT_FUNCTION(plm_trait_pca3d_2);
PLM_TRAIT_FUNCTION(plm_trait_pca3d_3);

/* traits/plant_hull.c */
PLM_TRAIT_FUNCTION(plm_trait_hull_volume);
PLM_TRAIT_FUNCTION(plm_trait_hull_area);

/* traits/plant_area.c */
PLM_TRAIT_FUNCTION(plm_trait_projected_area);

/* traits/plant_light.c */
PLM_TRAIT_FUNCTION(plm_trait_absorbed_radiation);
PLM_TRAIT_FUNCTION(plm_trait_leaf_absorbed_radiation);

/* traits/plant_colour.c */
PLM_TRAIT_FUNCTION(plm_trait_gli);
PLM_TRAIT_FUNCTION(plm_trait_hue_mean);

/* traits/plant_smoothness.c */
PLM_TRAIT_FUNCTION(plm_trait_smoothness_mean);
PLM_TRAIT_FUNCTION(plm_trait_smoothness_sd);
PLM_TRAIT_FUNCTION(plm_trait_boundary_share);

#endif
