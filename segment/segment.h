/* segment/segment.h: which point belongs to what: noise, ground and pot, stem, petioles, leaves.
 *
 * Knows cloud/ only. The functions are stages: each takes what the earlier ones found, and the plan (traits/) calls only
 * those that a scene needs. No parameter is in metres: scales come from the cloud itself, so clouds of any unit work.
 * Deterministic; rows may come in any order. */
#ifndef PLANTIMETER_SEGMENT_SEGMENT_H
#define PLANTIMETER_SEGMENT_SEGMENT_H

#include "../cloud/cloud.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum plm_up {
    PLM_UP_AUTO = 0,
    PLM_UP_X,
    PLM_UP_Y,
    PLM_UP_Z,
    PLM_UP_MINUS_X,
    PLM_UP_MINUS_Y,
    PLM_UP_MINUS_Z
} plm_up;

/** The direction of zenith in the cloud's own axes, and how it was found. */
typedef struct plm_frame {
    double rotation[3][3]; /**< rows are the plant's x, y and z (zenith) axes in the cloud's axes: proper rotation */
    plm_up up;             /**< the axis, PLM_UP_AUTO when zenith is none of the six */
    double confidence;     /**< 0 to 1; 1 when the caller said it */
    const char *evidence;  /**< "given", "ground", "posture", "default", ...: static text */
} plm_frame;

/** Finds zenith. up other than PLM_UP_AUTO is taken as it is. AUTO asks the ground (soil, pot, table), then how the plant
 * stands ("posture"), and settles on the nearest of the six axes, as files are nearly always axis-aligned: a tilted frame
 * would spoil every angle. Only ground that is tilted by more than 25 degrees against all axes gives another direction.
 * Where neither is clear, z ("default", confidence 0.3 at most): single leaves, some plants upside down. PLM_E_DEGENERATE
 * for an empty cloud. */
PLM_API plm_status plm_find_up(const plm_cloud *cloud, plm_up up, plm_frame *frame, plm_error *error);

/** Turns a cloud (coordinates, normals) into the frame, in place; the origin is turned too. */
PLM_API void plm_frame_apply(const plm_frame *frame, plm_cloud *cloud);

typedef enum plm_ground_mode { PLM_GROUND_AUTO = 0, PLM_GROUND_NONE, PLM_GROUND_HEIGHT } plm_ground_mode;

/** Ground, pot and table. Heights are z in the cloud's frame (origin added). */
typedef struct plm_ground {
    bool found;
    double soil_height; /**< the plane that the plant stands on: soil in the pot, or the table */
    bool has_pot;
    double rim_height;   /**< of the pot */
    double pot_diameter; /**< outer, at the rim */
    double pot_centre[2];
    bool has_table;
    double table_height;
} plm_ground;

/** Labels ground points. label (count of cloud, the caller's) gets PLM_LABEL_GROUND where a point is pot, soil or table;
 * other rows stay as they are. z is up. PLM_GROUND_HEIGHT: everything below height (z, origin added) is ground.
 * Uses rasters and, where the cloud has colour, colour; no neighbour index. */
PLM_API plm_status plm_find_ground(const plm_cloud *cloud, plm_ground_mode mode, double height, uint8_t *label,
                                   plm_ground *ground, plm_error *error);

/** Marks floaters and ghost points: keep[i] (count of cloud) is false for noise. Rows with label PLM_LABEL_GROUND
 * (label may be NULL) are neither judged nor counted. Learnt from virtual plants, see segment/ghosts.c; clouds of less
 * than 240 points lose none. spacing (may be NULL): out, the median distance of nearest neighbours in a copy of at most
 * about 80 000 points. */
PLM_API plm_status plm_clean(const plm_cloud *cloud, const uint8_t *label, bool *keep, double *spacing,
                             plm_error *error);

/** What kind of plant the cloud was taken for. */
typedef enum plm_habit {
    PLM_HABIT_UNKNOWN = 0,
    PLM_HABIT_SIMPLE,      /**< stem, petioles, simple leaves */
    PLM_HABIT_COMPOUND,    /**< stem, leaves of several leaflets */
    PLM_HABIT_STRAP,       /**< stem, strap leaves without petiole (maize) */
    PLM_HABIT_ROSETTE,     /**< no visible stem, petioles or leaves from the base */
    PLM_HABIT_HEAD,        /**< leaves without petioles around a short stem (lettuce) */
    PLM_HABIT_SINGLE_LEAF, /**< one blade */
    PLM_HABIT_BARE_STEM    /**< stem, no leaves */
} plm_habit;

/** "simple", "compound", ... Static storage. */
PLM_API const char *plm_habit_name(plm_habit habit);

enum {
    PLM_FLAG_LOW_DENSITY = 1 << 0,
    PLM_FLAG_TRUNCATED = 1 << 1,
    PLM_FLAG_MERGED_LEAF = 1 << 2,
    PLM_FLAG_ALPHA_SENSITIVE = 1 << 3,
    PLM_FLAG_COMPLETED = 1 << 4,
    PLM_FLAG_OCCLUDED = 1 << 5,
    PLM_FLAG_CURVED = 1 << 6,
    PLM_FLAG_UNCERTAIN = 1 << 7
};

typedef struct plm_segment_options {
    plm_habit habit;     /**< PLM_HABIT_UNKNOWN: guessed, and said */
    size_t point_budget; /**< structure is found on about so many points and carried to all; 0: default */
    uint64_t seed;
    const plm_deadline *deadline; /**< asked between the steps; NULL: none */
} plm_segment_options;

/** Labels and organ numbers of all points of a cloud. */
typedef struct plm_segmentation {
    size_t count;
    uint8_t *label; /**< plm_label */
    int32_t *organ; /**< number within its class, 0-based; -1: none. Petiole k carries leaf k. Leaves are numbered along
                           the stem from the base up, those of a head by the height of their feet */
    int32_t
        *leaflet; /**< of leaf points of compound leaves: number within the leaf, else -1; NULL when there are none */
    size_t stem_count, petiole_count, leaf_count; /**< a petiole that was not seen is absent, so counts may differ */
    uint32_t *leaf_flags;                         /**< leaf_count bit sets of PLM_FLAG_... */
    plm_habit habit;
    double scale;       /**< R, about three stem radii; 0 when the plant has no tubes */
    double stem_radius; /**< good for scales, not for the diameter trait */
    double spacing, noise;
    char warning[256]; /**< "" or what the user should know */
} plm_segmentation;

/** Labels stem, petioles and leaves of a plant, z up. label and keep are as plm_find_ground and plm_clean gave them
 * (either may be NULL). Ground stays ground, noise becomes other. The result is the caller's (plm_segmentation_free).
 * PLM_E_DEGENERATE: too few points for any structure. PLM_E_TIME: the deadline passed. */
PLM_API plm_status plm_segment(const plm_cloud *cloud, const uint8_t *label, const bool *keep,
                               const plm_segment_options *options, plm_segmentation *result, plm_error *error);

PLM_API void plm_segmentation_free(plm_segmentation *segmentation);

#ifdef __cplusplus
}
#endif
#endif
