/* io/text_layout.h: how a text file of points is laid out: found out, or told. Internal to io/. */
#ifndef PLANTIMETER_IO_TEXT_LAYOUT_H
#define PLANTIMETER_IO_TEXT_LAYOUT_H

#include "io/ascii.h"

typedef struct plm_text_layout {
    char separator, decimal;
    size_t item_count;   /* of a row */
    size_t begin, line;  /* byte and number (from 1 on) of the first row's line */
    bool has_count_line; /* a first line with nothing but the number of points (PTS files) */
    plm_line header;     /* line that names the columns, without its comment sign; begin NULL: none */
    char header_separator;
} plm_text_layout;

/** Finds the first row, the separator, the decimal sign and the header. PLM_E_FORMAT where no row of at least three
 * numbers stands at the beginning, PLM_E_ARGUMENT when options give a separator that is none. */
plm_status plm_text_layout_find(const plm_bytes *bytes, const plm_read_options *options, plm_text_layout *layout,
                                plm_error *error);

/** The name of a column without the unit behind it ("x [m]") and cut where it is too long. */
void plm_column_name(const char *begin, const char *stop, char name[64]);

/** Names the columns: from options, else the header, else from what their numbers look like in rows spread over the file:
 * unit vectors are normals, three columns within 0 to 1 or whole within 0 to 255 are colours, few whole numbers are
 * labels. PLM_E_ARGUMENT when options name more columns than there are. */
plm_status plm_text_columns(const plm_bytes *bytes, const plm_read_options *options, const plm_text_layout *layout,
                            plm_columns *columns, plm_error *error);

#endif
