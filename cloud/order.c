/* cloud/order.c: Hoare's selection (C. A. R. Hoare, Algorithm 65: Find, 1961) and what rests on it. */
#include "cloud/order.h"

#include <math.h>
#include <stdlib.h>

/* Median of |x| / SD of a normal distribution. */
static const double deviation_to_sd = 1.4826022185056018;

double plm_order_select(double *values, size_t count, size_t place)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        /* Median of three: sorted input is the common case. */
        const double a = values[low], b = values[low + (high - low) / 2], c = values[high];
        const double pivot = fmax(fmin(a, b), fmin(fmax(a, b), c));
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot) i++;
            while (values[j] > pivot) j--;
            if (i >= j) break;
            const double other = values[i];
            values[i++] = values[j];
            values[j--] = other;
        }
        /* Here values[low..j] <= pivot and values[i..high] >= pivot, where i is j or j + 1. */
        if (values[j] > pivot) j--;
        if (place <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[place];
}

double plm_order_quantile(double *values, size_t count, double share)
{
    if (count == 0) return NAN;
    const double position = fmin(fmax(share, 0), 1) * (double)(count - 1);
    const size_t place = (size_t)position;
    const double lower = plm_order_select(values, count, place);
    const double rest = position - (double)place;
    if (rest <= 0 || place + 1 >= count) return lower;
    double upper = values[place + 1];
    for (size_t i = place + 2; i < count; i++) upper = fmin(upper, values[i]);
    return lower + rest * (upper - lower);
}

double plm_order_median(double *values, size_t count)
{
    return plm_order_quantile(values, count, 0.5);
}

double plm_order_robust_sd(double *values, size_t count, double centre)
{
    for (size_t i = 0; i < count; i++) values[i] = fabs(values[i] - centre);
    return deviation_to_sd * plm_order_median(values, count);
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

void plm_order_sort(float *values, size_t count)
{
    if (count) qsort(values, count, sizeof *values, compare_floats);
}
