/* tool/talk.h: what is told while plants are measured: stages on a terminal, warnings, and the short table. */
#ifndef PLANTIMETER_TOOL_TALK_H
#define PLANTIMETER_TOOL_TALK_H

#include "reports/results.h"

/** A line on the terminal that stages write over. All to stderr; nothing into a pipe, nothing when quiet. */
typedef struct progress_line {
    bool is_shown;
    const char *plant_id;
    size_t number, total;
} progress_line;

progress_line progress_begin(bool quiet);
/** A plm_measure_options.progress. user is the progress_line. */
void progress_stage(const char *stage, void *user);
/** Wipes the line. */
void progress_end(const progress_line *line);

/** The short table: a line a plant. traits: the list that was asked for, NULL for all. */
plm_status print_short_table(const plm_results *results, const char *traits, plm_error *error);

#endif
