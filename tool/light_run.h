/* tool/light_run.h: lighting the meshes that `light` was given. */
#ifndef PLANTIMETER_TOOL_LIGHT_RUN_H
#define PLANTIMETER_TOOL_LIGHT_RUN_H

#include "simulate/simulate.h"

typedef struct light_settings {
    const char *output, *reflectance, *transmittance;
    int rays, sources, depth, unit, up, threads;
    double power, irradiance;
    uint64_t seed;
    bool is_quiet;
    plm_light_options light; /* made of the above */
} light_settings;

/** Lights every input (a mesh file or a folder of `measure`) and writes the results. A plant that fails does not stop the
 * others. Gives the exit code. */
int light_run(const light_settings *settings, char *const *input, size_t count);

#endif
