/* reports/plots.h: static plots by gnuplot, from scripts that are kept beside their pictures. Internal. */
#ifndef PLANTIMETER_REPORTS_PLOTS_H
#define PLANTIMETER_REPORTS_PLOTS_H

#include "reports/validation.h"

/** For every trait of a validation, into folder (made where it is missing): TRAIT.dat (the pairs), TRAIT.gp (the script) and
 * TRAIT.svg and TRAIT.png (300 dots per inch): estimate against manual with the 1:1 line, the Deming line, 95 % bars, n, R2, RMSE,
 * rRMSE and MAPE; the Bland-Altman plot; the distribution of differences. In the SVG the pointer over a point names plant
 * and organ. Blue, orange and grey: told apart without red and green. drawn: out, false where gnuplot is not installed: the
 * scripts and data are there all the same. PLM_E_WRITE; PLM_E_LIBRARY where gnuplot fails (the message names the script). */
plm_status plm_validation_plots(const plm_validation *validation, const char *folder, bool *drawn, plm_error *error);

/** Runs gnuplot on a script, in the script's folder. ran: out, false where there is no gnuplot. */
plm_status plm_gnuplot_run(const char *folder, const char *script, bool *ran, plm_error *error);

#endif
