/* mesh/mesh_cluster.c: coarser meshes by clustering vertices in cubes. */
#include "mesh/mesh_cluster.h"

#include "cloud/voxel.h"

#include <math.h>

static bool is_left(const uint32_t owner[], const uint32_t corner[3])
{
    const uint32_t a = owner[corner[0]], b = owner[corner[1]], c = owner[corner[2]];
    return a != b && b != c && c != a;
}

static plm_status gather(const plm_mesh *mesh, const plm_voxels *cubes, plm_mesh *out, plm_error *error)
{
    size_t left = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) left += is_left(cubes->owner, mesh->triangle[i]);
    const plm_status status = plm_mesh_create(cubes->count, left, out, error);
    if (status != PLM_OK) return status;
    if (mesh->face_organ && !(out->face_organ = plm_alloc(left, sizeof *out->face_organ, error))) {
        plm_mesh_free(out);
        return PLM_E_MEMORY;
    }
    for (int axis = 0; axis < 3; axis++) out->origin[axis] = mesh->origin[axis];
    for (size_t i = 0; i < cubes->count; i++)
        for (int axis = 0; axis < 3; axis++) out->vertex[i][axis] = cubes->xyz[i][axis];
    size_t at = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        if (!is_left(cubes->owner, mesh->triangle[i])) continue;
        for (int k = 0; k < 3; k++) out->triangle[at][k] = cubes->owner[mesh->triangle[i][k]];
        if (out->face_organ) out->face_organ[at] = mesh->face_organ[i];
        at++;
    }
    return PLM_OK;
}

plm_status plm_mesh_cluster(const plm_mesh *mesh, size_t triangles, plm_mesh *out, plm_error *error)
{
    double area;
    plm_status status = plm_mesh_area(mesh, &area, error);
    if (status != PLM_OK) return status;
    float(*xyz)[3] = plm_alloc(mesh->vertex_count, sizeof *xyz, error);
    if (!xyz) return PLM_E_MEMORY;
    for (size_t i = 0; i < mesh->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++) xyz[i][axis] = (float)mesh->vertex[i][axis];
    plm_voxels cubes = {0};
    const double edge = sqrt(2 * area / (double)(triangles ? triangles : 1)); /* two triangles a cube that is cut */
    status = plm_voxel_thin((const float(*)[3])xyz, mesh->vertex_count, edge, &cubes, error);
    if (status == PLM_OK) status = gather(mesh, &cubes, out, error);
    plm_voxels_free(&cubes);
    plm_free(xyz);
    return status;
}
