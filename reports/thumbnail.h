/* reports/thumbnail.h: a small copy of a plant's picture for the page. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_THUMBNAIL_H
#define PLANTIMETER_REPORTS_THUMBNAIL_H

#include "cloud/cloud.h"

/** Reads a PNG and gives its left part (share of its width, 0 to 1) smaller by a whole factor (mean of the pixels) as a
 * JPEG. bytes, size: out, the caller's (plm_free). PLM_E_READ, PLM_E_FORMAT (no PNG), PLM_E_MEMORY, PLM_E_LIBRARY. */
plm_status plm_thumbnail(const char *png_path, double share, int factor, unsigned char **bytes, size_t *size,
                         plm_error *error);

#endif
