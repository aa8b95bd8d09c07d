/* traits/plant_hull.c: volume and area of the plant's convex hull. Sampling makes a hull too small, noise makes it too large. In noise
 * what nothing supports (ghosts) is peeled off first, points near the hull are projected onto local quadrics, and where the surface
 * ends at the corners is told by the points about them (traits/hull_corners.c), with the noise that is left in each; the insets of voxel
 * means and of fitted discs are shares of their size. Without noise corners, and how much a random half of the points loses (a deficit
 * that grows as n^-0.58, between wedge tips and smooth rims, wants the Richardson factor 2.0), tell half each; without an index of the
 * points halves alone. Condition: 1 in volume; for a sheet the volume is noise over thickness, which the standard error shows. */
#include "cloud/random.h"
#include "traits/extreme.h"
#include "traits/families.h"
#include "traits/hull_corners.h"
#include "traits/near_hull.h"
#include "traits/projection.h"
#include "traits/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HALVES = 12, MOST_PEELS = 24 };

/** The hull after projection. */
typedef struct hull_measure {
    double volume, area;
    double half_volume, half_area, half_volume_sd; /* of random halves; without noise */
    double lacking, lacking_error;                 /* behind its corners */
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

/* The points near the hull, projected in noise (points: that surfaces are fitted to); those that belong to no surface are left out. near:
 * overwritten. Gives how many. */
static size_t project_near(const plm_scene *scene, const plm_subset *points, bool *near, float (*out)[3])
{
    const int64_t count = (int64_t)scene->plant_count;
    size_t used = 0;
    for (int64_t i = 0; i < count; i++)
        if (near[i]) memcpy(out[used++], scene->plant[i], sizeof *out);
    if (!points) return used;
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

/* What lacks at the corners: in noise of the projected hull, else of the plant's own. points: NULL without noise. */
static plm_status measure_corners(const plm_scene *scene, const bool *use, const plm_subset *points,
                                  const plm_mesh *projected, hull_measure *m, plm_error *error)
{
    if (!scene->plant_index) return PLM_OK;
    if (!points)
        return plm_hull_corners(&scene->hull, scene->plant_index, (const float(*)[3])scene->plant, &m->lacking,
                                &m->lacking_error, error);
    return plm_hull_noisy_corners(projected, points, use, &scene->sampling, &m->lacking, &m->lacking_error, error);
}

/* points: NULL without noise. */
static plm_status measure_skin(const plm_scene *scene, const plm_subset *points, const bool *use, bool *near,
                               hull_measure *m, plm_error *error)
{
    const double depth = 6 * fmax(scene->sampling.noise, scene->sampling.spacing);
    size_t count;
    plm_status status = plm_near_hull(&scene->hull, (const float(*)[3])scene->plant, use, scene->plant_count, depth,
                                      near, &count, error);
    if (status != PLM_OK) return status;
    float(*skin)[3] = plm_alloc(count, sizeof *skin, error);
    if (!skin) return PLM_E_MEMORY;
    plm_mesh hull = {0};
    count = project_near(scene, points, near, skin);
    status = plm_convex_hull((const float(*)[3])skin, count, &m->volume, &m->area, points ? &hull : NULL, error);
    if (status == PLM_OK && !points)
        status = measure_halves((const float(*)[3])skin, count, scene->options->seed, m, error);
    if (status == PLM_OK) status = measure_corners(scene, use, points, &hull, m, error);
    plm_mesh_free(&hull);
    plm_free(skin);
    return status;
}

static plm_status measure_hull(plm_scene *scene, bool noisy, hull_measure *m, plm_error *error)
{
    bool *near = plm_alloc(scene->plant_count, sizeof *near, error);
    bool *use = plm_alloc(scene->plant_count, sizeof *use, error);
    plm_status status = near && use ? PLM_OK : PLM_E_MEMORY;
    for (size_t i = 0; use && i < scene->plant_count; i++) use[i] = true;
    plm_subset points = {0};
    if (status == PLM_OK && noisy) status = peel(scene, use, near, error);
    if (status == PLM_OK && noisy)
        status = plm_fit_points(scene->plant_index, (const float(*)[3])scene->plant, scene->plant_count,
                                &scene->sampling, &points, error);
    if (status == PLM_OK) status = measure_skin(scene, noisy ? &points : NULL, use, near, m, error);
    plm_subset_free(&points);
    plm_free(near);
    plm_free(use);
    return status;
}

/** A correction and its standard error. */
typedef struct correction {
    double gain, error;
} correction;

/* Voxel means whose voxels are known: the more pixels a voxel has, the farther out one of them makes one. Inset in voxels =
 * pixel_inset - pixel_outset x gathering (plm_sampling), between two families of virtual depth cameras: fitted to one of them, in
 * images of 960 to 2800 columns, it would be steeper by two or three. */
static const double pixel_inset = 0.3, pixel_outset = 0.7;
/* How far off that is, in voxels; of voxels that are not known, in spacings (maximum likelihood on 196 virtual scans, with the corners'
 * own errors). */
static const double inset_unknown = 0.1, voxel_unknown = 0.3;

static double voxel_inset(const plm_scene *scene, const hull_measure *m)
{
    return scene->sampling.pitch * (pixel_inset - pixel_outset * scene->sampling.gathering) * m->area;
}

/* Halves and corners half each: where rims are straight the corners lack too much, where tips are few halves scatter (144 clean
 * plants: 0.161 by halves, 0.146 by corners, 0.144 % by both). What the two are apart is in doubt by half. */
static correction without_noise(const plm_scene *scene, const hull_measure *m)
{
    const double deficit = m->volume - m->half_volume, voxels = voxel_inset(scene, m);
    if (!scene->plant_index) return (correction){2 * deficit + voxels, hypot(0.5 * deficit, m->half_volume_sd)};
    return (correction){0.5 * m->lacking + deficit + voxels,
                        hypot(hypot(m->half_volume_sd, m->lacking_error), 0.5 * m->lacking - deficit)};
}

/* Of what corners lack, in voxel means: 172 virtual scans and four of another family ask for it. */
static const double fused_share = 0.85;

static correction of_voxel_means(const plm_scene *scene, const hull_measure *m)
{
    const plm_sampling *s = &scene->sampling;
    const double unknown = s->pitch > 0 ? inset_unknown * s->pitch : voxel_unknown * s->spacing;
    return (correction){fused_share * m->lacking + voxel_inset(scene, m), hypot(m->lacking_error, unknown * m->area)};
}

/* What is in doubt: the corners' own errors times what, and a share of the noise (184 virtual splats of 0.2 to 0.8 mm of noise and 12 to
 * 120 thousand points). */
static const double corner_errors = 1.2, noise_unknown = 0.15;

static correction in_noise(const plm_scene *scene, const hull_measure *m)
{
    const double shell = scene->sampling.noise * m->area, disc = PLM_DISC_REACH * scene->sampling.extent * m->area;
    return (correction){m->lacking + disc, hypot(hypot(corner_errors * m->lacking_error, noise_unknown * shell), disc)};
}

/* By how much of what its volume grows by, relatively, a hull's area grows: of a ball two thirds, of the flat hulls of plants, which
 * noise thickens rather than widens, less (184 splats 0.46, 220 scans by depth cameras 0.5). */
static const double area_share = 0.5;
/* The same of the volume's standard error: a little more, as that share differs between plants (120 a mode). */
static const double area_share_unsure = 0.65;

static double grown_area(const hull_measure *m, double gain)
{
    return m->volume > 0 ? area_share * gain / m->volume * m->area : 0;
}

/* A sheet's area does not grow as its volume does: its rim is known to the noise or a spacing (here that of a square). */
static double sheet_area_error(const plm_sampling *sampling, double area)
{
    return 8 * sqrt(area / 2) * fmax(sampling->noise, sampling->spacing);
}

static void correct_noisy_area(plm_scene *scene, const hull_measure *m, const correction *volume)
{
    scene->hull_area = m->area;
    scene->hull_area_error = sheet_area_error(&scene->sampling, m->area);
    if (scene->hull_is_sheet) return;
    scene->hull_area += grown_area(m, volume->gain);
    scene->hull_area_error = area_share_unsure / area_share * fabs(grown_area(m, volume->error));
}

static void correct_area_without_noise(plm_scene *scene, const hull_measure *m)
{
    const double deficit = m->area - m->half_area;
    scene->hull_area = m->area + 2 * deficit + grown_area(m, voxel_inset(scene, m));
    scene->hull_area_error = 0.8 * fabs(deficit);
}

/* Values and standard errors from what was measured. */
static void correct(plm_scene *scene, const hull_measure *m, bool noisy)
{
    const correction volume = !noisy                  ? without_noise(scene, m)
                              : scene->sampling.fused ? of_voxel_means(scene, m)
                                                      : in_noise(scene, m);
    scene->hull_volume = m->volume + volume.gain;
    scene->hull_volume_error = volume.error;
    scene->hull_is_sheet = 0.3 * scene->sampling.noise * m->area > 0.1 * m->volume || !(scene->hull_volume > 0);
    if (noisy)
        correct_noisy_area(scene, m, &volume);
    else
        correct_area_without_noise(scene, m);
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
