/* tool/visibility.h: traits of a plant that was seen in part, brought to what the whole plant would have: the laser-scanning paper's
 * normalisation by visible area, with the curves that `study thinning` wrote. */
#ifndef PLANTIMETER_TOOL_VISIBILITY_H
#define PLANTIMETER_TOOL_VISIBILITY_H

#include "reports/results.h"

/** One curve: relative trait = 1 + slope x (relative visible area - 1), with the SD of the study's steps about it. */
typedef struct visibility_curve {
    char trait[64];
    double slope, residual;
} visibility_curve;

typedef struct visibility_share {
    char *plant_id;
    double share;
} visibility_share;

/** What --visibility-correction and --visible-share say. */
typedef struct visibility {
    size_t curve_count, share_count;
    visibility_curve *curve;
    visibility_share *share; /* of single plants */
    double common_share;     /* of all others; 0: none */
} visibility;

/** Reads FILE or FILE:PLANT (the plant is needed where the file holds curves of several) and the share: a number above 0 to 1, or
 * a CSV with the columns plant_id and visible_share. PLM_E_ARGUMENT, PLM_E_READ, PLM_E_FORMAT. Free with visibility_free. */
plm_status visibility_read(const char *correction, const char *share, visibility *made, plm_error *error);
void visibility_free(visibility *made);

/** Writes corrected.csv: plant_id, trait, value, std_error, visible_share, corrected_value, corrected_std_error, unit. Plants without
 * a share, and traits without a curve, have no row. */
plm_status visibility_write(const visibility *made, const plm_results *results, const char *path, plm_error *error);

/** value and std_error of the whole plant: value / f, f = 1 + slope x (share - 1); the error of the curve is added to that of the
 * value. False where f is not above 0.05: then nothing is known. */
bool visibility_correct(const visibility_curve *curve, double share, double value, double std_error, double *corrected,
                        double *corrected_error);

#endif
