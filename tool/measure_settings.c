/* tool/measure_settings.c: from options of the command line to options of the library. */
#include "tool/measure_settings.h"

#include "reports/report.h"
#include "tool/light_hook.h"
#include "traits/plan.h"

#include <string.h>

measure_settings measure_setting_defaults(void)
{
    plm_measure_options library;
    plm_measure_defaults(&library);
    return (measure_settings){.stem_height = library.stem_height,
                              .neighbours = library.neighbours,
                              .effort = (int)library.effort,
                              .seed = library.seed,
                              .views = PLM_REPORT_VIEWS,
                              .reading.minimum_opacity = 0.005};
}

/* auto, none or a height. */
static plm_status parse_ground(const char *text, plm_measure_options *options, plm_error *error)
{
    options->ground = PLM_GROUND_AUTO;
    if (!text || !strcmp(text, "auto")) return PLM_OK;
    options->ground = PLM_GROUND_NONE;
    if (!strcmp(text, "none")) return PLM_OK;
    options->ground = PLM_GROUND_HEIGHT;
    if (plm_parse_length(text, &options->ground_height, error) == PLM_OK) return PLM_OK;
    return plm_fail(error, PLM_E_ARGUMENT, "--ground: \"%s\"; expected auto, none or a height such as 12mm", text);
}

plm_status measure_options_of(const measure_settings *settings, plm_measure_options *options, plm_error *error)
{
    plm_measure_options made;
    plm_measure_defaults(&made);
    made.traits = settings->traits;
    made.up = (plm_up)settings->reading.up;
    made.stem_height = settings->stem_height;
    made.neighbours = settings->neighbours;
    made.alpha = settings->alpha;
    made.effort = (plm_effort)settings->effort;
    made.points = (size_t)settings->points;
    made.habit = (plm_habit)settings->habit;
    made.seed = settings->seed;
#ifndef PLM_WITHOUT_LIGHT
    made.light = light_hook;
#endif
    plm_plan plan;
    plm_status status = check_reading(&settings->reading, error);
    if (status == PLM_OK) status = parse_ground(settings->ground, &made, error);
    if (status == PLM_OK) status = plm_plan_make(&made, 0, &plan, error); /* knows the names of traits */
    if (status == PLM_OK) *options = made;
    return status;
}
