/* traits/axis.c: runs the fits of stems and petioles and keeps what came of them. Stems come first: petioles start at
 * their surface. */
#include "traits/axis.h"

#include "cloud/linear.h"

#include <stdio.h>
#include <string.h>

void plm_axis_free(plm_axis *axis)
{
    plm_free(axis);
}

double plm_axis_radius(const plm_axis *axis, double t)
{
    return fmax(axis->radius + axis->taper * fmin(fmax(t, -1), 1), 0.25 * axis->radius);
}

plm_status plm_tube_points_gather(const plm_organ *organ, size_t wanted, plm_tube_points *points, plm_error *error)
{
    /* Organs hold their points in canonical spatial order: every n-th of them is an even sample. */
    const size_t step = organ->count > wanted ? (organ->count + wanted - 1) / wanted : 1;
    const size_t count = (organ->count + step - 1) / step;
    double(*xyz)[3] = plm_alloc(count, sizeof *xyz, error);
    if (!xyz) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) xyz[i][k] = organ->xyz[i * step][k];
    *points = (plm_tube_points){.count = count, .xyz = xyz};
    return PLM_OK;
}

/* Fits one organ's axis into *axis (freed by the caller where the organ gets none). */
static plm_status fit_organ(const plm_scene *scene, plm_organ *organ, plm_error *error)
{
    plm_axis *axis = plm_alloc_zero(1, sizeof *axis, error);
    if (!axis) return PLM_E_MEMORY;
    plm_error why = {0};
    const plm_status status = organ->label == PLM_LABEL_STEM ? plm_stem_axis_fit(scene, organ, axis, &why)
                                                             : plm_petiole_axis_fit(scene, organ, axis, &why);
    if (status == PLM_OK) {
        organ->axis = axis;
        return PLM_OK;
    }
    plm_axis_free(axis);
    if (status == PLM_E_MEMORY) return plm_fail(error, status, "%s", why.message);
    snprintf(organ->axis_reason, sizeof organ->axis_reason, "%.*s", (int)sizeof organ->axis_reason - 1, why.message);
    return PLM_OK;
}

/* Fits all organs of a label. Each thread writes to its own organ; of several failures the first organ's is told,
 * whatever the threads did. */
static plm_status fit_label(plm_scene *scene, plm_label label, plm_error *error)
{
    plm_status *status = plm_alloc_zero(scene->organ_count, sizeof *status, error);
    if (!status) return PLM_E_MEMORY;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < scene->organ_count; i++)
        if (scene->organ[i].label == label && !plm_deadline_passed(scene->options->deadline))
            status[i] = fit_organ(scene, &scene->organ[i], NULL);
    plm_status result = plm_deadline_check(scene->options->deadline, error);
    for (size_t i = 0; i < scene->organ_count && result == PLM_OK; i++)
        if (status[i] != PLM_OK)
            result = plm_fail(error, status[i], "%s %d: no axis through its %zu points: %s", plm_label_name(label),
                              scene->organ[i].id, scene->organ[i].count, plm_status_name(status[i]));
    plm_free(status);
    return result;
}

/* Turns a branch so that its base is the end at the stem that it leaves. */
static void turn(plm_axis *axis)
{
    const double begin = axis->begin;
    axis->begin = axis->end;
    axis->end = begin;
    for (int k = 0; k < 3; k++) {
        const double base = axis->base[k];
        axis->base[k] = axis->tip[k];
        axis->tip[k] = base;
        axis->direction[k] = -axis->direction[k];
    }
}

/* Distance of a point from an axis between its ends, and the length from its base to there. */
static double distance_to(const plm_axis *axis, const double point[3], double *node)
{
    const double low = fmin(axis->begin, axis->end), high = fmax(axis->begin, axis->end);
    const double t = fmin(fmax(plm_curve_foot(&axis->line, point), low), high);
    double at[3], gap[3];
    plm_curve_point(&axis->line, t, at);
    for (int k = 0; k < 3; k++) gap[k] = point[k] - at[k];
    *node = fabs(plm_curve_length(&axis->line, axis->begin, t));
    return plm_norm(gap);
}

/* A stem of whose ends one lies at a longer stem, above its foot, is a branch of it. */
static void find_carriers(plm_scene *scene)
{
    for (size_t i = 0; i < scene->organ_count; i++) {
        plm_axis *branch = scene->organ[i].axis;
        if (scene->organ[i].label != PLM_LABEL_STEM || !branch) continue;
        double nearest = INFINITY;
        bool at_tip = false;
        for (size_t j = 0; j < scene->organ_count; j++) {
            const plm_axis *stem = scene->organ[j].axis;
            if (j == i || scene->organ[j].label != PLM_LABEL_STEM || !stem || stem->length <= branch->length) continue;
            for (int end = 0; end < 2; end++) {
                double node;
                const double distance = distance_to(stem, end ? branch->tip : branch->base, &node);
                const double reach = 2 * stem->radius + branch->radius + 3 * (stem->noise + branch->noise);
                if (distance > reach || distance >= nearest || node < 2 * stem->radius) continue;
                nearest = distance;
                at_tip = end;
                branch->carrier = scene->organ[j].id;
                branch->node = node;
                branch->node_error = stem->radius;
            }
        }
        if (at_tip) turn(branch);
    }
}

plm_status plm_scene_fit_axes(plm_scene *scene, plm_error *error)
{
    plm_status status = fit_label(scene, PLM_LABEL_STEM, error);
    if (status != PLM_OK) return status;
    find_carriers(scene);
    return fit_label(scene, PLM_LABEL_PETIOLE, error);
}
