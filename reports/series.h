/* reports/series.h: the same plants on several days: traits over time, growth rates, outliers. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_SERIES_H
#define PLANTIMETER_REPORTS_SERIES_H

#include "reports/results.h"

/** One value of a plant's trait on a day. */
typedef struct plm_series_point {
    double day; /**< since the first date */
    const char *date;
    double value, std_error; /**< in the trait's unit; std_error NAN: unknown */
    bool is_outlier;
} plm_series_point;

/** A plant's trait over time: points [first, first + count) of the series. */
typedef struct plm_series_line {
    const char *plant_id;
    const plm_trait *trait;
    size_t first, count;
} plm_series_line;

/** A rate with its standard error (NAN: unknown or not defined). */
typedef struct plm_rate {
    double value, std_error;
} plm_rate;

/** Runs of the same plants, by date. */
typedef struct plm_series {
    size_t run_count;
    plm_results *run; /**< in the order of the dates */
    double *day;
    char **date; /**< as given */
    size_t point_count, line_count;
    plm_series_point *point; /**< line by line, by day */
    plm_series_line *line;   /**< by trait, in the order of the trait table, then by plant */
} plm_series;

/** Reads runs and their dates, joins them by plant_id, and marks outliers. dates: CSV with the columns run (as in folder, or its
 * last name) and date: 2026-05-02, 2026-05-02T09:30, or a number of days. Traits of the plant and of its main stem.
 * PLM_E_READ, PLM_E_FORMAT (a date that cannot be read), PLM_E_ARGUMENT (a run without date, two runs of one time). */
plm_status plm_series_open(plm_series *made, char *const *folder, size_t count, const char *dates, plm_error *error);
void plm_series_close(plm_series *series);

/** Days since 1970-01-01 of a date, or the number that it is. False for anything else. */
bool plm_series_date(const char *text, double *days);

/** Marks points that jump: the difference to the line through the neighbouring days is beyond 3.5 (B. Iglewicz and D. Hoaglin,
 * How to detect and handle outliers, 1993) times the larger of its standard error and the robust SD of such differences over all
 * lines of the trait (relative to the value). The largest first, then again without it. Fewer than 4 days: none. */
plm_status plm_series_mark_outliers(plm_series *series, plm_error *error);

/** Absolute rate (unit a day) and relative rate (a day) between two points: (b - a) / dt and (ln b - ln a) / dt, errors by
 * propagation (R. Hunt, Plant growth curves, 1982). The relative rate of values that are not positive is NAN. */
void plm_series_rates(const plm_series_point *a, const plm_series_point *b, plm_rate *absolute, plm_rate *relative);

/** The same over all days but outliers: slopes of weighted least squares on the values and on their logarithms; weights from the
 * standard errors where all points have one. The error is the larger of what the weights say and what the scatter about the
 * line says. NAN below two days. */
void plm_series_fit(const plm_series *series, const plm_series_line *line, plm_rate *absolute, plm_rate *relative);

/** Writes series.csv (long), wide.csv (a column a date) and growth.csv (each interval and the whole) into folder. */
plm_status plm_series_write(const plm_series *series, const char *folder, plm_error *error);

/** Draws each trait over time (gnuplot; script and data are kept): folder/TRAIT.svg and .png. drawn: out, false without gnuplot. */
plm_status plm_series_plots(const plm_series *series, const char *folder, bool *drawn, plm_error *error);

#endif
