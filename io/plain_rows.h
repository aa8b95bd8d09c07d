/* io/plain_rows.h: the fast way for what nearly all big files hold: coordinates as floats in this machine's byte order, and
 * colours as bytes. Internal to io/. */
#ifndef PLANTIMETER_IO_PLAIN_ROWS_H
#define PLANTIMETER_IO_PLAIN_ROWS_H

#include "io/columns.h"

/** Can the rows' places be read by the two functions below? */
bool plm_plain_places_are(const plm_roles *roles);

/** Are the colours red, green, blue as bytes? */
bool plm_plain_colours_are(const plm_roles *roles);

/** Smallest and largest coordinates of count rows. False when one is not finite or too far: the bounds are of no use then. */
bool plm_plain_bounds(const plm_roles *roles, size_t first, size_t count, double low[3], double high[3]);

/** Offsets of count rows from origin. */
void plm_plain_places(const plm_roles *roles, size_t first, size_t count, const double origin[3], float (*xyz)[3]);

/** Colours of count rows. */
void plm_plain_colours(const plm_roles *roles, size_t first, size_t count, uint8_t (*rgb)[3]);

#endif
