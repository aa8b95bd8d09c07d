/* io/origin.h: where a cloud's origin is put. Internal to io/. */
#ifndef PLANTIMETER_IO_ORIGIN_H
#define PLANTIMETER_IO_ORIGIN_H

#include "io/columns.h"

/** An origin near the points, the same for any order of the rows; low and high bound the finite points.
 * Zero where the points lie near 0 already, so that offsets are then the file's own numbers. */
void plm_choose_origin(const plm_columns *columns, const plm_roles *roles, const double low[3], const double high[3],
                       double origin[3]);

/** Coordinates beyond this, about 1e18, are as good as infinite: squares of their distances overflow a float. */
#define PLM_FARTHEST 0x1p60

#endif
