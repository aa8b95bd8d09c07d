/* traits/pass.c: one pass: the stages of the plan, one after the other. Each stage is a function of the job; what a stage
 * leaves out it tells the plan. */
#include "traits/pass.h"

#include "cloud/clock.h"
#include "segment/sparse_tips.h"
#include "traits/axis.h"
#include "traits/evaluate.h"
#include "traits/plan.h"
#include "traits/plant_mesh.h"
#include "traits/rosette_base.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/** All that the stages share. */
typedef struct plant_job {
    const plm_measure_options *options; /* with the deadline of the stages */
    plm_measure_options stage_options;
    double end;                  /* of the pass's deadline */
    plm_deadline stage_deadline; /* that of the pass, less the last stage's time */
    const bool *chosen;
    plm_pace *pace;
    plm_pass *pass;
    plm_measurement *draft; /* the pass's */
    bool has_labels;        /* the cloud came with labels */
    plm_cloud *cloud;       /* the pass's copy of points */
    uint8_t *label;         /* ground by plm_find_ground: of cloud's points; NULL where labels came with the cloud */
    bool *keep, *tip;       /* by plm_clean_but_tips; NULL: all, none */
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
    const plm_status status = plm_find_up(job->cloud, job->options->up, &draft->frame, error);
    if (status == PLM_OK) plm_frame_apply(&draft->frame, job->cloud);
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
    job->tip = plm_alloc(job->cloud->count, sizeof *job->tip, error);
    if (!job->keep || !job->tip) return PLM_E_MEMORY;
    return plm_clean_but_tips(job->cloud, job->label, job->keep, job->tip, NULL, error);
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
            is_plant[i] =
                (!job->label || job->label[i] != PLM_LABEL_GROUND) && (!job->keep || job->keep[i] || job->tip[i]);
    }
    job->scene.cloud = cloud;
    job->scene.options = job->options;
    job->scene.ground = &job->draft->ground;
    job->scene.ground_label = job->has_labels ? cloud->label : job->label;
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
    const plm_segment_options options = {
        .habit = job->options->habit, .seed = job->options->seed, .deadline = job->options->deadline};
    plm_error trouble = {0};
    const plm_status status =
        plm_segment(job->cloud, job->label, job->keep, &options, &job->pass->segmentation, &trouble);
    if (status == PLM_E_DEGENERATE) {
        snprintf(job->scene.organ_reason, sizeof job->scene.organ_reason, "%.150s", trouble.message);
        return PLM_OK;
    }
    if (status != PLM_OK) return plm_fail(error, status, "%s", trouble.message);
    if (job->keep) {
        const plm_status tips = plm_label_tips(job->cloud, job->keep, job->tip, &job->pass->segmentation, error);
        if (tips != PLM_OK) return tips;
    }
    return job->pass->segmentation.warning[0] ? warn(job, error, "%s", job->pass->segmentation.warning) : PLM_OK;
}

/* Labels that came with the cloud, as if they had been found. */
static plm_status take_labels(plant_job *job, plm_error *error)
{
    const plm_cloud *cloud = job->cloud;
    plm_segmentation *made = &job->pass->segmentation;
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
    if (status != PLM_OK || !job->pass->segmentation.label) return status;
    const bool with_index = job->draft->plan.needs & (PLM_NEEDS_SURFACE | PLM_NEEDS_AXIS);
    status = plm_scene_organs(&job->scene, &job->pass->segmentation, with_index, error);
    size_t count[PLM_LABEL_COUNT] = {0};
    for (size_t i = 0; i < job->scene.organ_count; i++) count[job->scene.organ[i].label]++;
    job->pass->segmentation.stem_count = count[PLM_LABEL_STEM];
    job->pass->segmentation.petiole_count = count[PLM_LABEL_PETIOLE];
    job->pass->segmentation.leaf_count = count[PLM_LABEL_LEAF];
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
    job->scene.late = job->pass->late;
    return plm_evaluate(&job->scene, job->chosen, &job->draft->value, &job->draft->value_count, job->pass->late_in,
                        error);
}

/* ---- Running them ---------------------------------------------------------------------------------------------- */

static plm_status (*const run[PLM_STAGE_COUNT])(plant_job *job, plm_error *error) = {
    [PLM_STAGE_GROUND] = run_ground,     [PLM_STAGE_CLEAN] = run_clean,     [PLM_STAGE_FRAME] = run_frame,
    [PLM_STAGE_INDEX] = run_index,       [PLM_STAGE_SEGMENT] = run_segment, [PLM_STAGE_ORGANS] = run_organs,
    [PLM_STAGE_SURFACES] = run_surfaces, [PLM_STAGE_HULL] = run_hull,       [PLM_STAGE_SMOOTHNESS] = run_smoothness,
    [PLM_STAGE_AXES] = run_axes,         [PLM_STAGE_LIGHT] = run_light,     [PLM_STAGE_TRAITS] = run_traits,
};

/* ---- Time ------------------------------------------------------------------------------------------------------ */

/* What the stage would have given is missing, and why. */
static void give_up(plant_job *job, plm_stage_id id, const char *why)
{
    plm_plan_leave_out(&job->draft->plan, id, "left out: time budget: %s", why);
    job->pass->late |= plm_stage_needs(id);
}

/* When the stages before the last must have ended. */
static double stage_end(const plant_job *job)
{
    const double last = job->pace ? plm_pace_predict(job->pace, PLM_STAGE_TRAITS, job->cloud->count) : 0;
    return job->end - last;
}

/* Whether a stage must be left out: others that it rests on were, or it would not end in time. The last stage always runs: it
 * writes the rows, also of what there was no time for. */
static bool is_late(plant_job *job, plm_stage_id id)
{
    const plm_deadline *deadline = job->options->deadline;
    if (!deadline || id == PLM_STAGE_TRAITS) return false;
    if (plm_needs_closure(plm_stage_needs(id)) & job->pass->late) {
        give_up(job, id, "what it rests on was left out");
    } else {
        const double left = stage_end(job) - plm_deadline_now(deadline);
        const double predicted = job->pace ? plm_pace_predict(job->pace, (int)id, job->cloud->count) : 0;
        char why[80];
        if (predicted <= left) return false;
        snprintf(why, sizeof why, "it takes about %.2g s, %.2g s are left", predicted, left > 0 ? left : 0);
        give_up(job, id, why);
    }
    return true;
}

/* ---- The stages in turn ---------------------------------------------------------------------------------------- */

/* Of all threads; where plants are measured side by side, of this one, which does all of the plant's work. */
static double processor_now(void)
{
    struct timespec used;
    clock_gettime(omp_in_parallel() ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &used);
    return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}

static plm_status run_stage(plant_job *job, plm_stage_id id, plm_error *error)
{
    plm_stage *stage = &job->draft->plan.stage[id];
    if (!stage->runs || !run[id] || is_late(job, id)) return PLM_OK;
    if (job->options->progress) job->options->progress(stage->name, job->options->progress_user);
    if (job->options->deadline) job->stage_deadline.at = id == PLM_STAGE_TRAITS ? job->end : stage_end(job);
    const double begin = plm_deadline_now(job->options->deadline), processor_begin = processor_now();
    const plm_status status = run[id](job, error);
    const double seconds = plm_deadline_now(job->options->deadline) - begin;
    stage->peak_bytes = plm_peak_bytes();
    if (status == PLM_E_TIME) give_up(job, id, "it did not end in time");
    if (stage->runs || status == PLM_E_TIME) { /* it may have found that there is nothing to do */
        stage->seconds = seconds;
        stage->processor_seconds = processor_now() - processor_begin;
    }
    if (status == PLM_OK && stage->runs && job->pace) plm_pace_note(job->pace, (int)id, job->cloud->count, seconds);
    return status == PLM_E_TIME ? PLM_OK : status;
}

/* Whether the plant may be a rosette is seen only now: heights then need axes. Within a time budget they are told without. */
static void widen_plan(plant_job *job)
{
    plm_plan *plan = &job->draft->plan;
    if (plan->needs & PLM_NEEDS_BASE && !job->options->deadline && plm_may_be_rosette(&job->scene))
        plm_plan_widen(plan, PLM_NEEDS_AXIS, plm_cloud_attributes(job->cloud), job->options,
                       "for the base of a low plant, which its leaves may hide");
}

/* Behind the frame stage the stages see the points in canonical order, where any of them looks or may look at neighbours. */
static plm_status run_stages(plant_job *job, plm_error *error)
{
    const plm_plan *plan = &job->draft->plan;
    plm_status status = run_stage(job, PLM_STAGE_FRAME, error);
    if (status == PLM_OK && (plan->stage[PLM_STAGE_INDEX].runs || plan->needs & PLM_NEEDS_BASE))
        status = plm_work_order(&job->pass->work, error);
    for (int id = PLM_STAGE_GROUND; id < PLM_STAGE_COUNT && status == PLM_OK; id++) {
        if (id == PLM_STAGE_INDEX) {
            status = gather_plant(job, error);
            widen_plan(job);
        }
        if (status == PLM_OK) status = run_stage(job, (plm_stage_id)id, error);
    }
    return status;
}

/* ---- What thinning costs --------------------------------------------------------------------------------------- */

/** Points from which on found labels are about as good as those of all. */
static const double enough_points = 20000;
/** What the standard errors of organs grow by as labels are found among fewer: with 1 their 95 % intervals held the truth
 * of 51 to 98 % of virtual plants thinned to 5000 points (docs/time.md). */
static const double label_growth = 2.0;

/* Estimators know spacing and noise of the points that they see, but not that an organ's outline was found among few. Labels that
 * came with the cloud stay what they are, and so does a cloud that was not thinned: its labels are all there is to have. */
static void widen_errors(plant_job *job, size_t all)
{
    const double points = (double)job->cloud->count;
    if (job->has_labels || job->cloud->count == all || points >= enough_points) return;
    if (job->scene.organ_reason[0]) return; /* what was measured is told by points alone */
    const double factor = 1 + label_growth * (sqrt(enough_points / points) - 1);
    for (size_t i = 0; i < job->draft->value_count; i++) {
        plm_trait_value *value = &job->draft->value[i];
        if (plm_needs_closure(value->trait->needs) & PLM_NEEDS_ORGANS) value->estimate.std_error *= factor;
    }
}

static void free_job(plant_job *job)
{
    plm_scene_free(&job->scene);
    plm_free(job->keep);
    plm_free(job->tip);
    plm_free(job->label);
}

plm_status plm_pass_run(const plm_cloud *cloud, const plm_pass_options *options, plm_pass *pass, plm_error *error)
{
    plm_pass made = {.has_labels = cloud->label != NULL};
    plant_job job = {.stage_options = *options->measure,
                     .chosen = options->chosen,
                     .pace = options->pace,
                     .pass = &made,
                     .draft = &made.draft,
                     .has_labels = made.has_labels};
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "the cloud has no points");
    if (options->measure->deadline) {
        job.stage_deadline = *options->measure->deadline;
        job.end = job.stage_deadline.at;
        job.stage_options.deadline = &job.stage_deadline;
    }
    job.options = &job.stage_options;
    plm_status status =
        plm_plan_of(options->measure, options->chosen, plm_cloud_attributes(cloud), &made.draft.plan, error);
    const double begin = plm_deadline_now(options->measure->deadline);
    if (status == PLM_OK) status = plm_work_make(cloud, options->points, &made.work, error);
    if (options->pace)
        plm_pace_note(options->pace, PLM_COST_SAMPLE, cloud->count,
                      plm_deadline_now(options->measure->deadline) - begin);
    job.cloud = &made.work.cloud;
    made.draft.used_points = made.work.count;
    if (status == PLM_OK) status = run_stages(&job, error);
    if (status == PLM_OK) widen_errors(&job, cloud->count);
    free_job(&job);
    if (status == PLM_OK)
        *pass = made;
    else
        plm_pass_free(&made);
    return status;
}

void plm_pass_free(plm_pass *pass)
{
    plm_measurement_free(&pass->draft);
    plm_segmentation_free(&pass->segmentation);
    plm_work_free(&pass->work);
    *pass = (plm_pass){0};
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

/* The pass's points take the place of all; their labels go into the cloud. */
static plm_status keep_points_of_pass(plm_pass *pass, plm_cloud *cloud, plm_measurement *draft, plm_error *error)
{
    plm_cloud_free(cloud);
    draft->cloud = pass->work.cloud;
    pass->work.cloud = (plm_cloud){0};
    draft->segmentation = pass->segmentation;
    pass->segmentation = (plm_segmentation){0};
    if (!draft->segmentation.label) return PLM_OK;
    return plm_segmentation_to_cloud(&draft->segmentation, &draft->cloud, error);
}

plm_status plm_pass_finish(plm_pass *pass, plm_cloud *cloud, bool with_all, plm_measurement *measurement,
                           plm_error *error)
{
    plm_measurement draft = pass->draft;
    pass->draft = (plm_measurement){0};
    plm_status status = PLM_OK;
    if (draft.plan.stage[PLM_STAGE_FRAME].runs)
        turn_centroids_back(&draft);
    else
        draft.frame = (plm_frame){.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .up = PLM_UP_Z, .evidence = "no time"};
    if (with_all) {
        draft.cloud = *cloud;
        *cloud = (plm_cloud){0};
        if (draft.plan.stage[PLM_STAGE_FRAME].runs) plm_frame_apply(&draft.frame, &draft.cloud);
        if (pass->segmentation.label)
            status = plm_work_give_labels(&pass->work, &pass->segmentation, &draft.cloud, &draft.segmentation, error);
    } else {
        status = keep_points_of_pass(pass, cloud, &draft, error);
    }
    plm_pass_free(pass);
    if (status == PLM_OK)
        *measurement = draft;
    else
        plm_measurement_free(&draft);
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
