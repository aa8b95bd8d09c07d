/* reports/plant_files.c: the labelled cloud and the leaf meshes of a plant, turned and scaled back to the input. */
#include "reports/plant_files.h"

#include <string.h>

/* From the plant's frame to the axes of the input: the transpose of a rotation. */
static void turn_back(const plm_frame *frame, const double turned[3], double original[3])
{
    for (int axis = 0; axis < 3; axis++)
        original[axis] = frame->rotation[0][axis] * turned[0] + frame->rotation[1][axis] * turned[1] +
                         frame->rotation[2][axis] * turned[2];
}

plm_status plm_write_labelled_cloud(const char *path, const plm_measurement *measurement, const plm_input_frame *frame,
                                    plm_error *error)
{
    plm_cloud cloud = measurement->cloud; /* its arrays, but for those that were turned or scaled */
    float(*xyz)[3] = plm_alloc(cloud.count, sizeof *xyz, error);
    float(*normal)[3] = xyz && cloud.normal ? plm_alloc(cloud.count, sizeof *normal, error) : NULL;
    float(*extent)[2] = xyz && cloud.extent ? plm_alloc(cloud.count, sizeof *extent, error) : NULL;
    plm_status status = xyz && !normal == !cloud.normal && !extent == !cloud.extent ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        memcpy(xyz, frame->xyz, cloud.count * sizeof *xyz);
        for (size_t i = 0; normal && i < cloud.count; i++) {
            const double turned[3] = {cloud.normal[i][0], cloud.normal[i][1], cloud.normal[i][2]};
            double original[3];
            turn_back(&measurement->frame, turned, original);
            for (int axis = 0; axis < 3; axis++) normal[i][axis] = (float)original[axis];
        }
        for (size_t i = 0; extent && i < cloud.count; i++)
            for (int axis = 0; axis < 2; axis++)
                extent[i][axis] = (float)(cloud.extent[i][axis] / frame->metres_per_unit);
        cloud.xyz = xyz;
        cloud.normal = normal;
        cloud.extent = extent;
        cloud.source = NULL;
        memcpy(cloud.origin, frame->origin, sizeof cloud.origin);
        status = plm_cloud_write(path, &cloud, error);
    }
    plm_free(extent);
    plm_free(normal);
    plm_free(xyz);
    return status;
}

/* A vertex in the input's coordinates. */
static plm_status vertex_back(const plm_measurement *measurement, const plm_input_frame *frame, const double vertex[3],
                              double out[3], plm_error *error)
{
    double turned[3], local[3];
    for (int axis = 0; axis < 3; axis++) turned[axis] = measurement->leaves.origin[axis] + vertex[axis];
    turn_back(&measurement->frame, turned, local);
    if (frame->georeference) return plm_georeference_restore(frame->georeference, local, out, error);
    for (int axis = 0; axis < 3; axis++) out[axis] = local[axis] / frame->metres_per_unit;
    return PLM_OK;
}

plm_status plm_write_leaf_meshes(const char *path, const plm_measurement *measurement, const plm_input_frame *frame,
                                 plm_error *error)
{
    plm_mesh mesh = measurement->leaves; /* its triangles; vertices of its own */
    memcpy(mesh.origin, frame->origin, sizeof mesh.origin);
    mesh.vertex = plm_alloc(mesh.vertex_count, sizeof *mesh.vertex, error);
    if (!mesh.vertex) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (size_t i = 0; i < mesh.vertex_count && status == PLM_OK; i++) {
        double place[3];
        status = vertex_back(measurement, frame, measurement->leaves.vertex[i], place, error);
        for (int axis = 0; axis < 3 && status == PLM_OK; axis++)
            mesh.vertex[i][axis] = place[axis] - frame->origin[axis];
    }
    if (status == PLM_OK) status = plm_mesh_write(path, &mesh, error);
    plm_free(mesh.vertex);
    return status;
}
