/* traits/traits.h: the trait table, the plan, and measuring a plant.
 *
 * Joins cloud/, segment/ and mesh/. A trait is one row of a table; the CSV, the plan, the help text and docs/traits.md
 * follow from it. Traits depend on the points and on their labels only, so a cloud labelled by hand and one labelled by
 * the program are measured alike. */
#ifndef PLANTIMETER_TRAITS_TRAITS_H
#define PLANTIMETER_TRAITS_TRAITS_H

#include "../cloud/cloud.h"
#include "../mesh/mesh.h"
#include "../segment/segment.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum plm_level { PLM_PLANT = 0, PLM_STEM, PLM_PETIOLE, PLM_LEAF, PLM_LEVEL_COUNT } plm_level;

/** "plant", "stem", "petiole" or "leaf". */
PLM_API const char *plm_level_name(plm_level level);

/** Unit of a report. Values inside are SI; factor turns them into the unit. */
typedef enum plm_unit {
    PLM_MILLIMETRE = 0,
    PLM_SQUARE_CM,
    PLM_CUBIC_CM,
    PLM_DEGREE,
    PLM_NUMBER,
    PLM_WATT,
    PLM_UNIT_COUNT
} plm_unit;

/** "mm", "cm2", "cm3", "deg", "1" or "W". */
PLM_API const char *plm_unit_name(plm_unit unit);
/** What an SI value is multiplied by to be in the unit: 1000, 1e4, 1e6, 180 / pi, 1 or 1. */
PLM_API double plm_unit_factor(plm_unit unit);

/** Stages that a trait needs, and how; the plan runs no other. */
enum {
    PLM_NEEDS_ZENITH = 1 << 0,
    PLM_NEEDS_GROUND = 1 << 1,  /**< ground set apart */
    PLM_NEEDS_CLEAN = 1 << 2,   /**< floaters dropped */
    PLM_NEEDS_ORGANS = 1 << 3,  /**< labels: from the file or from segmentation */
    PLM_NEEDS_SURFACE = 1 << 4, /**< leaf surfaces */
    PLM_NEEDS_AXIS = 1 << 5,    /**< fitted axes of stems and petioles */
    PLM_NEEDS_HULL = 1 << 6,
    PLM_NEEDS_NEIGHBOURS = 1 << 7, /**< the fused neighbour pass */
    PLM_NEEDS_COLOUR = 1 << 8,
    PLM_NEEDS_SAMPLING = 1 << 9, /**< spacing and noise of the plant */
    PLM_NEEDS_LIGHT = 1 << 10,   /**< absorbed light of the surfaces */
    PLM_NEEDS_BASE = 1 << 11,    /**< axes, where the plant is so low that its leaves may hide its lowest surface */
    /** No stage: points alone tell the trait where the plant can't be cut into organs (not: for want of time). */
    PLM_NEEDS_NO_ORGANS = 1 << 12
};

typedef enum plm_state { PLM_STATE_OK = 0, PLM_STATE_NOT_APPLICABLE, PLM_STATE_FAILED } plm_state;

/** What became of the iterative fit behind an estimate. */
typedef struct plm_fit_note {
    int step_count; /**< 0: no such fit */
    double
        condition; /**< of the normal matrix with unit diagonal: large where the points leave parameters undetermined */
    const char *end; /**< why it ended: static text */
} plm_fit_note;

/** One measured value. SI. */
typedef struct plm_estimate {
    double value;
    double std_error;   /**< NAN where it has no meaning (counts): written as an empty field */
    size_t point_count; /**< points that the value rests on */
    plm_state state;
    unsigned flags;     /**< PLM_FLAG_... of segment.h */
    const char *method; /**< how: static text, "tube fit", "alpha shape", ... */
    plm_fit_note fit;
    char reason[160]; /**< why it is not_applicable or failed, and what to change */
} plm_estimate;

typedef struct plm_scene plm_scene; /* traits/scene.h: the plant as the trait functions see it */
typedef struct plm_organ plm_organ;

/** One row of the trait table. */
typedef struct plm_trait {
    const char *name;
    plm_level level;
    plm_unit unit;
    unsigned needs;
    /** Fills out; organ is NULL for plant-level traits. A value that the scene cannot give is not an error but a state
     * with a reason; a status other than PLM_OK (memory, library) ends the plant. */
    plm_status (*measure)(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error);
    const char *definition;
    const char *source;   /**< paper and equation, or peer */
    const char *ontology; /**< Trait Ontology term, "" where there is none */
    bool on_request;      /**< costs much: measured only where it is asked for by its name */
} plm_trait;

/** The table: count rows, in the order of the reports. Static storage. */
PLM_API const plm_trait *plm_traits(size_t *count);

/** The row of a name, or NULL. */
PLM_API const plm_trait *plm_trait_find(const char *name);

/** Power that the faces of a mesh absorb, in watts: of each group of faces (face_group[f] is the group of triangle f, below
 * group_count) and of all, with standard errors. z is up. Given by whoever has a ray tracer; none is known here. */
typedef plm_status plm_light_function(const plm_mesh *mesh, const int32_t *face_group, size_t group_count,
                                      uint64_t seed, double *group_power, double *group_std_error, double *power,
                                      double *std_error, plm_error *error);

/** How much of a large cloud is looked at: about 50 000 points, 200 000, or 400 000 (docs/tradeoff.md: more made nothing better,
 * spacings far below the noise say nothing new). What is left out is random. */
typedef enum plm_effort { PLM_EFFORT_FAST = 0, PLM_EFFORT_BALANCED, PLM_EFFORT_PRECISE } plm_effort;

/** Options of a measurement. Fill with plm_measure_defaults first. */
typedef struct plm_measure_options {
    const char *traits; /**< comma-separated names; NULL: all but those that are on request */
    plm_up up;
    plm_ground_mode ground;
    double ground_height; /**< z in metres, with PLM_GROUND_HEIGHT */
    double stem_height;   /**< metres along the stem from its base (branches: from the branching point) to where the
                               diameter is taken */
    int neighbours;       /**< of the smoothness factor */
    double alpha;         /**< leaf surface, metres; 0: found out */
    plm_effort effort;
    size_t points; /**< look at about so many points; 0: by effort */
    plm_habit habit;
    uint64_t seed;
    bool is_splat;             /**< the cloud holds gaussians (extent is set) */
    plm_light_function *light; /**< for absorbed_radiation; NULL: it is not applicable */
    /** What has not ended by then is given up, and the values that needed it fail with the reason "time budget"; NULL: none. */
    const plm_deadline *deadline;
    /** Called at the start of each stage; NULL: no talk. */
    void (*progress)(const char *stage, void *user);
    void *progress_user;
} plm_measure_options;

PLM_API void plm_measure_defaults(plm_measure_options *options);

/** A stage of the plan, and what became of it. */
typedef struct plm_stage {
    const char *name;
    bool runs;
    char why[160]; /**< which traits need it, or why it is left out */
    double seconds;
    double processor_seconds; /**< of all threads */
    uint64_t peak_bytes;      /**< peak resident memory of the process after the stage */
} plm_stage;

enum { PLM_STAGE_MAXIMUM = 16 };

typedef struct plm_plan {
    size_t stage_count;
    plm_stage stage[PLM_STAGE_MAXIMUM];
    unsigned needs; /**< PLM_NEEDS_... that run */
} plm_plan;

/** Works out what will run for the options and for what the cloud has (attributes: bit set of plm_attribute).
 * PLM_E_ARGUMENT  an unknown trait; the message names the nearest one. */
PLM_API plm_status plm_plan_make(const plm_measure_options *options, unsigned attributes, plm_plan *plan,
                                 plm_error *error);

/* ---- The unit of a file ----------------------------------------------------------------------------------------- */

/** How many metres the unit of a file is, and how that is known. */
typedef struct plm_unit_scale {
    double metres_per_unit;
    const char *unit;   /**< "m", "cm", "mm", "?": static text */
    bool is_doubtful;   /**< the size is none that a plant has in metres: the user should be told evidence */
    char evidence[192]; /**< in words */
} plm_unit_scale;

/** Guesses the unit: metres where the size is one that plants have, else millimetres or centimetres by the spacing of
 * the points. PLM_E_DEGENERATE for an empty cloud. */
PLM_API plm_status plm_scale_guess(const plm_cloud *cloud, plm_unit_scale *scale, plm_error *error);

/** The scale from two points of the file, in its unit, whose distance in metres is known. PLM_E_ARGUMENT. */
PLM_API plm_status plm_scale_of_length(const double a[3], const double b[3], double metres, plm_unit_scale *scale,
                                       plm_error *error);

/** The scale from the outer diameter of the pot's rim, metres. up: as in plm_find_up.
 * PLM_E_DEGENERATE  no pot is found. */
PLM_API plm_status plm_scale_of_pot(const plm_cloud *cloud, plm_up up, double diameter, plm_unit_scale *scale,
                                    plm_error *error);

/** Multiplies coordinates, origin and extents by factor, in place. */
PLM_API void plm_cloud_rescale(plm_cloud *cloud, double factor);

/* ---- Measuring --------------------------------------------------------------------------------------------------- */

/** One row of traits.csv. */
typedef struct plm_trait_value {
    const plm_trait *trait;
    int32_t organ_id;   /**< -1 at plant level */
    double centroid[3]; /**< of the organ's points, metres, in the frame of the cloud that was handed in */
    plm_estimate estimate;
} plm_trait_value;

/** All that a measurement gives. The caller's: plm_measurement_free. */
typedef struct plm_measurement {
    size_t value_count;
    plm_trait_value *value;
    plm_cloud cloud;    /**< the cloud in the plant's frame (z up), all points, with label and organ */
    size_t used_points; /**< points that were looked at; fewer than the cloud's where effort thins it */
    plm_segmentation segmentation;
    plm_frame frame;
    plm_ground ground;
    plm_plan plan;
    plm_mesh leaves; /**< all leaf surfaces, face_organ is the leaf's number; empty when not asked for */
    plm_mesh hull;   /**< empty when not asked for */
    size_t warning_count;
    char (*warning)[256];
} plm_measurement;

/** Measures one plant. cloud: metres, any up axis; labels in it (label not NULL) are used instead of segmenting. It is
 * taken over: the call leaves it empty and the measurement owns its points, turned to z up.
 * PLM_E_DEGENERATE  an empty cloud; everything short of that gives traits with reasons.
 * PLM_E_ARGUMENT    a coordinate that is NaN or infinite, an unknown trait. */
PLM_API plm_status plm_measure(plm_cloud *cloud, const plm_measure_options *options, plm_measurement *measurement,
                               plm_error *error);

PLM_API void plm_measurement_free(plm_measurement *measurement);

#ifdef __cplusplus
}
#endif
#endif
