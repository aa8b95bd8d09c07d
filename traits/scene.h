/* traits/scene.h: the plant as the trait functions see it. Internal. */
#ifndef PLANTIMETER_TRAITS_SCENE_H
#define PLANTIMETER_TRAITS_SCENE_H

#include "cloud/neighbours.h"
#include "cloud/sampling.h"
#include "traits/traits.h"

/** One organ: its points, copied out so that they lie together, and what was fitted to them. */
struct plm_organ {
    plm_label label;
    int32_t id;
    size_t count;
    float (*xyz)[3];  /* offsets from the scene's origin, metres, z up */
    uint32_t *row;    /* rows of scene->cloud */
    int32_t *leaflet; /* NULL where there are none */
    plm_index *index; /* over xyz; NULL below 12 points */
    plm_sampling sampling;
    double centroid[3];
    unsigned flags;           /* from segmentation: PLM_FLAG_... */
    plm_leaf_surface surface; /* leaves; empty where it was not asked for or failed */
    plm_status surface_status;
    char surface_reason[160];
    struct plm_axis *axis; /* stems and petioles: the fitted centre line and radius (traits/axis.h); NULL else */
    char axis_reason[160];
};

struct plm_scene {
    const plm_cloud *cloud; /* z up, metres, label and organ set */
    const plm_measure_options *options;
    const plm_ground *ground;
    plm_habit habit;
    bool is_splat, has_colour;
    plm_sampling sampling; /* of the whole plant */
    size_t plant_count;    /* points of the plant: not ground, not noise */
    float (*plant)[3];     /* their offsets */
    uint32_t *plant_row;
    size_t organ_count;
    plm_organ *organ; /* stems, then petioles, then leaves, each by number */
    plm_mesh hull;    /* of the plant */
    double hull_volume, hull_area;
};

/** The organ of a label and number, or NULL. */
const plm_organ *plm_scene_organ(const plm_scene *scene, plm_label label, int32_t id);

/** Fills out with a state and a printf-style reason; gives PLM_OK, so that a trait function can return it. */
plm_status plm_not_applicable(plm_estimate *out, const char *format, ...) PLM_PRINTF(2, 3);
plm_status plm_trait_failed(plm_estimate *out, const char *format, ...) PLM_PRINTF(2, 3);

#endif
