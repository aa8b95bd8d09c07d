/* traits/plant_hull.c: volume and area of the plant's convex hull. Sampling makes a hull too small, noise makes it too large:
 * points near the raw hull are projected onto local quadrics first, and what is left of both is corrected by how much a
 * random half of the points loses (a deficit that grows as n^-0.58, between wedge tips and smooth rims, wants the
 * Richardson factor 2.0), in scans without noise by what its corners lack as well (traits/hull_corners.c), and by noise times
 * area. What nothing supports (ghosts) is peeled off first. The factors for noisy clouds are fits over virtual scans (see
 * factors_of). Condition: 1 in volume; for a sheet the volume is noise over thickness, which the standard error shows. */
#include "cloud/random.h"
#include "traits/extreme.h"
#include "traits/families.h"
#include "traits/hull_corners.h"
#include "traits/near_hull.h"
#include "traits/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HALVES = 12, MOST_PEELS = 24 };

/** The hull after projection, and of random halves. */
typedef struct hull_measure {
    double volume, area, half_volume, half_area, half_volume_sd;
    double lacking, lacking_error; /* behind its corners; 0 in noise */
} hull_measure;

/* Each random half and the other: a corner that one lacks the other has, so their mean scatters less (over 61 clean scans the
 * volume's error 0.24 and 0.19 %). */
static plm_status measure_halves(const float (*xyz)[3], size_t count, uint64_t seed, hull_measure *m, plm_error *error)
{
    float(*half)[3] = plm_alloc(count, sizeof *half, error);
    if (!half) return PLM_E_MEMORY;
    double volume[HALVES], sum = 0, areas = 0, squares = 0;
    plm_status status = PLM_OK;
    for (uint64_t h = 0; h < HALVES && status == PLM_OK; h++) {
        size_t used = 0;
        for (size_t i = 0; i < count; i++)
            if ((plm_mix((plm_mix(seed) + h / 2) * 0x9e3779b97f4a7c15u + i) + h) & 1)
                memcpy(half[used++], xyz[i], sizeof *half);
        double area;
        status = plm_convex_hull((const float(*)[3])half, used, &volume[h], &area, NULL, error);
        if (status == PLM_OK) sum += volume[h], areas += area;
    }
    plm_free(half);
    if (status != PLM_OK) return status;
    m->half_volume = sum / HALVES;
    m->half_area = areas / HALVES;
    for (int h = 0; h < HALVES; h++) squares += pow(volume[h] - m->half_volume, 2);
    m->half_volume_sd = sqrt(squares / (HALVES - 1));
    return PLM_OK;
}

/* The points near the hull, projected when noisy; those that belong to no surface are left out. Gives how many. */
static size_t project_near(const plm_scene *scene, const plm_subset *points, bool *near, float (*out)[3], bool noisy)
{
    const int64_t count = (int64_t)scene->plant_count;
    size_t used = 0;
    for (int64_t i = 0; i < count; i++)
        if (near[i]) memcpy(out[used++], scene->plant[i], sizeof *out);
    if (!noisy) return used;
    const int64_t candidates = (int64_t)used;
#pragma omp parallel for schedule(dynamic, 64)
    for (int64_t i = 0; i < candidates; i++) {
        plm_projection onto;
        near[i] = plm_project_to_surface(points, out[i], scene->sampling.noise, &onto);
        if (near[i]) memcpy(out[i], onto.place, sizeof *out);
    }
    used = 0;
    for (int64_t i = 0; i < candidates; i++)
        if (near[i]) memmove(out[used++], out[i], sizeof *out);
    return used;
}

/* Hull of the rows in use. */
static plm_status hull_of_used(const plm_scene *scene, const bool *use, plm_mesh *hull, plm_error *error)
{
    float(*kept)[3] = plm_alloc(scene->plant_count, sizeof *kept, error);
    if (!kept) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; i < scene->plant_count; i++)
        if (use[i]) memcpy(kept[count++], scene->plant[i], sizeof *kept);
    double volume, area;
    plm_mesh_free(hull);
    const plm_status status = plm_convex_hull((const float(*)[3])kept, count, &volume, &area, hull, error);
    plm_free(kept);
    return status;
}

/* Takes points out that nothing supports, as long as new ones come to lie at the hull: scene->hull becomes that of the rest,
 * use says which points that are. near: room for a plant's rows. */
static plm_status peel(plm_scene *scene, bool *use, bool *near, plm_error *error)
{
    const double depth = 1.5 * fmax(scene->sampling.noise, scene->sampling.spacing);
    const int64_t count = (int64_t)scene->plant_count;
    plm_status status = PLM_OK;
    for (int round = 0; round < MOST_PEELS && status == PLM_OK; round++) {
        size_t found, dropped = 0;
        status = plm_near_hull(&scene->hull, (const float(*)[3])scene->plant, use, scene->plant_count, depth, near,
                               &found, error);
        if (status != PLM_OK) break;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : dropped)
        for (int64_t i = 0; i < count; i++) {
            if (!near[i]) continue;
            use[i] = plm_is_supported(scene->plant_index, (const float(*)[3])scene->plant, scene->plant[i],
                                      &scene->sampling);
            dropped += !use[i];
        }
        if (dropped == 0) break;
        status = hull_of_used(scene, use, &scene->hull, error);
    }
    return status;
}

static plm_status measure_skin(const plm_scene *scene, const bool *use, bool *near, bool noisy, hull_measure *m,
                               plm_error *error)
{
    const double depth = 6 * fmax(scene->sampling.noise, scene->sampling.spacing);
    size_t count;
    plm_status status = plm_near_hull(&scene->hull, (const float(*)[3])scene->plant, use, scene->plant_count, depth,
                                      near, &count, error);
    if (status != PLM_OK) return status;
    float(*skin)[3] = plm_alloc(count, sizeof *skin, error);
    if (!skin) return PLM_E_MEMORY;
    plm_subset points = {0};
    if (noisy)
        status = plm_fit_points(scene->plant_index, (const float(*)[3])scene->plant, scene->plant_count,
                                &scene->sampling, &points, error);
    if (status == PLM_OK) count = project_near(scene, &points, near, skin, noisy);
    plm_subset_free(&points);
    if (status == PLM_OK) status = plm_convex_hull((const float(*)[3])skin, count, &m->volume, &m->area, NULL, error);
    if (status == PLM_OK) status = measure_halves((const float(*)[3])skin, count, scene->options->seed, m, error);
    if (status == PLM_OK && !noisy && scene->plant_index)
        status = plm_hull_corners(&scene->hull, scene->plant_index, (const float(*)[3])scene->plant, &m->lacking,
                                  &m->lacking_error, error);
    plm_free(skin);
    return status;
}

static plm_status measure_hull(plm_scene *scene, bool noisy, hull_measure *m, plm_error *error)
{
    bool *near = plm_alloc(scene->plant_count, sizeof *near, error);
    bool *use = plm_alloc(scene->plant_count, sizeof *use, error);
    plm_status status = near && use ? PLM_OK : PLM_E_MEMORY;
    for (size_t i = 0; use && i < scene->plant_count; i++) use[i] = true;
    if (status == PLM_OK && noisy) status = peel(scene, use, near, error);
    if (status == PLM_OK) status = measure_skin(scene, use, near, noisy, m, error);
    plm_free(near);
    plm_free(use);
    return status;
}

/** Factors of the corrections: of the halves' deficit, of noise x area, of its square over the volume, and of the
 * reach of a splat's discs x area; the standard errors of the first two; and likewise of the hull's area, relatively. */
typedef struct hull_factors {
    double deficit, noise, thin, disc, deficit_error, noise_error;
    double corners; /* of what they lack (traits/hull_corners.h) */
    /** Deficits of less than this many shells come from smooth surfaces, where projection takes the noise away; it stays at
     * rims and tips, which a random half of the points misses. */
    double smooth;
    double area_deficit, area_noise, area_noise_error;
} hull_factors;

/* The area of a ball grows by two thirds of what its volume grows by; noise thickens the flat hulls of plants rather than
 * widening them. */
static const double ball = 2.0 / 3;

static const double thin_error = 0.3; /* of what thin takes off */

/* Voxel means whose voxels are known: the more pixels a voxel has, the farther out one of them makes one. Inset in voxels =
 * pixel_inset - pixel_outset x gathering (plm_sampling), between two families of virtual depth cameras: fitted to one of them, in
 * images of 960 to 2800 columns, it would be steeper by two or three. */
static const double pixel_inset = 0.3, pixel_outset = 0.7;

/* thin: the noise of rims adds to a hull on both sides, the more the less lies between them: fitted, with the two before, to 191
 * virtual splats of 0.5 mm of noise from rosettes of 20 mm to maize (error 0.80 %, of each quarter by the others' fit 0.84; of 80 others
 * of 10 to 120 thousand points and 0.1 to 0.8 mm 1.2 %). Other noisy scans that are not voxel means take them too. For voxel means
 * `noise` is between what 290 scans by virtual depth cameras ask for (0.5: rosettes -0.2, others -0.4 %) and four of another family (0.2). */
static hull_factors factors_of(const plm_scene *scene, bool noisy)
{
    /* Halves and corners half each: where rims are straight the corners lack too much, where tips are few halves scatter (144 clean
     * plants: 0.161 by halves, 0.146 by corners, 0.144 % by both). */
    if (!noisy && scene->plant_index) return (hull_factors){.corners = 0.5, .deficit = 1.0, .area_deficit = 2.0};
    if (!noisy) return (hull_factors){.deficit = 2.0, .deficit_error = 0.5, .area_deficit = 2.0};
    if (scene->sampling.fused)
        return (hull_factors){
            .noise = 0.4, .deficit_error = 0.5, .noise_error = 0.4, .area_noise = 0.09, .area_noise_error = 0.15};
    if (scene->is_splat)
        return (hull_factors){.deficit = 1.9,
                              .noise = 0.4,
                              .disc = 0.4,
                              .deficit_error = 0.8,
                              .noise_error = 0.4,
                              .area_deficit = 1.9,
                              .area_noise = 0.4 * ball,
                              .area_noise_error = 0.13};
    return (hull_factors){.deficit = 2.7,
                          .noise = 1.45,
                          .thin = 5.9,
                          .deficit_error = 1.0,
                          .noise_error = 0.4,
                          .smooth = 0.13,
                          .area_deficit = 3.5,
                          .area_noise = 1.15,
                          .area_noise_error = 0.35};
}

/* Values and standard errors from what was measured. */
static void correct(plm_scene *scene, const hull_measure *m, bool noisy)
{
    const double sigma = scene->sampling.noise;
    const hull_factors f = factors_of(scene, noisy);
    const double deficit = m->volume - m->half_volume, shell = noisy ? sigma * m->area : 0,
                 disc = f.disc * scene->sampling.extent * m->area;
    const double rims = f.smooth > 0 && shell > 0 ? deficit / (deficit + f.smooth * shell) : 1;
    const double per_volume = m->volume > 0 ? m->area / m->volume : 0;
    const double share = sigma * per_volume; /* of the volume, in noise */
    const double thickened = f.thin * share * shell;
    const double voxels = scene->sampling.pitch * (pixel_inset - pixel_outset * scene->sampling.gathering) * m->area;
    /* Half of what the two ways to tell what a hull without noise lacks are apart. */
    const double apart = f.corners > 0 ? f.corners * m->lacking - f.deficit * deficit : 0;
    scene->hull_volume =
        m->volume + f.corners * m->lacking + f.deficit * deficit - rims * (f.noise * shell + thickened) + disc + voxels;
    scene->hull_volume_error = sqrt(
        pow(f.deficit_error * deficit, 2) + pow(f.noise_error * shell, 2) + pow(thin_error * rims * thickened, 2) +
        disc * disc + (noisy ? 0 : m->half_volume_sd * m->half_volume_sd) + pow(m->lacking_error, 2) + apart * apart);
    scene->hull_is_sheet = 0.3 * sigma * m->area > 0.1 * m->volume || !(scene->hull_volume > 0);
    const double area_deficit = m->area - m->half_area, added = rims * shell * per_volume;
    scene->hull_area =
        m->area + f.area_deficit * area_deficit - f.area_noise * added + ball * (disc + voxels) * per_volume;
    scene->hull_area_error =
        sqrt(pow(0.8 * area_deficit, 2) + pow(f.area_noise_error * added, 2) + pow(ball * disc * per_volume, 2));
    scene->hull_method = noisy ? "hull of the projected surface" : "hull, sampling gap added";
}

/* A plant without a hull is no failure of the measurement: the traits of the hull say it. */
plm_status plm_scene_hull(plm_scene *scene, plm_error *error)
{
    const bool noisy = scene->sampling.noise > PLM_NOISE_FREE * scene->sampling.spacing && scene->plant_index;
    double volume, area;
    hull_measure m = {0};
    plm_error trouble = {0};
    scene->hull_status =
        plm_convex_hull((const float(*)[3])scene->plant, scene->plant_count, &volume, &area, &scene->hull, &trouble);
    if (scene->hull_status == PLM_OK) scene->hull_status = measure_hull(scene, noisy, &m, &trouble);
    if (scene->hull_status == PLM_OK) {
        correct(scene, &m, noisy);
    } else if (scene->hull_status != PLM_E_DEGENERATE) {
        return plm_fail(error, scene->hull_status, "%s", trouble.message);
    } else {
        snprintf(scene->hull_reason, sizeof scene->hull_reason, "%.150s", trouble.message);
    }
    return PLM_OK;
}

plm_status plm_trait_hull_volume(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    if (scene->hull_status != PLM_OK) return plm_trait_failed(out, "%s", scene->hull_reason);
    if (scene->hull_is_sheet)
        return plm_trait_failed(out, "the hull is a sheet: %.2g mm of noise are not small against its thickness",
                                1e3 * scene->sampling.noise);
    out->value = scene->hull_volume;
    out->std_error = scene->hull_volume_error;
    out->method = scene->hull_method;
    return PLM_OK;
}

plm_status plm_trait_hull_area(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    if (scene->hull_status != PLM_OK) return plm_trait_failed(out, "%s", scene->hull_reason);
    out->value = scene->hull_area;
    out->std_error = scene->hull_area_error;
    out->method = scene->hull_method;
    return PLM_OK;
}
