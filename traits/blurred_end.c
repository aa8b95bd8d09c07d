/* traits/blurred_end.c: extreme value of a blurred edge. */
#include "traits/blurred_end.h"

#include "cloud/linear.h"
#include "cloud/order.h"

enum { LAST_POINTS = 24, BISECTIONS = 60 };

static const double stray_gap = 8; /* typical gaps: once in 3000 ends by chance */

/* Expected exceedance of a standard normal beyond z: phi(z) - z Q(z). */
static double exceedance(double z)
{
    return exp(-0.5 * z * z) / sqrt(2 * PLM_PI) - z * 0.5 * erfc(z / sqrt(2.0));
}

/* z at which number x exceedance(z) is ln 2. */
static double overshoot(double number)
{
    double low = -2 / number - 2, high = 8;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (low + high);
        if (number * exceedance(middle) > log(2.0))
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* Sorts the last points: position[count - last .. count) ascending. */
static void sort_last(double *position, size_t count, size_t last)
{
    plm_order_select(position, count, count - last);
    for (size_t i = count - last + 1; i < count; i++) { /* few: by insertion */
        const double value = position[i];
        size_t j = i;
        for (; j > count - last && position[j - 1] > value; j--) position[j] = position[j - 1];
        position[j] = value;
    }
}

/* Leaves out strays: while the gap below the highest point is wider than chance and noise allow. */
static size_t drop_strays(const double *position, size_t count, size_t last, double sigma)
{
    const double typical = (position[count - 1 - last / 4] - position[count - last]) / (double)(last - 1 - last / 4);
    size_t kept = count;
    while (count - kept < last / 8 && position[kept - 1] - position[kept - 2] > stray_gap * typical + 2 * sigma) kept--;
    return kept;
}

plm_end plm_blurred_end(double *position, size_t count, double sigma)
{
    size_t last = count < LAST_POINTS ? count : LAST_POINTS;
    sort_last(position, count, last);
    const size_t all = count;
    if (last >= 8) count = drop_strays(position, count, last, sigma);
    last -= all - count;
    const double highest = position[count - 1];
    double inner = position[count - last];
    size_t beyond = last - 1;                       /* points above inner, up to the highest */
    if (sigma > 0 && highest - inner < 6 * sigma) { /* the blurred zone must be small against the window */
        beyond = 0;
        double next = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            if (position[i] > highest - 6 * sigma)
                beyond++;
            else
                next = fmax(next, position[i]);
        }
        inner = isfinite(next) ? next : inner;
        if (!isfinite(next)) beyond = last - 1;
    }
    const double stretch = fmax(highest - inner, 1e-300);
    double edge = highest;
    double density = (double)beyond / stretch;
    for (int round = 0; round < 4; round++) { /* density counts up to the edge, which depends on it */
        edge = sigma > 0 && density * sigma > 1e-6 ? highest - sigma * overshoot(density * sigma)
                                                   : highest + log(2.0) / density;
        density = (double)beyond / fmax(edge - inner, 0.25 * stretch);
    }
    const double gap = 1 / density;
    return (plm_end){edge, sqrt(gap * gap + 0.5 * sigma * sigma)};
}
