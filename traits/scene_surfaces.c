/* traits/scene_surfaces.c: the surfaces and midribs of a scene's leaves, and all of them as one mesh. */
#include "traits/leaf_midrib.h"

#include <stdio.h>
#include <string.h>

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

/* Appends a surface behind the vertices and triangles that mesh has already; there is room. */
static void append(const plm_mesh *surface, int32_t leaf, plm_mesh *mesh)
{
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t i = 0; i < surface->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++) /* organs' offsets are from the cloud's origin, as the mesh's are */
            mesh->vertex[mesh->vertex_count + i][axis] = surface->origin[axis] + surface->vertex[i][axis];
    for (size_t i = 0; i < surface->triangle_count; i++) {
        for (int k = 0; k < 3; k++) mesh->triangle[mesh->triangle_count + i][k] = first + surface->triangle[i][k];
        mesh->face_organ[mesh->triangle_count + i] = leaf;
    }
    mesh->vertex_count += surface->vertex_count;
    mesh->triangle_count += surface->triangle_count;
}

plm_status plm_scene_leaf_mesh(const plm_scene *scene, plm_mesh *mesh, plm_error *error)
{
    size_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < scene->organ_count; i++) {
        vertices += scene->organ[i].surface.mesh.vertex_count;
        triangles += scene->organ[i].surface.mesh.triangle_count;
    }
    if (vertices > UINT32_MAX)
        return plm_fail(error, PLM_E_LIBRARY, "%zu vertices of leaves; one mesh holds at most %u", vertices,
                        UINT32_MAX);
    plm_mesh made;
    plm_status status = plm_mesh_create(vertices, triangles, &made, error);
    if (status != PLM_OK) return status;
    made.face_organ = plm_alloc(triangles, sizeof *made.face_organ, error);
    if (!made.face_organ) {
        plm_mesh_free(&made);
        return PLM_E_MEMORY;
    }
    memcpy(made.origin, scene->cloud->origin, sizeof made.origin);
    made.vertex_count = made.triangle_count = 0;
    for (size_t i = 0; i < scene->organ_count; i++) append(&scene->organ[i].surface.mesh, scene->organ[i].id, &made);
    *mesh = made;
    return PLM_OK;
}
