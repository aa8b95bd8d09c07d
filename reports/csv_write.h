/* reports/csv_write.h: cells of CSV files, the same in every table. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_CSV_WRITE_H
#define PLANTIMETER_REPORTS_CSV_WRITE_H

#include "io/io.h"

/** Room for any number of plm_format_number. */
enum { PLM_NUMBER_LENGTH = 32 };

/** The shortest decimal that reads back to 9 significant digits of value, with a point whatever the locale is; NaN and
 * Inf give "", so that no table shows them. Gives text. */
const char *plm_format_number(double value, char text[PLM_NUMBER_LENGTH]);

/** Writes one cell, quoted where it holds a separator, a quote or a line end (RFC 4180), and the separator or line end
 * behind it. */
plm_status plm_csv_text(plm_output *output, const char *text, char behind, plm_error *error);
plm_status plm_csv_number(plm_output *output, double value, char behind, plm_error *error);

#endif
