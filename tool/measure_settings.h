/* tool/measure_settings.h: options about measuring, shared by `measure` and `plan`. */
#ifndef PLANTIMETER_TOOL_MEASURE_SETTINGS_H
#define PLANTIMETER_TOOL_MEASURE_SETTINGS_H

#include "tool/reading.h"

typedef struct measure_settings {
    reading_settings reading;
    const char *output, *traits, *ground, *correction, *share;
    double stem_height, alpha, time_budget;
    plm_texts target_error;
    int neighbours, effort, points, habit, threads, files, views;
    uint64_t seed;
    bool force, quiet, json;
} measure_settings;

/** What holds where no option says otherwise. */
measure_settings measure_setting_defaults(void);

/** Turns them into options of the library, and checks all that can be checked before a file is read. PLM_E_ARGUMENT. */
plm_status measure_options_of(const measure_settings *settings, plm_measure_options *options, plm_error *error);

#endif
