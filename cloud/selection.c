/* cloud/selection.c: selection by partition. */
#include "cloud/selection.h"

enum { SORTED_OUTRIGHT = 12 };

static void swap(double *a, double *b)
{
    const double other = *a;
    *a = *b;
    *b = other;
}

static void insertion_sort(double *values, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const double value = values[i];
        size_t j = i;
        for (; j > 0 && values[j - 1] > value; j--) values[j] = values[j - 1];
        values[j] = value;
    }
}

static double median_of_three(double a, double b, double c)
{
    if (a < b) return b < c ? b : a < c ? c : a;
    return a < c ? a : b < c ? c : b;
}

double plm_select_quantile(double *values, size_t count, double share)
{
    const size_t wanted = (size_t)(share * (double)(count - 1));
    size_t low = 0, high = count - 1; /* what is wanted lies in between */
    while (high - low >= SORTED_OUTRIGHT) {
        const double pivot = median_of_three(values[low], values[low + (high - low) / 2], values[high]);
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot) i++;
            while (values[j] > pivot) j--;
            if (i >= j) break;
            swap(&values[i++], &values[j--]);
        }
        if (i == j) { /* both stopped on the pivot: it is in its sorted place */
            if (wanted == i) return pivot;
            if (wanted < i)
                high = i - 1;
            else
                low = i + 1;
        } else if (wanted <= j) {
            high = j;
        } else {
            low = i;
        }
    }
    insertion_sort(values + low, high - low + 1);
    return values[wanted];
}
