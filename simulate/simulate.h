/* simulate/simulate.h: plants whose traits are known exactly, and the scanners that turn them into clouds.
 *
 * Knows cloud/ and io/. A virtual plant is a triangle mesh grown from parametric organs (swept tubes, bent blades),
 * with the class and number of the organ on every face and the truth of every trait beside it. Metres and radians
 * inside; the truth file is in metres and degrees, as the files of the development clouds are. Everything follows from
 * the seed: random numbers are a function of (seed, ray), so that any number of threads gives the same digits. */
#ifndef PLANTIMETER_SIMULATE_SIMULATE_H
#define PLANTIMETER_SIMULATE_SIMULATE_H

#include "../cloud/cloud.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Plants ---------------------------------------------------------------------------------------------------- */

enum { PLM_TRUE_NODES_MAXIMUM = 64 };

/** A stem or branch as it was built. */
typedef struct plm_true_stem {
    int32_t parent; /**< the stem that it branches from, -1 for a main stem */
    double base[3], tip[3];
    double length;      /**< of the axis, m */
    double inclination; /**< of base to tip, from zenith */
    double diameter;    /**< perpendicular to the axis at diameter_height, m */
    double diameter_height;
    bool is_short;                     /**< shorter than 4 cm: diameter at half length instead of 2 cm */
    double diameter_point[3], axis[3]; /**< of the axis where the diameter is taken */
    int node_count;
    double node[PLM_TRUE_NODES_MAXIMUM]; /**< distance of each leaf's node from the base along the axis, rising */
    double centroid[3];                  /**< of the organ's faces */
    double visible_fraction;             /**< set by a scan; NAN before */
    size_t points;
} plm_true_stem;

/** A petiole. Lengths and chord run from the stem's surface to the (last) blade's junction. */
typedef struct plm_true_petiole {
    double base[3], junction[3];
    double length, chord;
    double inclination;     /**< of the chord, from zenith, 0 to pi */
    double inclination_pca; /**< of the largest principal axis of its surface outside of the stem */
    double diameter;        /**< half way (compound: half way to the first leaflet) */
    bool is_compound;
    double first_length, first_inclination, first_junction[3]; /**< compound: to the first leaflet */
    double centroid[3];
    double visible_fraction;
    size_t points;
} plm_true_petiole;

typedef enum plm_leaf_role { PLM_LEAF_TRUE = 0, PLM_LEAF_COTYLEDON, PLM_LEAF_UNIFOLIATE } plm_leaf_role;

/** A leaf, or a leaflet of a compound leaf. Angles from zenith, azimuth from +x towards +y. */
typedef struct plm_true_leaf {
    plm_leaf_role role;
    int32_t leaflet; /**< number within its leaf, from 1; 0 for a leaf */
    bool is_compound;
    size_t first_leaflet, leaflet_count; /**< rows of the plant's leaflets, compound leaves only */
    double area, inclination, facet_inclination_mean, facet_inclination_sd;
    double flatness; /**< smallest over middle eigenvalue of the surface's second moments */
    double normal[3];
    double azimuth, azimuth_from_stem;
    double length, width;
    double width_chord;     /**< NAN for compound leaves */
    double insertion_angle; /**< NAN where there is no stem */
    double base[3], tip[3];
    double centroid[3];
    double visible_fraction;
    size_t points;
} plm_true_leaf;

/** Traits of the whole plant, from all its faces. */
typedef struct plm_true_plant {
    double height, width, lowest, highest;
    double hull_volume, hull_area; /**< NAN until the caller sets them: hulls are made in mesh/ */
    double pca1, pca2, pca_variance_ratio, pca_axis1[2];
    double projected_area;
    double leaf_area;
    double leaf_overlap[3];     /**< share of the leaves' silhouettes lost to overlap, along z, x and y */
    size_t leaf_pairs_crossing; /**< pairs of leaves whose surfaces cut each other */
} plm_true_plant;

/** A virtual plant. Arrays belong to it (plm_virtual_plant_free). */
typedef struct plm_virtual_plant {
    char kind[32];
    uint64_t seed;
    bool is_arched;        /**< a seedling that was grown so, see plm_plant_options */
    plm_mesh mesh;         /**< face_organ is set: number within the class */
    uint8_t *face_label;   /**< plm_label of every triangle */
    int32_t *face_leaflet; /**< number of the leaflet from 1, -1 for none */
    float *vertex_rim;     /**< of blades: distance to the blade's rim, m; of tubes INFINITY */
    float *vertex_radius;  /**< of tubes: their radius, m; of blades 0 */
    size_t stem_count, petiole_count, leaf_count, leaflet_count;
    plm_true_stem *stem;
    plm_true_petiole *petiole;
    plm_true_leaf *leaf;
    plm_true_leaf *leaflet; /**< of all compound leaves, leaf after leaf */
    bool has_petioles;      /**< petiole k carries leaf k; false: leaves sit on the stem */
    plm_true_plant whole;
} plm_virtual_plant;

typedef struct plm_plant_options {
    uint64_t seed;
    double resolution; /**< 1: some 5 000 faces a leaf; lengths of edges go with 1 / resolution. 0 means 1 */
    bool
        is_arched; /**< seedlings: petioles leave the stem steeply and arch, blades follow them; deep sinuses of lobed ones */
} plm_plant_options;

/** A kind of plant that can be grown. */
typedef struct plm_plant_kind {
    const char *name;
    const char *summary;
} plm_plant_kind;

/** Kind number index, or NULL beyond the last. Static storage. */
PLM_API const plm_plant_kind *plm_plant_kind_at(size_t index);

/** Grows one plant. z is up, the base of the main stem is at the origin. The truth is complete but for hull_volume,
 * hull_area and what a scan adds. Angles and areas come from the mesh itself, axes and midribs from the parametric
 * curves. PLM_E_ARGUMENT  an unknown kind (the message names the nearest), or a resolution outside [0.02, 8]. */
PLM_API plm_status plm_plant_grow(const char *kind, const plm_plant_options *options, plm_virtual_plant *plant,
                                  plm_error *error);

PLM_API void plm_virtual_plant_free(plm_virtual_plant *plant);

/* ---- Scanners -------------------------------------------------------------------------------------------------- */

typedef enum plm_scanner {
    PLM_SCANNER_NONE = 0,
    PLM_SCANNER_DOME,    /**< 13 x 25 scanners on a hemisphere, first hits */
    PLM_SCANNER_RGBD,    /**< depth cameras on a ring, fused on voxels */
    PLM_SCANNER_UNIFORM, /**< points at random on the surface, seen or not */
    PLM_SCANNER_SPLAT    /**< like the centres of fitted gaussians */
} plm_scanner;

/** Options of a scan. All zero is a good default but for the scanner. */
typedef struct plm_scan_options {
    plm_scanner scanner;
    uint64_t seed;
    size_t points;   /**< wanted number of plant points; 0: from density */
    double density;  /**< hits per m2 of one-sided plant surface; 0: 0.1 per mm2, more on small plants */
    double noise;    /**< SD, m: dome and uniform: each axis; rgbd: depth at 0.4 m; splat: along the normal */
    double outliers; /**< share of points that are floaters */
    bool has_pot, has_table;
    double dome_radius; /**< m; 0: 3.6, neighbours about 50 cm apart */
    int views;          /**< rgbd: 0 means 12; splat: 0 means 60 */
    double
        distance; /**< rgbd: camera to the middle of the plant, m; 0: drawn between 0.25 and 0.42, more for large plants */
    int image_width;  /**< rgbd: pixels, height is 9/16 of it; 0: 960, half of the colour image's 1920 */
    double elevation; /**< rgbd: of the ring, radians; 0: drawn between 15 and 40 degrees */
    double voxel;     /**< rgbd: m; 0: drawn between 0.5 and 1 mm, more for large plants */
    double misplacement, misrotation; /**< rgbd: SD of each view's shift (m) and turn (rad); 0: 0.2 mm, 0.05 degrees;
                                           below 0: none */
    double axis_tilt,
        axis_shift; /**< rgbd: how far the calibrated axis of the turntable leans (rad) and stands (m) from the true one;
                                       poses of the views after the first are wrong by it */
    const char *
        views_folder; /**< rgbd: depth, colour, mask and pose of every view are written here; NULL: not. The caller's */
    double thin_stem; /**< rgbd: stems and petioles of smaller diameter lose pieces, m; 0: 3 mm; below 0: none */
    double unevenness; /**< splat: ratio of the densities; 0: drawn between 5 and 15 */
    bool is_gaussians; /**< splat: gaussians instead of points: their centres keep off the rim */
} plm_scan_options;

/** Gaussians of a splat: log scales and quaternion as the files have them. Arrays of the cloud's count. */
typedef struct plm_gaussians {
    float (*log_scale)[3];
    float (*rotation)[4]; /**< w x y z */
    float *logit_opacity;
} plm_gaussians;

/** Pot and table under the plant. Heights are z, m. */
typedef struct plm_surroundings {
    bool has_pot, has_table;
    double centre[2];
    double soil, rim, radius, table;
} plm_surroundings;

/** What a scan gives. The caller's: plm_scan_free. */
typedef struct plm_scan {
    plm_cloud cloud;     /**< xyz, rgb, normal (splat), label, organ */
    int32_t *leaflet;    /**< NULL where the plant has no compound leaves */
    plm_gaussians splat; /**< arrays NULL unless the scanner is the splat one */
    plm_surroundings surroundings;
    size_t class_points[PLM_LABEL_COUNT];
    size_t pixels;         /**< rgbd: depth pixels that were fused */
    double ghost_share;    /**< rgbd: of the pixels */
    double hits_per_area;  /**< dome, uniform: plant points per m2 */
    plm_scan_options used; /**< the options with all defaults filled in */
} plm_scan;

/** Scans a plant. Fills visible_fraction and points of the plant's organs. Rays are cast by Embree (first hits); labels
 * are those of the face that was hit. PLM_E_ARGUMENT for options out of range, PLM_E_LIBRARY when Embree fails. */
PLM_API plm_status plm_scan_plant(plm_virtual_plant *plant, const plm_scan_options *options, plm_scan *scan,
                                  plm_error *error);

PLM_API void plm_scan_free(plm_scan *scan);

/* ---- Light ------------------------------------------------------------------------------------------------------ */

enum { PLM_LIGHT_BANDS = 3 };

/** Options of a light run. Fill with plm_light_defaults first. */
typedef struct plm_light_options {
    uint64_t seed;
    uint64_t rays;       /**< sent out by the sources together */
    int circles, around; /**< sources: so many circles of so many directions on the sky */
    double power;        /**< of all sources, W; a third in each band (red, green, blue) */
    double
        irradiance; /**< W/m2 that all sources together bring, each across its own direction; 0: power holds. Else power is
                            irradiance x the sphere's disc, and what is absorbed does not depend on the sphere */
    double reflectance[PLM_LIGHT_BANDS];   /**< diffuse, of both sides of a face */
    double transmittance[PLM_LIGHT_BANDS]; /**< diffuse; what is neither reflected nor transmitted is absorbed */
    int depth;                             /**< hits of one ray at most; what travels on then counts as escaped */
    double centre[3], radius; /**< every source shines evenly on the disc that covers this sphere, m; radius 0:
                                               the sphere about the mesh */
} plm_light_options;

/** The laser-scanning paper: 10 million rays, six circles of twelve sources, 1000 W, 10 hits; leaves pure green: of green light
 * all that is not transmitted is reflected, red and blue are absorbed; 10 % is transmitted. */
PLM_API void plm_light_defaults(plm_light_options *options);

/** Absorbed power. The caller's: plm_light_free. */
typedef struct plm_light {
    size_t face_count, group_count;
    double *face_power;      /**< W, of each triangle */
    double *group_power;     /**< W, of each group of faces */
    double *group_std_error; /**< W, from 16 independent parts of the rays */
    double emitted, absorbed, escaped;
    double absorbed_std_error;
    uint64_t ray_count; /**< cast in all, those after reflection and transmission included */
} plm_light;

/** Absorbed light of every face, by following rays from directional sources through diffuse reflection and transmission. face_group
 * (may be NULL) puts triangle f into group face_group[f], -1 for none; groups are numbered below group_count. Absorbed and
 * escaped add up to emitted exactly but for the rounding of one sum; the same digits on any number of threads.
 * The first rays of each source and their first scattering follow a low-discrepancy sequence, shifted at random.
 * PLM_E_ARGUMENT  options out of range; reflectance + transmittance above 1. PLM_E_DEGENERATE  no faces. */
PLM_API plm_status plm_light_trace(const plm_mesh *mesh, const int32_t *face_group, size_t group_count,
                                   const plm_light_options *options, plm_light *light, plm_error *error);

PLM_API void plm_light_free(plm_light *light);

/** Faces of one organ. */
typedef struct plm_light_group {
    int label; /**< plm_label, or -1 where the mesh has no labels */
    int32_t organ;
    size_t face_count;
    double area; /**< one-sided */
} plm_light_group;

/** Sorts the faces of a mesh into organs by face_label (may be NULL) and mesh->face_organ: stems, petioles, leaves and then the
 * rest, each by number. face_group (one a triangle) is filled in; -1 for faces of no organ. group is the caller's (plm_free);
 * count 0 where the mesh names no organs. PLM_E_MEMORY. */
PLM_API plm_status plm_light_groups(const plm_mesh *mesh, const uint8_t *face_label, int32_t *face_group,
                                    plm_light_group **group, size_t *count, plm_error *error);

/** Writes a mesh as binary PLY with each face's absorbed power (`absorbed_w`), that per area (`absorbed_w_m2`), a colour from
 * dark to light by the latter, and label and organ where they are known. Vertices are origin + offset. */
PLM_API plm_status plm_light_write(const char *path, const plm_mesh *mesh, const uint8_t *face_label,
                                   const plm_light *light, plm_error *error);

/* ---- Loss of geometry -------------------------------------------------------------------------------------------- */

/** Which faces go first (laser-scanning paper). */
typedef enum plm_loss {
    PLM_LOSS_RANDOM = 0,
    PLM_LOSS_INSIDE_OUT, /**< those nearest to the plant's axis */
    PLM_LOSS_OUTSIDE_IN, /**< those farthest from it */
    PLM_LOSS_COUNT
} plm_loss;

/** "random", "inside-out" or "outside-in". Static storage. */
PLM_API const char *plm_loss_name(plm_loss loss);

/** Traits that the study follows. */
typedef enum plm_thinning_trait {
    PLM_THIN_HEIGHT = 0, /**< highest point above the ground, m */
    PLM_THIN_PCA1,       /**< of the cloud's ground projection, m */
    PLM_THIN_PCA2,
    PLM_THIN_HULL_VOLUME,   /**< m3 */
    PLM_THIN_ABSORBED,      /**< absorbed radiation, W */
    PLM_THIN_AREA,          /**< of the faces that are left, m2 */
    PLM_THIN_VISIBLE_AREA,  /**< by the paper's rule, m2 */
    PLM_THIN_VISIBLE_FACES, /**< share of the faces that are left */
    PLM_THIN_POINTS,
    PLM_THIN_SF_MEAN, /**< smoothness factor */
    PLM_THIN_SF_SD,
    PLM_THIN_SF_BOUNDARY, /**< share above 0.5 */
    PLM_THIN_SF_T,        /**< Welch's t against the intact plant */
    PLM_THIN_COUNT
} plm_thinning_trait;

/** "plant_height", "pca1", ... as the study's tables name them. Static storage. */
PLM_API const char *plm_thinning_trait_name(plm_thinning_trait trait);

typedef struct plm_thinning_options {
    uint64_t seed;
    double density;      /**< hits per m2 on the intact plant; 0: 0.105e6, the paper's tomato */
    uint64_t light_rays; /**< 0: 1 million */
    int neighbours;      /**< of the smoothness factor; 0: 16 */
    /** Volume of the convex hull of points: hulls are made in mesh/, which this module does not know. */
    plm_status (*hull)(const float (*xyz)[3], size_t count, double *volume, double *area, plm_mesh *mesh,
                       plm_error *error);
} plm_thinning_options;

/** A plant that is being thinned: the intact one, the dome that looks at it, its light, and what each face's number of hits is
 * compared with. Opaque. */
typedef struct plm_thinning plm_thinning;

/** Prepares a study of plant, which must outlive it. The dome's rays are set so that the intact plant gets the wanted
 * density; all steps use the same rays and the same light. */
PLM_API plm_status plm_thinning_start(const plm_virtual_plant *plant, const plm_thinning_options *options,
                                      plm_thinning **thinning, plm_error *error);
PLM_API void plm_thinning_free(plm_thinning *thinning);

/** Area (m2) and hits of each face of the half ellipsoid that the plant's density is compared with: count of both. They belong to
 * thinning. */
PLM_API void plm_thinning_ellipsoid(const plm_thinning *thinning, const double **area, const uint32_t **hits,
                                    size_t *count);

/** Removes loss_percent of the original number of faces and measures: value[PLM_THIN_COUNT]. loss_percent 0 is the intact
 * plant. */
PLM_API plm_status plm_thinning_step(const plm_thinning *thinning, plm_loss loss, double loss_percent,
                                     double value[PLM_THIN_COUNT], plm_error *error);

/* ---- Files ------------------------------------------------------------------------------------------------------- */

/** The scan as PLY with everything that is known of each point: label, organ, leaflet where there are compound leaves, and
 * the gaussians' fields where there are gaussians. is_labelled false leaves out the labels: what a user would bring. */
PLM_API plm_status plm_scan_write(const char *path, const plm_scan *scan, bool is_labelled, plm_error *error);

/** The plant's faces as PLY with label, organ and leaflet of each. */
PLM_API plm_status plm_virtual_plant_write(const char *path, const plm_virtual_plant *plant, plm_error *error);

/** The truth as JSON: metres, degrees, organ by organ, with the definitions. scan (may be NULL) says how it was scanned. */
PLM_API plm_status plm_truth_write(const char *path, const char *plant_id, const plm_virtual_plant *plant,
                                   const plm_scan *scan, plm_error *error);

/** One row of an index of plants. Strings are the caller's. */
typedef struct plm_truth_case {
    const char *plant_id, *file, *labelled, *truth, *kind;
    uint64_t seed;
    const plm_scan *scan; /**< NULL where the plant was not scanned */
} plm_truth_case;

/** Index of the plants of a run, as JSON: kind, mode, files, points by class. A scan's cloud is not looked at. */
PLM_API plm_status plm_truth_index_write(const char *path, const char *set, const plm_truth_case *cases, size_t count,
                                         plm_error *error);

/** Appends readings as of ruler, leaf area meter, protractor and calliper to text: truth plus a small reading error, rounded.
 * Rows plant_id,organ,organ_id,trait,value,unit; the caller writes the header. text (may be NULL before) is the caller's
 * (plm_free). */
PLM_API plm_status plm_manual_readings(const char *plant_id, const plm_virtual_plant *plant, uint64_t seed, char **text,
                                       plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
