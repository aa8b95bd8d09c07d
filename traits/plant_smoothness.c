/* traits/plant_smoothness.c: the smoothness factor of the plant's points (laser-scanning paper, Eq. 1): mean, standard deviation
 * and share above 0.5 (boundary points). A diagnostic of the scan: 0 inside a flat leaf, towards 1 at edges. With N random
 * neighbours on a plane its expectation is about sqrt(pi / 4 N), not 0. */
#include "cloud/smoothness.h"
#include "traits/families.h"
#include "traits/scene.h"

#include <math.h>

plm_status plm_scene_smoothness(plm_scene *scene, plm_error *error)
{
    const size_t count = scene->plant_count, k = (size_t)scene->options->neighbours;
    scene->smoothness_mean = scene->smoothness_sd = scene->boundary_share = NAN;
    if (count < k + 1) return PLM_OK;
    float *factor = plm_alloc(count, sizeof *factor, error);
    if (!factor) return PLM_E_MEMORY;
    const plm_neighbour_measures measures = {.smoothness = factor};
    const plm_status status = plm_neighbour_pass((const float(*)[3])scene->plant, count, k, &measures, error);
    if (status == PLM_OK) {
        double sum = 0, squares = 0;
        size_t above = 0;
        for (size_t i = 0; i < count; i++) sum += factor[i];
        const double mean = sum / (double)count;
        for (size_t i = 0; i < count; i++) {
            squares += (factor[i] - mean) * (factor[i] - mean);
            above += factor[i] > 0.5f;
        }
        scene->smoothness_mean = mean;
        scene->smoothness_sd = sqrt(squares / (double)count);
        scene->boundary_share = (double)above / (double)count;
    }
    plm_free(factor);
    return status;
}

/* Points share neighbours: about k of them count as one. */
static double independent(const plm_scene *scene)
{
    return fmax(1, (double)scene->plant_count / scene->options->neighbours);
}

static plm_status give(const plm_scene *scene, double value, double std_error, plm_estimate *out)
{
    if (isnan(value))
        return plm_trait_failed(out, "%zu points; %d neighbours need more (--neighbours)", scene->plant_count,
                                scene->options->neighbours);
    out->value = value;
    out->std_error = std_error;
    out->method = "all points, k neighbours";
    return PLM_OK;
}

plm_status plm_trait_smoothness_mean(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                     plm_error *error)
{
    (void)organ, (void)error;
    return give(scene, scene->smoothness_mean, scene->smoothness_sd / sqrt(independent(scene)), out);
}

plm_status plm_trait_smoothness_sd(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    return give(scene, scene->smoothness_sd, scene->smoothness_sd / sqrt(2 * independent(scene)), out);
}

plm_status plm_trait_boundary_share(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    const double share = scene->boundary_share;
    return give(scene, share, sqrt(fmax(0, share * (1 - share)) / independent(scene)), out);
}
