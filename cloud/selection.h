/* cloud/selection.h: quantiles without sorting. Internal. */
#ifndef PLANTIMETER_CLOUD_SELECTION_H
#define PLANTIMETER_CLOUD_SELECTION_H

#include <stddef.h>

/** The value that stands at place floor(share * (count - 1)) of count sorted values (count at least 1, no NaN, share 0 to
 * 1). Reorders values. O(count) on average (C. A. R. Hoare, Find, 1961). */
double plm_select_quantile(double *values, size_t count, double share);

#endif
