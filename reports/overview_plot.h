/* reports/overview_plot.h: the main traits of every plant of a run side by side. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_OVERVIEW_PLOT_H
#define PLANTIMETER_REPORTS_OVERVIEW_PLOT_H

#include "reports/results.h"

/** Draws height, leaf area, leaf count and stem diameter of each plant with 95 % bars: folder/overview.svg and .png by gnuplot;
 * script and data are kept; the folder is made. drawn: out, false where gnuplot is not installed. PLM_E_WRITE, PLM_E_LIBRARY. */
plm_status plm_overview_plot(const plm_results *results, const char *folder, bool *drawn, plm_error *error);

#endif
