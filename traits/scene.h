/* traits/scene.h: the plant as the trait functions see it. Internal. */
#ifndef PLANTIMETER_TRAITS_SCENE_H
#define PLANTIMETER_TRAITS_SCENE_H

#include "cloud/neighbours.h"
#include "cloud/sampling.h"
#include "traits/traits.h"

/** One organ: its points, copied out so that they lie together, and what was fitted to them. Points come in the
 * canonical order of cloud/spatial_order.h, so that an estimator which takes every n-th of them does not depend on the
 * order of the file's rows. */
struct plm_organ {
    plm_label label;
    int32_t id;
    size_t count;
    float (*xyz)[3];          /* offsets from scene->cloud->origin, metres, z up */
    uint32_t *row;            /* rows of scene->cloud */
    int32_t *leaflet;         /* NULL where there are none */
    plm_index *index;         /* over xyz; NULL below 12 points, and where no trait asks for surfaces or axes */
    plm_sampling sampling;    /* as index: else zero */
    double centroid[3];       /* offset as xyz */
    unsigned flags;           /* from segmentation: PLM_FLAG_... */
    plm_leaf_surface surface; /* leaves; empty where it was not asked for or failed */
    plm_status surface_status;
    char surface_reason[160];
    struct plm_midrib *midrib; /* leaves with a surface (traits/leaf_midrib.h); NULL where it has no petiole or stem */
    struct plm_axis *axis;     /* stems and petioles: the fitted centre line and radius (traits/axis.h); NULL else */
    char axis_reason[160];
    double absorbed, absorbed_error; /* W; zero where it was not asked for */
};

struct plm_scene {
    const plm_cloud *cloud; /* z up, metres, canonical order where an index is built; label and organ set where they
                               are known */
    const plm_measure_options *options;
    const plm_ground *ground;
    const uint8_t *ground_label; /* of cloud's points: PLM_LABEL_GROUND is ground; NULL where none was looked for */
    plm_habit habit;
    bool is_splat, has_colour;
    bool labels_given;  /* with the cloud: organs end where they say. Else they were found, and their ends are unsure */
    size_t plant_count; /* points of the plant: not ground, not noise */
    float (*plant)[3];  /* their offsets */
    uint32_t *plant_row;    /* rows of cloud */
    plm_index *plant_index; /* over plant; NULL below 12 points, and where no trait needs neighbours, organs or hull: a
                               height alone builds none but of a low plant, and must find its own scales in the bands
                               that it reads */
    plm_sampling sampling;  /* of the plant, as plant_index: else zero (but extent) */
    char organ_reason[160]; /* why the plant was not cut into organs; "" where it was */
    size_t organ_count;
    plm_organ *organ;              /* stems, then petioles, then leaves, each by number */
    plm_mesh hull;                 /* of the plant */
    double hull_volume, hull_area; /* corrected for sampling and noise */
    double hull_volume_error, hull_area_error;
    bool hull_is_sheet; /* too thin against the noise for a volume */
    const char *hull_method;
    double smoothness_mean, smoothness_sd, boundary_share; /* NAN where not measured */
    double absorbed, absorbed_error;                       /* W */
    char light_reason[160];                                /* why there is no light; "" where there is */
    unsigned late;                                         /* PLM_NEEDS_... that there was no time for */
    plm_status hull_status;
    char hull_reason[160];
};

/** The organ of a label and number, or NULL. */
const plm_organ *plm_scene_organ(const plm_scene *scene, plm_label label, int32_t id);

/** Fills out with a state and a printf-style reason; gives PLM_OK, so that a trait function can return it. */
plm_status plm_not_applicable(plm_estimate *out, const char *format, ...) PLM_PRINTF(2, 3);
plm_status plm_trait_failed(plm_estimate *out, const char *format, ...) PLM_PRINTF(2, 3);

/* ---- Building it: one function a stage, called by traits/measure.c ------------------------------------------- */

/** Gathers the plant's points: rows of cloud for which is_plant is true. cloud, options and ground must be set. */
plm_status plm_scene_gather(plm_scene *scene, const bool *is_plant, plm_error *error);

/** Builds plant_index and measures sampling. */
plm_status plm_scene_index(plm_scene *scene, plm_error *error);

/** Copies out the organs that the segmentation (of scene->cloud's rows) names. with_index: index and sampling too. */
plm_status plm_scene_organs(plm_scene *scene, const plm_segmentation *segmentation, bool with_index, plm_error *error);

/** Makes the surfaces and midribs of all leaves; a leaf that has none says why in surface_reason. Parallel over leaves. */
plm_status plm_scene_surfaces(plm_scene *scene, plm_error *error);

/** Measures the hull (traits/plant_hull.c) and the smoothness factors (traits/plant_smoothness.c) of the plant. What the points
 * do not determine is left for the traits to tell. */
plm_status plm_scene_hull(plm_scene *scene, plm_error *error);
plm_status plm_scene_smoothness(plm_scene *scene, plm_error *error);

/** Lights the leaf surfaces, and stems and petioles as tubes (traits/plant_light.c). */
plm_status plm_scene_light(plm_scene *scene, plm_error *error);

void plm_scene_free(plm_scene *scene);

#endif
