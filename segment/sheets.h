/* segment/sheets.h: the sheets that a surface falls into: leaves that meet in narrow places, or not at all. Internal. */
#ifndef PLANTIMETER_SEGMENT_SHEETS_H
#define PLANTIMETER_SEGMENT_SHEETS_H

#include "segment/sheet_surface.h"

/** sheet: out, one a point of the surface, 0 to *sheets - 1, or -1 where there is no sheet at all. PLM_E_MEMORY only. */
plm_status plm_find_sheets(const plm_sheet_surface *surface, int32_t *sheet, size_t *sheets, plm_error *error);

#endif
