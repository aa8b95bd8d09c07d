/* reports/html.h: writing a page: escaped text, bytes as base64, numbers; the first failure stays. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_HTML_H
#define PLANTIMETER_REPORTS_HTML_H

#include "io/io.h"

/** A page under way. Once status is not PLM_OK, every call does nothing. */
typedef struct plm_html {
    plm_output *output;
    plm_status status;
    plm_error *error;
} plm_html;

/** Markup as it stands, in printf style: what is put in must be markup or numbers. */
void plm_html_print(plm_html *page, const char *format, ...) PLM_PRINTF(2, 3);

/** Text of the user's: & < > " ' and control characters made harmless, also within attributes. */
void plm_html_text(plm_html *page, const char *text);

/** Bytes as they are (styles, scripts). */
void plm_html_bytes(plm_html *page, const void *bytes, size_t size);

/** Bytes as a data URI (data:TYPE;base64,...). */
void plm_html_data_uri(plm_html *page, const char *type, const void *bytes, size_t size);

#endif
