/* reports/csv_table.h: reading a CSV as people and spreadsheets write it. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_CSV_TABLE_H
#define PLANTIMETER_REPORTS_CSV_TABLE_H

#include "cloud/cloud.h"

/** A table of text: a header and rows of as many cells. Missing cells at a row's end are "". The caller's
 * (plm_table_free). */
typedef struct plm_table {
    size_t columns, rows;
    char **cell;  /**< (rows + 1) * columns, the header first */
    size_t *line; /**< line of the file that a row starts on, 1-based; rows + 1 */
    char *text;   /**< what the cells point into */
} plm_table;

/** Reads a table (RFC 4180: quoted cells may hold separators, quotes and line ends). Separator: comma, semicolon or tab,
 * whichever the header line holds most of. A byte order mark and carriage returns are dropped; empty lines are skipped.
 * PLM_E_READ; PLM_E_FORMAT: an empty file, an open quote, a row longer than the header (file, line, found, expected). */
plm_status plm_table_read(const char *path, plm_table *table, plm_error *error);

/** The same from size bytes; name stands for the file in messages. */
plm_status plm_table_parse(const char *data, size_t size, const char *name, plm_table *table, plm_error *error);

void plm_table_free(plm_table *table);

/** Column of a header name (case does not matter), or SIZE_MAX. */
size_t plm_table_column(const plm_table *table, const char *name);

/** Cell of a row (0-based, the header not counted); "" where column is SIZE_MAX. */
const char *plm_table_cell(const plm_table *table, size_t row, size_t column);

/** Parses a number that fills the cell, point as decimal mark whatever the locale is; false for anything else (empty,
 * "NA", NaN and Inf included). */
bool plm_table_number(const char *cell, double *value);

#endif
