/* traits/scene_surfaces.c: the surfaces and midribs of a scene's leaves. */
#include "traits/leaf_midrib.h"

#include <stdio.h>

static plm_status make_surface(const plm_scene *scene, plm_organ *leaf)
{
    const plm_surface_options options = {.alpha = scene->options->alpha,
                                         .noise = leaf->index ? leaf->sampling.noise : -1,
                                         .fused = scene->plant_index ? scene->sampling.fused : -1,
                                         .voxel = scene->sampling.pitch,
                                         .extent = leaf->sampling.extent,
                                         .seed = scene->options->seed};
    plm_error trouble = {0};
    leaf->surface_status =
        plm_leaf_surface_make((const float(*)[3])leaf->xyz, leaf->count, &options, &leaf->surface, &trouble);
    plm_status status = leaf->surface_status;
    if (status == PLM_OK) status = plm_midrib_find(scene, leaf, &leaf->midrib, &trouble);
    if (leaf->surface_status != PLM_OK || status == PLM_E_MEMORY)
        snprintf(leaf->surface_reason, sizeof leaf->surface_reason, "%.150s", trouble.message);
    return status == PLM_E_MEMORY ? status : PLM_OK;
}

plm_status plm_scene_surfaces(plm_scene *scene, plm_error *error)
{
    plm_status *status = plm_alloc_zero(scene->organ_count, sizeof *status, error);
    if (!status) return PLM_E_MEMORY;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < scene->organ_count; i++)
        if (scene->organ[i].label == PLM_LABEL_LEAF && !plm_deadline_passed(scene->options->deadline))
            status[i] = make_surface(scene, &scene->organ[i]);
    plm_status result = plm_deadline_check(scene->options->deadline, error);
    for (size_t i = 0; i < scene->organ_count && result == PLM_OK; i++)
        if (status[i] != PLM_OK)
            result = plm_fail(error, status[i], "leaf %d: %s", scene->organ[i].id, scene->organ[i].surface_reason);
    plm_free(status);
    return result;
}
