/* reports/base64.h: bytes as text (RFC 4648). Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_BASE64_H
#define PLANTIMETER_REPORTS_BASE64_H

#include "cloud/cloud.h"

/** The bytes as base64 with padding and a zero behind; the caller's (plm_free). NULL: no memory. */
char *plm_base64(const void *bytes, size_t size, plm_error *error);

#endif
