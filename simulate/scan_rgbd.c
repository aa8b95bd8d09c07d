/* simulate/scan_rgbd.c: depth views on a ring, put together by their (slightly wrong) poses and fused on voxels: a
 * voxel's point is the mean of its pixels, its label that of most of them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloud/random.h"
#include "simulate/view.h"

/* A pixel on its way into a voxel. Sorted by voxel, then by the order in which the pixels were seen. */
typedef struct voxel_pixel {
    uint64_t voxel;
    uint64_t order; /* row in samples */
} voxel_pixel;

static int by_voxel(const void *a, const void *b)
{
    const voxel_pixel *p = a, *q = b;
    if (p->voxel != q->voxel) return p->voxel < q->voxel ? -1 : 1;
    return (p->order > q->order) - (p->order < q->order);
}

static plm_status collect(const plm_stage_set *stage, const plm_scan_options *options, const plm_view *view,
                          plm_samples *samples, plm_error *error)
{
    plm_status status = PLM_OK;
    for (int row = 0; row < view->camera.height; row++)
        for (int column = 0; column < view->camera.width && status == PLM_OK; column++) {
            const size_t pixel = (size_t)row * (size_t)view->camera.width + (size_t)column;
            if (!(view->depth[pixel] > 0)) continue;
            double point[3], direction[3];
            plm_sample sample;
            plm_camera_unproject(&view->assumed, column + 0.5, row + 0.5, (double)view->depth[pixel], point);
            for (int i = 0; i < 3; i++) {
                sample.xyz[i] = (float)point[i];
                direction[i] = point[i] - view->assumed.position[i];
            }
            plm_sample_label(stage, view->face[pixel], direction, options->seed, &sample);
            if (view->is_ghost[pixel]) {
                sample.label = PLM_LABEL_OTHER;
                sample.organ = sample.leaflet = -1;
            }
            status = plm_samples_add(samples, &sample, error);
        }
    return status;
}

/* The kind of a sample as one number: class, organ, leaflet. */
static uint64_t kind_of(const plm_sample *sample)
{
    return ((uint64_t)sample->label << 56) | ((uint64_t)(uint32_t)(sample->organ + 1) << 24) |
           (uint64_t)(uint32_t)(sample->leaflet + 1);
}

/* The sample whose kind is most frequent among count of them (the first of these). Voxels hold few pixels. */
static const plm_sample *majority(const plm_samples *pixels, const voxel_pixel *member, size_t count)
{
    size_t best = 0, most = 0;
    for (size_t i = 0; i < count; i++) {
        const uint64_t kind = kind_of(&pixels->sample[member[i].order]);
        size_t same = 0;
        for (size_t j = 0; j < count; j++) same += kind_of(&pixels->sample[member[j].order]) == kind;
        if (same > most) {
            most = same;
            best = i;
        }
        if (2 * most > count) break;
    }
    return &pixels->sample[member[best].order];
}

static plm_status add_voxel(const plm_samples *pixels, const voxel_pixel *member, size_t count, plm_samples *fused,
                            plm_error *error)
{
    plm_sample mean = *majority(pixels, member, count);
    double place[3] = {0}, rgb[3] = {0};
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) {
            place[i] += (double)pixels->sample[member[k].order].xyz[i];
            rgb[i] += pixels->sample[member[k].order].rgb[i];
        }
    for (int i = 0; i < 3; i++) {
        mean.xyz[i] = (float)(place[i] / (double)count);
        mean.rgb[i] = (uint8_t)(rgb[i] / (double)count);
    }
    return plm_samples_add(fused, &mean, error);
}

static plm_status fuse(const plm_samples *pixels, double voxel, plm_samples *fused, plm_error *error)
{
    voxel_pixel *order = plm_alloc(pixels->count, sizeof *order, error);
    plm_status status = order ? PLM_OK : PLM_E_MEMORY;
    for (size_t k = 0; status == PLM_OK && k < pixels->count; k++) {
        uint64_t key = 0;
        for (int i = 0; i < 3; i++) /* 21 bits an axis: a million voxels to each side of the origin */
            key = (key << 21) |
                  ((uint64_t)(int64_t)(floor((double)pixels->sample[k].xyz[i] / voxel) + 1048576) & 0x1fffff);
        order[k] = (voxel_pixel){key, k};
    }
    if (status == PLM_OK) qsort(order, pixels->count, sizeof *order, by_voxel);
    for (size_t first = 0, last; status == PLM_OK && first < pixels->count; first = last) {
        for (last = first; last < pixels->count && order[last].voxel == order[first].voxel;) last++;
        status = add_voxel(pixels, order + first, last - first, fused, error);
    }
    plm_free(order);
    return status;
}

/* Keeps about `wanted` points, at random. */
static void thin(plm_samples *samples, size_t wanted, uint64_t seed)
{
    const uint64_t key = plm_key(seed, 15);
    size_t kept = 0, needed = wanted;
    const size_t count = samples->count;
    for (size_t k = 0; k < count; k++)
        if (plm_uniform_at(key, k) * (double)(count - k) < (double)needed) {
            samples->sample[kept++] = samples->sample[k];
            needed--;
        }
    samples->count = kept;
}

plm_status plm_scan_rgbd(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                         plm_scan *scan, plm_error *error)
{
    plm_samples pixels = {0};
    plm_status status = PLM_OK;
    size_t ghosts = 0;
    for (int k = 0; k < options->views && status == PLM_OK; k++) {
        plm_view view = {0};
        status = plm_view_take(stage, options, k, &view, error);
        if (status == PLM_OK && options->views_folder) status = plm_view_write(stage, options, k, &view, error);
        if (status == PLM_OK) status = collect(stage, options, &view, &pixels, error);
        scan->pixels += view.pixels;
        ghosts += view.ghosts;
        plm_view_free(&view);
    }
    if (status == PLM_OK && !pixels.count)
        status = plm_fail(error, PLM_E_DEGENERATE, "none of %d views saw anything", options->views);
    if (status == PLM_OK) status = fuse(&pixels, options->voxel, samples, error);
    if (status == PLM_OK) {
        scan->ghost_share = (double)ghosts / (double)scan->pixels;
        if (options->points && options->points < samples->count) thin(samples, options->points, options->seed);
        status = plm_add_floaters(stage, options->outliers, options->seed, samples, error);
    }
    plm_free(pixels.sample);
    return status;
}
