/* traits/scene.c: from a cloud with labels to organs with their points side by side, indexed and with known sampling. */
#include "traits/scene.h"

#include "cloud/order.h"
#include "cloud/voxel_pitch.h"
#include "traits/axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** Fewest points that have a sampling (cloud/sampling.h). */
enum { FEWEST_POINTS = 12 };

const plm_organ *plm_scene_organ(const plm_scene *scene, plm_label label, int32_t id)
{
    for (size_t i = 0; i < scene->organ_count; i++)
        if (scene->organ[i].label == label && scene->organ[i].id == id) return &scene->organ[i];
    return NULL;
}

static void set_state(plm_estimate *out, plm_state state, const char *format, va_list arguments)
{
    out->state = state;
    vsnprintf(out->reason, sizeof out->reason, format, arguments);
}

plm_status plm_not_applicable(plm_estimate *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    set_state(out, PLM_STATE_NOT_APPLICABLE, format, arguments);
    va_end(arguments);
    return PLM_OK;
}

plm_status plm_trait_failed(plm_estimate *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    set_state(out, PLM_STATE_FAILED, format, arguments);
    va_end(arguments);
    return PLM_OK;
}

/* Median over points of the mean of a gaussian's two long axes: how far a fitted disc reaches past its centre. */
static plm_status median_extent(const plm_cloud *cloud, const uint32_t *row, size_t count, double *extent,
                                plm_error *error)
{
    float *mean = plm_alloc(count, sizeof *mean, error);
    if (!mean) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) mean[i] = 0.5f * (cloud->extent[row[i]][0] + cloud->extent[row[i]][1]);
    plm_order_sort(mean, count);
    *extent = count ? mean[count / 2] : 0;
    plm_free(mean);
    return PLM_OK;
}

plm_status plm_scene_gather(plm_scene *scene, const bool *is_plant, plm_error *error)
{
    const plm_cloud *cloud = scene->cloud;
    size_t count = 0;
    for (size_t i = 0; i < cloud->count; i++) count += is_plant[i];
    scene->plant = plm_alloc(count, sizeof *scene->plant, error);
    scene->plant_row = scene->plant ? plm_alloc(count, sizeof *scene->plant_row, error) : NULL;
    if (!scene->plant_row) return PLM_E_MEMORY;
    for (size_t i = 0; i < cloud->count; i++) {
        if (!is_plant[i]) continue;
        memcpy(scene->plant[scene->plant_count], cloud->xyz[i], sizeof *scene->plant);
        scene->plant_row[scene->plant_count++] = (uint32_t)i;
    }
    scene->is_splat = cloud->extent != NULL;
    scene->has_colour = cloud->rgb != NULL;
    if (!scene->is_splat) return PLM_OK;
    return median_extent(cloud, scene->plant_row, scene->plant_count, &scene->sampling.extent, error);
}

/* Index and sampling of points, whose extent the caller knows. Points that determine no sampling (all in one place, say)
 * are no failure: the traits that want it say what they miss. */
static plm_status index_points(const float (*xyz)[3], size_t count, const bool *fused, plm_index **index,
                               plm_sampling *sampling, plm_error *error)
{
    if (count < FEWEST_POINTS) return PLM_OK;
    plm_status status = plm_index_build(xyz, count, index, error);
    if (status != PLM_OK) return status;
    plm_sampling measured = {0};
    status = plm_sampling_measure(*index, xyz, count, fused, &measured, error);
    if (status != PLM_OK) return status == PLM_E_DEGENERATE ? PLM_OK : status;
    measured.extent = sampling->extent;
    *sampling = measured;
    return PLM_OK;
}

plm_status plm_scene_index(plm_scene *scene, plm_error *error)
{
    const float(*xyz)[3] = (const float(*)[3])scene->plant;
    plm_status status = index_points(xyz, scene->plant_count, NULL, &scene->plant_index, &scene->sampling, error);
    if (status == PLM_OK) status = plm_voxels_measure(xyz, scene->plant_count, &scene->sampling, error);
    return status;
}

/* ---- Organs --------------------------------------------------------------------------------------------------- */

/* label, number and row of a point in one word, so that sorting gathers the organs and keeps the rows' order. Rows
 * reach 2^32: they take the low half; labels two bits; numbers thirty, beyond which a point has no organ. */
static uint64_t organ_key(uint8_t label, int32_t id, size_t row)
{
    return (uint64_t)label << 62 | (uint64_t)(uint32_t)id << 32 | (uint64_t)row;
}

static bool is_organ(uint8_t label, int32_t id)
{
    return label >= PLM_LABEL_STEM && label <= PLM_LABEL_LEAF && id >= 0 && id < 1 << 30;
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static plm_status fill_organ(const plm_scene *scene, const plm_segmentation *segmentation, const uint64_t *key,
                             size_t count, plm_organ *organ, plm_error *error)
{
    organ->label = (plm_label)(key[0] >> 62);
    organ->id = (int32_t)(key[0] >> 32 & 0x3fffffff);
    organ->count = count;
    organ->xyz = plm_alloc(count, sizeof *organ->xyz, error);
    organ->row = organ->xyz ? plm_alloc(count, sizeof *organ->row, error) : NULL;
    if (!organ->row) return PLM_E_MEMORY;
    const bool has_leaflets = organ->label == PLM_LABEL_LEAF && segmentation->leaflet;
    if (has_leaflets && !(organ->leaflet = plm_alloc(count, sizeof *organ->leaflet, error))) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const uint32_t row = (uint32_t)key[i];
        organ->row[i] = row;
        memcpy(organ->xyz[i], scene->cloud->xyz[row], sizeof *organ->xyz);
        if (has_leaflets) organ->leaflet[i] = segmentation->leaflet[row];
        for (int axis = 0; axis < 3; axis++) organ->centroid[axis] += organ->xyz[i][axis];
    }
    for (int axis = 0; axis < 3; axis++) organ->centroid[axis] /= (double)count;
    if (organ->label == PLM_LABEL_LEAF && segmentation->leaf_flags && (size_t)organ->id < segmentation->leaf_count)
        organ->flags = segmentation->leaf_flags[organ->id];
    return PLM_OK;
}

/* Sorted keys to organs. */
static plm_status cut_organs(plm_scene *scene, const plm_segmentation *segmentation, const uint64_t *key, size_t count,
                             plm_error *error)
{
    size_t organ_count = 0;
    for (size_t i = 0; i < count; i++) organ_count += i == 0 || key[i] >> 32 != key[i - 1] >> 32;
    scene->organ = plm_alloc_zero(organ_count, sizeof *scene->organ, error);
    if (!scene->organ) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (size_t begin = 0, end; begin < count && status == PLM_OK; begin = end) {
        for (end = begin + 1; end < count && key[end] >> 32 == key[begin] >> 32;) end++;
        status = fill_organ(scene, segmentation, key + begin, end - begin, &scene->organ[scene->organ_count++], error);
    }
    return status;
}

static plm_status gather_organs(plm_scene *scene, const plm_segmentation *segmentation, plm_error *error)
{
    uint64_t *key = plm_alloc(segmentation->count, sizeof *key, error);
    if (!key) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; i < segmentation->count; i++)
        if (is_organ(segmentation->label[i], segmentation->organ[i]))
            key[count++] = organ_key(segmentation->label[i], segmentation->organ[i], i);
    qsort(key, count, sizeof *key, compare_keys);
    const plm_status status = cut_organs(scene, segmentation, key, count, error);
    plm_free(key);
    return status;
}

/* Each thread writes to its own organ; of several failures the first organ's is told, whatever the threads did. */
static plm_status index_organs(plm_scene *scene, plm_error *error)
{
    const bool *fused = scene->plant_index ? &scene->sampling.fused : NULL;
    plm_status *status = plm_alloc_zero(scene->organ_count, sizeof *status, error);
    if (!status) return PLM_E_MEMORY;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < scene->organ_count; i++) {
        plm_organ *organ = &scene->organ[i];
        if (scene->is_splat)
            status[i] = median_extent(scene->cloud, organ->row, organ->count, &organ->sampling.extent, NULL);
        if (status[i] == PLM_OK)
            status[i] =
                index_points((const float(*)[3])organ->xyz, organ->count, fused, &organ->index, &organ->sampling, NULL);
    }
    plm_status result = PLM_OK;
    for (size_t i = 0; i < scene->organ_count && result == PLM_OK; i++)
        if (status[i] != PLM_OK)
            result = plm_fail(error, status[i], "%s %d: no index over its %zu points: %s",
                              plm_label_name(scene->organ[i].label), scene->organ[i].id, scene->organ[i].count,
                              plm_status_name(status[i]));
    plm_free(status);
    return result;
}

plm_status plm_scene_organs(plm_scene *scene, const plm_segmentation *segmentation, bool with_index, plm_error *error)
{
    scene->habit = segmentation->habit;
    plm_status status = gather_organs(scene, segmentation, error);
    if (status == PLM_OK && with_index) status = index_organs(scene, error);
    return status;
}

void plm_scene_free(plm_scene *scene)
{
    for (size_t i = 0; i < scene->organ_count; i++) {
        plm_organ *organ = &scene->organ[i];
        plm_leaf_surface_free(&organ->surface);
        plm_free(organ->midrib);
        plm_index_free(organ->index);
        plm_free(organ->leaflet);
        plm_axis_free(organ->axis);
        plm_free(organ->row);
        plm_free(organ->xyz);
    }
    plm_free(scene->organ);
    plm_mesh_free(&scene->hull);
    plm_index_free(scene->plant_index);
    plm_free(scene->plant_row);
    plm_free(scene->plant);
    *scene = (plm_scene){0};
}
