/* traits/evaluate.c: calls the trait functions, and keeps what they may get wrong out of the tables: a value that is
 * not finite becomes a failure with its reason. Organs are measured in parallel, each trait into its own place. */
#include "traits/evaluate.h"

#include "traits/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** Needs that rest on organs. */
static const unsigned needs_organs = PLM_NEEDS_ORGANS | PLM_NEEDS_SURFACE | PLM_NEEDS_AXIS | PLM_NEEDS_LIGHT;

/** One call to make: a trait of an organ (NULL: of the plant, or of a level that has no organ). */
typedef struct call {
    const plm_trait *trait;
    const plm_organ *organ;
} call;

static plm_level level_of(plm_label label)
{
    return label == PLM_LABEL_STEM ? PLM_STEM : label == PLM_LABEL_PETIOLE ? PLM_PETIOLE : PLM_LEAF;
}

static size_t add_calls(const bool *chosen, plm_level level, const plm_organ *organ, call *calls)
{
    size_t count, added = 0;
    const plm_trait *trait = plm_traits(&count);
    for (size_t i = 0; i < count; i++)
        if (chosen[i] && trait[i].level == level) {
            if (calls) calls[added] = (call){&trait[i], organ};
            added++;
        }
    return added;
}

/* Lists the calls in the order of the reports; calls NULL: only counts them. Organs stand by level already. */
static size_t list_calls(const plm_scene *scene, const bool *chosen, call *calls)
{
    size_t count = add_calls(chosen, PLM_PLANT, NULL, calls);
    size_t organ = 0;
    for (int level = PLM_STEM; level < PLM_LEVEL_COUNT; level++) {
        const size_t first = organ;
        for (; organ < scene->organ_count && level_of(scene->organ[organ].label) == (plm_level)level; organ++)
            count += add_calls(chosen, (plm_level)level, &scene->organ[organ], calls ? calls + count : NULL);
        if (organ == first) count += add_calls(chosen, (plm_level)level, NULL, calls ? calls + count : NULL);
    }
    return count;
}

/* Whether there was or is no time for a trait. */
static bool is_late(const plm_scene *scene, const plm_trait *trait)
{
    return (plm_needs_closure(trait->needs) & scene->late) || plm_deadline_passed(scene->options->deadline);
}

/* Why a trait cannot be had whatever its function does. */
static bool is_out_of_reach(const plm_scene *scene, const call *made, plm_estimate *out)
{
    const plm_trait *trait = made->trait;
    if (trait->needs & PLM_NEEDS_COLOUR && !scene->has_colour)
        plm_not_applicable(out, "the cloud has no colour");
    else if (is_late(scene, trait))
        plm_trait_failed(out, "time budget: no time was left for what it needs; give more");
    else if (scene->plant_count == 0)
        plm_not_applicable(out, "no point of the cloud belongs to the plant");
    else if (scene->organ_reason[0] && (trait->needs & needs_organs) && !(trait->needs & PLM_NEEDS_NO_ORGANS))
        plm_trait_failed(out, "%s", scene->organ_reason);
    else if (trait->level != PLM_PLANT && !made->organ)
        plm_not_applicable(out, "the plant has no %s", plm_level_name(trait->level));
    return out->state != PLM_STATE_OK;
}

static plm_status measure_one(const plm_scene *scene, const call *made, plm_estimate *out, plm_error *error)
{
    const plm_organ *organ = made->organ;
    *out = (plm_estimate){.value = NAN, .std_error = NAN, .method = ""};
    out->point_count = organ ? organ->count : made->trait->level == PLM_PLANT ? scene->plant_count : 0;
    if (is_out_of_reach(scene, made, out)) return PLM_OK;
    plm_status status = made->trait->measure(scene, organ, out, error);
    if (status == PLM_E_DEGENERATE || status == PLM_E_ARGUMENT) /* this trait's trouble, not the plant's */
        status = plm_trait_failed(out, "%s", error->message);
    if (status != PLM_OK) return status;
    if (out->state == PLM_STATE_OK && !isfinite(out->value))
        plm_trait_failed(out, "the value came out as %g", out->value);
    if (out->state != PLM_STATE_OK) out->value = out->std_error = NAN;
    if (organ && out->state == PLM_STATE_OK) out->flags |= organ->flags;
    if (!isnan(out->std_error) && (out->std_error < 0 || isinf(out->std_error))) out->std_error = NAN;
    return PLM_OK;
}

/* Where a row of the table lies: the organ's centroid or the plant's; nowhere for a level that has no organ. */
static void place(const plm_scene *scene, const double plant_centroid[3], const call *made, plm_trait_value *value)
{
    value->trait = made->trait;
    value->organ_id = made->organ ? made->organ->id : -1;
    const double *offset = made->organ ? made->organ->centroid : plant_centroid;
    const bool nowhere = made->trait->level != PLM_PLANT && !made->organ;
    for (int axis = 0; axis < 3; axis++)
        value->centroid[axis] = nowhere ? NAN : scene->cloud->origin[axis] + offset[axis];
}

/* NAN for a plant without points. */
static void plant_centroid(const plm_scene *scene, double centroid[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (size_t i = 0; i < scene->plant_count; i++) sum += scene->plant[i][axis];
        centroid[axis] = sum / (double)scene->plant_count;
    }
}

/* Side by side: each call writes to its own row, and what a trait does in parallel itself it then does alone. */
static void measure_all(const plm_scene *scene, const call *calls, size_t count, plm_trait_value *values,
                        plm_status *status, plm_error *errors)
{
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < count; i++) status[i] = measure_one(scene, &calls[i], &values[i].estimate, &errors[i]);
}

/* Whether the value is missing for want of time: its reason says so. */
static bool was_late(const plm_estimate *estimate)
{
    return estimate->state == PLM_STATE_FAILED && !strncmp(estimate->reason, "time budget", strlen("time budget"));
}

plm_status plm_evaluate(const plm_scene *scene, const bool *chosen, plm_trait_value **values, size_t *value_count,
                        bool late[2], plm_error *error)
{
    const size_t count = list_calls(scene, chosen, NULL);
    plm_status result = PLM_E_MEMORY;
    call *calls = plm_alloc(count, sizeof *calls, error);
    plm_trait_value *made = calls ? plm_alloc_zero(count, sizeof *made, error) : NULL;
    plm_status *status = made ? plm_alloc_zero(count, sizeof *status, error) : NULL;
    plm_error *errors = status ? plm_alloc_zero(count, sizeof *errors, error) : NULL;
    if (errors) {
        result = PLM_OK;
        list_calls(scene, chosen, calls);
        double centroid[3];
        plant_centroid(scene, centroid);
        for (size_t i = 0; i < count; i++) place(scene, centroid, &calls[i], &made[i]);
        measure_all(scene, calls, count, made, status, errors);
        for (size_t i = 0; i < count && result == PLM_OK; i++)
            if (status[i] != PLM_OK)
                result = plm_fail(error, status[i], "%s: %s", calls[i].trait->name, errors[i].message);
    }
    for (size_t i = 0; i < count && result == PLM_OK; i++)
        if (was_late(&made[i].estimate)) late[(plm_needs_closure(made[i].trait->needs) & PLM_NEEDS_ORGANS) != 0] = true;
    if (result == PLM_OK) {
        *values = made;
        *value_count = count;
        made = NULL;
    }
    plm_free(errors);
    plm_free(status);
    plm_free(made);
    plm_free(calls);
    return result;
}
