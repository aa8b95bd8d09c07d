/* io/json_file.h: what everything that writes JSON shares. Internal to the library and tool/. */
#ifndef PLANTIMETER_IO_JSON_FILE_H
#define PLANTIMETER_IO_JSON_FILE_H

#include <jansson.h>

#include "cloud/cloud.h"

/** Digits of a number, as in the tables; and all of a double's. */
enum { PLM_JSON_DIGITS = 9, PLM_JSON_DIGITS_ALL = 17 };

/** Makes jansson allocate through the library's seam. Called by whatever makes JSON. */
void plm_json_use_seam(void);

/** Fails with PLM_E_MEMORY where object is NULL: what jansson could not make. */
plm_status plm_json_check(const json_t *object, plm_error *error);

/** A text of the user's as a JSON string, bytes that are no UTF-8 replaced; the caller's, NULL without memory. */
json_t *plm_json_text(const char *text);

/** Writes an object to a file (plm_output), so many digits a number. NULL: what jansson could not make, PLM_E_MEMORY. */
plm_status plm_json_write(const char *path, const json_t *object, int digits, plm_error *error);

#endif
