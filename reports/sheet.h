/* reports/sheet.h: a CSV under way; the first failure stays, and every call behind it does nothing. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_SHEET_H
#define PLANTIMETER_REPORTS_SHEET_H

#include "reports/csv_write.h"

typedef struct plm_sheet {
    plm_output *output;
    plm_status status;
    plm_error *error;
} plm_sheet;

/** Opens folder/name for writing. */
plm_sheet plm_sheet_open(const char *folder, const char *name, plm_error *error);
/** One cell and what stands behind it (a comma or a line end). */
void plm_sheet_text(plm_sheet *sheet, const char *cell, char behind);
void plm_sheet_number(plm_sheet *sheet, double value, char behind);
/** A cell in quotes, whatever it holds. */
void plm_sheet_quoted(plm_sheet *sheet, const char *cell, char behind);
/** A line of column names, as it stands. */
void plm_sheet_line(plm_sheet *sheet, const char *line);
/** Renames the file into place where all went well. Gives the first failure. */
plm_status plm_sheet_close(plm_sheet *sheet);

#endif
