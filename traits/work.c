/* traits/work.c: large clouds thinned to a budget and brought into canonical order; labels back to all points. */
#include "traits/work.h"

#include "cloud/neighbours.h"
#include "cloud/spatial_order.h"
#include "cloud/subset.h"

#include <math.h>
#include <string.h>

/** A left-out point farther than this from all seen ones belongs to none of them. */
static const double reach_in_spacings = 5;

plm_status plm_work_make(const plm_cloud *cloud, size_t budget, plm_work *work, plm_error *error)
{
    plm_work made = {.count = cloud->count};
    made.row = plm_alloc(cloud->count, sizeof *made.row, error);
    if (!made.row) return PLM_E_MEMORY;
    if (budget && cloud->count > budget)
        made.count = plm_sample_rows((const float(*)[3])cloud->xyz, cloud->count, budget, made.row);
    else
        for (size_t i = 0; i < cloud->count; i++) made.row[i] = (uint32_t)i;
    const plm_status status = plm_cloud_select(cloud, made.row, made.count, &made.cloud, error);
    if (status == PLM_OK)
        *work = made;
    else
        plm_work_free(&made);
    return status;
}

plm_status plm_work_order(plm_work *work, plm_error *error)
{
    plm_cloud in_order = {0};
    uint32_t *place = plm_alloc(work->count, sizeof *place, error);
    uint32_t *row = place ? plm_alloc(work->count, sizeof *row, error) : NULL;
    plm_status status = row ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_spatial_order((const float(*)[3])work->cloud.xyz, work->count, place, error);
    if (status == PLM_OK) status = plm_cloud_select(&work->cloud, place, work->count, &in_order, error);
    if (status == PLM_OK) {
        for (size_t i = 0; i < work->count; i++) row[i] = work->row[place[i]];
        plm_free(work->row);
        plm_cloud_free(&work->cloud);
        work->row = row;
        work->cloud = in_order;
        row = NULL;
    }
    plm_free(place);
    plm_free(row);
    return status;
}

void plm_work_free(plm_work *work)
{
    plm_free(work->row);
    plm_cloud_free(&work->cloud);
    *work = (plm_work){0};
}

/* ---- The way back ------------------------------------------------------------------------------------------------ */

/* The point whose labels each row takes: its own where it was seen, else the nearest; PLM_NO_ROW for none. */
static plm_status find_source(const plm_work *work, const plm_cloud *cloud, double spacing, uint32_t *source,
                              plm_error *error)
{
    for (size_t i = 0; i < cloud->count; i++) source[i] = PLM_NO_ROW;
    for (size_t i = 0; i < work->count; i++) source[work->row[i]] = (uint32_t)i;
    if (work->count == cloud->count) return PLM_OK;
    plm_index *index = NULL;
    const plm_status status = plm_index_build((const float(*)[3])work->cloud.xyz, work->count, &index, error);
    if (status != PLM_OK) return status;
    const double reach = spacing > 0 ? reach_in_spacings * spacing : INFINITY;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < cloud->count; i++) {
        if (source[i] != PLM_NO_ROW) continue;
        uint32_t nearest;
        float squared;
        plm_index_nearest(index, cloud->xyz[i], 1, &nearest, &squared);
        if (squared <= reach * reach) source[i] = nearest;
    }
    plm_index_free(index);
    return PLM_OK;
}

/* Room in the cloud for the labels of a segmentation; leaflets that it lacks go, as they are of other leaves. */
static bool make_label_room(const plm_segmentation *found, plm_cloud *cloud, plm_error *error)
{
    if (!cloud->label) cloud->label = plm_alloc(cloud->count, sizeof *cloud->label, error);
    if (cloud->label && !cloud->organ) cloud->organ = plm_alloc(cloud->count, sizeof *cloud->organ, error);
    if (!found->leaflet) {
        plm_free(cloud->leaflet);
        cloud->leaflet = NULL;
    } else if (cloud->organ && !cloud->leaflet) {
        cloud->leaflet = plm_alloc(cloud->count, sizeof *cloud->leaflet, error);
    }
    return cloud->label && cloud->organ && (cloud->leaflet || !found->leaflet);
}

static bool make_room(const plm_segmentation *found, plm_cloud *cloud, plm_segmentation *made, plm_error *error)
{
    made->count = cloud->count;
    made->label = plm_alloc(cloud->count, sizeof *made->label, error);
    made->organ = made->label ? plm_alloc(cloud->count, sizeof *made->organ, error) : NULL;
    made->leaflet = made->organ && found->leaflet ? plm_alloc(cloud->count, sizeof *made->leaflet, error) : NULL;
    return made->organ && (made->leaflet || !found->leaflet) && make_label_room(found, cloud, error);
}

plm_status plm_work_give_labels(const plm_work *work, plm_segmentation *found, plm_cloud *cloud, plm_segmentation *to,
                                plm_error *error)
{
    const bool has_labels = cloud->label != NULL, has_organs = cloud->organ != NULL;
    plm_segmentation made = *found;
    made.label = NULL;
    made.organ = made.leaflet = NULL;
    uint32_t *source = plm_alloc(cloud->count, sizeof *source, error);
    plm_status status = source && make_room(found, cloud, &made, error) ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = find_source(work, cloud, found->spacing, source, error);
    if (status != PLM_OK) {
        plm_free(made.label);
        plm_free(made.organ);
        plm_free(made.leaflet);
        plm_free(source);
        return status;
    }
    for (size_t row = 0; row < cloud->count; row++) {
        const uint32_t from = source[row];
        const bool was_seen = from != PLM_NO_ROW && work->row[from] == row;
        plm_label label = PLM_LABEL_OTHER;
        int32_t organ = -1, leaflet = -1;
        if (was_seen || (from != PLM_NO_ROW && !has_labels)) {
            label = (plm_label)found->label[from];
            organ = found->organ[from];
            if (found->leaflet) leaflet = found->leaflet[from];
        } else if (has_labels) {
            label = cloud->label[row] < PLM_LABEL_COUNT ? (plm_label)cloud->label[row] : PLM_LABEL_OTHER;
            organ = has_organs ? cloud->organ[row] : 0;
        }
        cloud->label[row] = made.label[row] = (uint8_t)label;
        cloud->organ[row] = made.organ[row] = organ;
        if (made.leaflet) cloud->leaflet[row] = made.leaflet[row] = leaflet;
    }
    plm_free(source);
    found->leaf_flags = NULL; /* moved with the struct */
    *to = made;
    return PLM_OK;
}

plm_status plm_segmentation_to_cloud(const plm_segmentation *segmentation, plm_cloud *cloud, plm_error *error)
{
    if (!make_label_room(segmentation, cloud, error)) return PLM_E_MEMORY;
    memcpy(cloud->label, segmentation->label, cloud->count * sizeof *cloud->label);
    memcpy(cloud->organ, segmentation->organ, cloud->count * sizeof *cloud->organ);
    if (cloud->leaflet) memcpy(cloud->leaflet, segmentation->leaflet, cloud->count * sizeof *cloud->leaflet);
    return PLM_OK;
}
