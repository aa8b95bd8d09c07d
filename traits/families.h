/* traits/families.h: the trait functions, one block a file. Internal. A row of traits/table.c names each of them; their
 * contract is that of plm_trait.measure (traits/traits.h): out comes in as PLM_STATE_OK with value and std_error NAN and
 * point_count that of the organ (plant traits: of the plant). Each block says the condition of its traits: how much larger the
 * relative error of the result may be than that of the coordinates. */
#ifndef PLANTIMETER_TRAITS_FAMILIES_H
#define PLANTIMETER_TRAITS_FAMILIES_H

#include "traits/traits.h"

#define PLM_TRAIT_FUNCTION(name)                                                                                       \
    plm_status name(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)

/* traits/counts.c. Exact over the labels: no condition, no standard error. */
/** Exact: the number of organs labelled leaf. An error is one of the labels. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_count);
/** Exact: the number of leaflets that were told apart. An error is one of the labels. */
PLM_TRAIT_FUNCTION(plm_trait_leaflet_count);

/* traits/leaf_area.c. Condition 1 in the area of the triangles (mesh/mesh.h: 4 roundings of their sum). */
/** Relative error about spacing times rim over area: the rim is known to a part of a spacing (0.2 s, and 0.3 to 0.45 of the noise). */
PLM_TRAIT_FUNCTION(plm_trait_leaf_area);
/** A sum of positive terms: its relative error is at most the largest one of its leaves. */
PLM_TRAIT_FUNCTION(plm_trait_total_leaf_area);
/** Exact: the radius that was used. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_alpha);
/** A condition itself, d ln A / d ln alpha; its own error is that of the areas over the step of ln alpha. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_alpha_sensitivity);

/* traits/leaf_inclination.c. Angles by atan2: to a rounding at 0 and 90 degrees too. */
/** Condition lambda1 / (lambda2 - lambda3) of the area's second moments: 1 for flat square leaves, large for strips and balls; in
 * noise the error goes with 3 sigma / (sqrt(n) width). */
PLM_TRAIT_FUNCTION(plm_trait_leaf_inclination);
/** Mean of facets weighted by area: condition 1 in their angles; noise tilts facets by about sigma over their size and
 * steepens flat leaves. */
PLM_TRAIT_FUNCTION(plm_trait_facet_inclination_mean);
/** As the mean; noise adds its own variance. Centred sums: no cancellation. */
PLM_TRAIT_FUNCTION(plm_trait_facet_inclination_sd);
/** Ratio of the smallest eigenvalue to the middle one: 8 roundings of the largest eigenvalue, over the middle one. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_flatness);

/* traits/leaf_size.c */
/** Condition 1; each end is known to a spacing. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_length);
/** Condition 1; each side is known to a spacing. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_width);
/** Condition 1 / sin(inclination of the midrib): an upright leaf has none. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_azimuth);
/** Condition: spacing over the distance of the leaf from the stem. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_azimuth_from_stem);

/* traits/stem_traits.c. Conditions as of the tube fit's normal matrix (plm_tube.condition). */
/** Its standard error grows about as 1 / a^2 for short arcs of angle a; refused as undetermined where it is above a quarter. */
PLM_TRAIT_FUNCTION(plm_trait_stem_diameter);
/** Condition 1; the ends are known to about a radius over the root of their points. A stem of less than three radii has none. */
PLM_TRAIT_FUNCTION(plm_trait_stem_length);
/** Error in radians: that of the ends over the length. A stem of less than three radii has none. */
PLM_TRAIT_FUNCTION(plm_trait_stem_inclination);

/* traits/petiole_traits.c */
/** Error in radians: about 2 (radius + noise) / sqrt(n) of each end, over the length: 1.5 to 2 degrees at 10 mm in noise. */
PLM_TRAIT_FUNCTION(plm_trait_petiole_inclination);
/** Condition 1; its error is that of the two ends. */
PLM_TRAIT_FUNCTION(plm_trait_petiole_length);
/** As stem_diameter; below four times the noise the ring is not resolved and 15 % are left open. */
PLM_TRAIT_FUNCTION(plm_trait_petiole_diameter);
/** Errors of petiole_inclination and of the carrier's direction, added as squares. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_insertion_angle);
/** A difference of two places on the stem: absolute error that of both, relative error that over the difference. */
PLM_TRAIT_FUNCTION(plm_trait_internode_length);

/* traits/plant_height.c. Differences of two extremes: condition is how far out the plant lies over its height. */
/** Error: that of the top and of the base, each known to the noise and the gap to the next points. */
PLM_TRAIT_FUNCTION(plm_trait_plant_height);
/** As plant_height; the soil's plane is held to be known to 1.5 times the error of the top. */
PLM_TRAIT_FUNCTION(plm_trait_height_above_ground);
/** A quantile: what the two halves of the points differ by, the error of the base, and a 150th of the extent's raster. */
PLM_TRAIT_FUNCTION(plm_trait_height_p98);
/** As height_p98. */
PLM_TRAIT_FUNCTION(plm_trait_height_p99);
/** As height_p98; noise averages out over a tenth of the area, the share of area that is seen does not. */
PLM_TRAIT_FUNCTION(plm_trait_height_top10);

/* traits/plant_extent.c */
/** Condition 1; each of two extremes is known to noise and spacing. */
PLM_TRAIT_FUNCTION(plm_trait_plant_width);
/** Condition 1; each of two extremes is known to noise and spacing. */
PLM_TRAIT_FUNCTION(plm_trait_box_x);
/** As box_x. */
PLM_TRAIT_FUNCTION(plm_trait_box_y);
/** As box_x. */
PLM_TRAIT_FUNCTION(plm_trait_box_z);
/** Extent along an axis whose direction has condition 1 / relative gap of the eigenvalues; that is in the standard error. */
PLM_TRAIT_FUNCTION(plm_trait_pca1);
/** As pca1. */
PLM_TRAIT_FUNCTION(plm_trait_pca2);
/** As pca1, in space. */
PLM_TRAIT_FUNCTION(plm_trait_pca3d_1);
/** As pca3d_1; the smaller of the two gaps counts. */
PLM_TRAIT_FUNCTION(plm_trait_pca3d_2);
/** As pca3d_1. */
PLM_TRAIT_FUNCTION(plm_trait_pca3d_3);

/* traits/plant_hull.c. Hulls by exact predicates; sums to 16 roundings. */
/** Condition 3 by the coordinates; what sampling leaves out goes with n^-0.54. A sheet's volume is noise over thickness: refused. */
PLM_TRAIT_FUNCTION(plm_trait_hull_volume);
/** Condition 2 by the coordinates. */
PLM_TRAIT_FUNCTION(plm_trait_hull_area);

/* traits/plant_area.c */
/** Condition 1; the rim of the silhouette is known to a cell: relative error about cell times rim over area. */
PLM_TRAIT_FUNCTION(plm_trait_projected_area);

/* traits/plant_light.c */
/** Condition about 1 in the area of the surfaces; the rays' own error goes with 1 / sqrt(rays). */
PLM_TRAIT_FUNCTION(plm_trait_absorbed_radiation);
/** As absorbed_radiation, with the rays that meet the leaf; what shades it must be there. */
PLM_TRAIT_FUNCTION(plm_trait_leaf_absorbed_radiation);

/* traits/plant_colour.c */
/** A mean of ratios (2 G - R - B) / (2 G + R + B): condition 1; black points, where it is 0 / 0, are left out. */
PLM_TRAIT_FUNCTION(plm_trait_gli);
/** A mean direction: condition 1 / length of the mean vector; grey points have no hue. */
PLM_TRAIT_FUNCTION(plm_trait_hue_mean);

/* traits/plant_smoothness.c. Of directions between 0 and 1; coincident neighbours are left out. */
/** Condition 1 by directions; where noise is above the spacing they are the noise's. */
PLM_TRAIT_FUNCTION(plm_trait_smoothness_mean);
/** Centred sums: no cancellation. */
PLM_TRAIT_FUNCTION(plm_trait_smoothness_sd);
/** A share of n points: steps of 1 / n, as points cross the limit. */
PLM_TRAIT_FUNCTION(plm_trait_boundary_share);

#endif
