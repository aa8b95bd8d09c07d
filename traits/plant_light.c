/* traits/plant_light.c: absorbed light of the measured surfaces: leaves, and stems and petioles as tubes about their fitted lines. The
 * rays are the caller's (plm_measure_options.light): this module knows no ray tracer. */
#include "traits/families.h"
#include "traits/leaf_surfaces.h"
#include "traits/plant_mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

plm_status plm_scene_light(plm_scene *scene, plm_error *error)
{
    plm_mesh mesh;
    if (!scene->options->light) {
        snprintf(scene->light_reason, sizeof scene->light_reason,
                 "no ray tracer was given (plm_measure_options.light)");
        return PLM_OK;
    }
    plm_status status = plm_scene_mesh(scene, false, &mesh, error);
    if (status != PLM_OK) return status;
    double *power = plm_alloc(scene->organ_count, sizeof *power, error);
    double *std_error = plm_alloc(scene->organ_count, sizeof *std_error, error);
    if (!power || !std_error)
        status = PLM_E_MEMORY;
    else if (mesh.triangle_count == 0)
        snprintf(scene->light_reason, sizeof scene->light_reason, "no organ has a surface");
    else
        status = scene->options->light(&mesh, mesh.face_organ, scene->organ_count, scene->options->seed, power,
                                       std_error, &scene->absorbed, &scene->absorbed_error, error);
    for (size_t k = 0; status == PLM_OK && mesh.triangle_count && k < scene->organ_count; k++) {
        scene->organ[k].absorbed = power[k];
        scene->organ[k].absorbed_error = std_error[k];
    }
    plm_free(power);
    plm_free(std_error);
    plm_mesh_free(&mesh);
    return status;
}

static const char *const method = "rays through leaf surfaces and tubes";

/* An area that is wrong by a share makes the light wrong by about that share. */
static double with_area_error(double power, double ray_error, double area, double area_error)
{
    return area > 0 ? hypot(ray_error, power * area_error / area) : ray_error;
}

plm_status plm_trait_absorbed_radiation(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                        plm_error *error)
{
    if (scene->light_reason[0]) return plm_not_applicable(out, "%s", scene->light_reason);
    plm_estimate area = {.value = 0};
    const plm_status status = plm_trait_total_leaf_area(scene, organ, &area, error);
    if (status != PLM_OK) return status;
    const bool has_area = area.state == PLM_STATE_OK;
    out->value = scene->absorbed;
    out->std_error = has_area ? with_area_error(scene->absorbed, scene->absorbed_error, area.value, area.std_error)
                              : scene->absorbed_error;
    out->flags |= area.flags;
    out->method = method;
    return PLM_OK;
}

plm_status plm_trait_leaf_absorbed_radiation(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                             plm_error *error)
{
    (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    if (scene->light_reason[0]) return plm_not_applicable(out, "%s", scene->light_reason);
    out->value = leaf->absorbed;
    out->std_error =
        with_area_error(leaf->absorbed, leaf->absorbed_error, leaf->surface.area, plm_leaf_area_error(leaf));
    out->method = method;
    return PLM_OK;
}
