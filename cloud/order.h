/* cloud/order.h: order statistics in linear time. Internal. */
#ifndef PLANTIMETER_CLOUD_ORDER_H
#define PLANTIMETER_CLOUD_ORDER_H

#include <stddef.h>

/** The value that stands at place (0-based, below count) when values are sorted. Reorders values: those before place are
 * not larger, those behind are not smaller. No NaN. Hoare's selection, linear on average. */
double plm_order_select(double *values, size_t count, size_t place);

/** The quantile at share (0 to 1), interpolated linearly between order statistics. Reorders values. NAN for count 0. */
double plm_order_quantile(double *values, size_t count, double share);

/** The median, the mean of the two middle ones where count is even. Reorders values. NAN for count 0. */
double plm_order_median(double *values, size_t count);

/** Robust standard deviation about centre: 1.4826 x the median of |value - centre|, which is the SD of a normal
 * distribution. values are overwritten. NAN for count 0. */
double plm_order_robust_sd(double *values, size_t count, double centre);

/** Sorts values, the smallest first. No NaN. */
void plm_order_sort(float *values, size_t count);

#endif
