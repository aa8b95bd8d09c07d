/* traits/measure.c: one plant from cloud to values: the stages of the plan, one after the other. Each stage is a function
 * of the job; what a stage leaves out it tells the plan. */
#include "cloud/clock.h"
#include "traits/axis.h"
#include "traits/evaluate.h"
#include "traits/plan.h"
#include "traits/work.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** All that the stages share. The measurement is a draft until the end. */
typedef struct plant_job {
    const plm_measure_options *options;
    plm_measurement *draft;
    bool *chosen;     /* rows of the trait table */
    bool has_labels;  /* the cloud came with labels */
    plm_work work;    /* a copy of the draft's cloud: thinned, in canonical order */
    plm_cloud *cloud; /* what the stages work on: the copy, where there is one, or the draft's cloud */
    uint8_t *label;   /* ground by plm_find_ground: of cloud's points; NULL where labels came with the cloud */
    bool *keep;       /* by plm_clean; NULL: all */
    plm_segmentation segmentation; /* of cloud's points; moves to the draft in the caller's order */
    plm_scene scene;
} plant_job;

/* A warning that cannot be kept for want of memory is a failure like any other. */
static plm_status warn(plant_job *job, plm_error *error, const char *format, ...) PLM_PRINTF(3, 4);
static plm_status warn(plant_job *job, plm_error *error, const char *format, ...)
{
    plm_measurement *draft = job->draft;
    void *grown = plm_realloc(draft->warning, draft->warning_count + 1, sizeof *draft->warning, error);
    if (!grown) return PLM_E_MEMORY;
    draft->warning = grown;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(draft->warning[draft->warning_count++], sizeof *draft->warning, format, arguments);
    va_end(arguments);
    return PLM_OK;
}

/* ---- Stages ---------------------------------------------------------------------------------------------------- */

static plm_status run_frame(plant_job *job, plm_error *error)
{
    plm_measurement *draft = job->draft;
    const plm_status status = plm_find_up(&draft->cloud, job->options->up, &draft->frame, error);
    if (status == PLM_OK) plm_frame_apply(&draft->frame, &draft->cloud);
    return status;
}

/* Whether any of the labels that came with the cloud is ground. */
static bool has_labelled_ground(const plm_cloud *cloud)
{
    for (size_t i = 0; i < cloud->count; i++)
        if (cloud->label[i] == PLM_LABEL_GROUND) return true;
    return false;
}

/* Labels that came with the cloud say what is ground; only its heights are looked for then, and only where some is. */
static plm_status run_ground(plant_job *job, plm_error *error)
{
    const plm_measure_options *options = job->options;
    if (job->has_labels && options->ground == PLM_GROUND_AUTO && !has_labelled_ground(job->cloud)) {
        plm_plan_leave_out(&job->draft->plan, PLM_STAGE_GROUND, "left out: the labels name no ground");
        return PLM_OK;
    }
    uint8_t *label = plm_alloc_zero(job->cloud->count, sizeof *label, error);
    if (!label) return PLM_E_MEMORY;
    const plm_status status =
        plm_find_ground(job->cloud, options->ground, options->ground_height, label, &job->draft->ground, error);
    if (status == PLM_OK && !job->has_labels)
        job->label = label;
    else
        plm_free(label);
    return status;
}

static plm_status run_clean(plant_job *job, plm_error *error)
{
    job->keep = plm_alloc(job->cloud->count, sizeof *job->keep, error);
    return job->keep ? plm_clean(job->cloud, job->label, job->keep, NULL, error) : PLM_E_MEMORY;
}

/* The rows that the trait functions call the plant: by the labels that came with the cloud, else all that is neither
 * ground nor noise. What segmenting calls other stays in: heights and hulls must not depend on whether leaves were
 * asked for as well. */
static plm_status gather_plant(plant_job *job, plm_error *error)
{
    const plm_cloud *cloud = job->cloud;
    bool *is_plant = plm_alloc(cloud->count, sizeof *is_plant, error);
    if (!is_plant) return PLM_E_MEMORY;
    for (size_t i = 0; i < cloud->count; i++) {
        if (job->has_labels)
            is_plant[i] = cloud->label[i] >= PLM_LABEL_STEM && cloud->label[i] <= PLM_LABEL_LEAF;
        else
            is_plant[i] = (!job->label || job->label[i] != PLM_LABEL_GROUND) && (!job->keep || job->keep[i]);
    }
    job->scene.cloud = cloud;
    job->scene.options = job->options;
    job->scene.ground = &job->draft->ground;
    job->scene.labels_given = job->has_labels;
    const plm_status status = plm_scene_gather(&job->scene, is_plant, error);
    plm_free(is_plant);
    return status;
}

static plm_status run_hull(plant_job *job, plm_error *error)
{
    const plm_status status = plm_scene_hull(&job->scene, error);
    job->draft->hull = job->scene.hull; /* the traits need its numbers only */
    job->scene.hull = (plm_mesh){0};
    for (int axis = 0; axis < 3; axis++) job->draft->hull.origin[axis] += job->cloud->origin[axis];
    return status;
}

static plm_status run_smoothness(plant_job *job, plm_error *error)
{
    return plm_scene_smoothness(&job->scene, error);
}

static plm_status run_index(plant_job *job, plm_error *error)
{
    return plm_scene_index(&job->scene, error);
}

/* A plant that cannot be cut into organs still has a height. */
static plm_status run_segment(plant_job *job, plm_error *error)
{
    const plm_segment_options options = {.habit = job->options->habit, .seed = job->options->seed};
    plm_error trouble = {0};
    const plm_status status = plm_segment(job->cloud, job->label, job->keep, &options, &job->segmentation, &trouble);
    if (status == PLM_E_DEGENERATE) {
        snprintf(job->scene.organ_reason, sizeof job->scene.organ_reason, "%.150s", trouble.message);
        return PLM_OK;
    }
    if (status != PLM_OK) return plm_fail(error, status, "%s", trouble.message);
    return job->segmentation.warning[0] ? warn(job, error, "%s", job->segmentation.warning) : PLM_OK;
}

/* Labels that came with the cloud, as if they had been found. */
static plm_status take_labels(plant_job *job, plm_error *error)
{
    const plm_cloud *cloud = job->cloud;
    plm_segmentation *made = &job->segmentation;
    made->label = plm_alloc(cloud->count, sizeof *made->label, error);
    made->organ = made->label ? plm_alloc(cloud->count, sizeof *made->organ, error) : NULL;
    if (!made->organ) return PLM_E_MEMORY;
    made->count = cloud->count;
    made->habit = job->options->habit;
    for (size_t i = 0; i < cloud->count; i++) {
        made->label[i] = cloud->label[i] < PLM_LABEL_COUNT ? cloud->label[i] : PLM_LABEL_OTHER;
        made->organ[i] = cloud->organ ? cloud->organ[i] : 0;
    }
    if (cloud->organ) return PLM_OK;
    return warn(job, error,
                "the labels come without organ numbers (a field \"organ\"): all points of a class count as one organ");
}

static plm_status run_organs(plant_job *job, plm_error *error)
{
    plm_status status = job->has_labels ? take_labels(job, error) : PLM_OK;
    if (status != PLM_OK || !job->segmentation.label) return status;
    const bool with_index = job->draft->plan.needs & (PLM_NEEDS_SURFACE | PLM_NEEDS_AXIS);
    status = plm_scene_organs(&job->scene, &job->segmentation, with_index, error);
    size_t count[PLM_LABEL_COUNT] = {0};
    for (size_t i = 0; i < job->scene.organ_count; i++) count[job->scene.organ[i].label]++;
    job->segmentation.stem_count = count[PLM_LABEL_STEM];
    job->segmentation.petiole_count = count[PLM_LABEL_PETIOLE];
    job->segmentation.leaf_count = count[PLM_LABEL_LEAF];
    return status;
}

static plm_status run_surfaces(plant_job *job, plm_error *error)
{
    const plm_status status = plm_scene_surfaces(&job->scene, error);
    return status == PLM_OK ? plm_scene_leaf_mesh(&job->scene, &job->draft->leaves, error) : status;
}

static plm_status run_axes(plant_job *job, plm_error *error)
{
    return plm_scene_fit_axes(&job->scene, error);
}

static plm_status run_light(plant_job *job, plm_error *error)
{
    return plm_scene_light(&job->scene, error);
}

static plm_status run_traits(plant_job *job, plm_error *error)
{
    return plm_evaluate(&job->scene, job->chosen, &job->draft->value, &job->draft->value_count, error);
}

/* ---- Running them ---------------------------------------------------------------------------------------------- */

static plm_status (*const run[PLM_STAGE_COUNT])(plant_job *job, plm_error *error) = {
    [PLM_STAGE_GROUND] = run_ground,     [PLM_STAGE_CLEAN] = run_clean,     [PLM_STAGE_FRAME] = run_frame,
    [PLM_STAGE_INDEX] = run_index,       [PLM_STAGE_SEGMENT] = run_segment, [PLM_STAGE_ORGANS] = run_organs,
    [PLM_STAGE_SURFACES] = run_surfaces, [PLM_STAGE_HULL] = run_hull,       [PLM_STAGE_SMOOTHNESS] = run_smoothness,
    [PLM_STAGE_AXES] = run_axes,         [PLM_STAGE_LIGHT] = run_light,     [PLM_STAGE_TRAITS] = run_traits,
};

static plm_status run_stage(plant_job *job, plm_stage_id id, plm_error *error)
{
    plm_stage *stage = &job->draft->plan.stage[id];
    if (!stage->runs || !run[id]) return PLM_OK;
    if (job->options->progress) job->options->progress(stage->name, job->options->progress_user);
    const double begin = plm_seconds_now();
    const plm_status status = run[id](job, error);
    if (stage->runs) stage->seconds = plm_seconds_now() - begin; /* it may have found that there is nothing to do */
    stage->peak_bytes = plm_peak_bytes();
    return status;
}

/* From here on the stages see the points in canonical order, where any of them looks at neighbours, and of large clouds as
 * many as the effort affords. */
static plm_status choose_points(plant_job *job, plm_error *error)
{
    plm_measurement *draft = job->draft;
    const bool in_order = draft->plan.stage[PLM_STAGE_INDEX].runs;
    const plm_status status = plm_work_make(&draft->cloud, plm_point_budget(job->options), in_order, &job->work, error);
    job->cloud = job->work.row ? &job->work.cloud : &draft->cloud;
    draft->used_points = job->work.count;
    return status;
}

static plm_status run_stages(plant_job *job, plm_error *error)
{
    plm_status status = run_stage(job, PLM_STAGE_FRAME, error);
    if (status == PLM_OK) status = choose_points(job, error);
    for (int id = PLM_STAGE_GROUND; id < PLM_STAGE_COUNT && status == PLM_OK; id++) {
        if (id == PLM_STAGE_INDEX) status = gather_plant(job, error);
        if (status == PLM_OK) status = run_stage(job, (plm_stage_id)id, error);
    }
    return status;
}

/* ---- The measurement ------------------------------------------------------------------------------------------- */

/* Centroids in the frame of the cloud that was handed in. */
static void turn_centroids_back(plm_measurement *draft)
{
    for (size_t i = 0; i < draft->value_count; i++) {
        const double *turned = draft->value[i].centroid;
        double original[3] = {0};
        for (int axis = 0; axis < 3; axis++)
            for (int k = 0; k < 3; k++) original[axis] += draft->frame.rotation[k][axis] * turned[k];
        memcpy(draft->value[i].centroid, original, sizeof original);
    }
}

static void free_job(plant_job *job)
{
    plm_scene_free(&job->scene);
    plm_segmentation_free(&job->segmentation);
    plm_free(job->keep);
    plm_free(job->label);
    plm_free(job->chosen);
    plm_work_free(&job->work);
}

/* Readers drop what is no number; a program that hands over a cloud may not have. */
static plm_status check_points(const plm_cloud *cloud, plm_error *error)
{
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "the cloud has no points");
    for (size_t i = 0; i < cloud->count; i++) {
        const float *at = cloud->xyz[i];
        if (isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2])) continue;
        return plm_fail(error, PLM_E_ARGUMENT, "point %zu of the cloud is (%g, %g, %g); coordinates must be finite", i,
                        (double)at[0], (double)at[1], (double)at[2]);
    }
    return PLM_OK;
}

plm_status plm_measure(plm_cloud *cloud, const plm_measure_options *options, plm_measurement *measurement,
                       plm_error *error)
{
    plm_measurement draft = {.cloud = *cloud};
    plant_job job = {.options = options, .draft = &draft, .has_labels = cloud->label != NULL};
    *cloud = (plm_cloud){0};
    size_t trait_count;
    plm_traits(&trait_count);
    plm_status status = check_points(&draft.cloud, error);
    if (status == PLM_OK) status = plm_plan_make(options, plm_cloud_attributes(&draft.cloud), &draft.plan, error);
    if (status == PLM_OK && !(job.chosen = plm_alloc(trait_count, sizeof *job.chosen, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_trait_choose(options->traits, job.chosen, error);
    if (status == PLM_OK) status = run_stages(&job, error);
    if (status == PLM_OK && job.segmentation.label)
        status = plm_work_give_labels(&job.work, &job.segmentation, &draft.cloud, &draft.segmentation, error);
    free_job(&job);
    if (status == PLM_OK) {
        turn_centroids_back(&draft);
        *measurement = draft;
    } else {
        plm_measurement_free(&draft);
    }
    return status;
}

void plm_measurement_free(plm_measurement *measurement)
{
    if (!measurement) return;
    plm_free(measurement->value);
    plm_free(measurement->warning);
    plm_segmentation_free(&measurement->segmentation);
    plm_cloud_free(&measurement->cloud);
    plm_mesh_free(&measurement->leaves);
    plm_mesh_free(&measurement->hull);
    *measurement = (plm_measurement){0};
}
