/* traits/plant_height.c: heights of a plant, by the definitions that are in use side by side. Condition: 1 (a difference of
 * two heights); the standard errors come from gap, noise and spacing at both ends (traits/extreme.c), or at the base from the
 * soil's scatter (traits/soil_base.c) or the rim of the stem's foot (traits/stem_foot.c). No index over the cloud is built, and
 * labels of organs play no part but where a low plant may hide its base (traits/rosette_base.c); then organs are found for it. So
 * height is the same whatever else is asked for. */
#include "cloud/voxel.h"
#include "traits/extreme.h"
#include "traits/families.h"
#include "traits/rosette_base.h"
#include "traits/scene.h"
#include "traits/soil_base.h"
#include "traits/stem_foot.h"

#include <math.h>
#include <stdlib.h>

static const double ZENITH[3] = {0, 0, 1}, NADIR[3] = {0, 0, -1};

/* least_noise: see plm_extreme_options. */
static plm_status find_top(const plm_scene *scene, double least_noise, plm_extreme *top, plm_error *error)
{
    const plm_extreme_options options = {.least_noise = least_noise, .disc = scene->sampling.extent};
    return plm_extreme_along((const float(*)[3])scene->plant, scene->plant_count, ZENITH, &options, top, error);
}

/* The noise of the whole of a plant that may be a rosette, or 0: the few small leaves at its top and the petioles at its foot
 * are narrower than what the noise is measured by, and read a tenth to a third less. The index that it is from is built for
 * the heights then. In fused scans it differs between places. */
static double noise_of_rosette(const plm_scene *scene)
{
    return !scene->options->deadline && !scene->sampling.fused ? scene->sampling.noise : 0;
}

/** What the base of a plant is known by. */
typedef enum base_by { BY_SURFACE, BY_PETIOLES, BY_PETIOLES_AND_SOIL, BY_SOIL, BY_STEM, BASES } base_by;

/* The stem's foot is cut off, so no disc ends short of it; the top's leaves tell the noise better than a thin stem, but for depth
 * cameras, which are noisier at a stem's sides than on leaves that many views see. */
static plm_status find_top_and_base(const plm_scene *scene, plm_extreme *top, plm_extreme *base, base_by *by,
                                    plm_error *error)
{
    const bool may_be_rosette = plm_may_be_rosette(scene);
    const double least = may_be_rosette ? noise_of_rosette(scene) : 0;
    plm_status status = find_top(scene, least, top, error);
    if (status != PLM_OK) return status;
    const plm_extreme_options options = {
        .noise = top->sampling.fused ? 0 : top->sampling.noise, .least_noise = least, .cut = !may_be_rosette};
    status = plm_extreme_along((const float(*)[3])scene->plant, scene->plant_count, NADIR, &options, base, error);
    bool lowered = false, on_soil = false, standing = false, cut = false;
    if (status == PLM_OK && may_be_rosette)
        status = plm_rosette_base(scene, top->value + base->value, base, &lowered, &on_soil, error);
    else if (status == PLM_OK)
        status = plm_soil_base(scene, top->value + base->value, base, &standing, error);
    if (status == PLM_OK && !may_be_rosette && !standing)
        status = plm_stem_foot((const float(*)[3])scene->plant, scene->plant_count, base, &cut, error);
    *by = lowered ? (on_soil ? BY_PETIOLES_AND_SOIL : BY_PETIOLES) : standing ? BY_SOIL : cut ? BY_STEM : BY_SURFACE;
    return status;
}

plm_status plm_trait_plant_height(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    plm_extreme top, base;
    base_by by;
    const plm_status status = find_top_and_base(scene, &top, &base, &by, error);
    if (status != PLM_OK) return status;
    out->value = top.value + base.value;
    out->std_error = hypot(top.std_error, base.std_error);
    static const char *const method[BASES] = {"extremes of the surface", "extremes of the surface, base by petioles",
                                              "extremes of the surface, base by petioles and soil",
                                              "top of the surface above the soil at the foot",
                                              "top of the surface above the end of the stem"};
    out->method = method[by];
    return PLM_OK;
}

plm_status plm_trait_height_above_ground(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                         plm_error *error)
{
    (void)organ;
    if (!scene->ground || !scene->ground->found) return plm_not_applicable(out, "no ground, pot or table was found");
    plm_extreme top;
    const plm_status status = find_top(scene, 0, &top, error);
    if (status != PLM_OK) return status;
    out->value = top.value + scene->cloud->origin[2] - scene->ground->soil_height;
    out->std_error = hypot(top.std_error, 1.5 * top.std_error); /* the soil plane is known no better than the top */
    out->method = "top of the surface above the soil";
    return PLM_OK;
}

static int ascending(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Heights of one point for each voxel, ascending: a voxel stands for the same area of surface, however densely it was
 * scanned. parity 0 or 1: only every other voxel; -1: all. */
static size_t voxel_heights(const plm_voxels *voxels, int parity, float *height)
{
    size_t count = 0;
    for (size_t i = 0; i < voxels->count; i++)
        if (parity < 0 || (int)(i & 1) == parity) height[count++] = voxels->xyz[i][2];
    qsort(height, count, sizeof *height, ascending);
    return count;
}

/* Mean of the heights at and above a share of them. */
static double mean_above(const float *height, size_t count, double share)
{
    const size_t first = (size_t)(share * (double)count);
    double sum = 0;
    for (size_t i = first; i < count; i++) sum += height[i];
    return sum / (double)(count - first);
}

static double percentile(const float *height, size_t count, double share)
{
    const double place = share * (double)(count - 1);
    const size_t below = (size_t)place;
    const double next = below + 1 < count ? height[below + 1] : height[below];
    return height[below] + (place - (double)below) * (next - height[below]);
}

static plm_status height_of(const plm_scene *scene, double (*level)(const float *, size_t, double), double share,
                            plm_estimate *out, plm_error *error)
{
    plm_extreme top, base;
    plm_voxels voxels = {0};
    float *height = NULL;
    const float(*xyz)[3] = (const float(*)[3])scene->plant;
    base_by by;
    plm_status status = find_top_and_base(scene, &top, &base, &by, error);
    const double extent = status == PLM_OK ? top.value + base.value : 0;
    if (status == PLM_OK && !(extent > 0)) status = plm_fail(error, PLM_E_DEGENERATE, "the plant has no height");
    /* 150 voxels high: fine against the traits' errors, coarse against the spacing of any cloud worth measuring */
    if (status == PLM_OK) status = plm_voxel_thin(xyz, scene->plant_count, extent / 150, &voxels, error);
    if (status == PLM_OK && !(height = plm_alloc(voxels.count, sizeof *height, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        double half[2];
        for (int parity = 0; parity < 2; parity++) {
            const size_t count = voxel_heights(&voxels, parity, height);
            half[parity] = count ? level(height, count, share) : NAN;
        }
        const size_t count = voxel_heights(&voxels, -1, height);
        out->value = level(height, count, share) + base.value;
        const double spread = isfinite(half[0]) && isfinite(half[1]) ? 0.5 * (half[0] - half[1]) : extent;
        out->std_error = sqrt(base.std_error * base.std_error + spread * spread + pow(extent / 150, 2) / 12);
        static const char *const method[BASES] = {"heights of equal areas", "heights of equal areas, base by petioles",
                                                  "heights of equal areas, base by petioles and soil",
                                                  "heights of equal areas above the soil at the foot",
                                                  "heights of equal areas above the end of the stem"};
        out->method = method[by];
    }
    plm_free(height);
    plm_voxels_free(&voxels);
    return status;
}

plm_status plm_trait_height_p98(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    return height_of(scene, percentile, 0.98, out, error);
}

plm_status plm_trait_height_p99(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    return height_of(scene, percentile, 0.99, out, error);
}

plm_status plm_trait_height_top10(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    return height_of(scene, mean_above, 0.90, out, error);
}
