/* traits/families.h: the trait functions, one block a file. Internal. A row of traits/table.c names each of them; their
 * contract is that of plm_trait.measure (traits/traits.h): out comes in as PLM_STATE_OK with value and std_error NAN and
 * point_count that of the organ (plant traits: of the plant). Each block says the condition of its traits: how much larger the
 * relative error of the result may be than that of the coordinates. */
#ifndef PLANTIMETER_TRAITS_FAMILIES_H
#define PLANTIMETER_TRAITS_FAMILIES_H

#include "traits/traits.h"

#define PLM_TRAIT_FUNCTION(name)                                                                                       \
    plm_status name(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)

/* traits/counts.c: Exact over the labels: no condition. No standard error. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_count);
PLM_TRAIT_FUNCTION(plm_trait_leaflet_count);

/* traits/leaf_area.c: Condition 1 in the area of the triangles (mesh/mesh.h: 4 roundings); the rim is known to a point spacing, so the
 * relative error goes with spacing times rim over area. alpha's sensitivity is a condition itself: d ln A / d ln alpha. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_area);
PLM_TRAIT_FUNCTION(plm_trait_total_leaf_area);
PLM_TRAIT_FUNCTION(plm_trait_leaf_alpha);
PLM_TRAIT_FUNCTION(plm_trait_leaf_alpha_sensitivity);

/* traits/leaf_inclination.c: Condition: lambda1 / (lambda2 - lambda3) of the area's second moments, 1 for flat square leaves, large for strips
 * and balls; the angle itself by atan2, to a rounding at 0 and 90 degrees. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_inclination);
PLM_TRAIT_FUNCTION(plm_trait_facet_inclination_mean);
PLM_TRAIT_FUNCTION(plm_trait_facet_inclination_sd);
PLM_TRAIT_FUNCTION(plm_trait_leaf_flatness);

/* traits/leaf_size.c: Lengths: condition 1. Azimuths: 1 / sin(inclination) of the midrib; a leaf that stands upright has none. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_length);
PLM_TRAIT_FUNCTION(plm_trait_leaf_width);
PLM_TRAIT_FUNCTION(plm_trait_leaf_azimuth);
PLM_TRAIT_FUNCTION(plm_trait_leaf_azimuth_from_stem);
/* traits/stem_traits.c: Diameter: condition of the tube fit (plm_tube.condition), 2 for a whole ring, some 20 for a half, 2e5 for 20 degrees.
 * Length and inclination: radius over length; a stem less than three radii long has neither. */
PLM_TRAIT_FUNCTION(plm_trait_stem_diameter);
PLM_TRAIT_FUNCTION(plm_trait_stem_length);
PLM_TRAIT_FUNCTION(plm_trait_stem_inclination);

/* traits/petiole_traits.c: As stems; directions have the noise of their ends over the petiole's length. */
PLM_TRAIT_FUNCTION(plm_trait_petiole_inclination);
PLM_TRAIT_FUNCTION(plm_trait_petiole_length);
PLM_TRAIT_FUNCTION(plm_trait_petiole_diameter);
PLM_TRAIT_FUNCTION(plm_trait_leaf_insertion_angle);
PLM_TRAIT_FUNCTION(plm_trait_internode_length);

/* traits/plant_height.c: Condition: how far out the plant lies over its height; differences of two extremes, each known to noise and spacing. Above ground: the soil's plane too. */
PLM_TRAIT_FUNCTION(plm_trait_plant_height);
PLM_TRAIT_FUNCTION(plm_trait_height_above_ground);
PLM_TRAIT_FUNCTION(plm_trait_height_p98);
PLM_TRAIT_FUNCTION(plm_trait_height_p99);
PLM_TRAIT_FUNCTION(plm_trait_height_top10);

/* traits/plant_extent.c: Widths and boxes: condition 1. Principal extents: 1 / relative gap of the eigenvalues, in the standard error. */
PLM_TRAIT_FUNCTION(plm_trait_plant_width);
PLM_TRAIT_FUNCTION(plm_trait_box_x);
PLM_TRAIT_FUNCTION(plm_trait_box_y);
PLM_TRAIT_FUNCTION(plm_trait_box_z);
PLM_TRAIT_FUNCTION(plm_trait_pca1);
PLM_TRAIT_FUNCTION(plm_trait_pca2);
PLM_TRAIT_FUNCTION(plm_trait_pca3d_1);
PLM_TRAIT_FUNCTION(plm_trait_pca3d_2);
PLM_TRAIT_FUNCTION(plm_trait_pca3d_3);

/* traits/plant_hull.c: Condition 3 in volume and 2 in area by the coordinates; a sheet's volume is noise over thickness and is refused. */
PLM_TRAIT_FUNCTION(plm_trait_hull_volume);
PLM_TRAIT_FUNCTION(plm_trait_hull_area);

/* traits/plant_area.c: Condition 1; the rim of the silhouette is known to a cell. */
PLM_TRAIT_FUNCTION(plm_trait_projected_area);

/* traits/plant_light.c: Condition about 1 in the area of the surfaces; the rays' own error goes with 1 / sqrt(rays). */
PLM_TRAIT_FUNCTION(plm_trait_absorbed_radiation);
PLM_TRAIT_FUNCTION(plm_trait_leaf_absorbed_radiation);

/* traits/plant_colour.c: Means over points: condition 1; no geometry. */
PLM_TRAIT_FUNCTION(plm_trait_gli);
PLM_TRAIT_FUNCTION(plm_trait_hue_mean);

/* traits/plant_smoothness.c: Bounded by 0 and 1, condition 1 by directions; coincident neighbours are left out. */
PLM_TRAIT_FUNCTION(plm_trait_smoothness_mean);
PLM_TRAIT_FUNCTION(plm_trait_smoothness_sd);
PLM_TRAIT_FUNCTION(plm_trait_boundary_share);

#endif
