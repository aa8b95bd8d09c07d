/* reports/view_file.h: what the 3D view of a plant shows, small enough for a page: PLANT.view.json. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_VIEW_FILE_H
#define PLANTIMETER_REPORTS_VIEW_FILE_H

#include "reports/reports.h"

/** Limits of a view; all zero: 200 000 points and 20 000 triangles. */
typedef struct plm_view_limits {
    size_t points, triangles;
} plm_view_limits;

/** Writes the view: points thinned by a hash of their coordinates to at most limits.points, leaf surfaces decimated, the
 * convex hull. Coordinates are 16-bit steps of the bounding cube (z up, metres): low + step * number, base64, little-endian;
 * so are organ numbers (places in "organs"). PLM_E_WRITE, PLM_E_MEMORY, PLM_E_LIBRARY. */
plm_status plm_write_view(const char *path, const char *plant_id, const plm_measurement *measurement,
                          const plm_view_limits *limits, plm_error *error);

#endif
