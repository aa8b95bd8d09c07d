/* tool/light_hook.c: the ray tracer of simulate/ as traits/ wants it: neither module knows the other. */
#include "tool/light_hook.h"

#include "simulate/simulate.h"

#include <string.h>

plm_status light_hook(const plm_mesh *mesh, const int32_t *face_group, size_t group_count, uint64_t seed,
                      double *group_power, double *group_std_error, double *power, double *std_error, plm_error *error)
{
    plm_light_options options;
    plm_light light;
    plm_light_defaults(&options);
    options.seed = seed;
    options.rays = 1000000;
    options.irradiance = 1000;
    const plm_status status = plm_light_trace(mesh, face_group, group_count, &options, &light, error);
    if (status != PLM_OK) return status;
    memcpy(group_power, light.group_power, group_count * sizeof *group_power);
    memcpy(group_std_error, light.group_std_error, group_count * sizeof *group_std_error);
    *power = light.absorbed;
    *std_error = light.absorbed_std_error;
    plm_light_free(&light);
    return PLM_OK;
}
