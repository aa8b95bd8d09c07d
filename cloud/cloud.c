/* cloud/cloud.c: making, selecting and freeing clouds and meshes. The attributes are one table, so that a new one
 * cannot be forgotten in one of the functions. */
#include "cloud/cloud.h"

#include <math.h>
#include <string.h>

/** Where an attribute's array hangs in plm_cloud, and the size of its rows. */
typedef struct attribute_row {
    unsigned bit; /* 0: always there */
    size_t offset;
    size_t size;
} attribute_row;

static const attribute_row attributes[] = {
    {0, offsetof(plm_cloud, xyz), sizeof(float[3])},
    {PLM_HAS_RGB, offsetof(plm_cloud, rgb), sizeof(uint8_t[3])},
    {PLM_HAS_NORMAL, offsetof(plm_cloud, normal), sizeof(float[3])},
    {PLM_HAS_EXTENT, offsetof(plm_cloud, extent), sizeof(float[2])},
    {PLM_HAS_OPACITY, offsetof(plm_cloud, opacity), sizeof(float)},
    {PLM_HAS_LABEL, offsetof(plm_cloud, label), sizeof(uint8_t)},
    {PLM_HAS_ORGAN, offsetof(plm_cloud, organ), sizeof(int32_t)},
    {PLM_HAS_LEAFLET, offsetof(plm_cloud, leaflet), sizeof(int32_t)},
    {PLM_HAS_SOURCE, offsetof(plm_cloud, source), sizeof(uint32_t)},
};

enum { ATTRIBUTE_COUNT = sizeof attributes / sizeof *attributes };

/* The array pointers have different types; memcpy reads and writes them without breaking aliasing rules. */
static void *array_get(const plm_cloud *cloud, const attribute_row *row)
{
    void *array;
    memcpy(&array, (const char *)cloud + row->offset, sizeof array);
    return array;
}

static void array_set(plm_cloud *cloud, const attribute_row *row, void *array)
{
    memcpy((char *)cloud + row->offset, &array, sizeof array);
}

plm_status plm_cloud_create(size_t count, unsigned wanted, plm_cloud *cloud, plm_error *error)
{
    if (count > UINT32_MAX)
        return plm_fail(error, PLM_E_ARGUMENT, "a cloud of %zu points; at most %u are supported", count, UINT32_MAX);
    plm_cloud made = {.count = count};
    for (size_t i = 0; i < ATTRIBUTE_COUNT; i++) {
        const attribute_row *row = &attributes[i];
        if (row->bit && !(wanted & row->bit)) continue;
        void *array = plm_alloc(count, row->size, error);
        if (!array) {
            plm_cloud_free(&made);
            return PLM_E_MEMORY;
        }
        array_set(&made, row, array);
    }
    *cloud = made;
    return PLM_OK;
}

void plm_cloud_free(plm_cloud *cloud)
{
    if (!cloud) return;
    for (size_t i = 0; i < ATTRIBUTE_COUNT; i++) plm_free(array_get(cloud, &attributes[i]));
    *cloud = (plm_cloud){0};
}

unsigned plm_cloud_attributes(const plm_cloud *cloud)
{
    unsigned found = 0;
    for (size_t i = 0; i < ATTRIBUTE_COUNT; i++)
        if (array_get(cloud, &attributes[i])) found |= attributes[i].bit;
    return found;
}

static void copy_rows(char *to, const char *from, size_t size, const uint32_t *index, size_t count)
{
    for (size_t i = 0; i < count; i++) memcpy(to + i * size, from + index[i] * size, size);
}

plm_status plm_cloud_select(const plm_cloud *cloud, const uint32_t *index, size_t count, plm_cloud *selection,
                            plm_error *error)
{
    for (size_t i = 0; i < count; i++)
        if (index[i] >= cloud->count)
            return plm_fail(error, PLM_E_ARGUMENT, "row %u of a cloud of %zu points", index[i], cloud->count);
    plm_cloud made;
    plm_status status = plm_cloud_create(count, plm_cloud_attributes(cloud) | PLM_HAS_SOURCE, &made, error);
    if (status != PLM_OK) return status;
    memcpy(made.origin, cloud->origin, sizeof made.origin);
    for (size_t i = 0; i < ATTRIBUTE_COUNT; i++) {
        const char *from = array_get(cloud, &attributes[i]);
        if (from) copy_rows(array_get(&made, &attributes[i]), from, attributes[i].size, index, count);
    }
    if (!cloud->source) memcpy(made.source, index, count * sizeof *index);
    *selection = made;
    return PLM_OK;
}

plm_status plm_cloud_bounds(const plm_cloud *cloud, float low[3], float high[3], plm_error *error)
{
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "an empty cloud has no bounds");
    for (int axis = 0; axis < 3; axis++) low[axis] = high[axis] = cloud->xyz[0][axis];
    for (size_t i = 1; i < cloud->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], cloud->xyz[i][axis]);
            high[axis] = fmaxf(high[axis], cloud->xyz[i][axis]);
        }
    return PLM_OK;
}

plm_status plm_mesh_create(size_t vertex_count, size_t triangle_count, plm_mesh *mesh, plm_error *error)
{
    plm_mesh made = {.vertex_count = vertex_count, .triangle_count = triangle_count};
    made.vertex = plm_alloc(vertex_count, sizeof *made.vertex, error);
    made.triangle = made.vertex ? plm_alloc(triangle_count, sizeof *made.triangle, error) : NULL;
    if (!made.triangle) {
        plm_mesh_free(&made);
        return PLM_E_MEMORY;
    }
    *mesh = made;
    return PLM_OK;
}

void plm_mesh_free(plm_mesh *mesh)
{
    if (!mesh) return;
    plm_free(mesh->vertex);
    plm_free(mesh->triangle);
    plm_free(mesh->face_organ);
    *mesh = (plm_mesh){0};
}
