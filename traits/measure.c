/* traits/measure.c: one plant from cloud to values: one pass over it. */
#include "traits/pass.h"
#include "traits/plan.h"

#include <math.h>

plm_status plm_check_points(const plm_cloud *cloud, plm_error *error)
{
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "the cloud has no points");
    for (size_t i = 0; i < cloud->count; i++) {
        const float *at = cloud->xyz[i];
        if (isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2])) continue;
        return plm_fail(error, PLM_E_ARGUMENT, "point %zu of the cloud is (%g, %g, %g); coordinates must be finite", i,
                        (double)at[0], (double)at[1], (double)at[2]);
    }
    return PLM_OK;
}

plm_status plm_measure(plm_cloud *cloud, const plm_measure_options *options, plm_measurement *measurement,
                       plm_error *error)
{
    plm_cloud taken = *cloud;
    *cloud = (plm_cloud){0};
    size_t trait_count;
    plm_traits(&trait_count);
    bool *chosen = plm_alloc(trait_count, sizeof *chosen, error);
    plm_pass pass = {0};
    plm_status status = chosen ? plm_check_points(&taken, error) : PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_trait_choose(options->traits, chosen, error);
    const plm_pass_options one = {.measure = options, .chosen = chosen, .points = plm_point_budget(options)};
    if (status == PLM_OK) status = plm_pass_run(&taken, &one, &pass, error);
    if (status == PLM_OK) status = plm_pass_finish(&pass, &taken, true, measurement, error);
    plm_cloud_free(&taken);
    plm_free(chosen);
    return status;
}
