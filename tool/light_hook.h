/* tool/light_hook.h: the ray tracer of simulate/ as traits/ wants it. */
#ifndef PLANTIMETER_TOOL_LIGHT_HOOK_H
#define PLANTIMETER_TOOL_LIGHT_HOOK_H

#include "traits/traits.h"

/** plm_measure_options.light: 1000 W/m2 from 72 directions of the sky, leaves pure green, a million rays. */
plm_light_function light_hook;

#endif
