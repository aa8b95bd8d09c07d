/* io/origin.c: where a cloud's origin is put.
 *
 * Offsets are float32: they round at 2^-25 to 2^-24 of their size, so the origin must be near the plant, and not in the
 * middle between a plant at UTM coordinates and a forgotten row of zeros. Where 98 % of the rows lie in a small part of
 * an axis' range, the range is narrowed to that part, until it is filled. That depends on counts alone, so the order of
 * rows does not matter. The axes are apart: with longitudes in degrees and heights in metres their ranges are not alike. */
#include "io/origin.h"

#include <math.h>

enum { BINS = 64, STEP = 512, LONGEST_ZOOM = 64 };

static const double tail = 0.01;            /* share of the rows that may lie beyond each end of the range */
static const double narrower = 1.0 / 16;    /* a range that shrinks by less is filled well enough */
static const double near_for_double = 1.5;  /* in lengths of the range: 1.5 * 2^-24 is 1e-7 of it */
static const double near_for_single = 10.0; /* in sizes of the cloud; a float32 file loses nothing by an origin of 0 */

typedef struct range {
    double low, high;
} range;

/* Counts the rows in each part of the range; gives how many there are. NaN is in none. */
static uint64_t count_rows(const plm_columns *columns, const plm_column *column, range within, uint64_t bin[BINS])
{
    const double length = within.high - within.low; /* may be so small that its inverse is not finite */
    double value[STEP];
    uint64_t inside = 0;
    for (size_t first = 0; first < columns->rows; first += STEP) {
        const size_t count = columns->rows - first < STEP ? columns->rows - first : STEP;
        plm_column_load(column, first, count, value);
        for (size_t i = 0; i < count; i++) {
            if (!(value[i] >= within.low && value[i] <= within.high)) continue;
            const int at = (int)((value[i] - within.low) / length * BINS);
            bin[at < BINS ? at : BINS - 1]++;
            inside++;
        }
    }
    return inside;
}

/* The parts of the range between the two tails. */
static range without_tails(const uint64_t bin[BINS], uint64_t rows, range whole)
{
    const uint64_t outside = (uint64_t)(tail * (double)rows);
    const double width = (whole.high - whole.low) / BINS;
    int first = 0, last = BINS - 1;
    for (uint64_t below = bin[0]; below <= outside && first < BINS - 1; below += bin[first]) first++;
    for (uint64_t above = bin[BINS - 1]; above <= outside && last > first; above += bin[last]) last--;
    return (range){whole.low + first * width, last == BINS - 1 ? whole.high : whole.low + (last + 1) * width};
}

/* The range in which nearly all rows are. */
static range crowded_range(const plm_columns *columns, const plm_column *column, range whole)
{
    for (int zoom = 0; zoom < LONGEST_ZOOM && whole.high > whole.low; zoom++) {
        uint64_t bin[BINS] = {0};
        const uint64_t rows = count_rows(columns, column, whole, bin);
        const range part = without_tails(bin, rows, whole);
        if (part.high - part.low > narrower * (whole.high - whole.low)) break;
        whole = part;
    }
    return whole;
}

/* The middle, rounded to a multiple of a power of two of at most an eighth of the range: origin + offset then needs few
 * digits, and a cloud that is written and read again finds the same origin. */
static double rounded_middle(range within)
{
    const double length = within.high - within.low, middle = within.low + length / 2;
    if (length == 0) return middle;
    int exponent;
    frexp(length / 8, &exponent);
    const double grain = ldexp(1, exponent - 1);
    return floor(middle / grain + 0.5) * grain;
}

static double reach_of(range within)
{
    return fmax(fabs(within.low), fabs(within.high));
}

void plm_choose_origin(const plm_columns *columns, const plm_roles *roles, const double low[3], const double high[3],
                       double origin[3])
{
    bool is_single = true;
    double size = 0, reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        is_single &= roles->column[PLM_ROLE_X + axis]->type == PLM_FLOAT32;
        size = fmax(size, high[axis] - low[axis]);
        reach = fmax(reach, reach_of((range){low[axis], high[axis]}));
        origin[axis] = 0;
    }
    if (is_single && reach <= near_for_single * size) return;
#pragma omp parallel for if (columns->rows > 100000)
    for (int axis = 0; axis < 3; axis++) {
        const range whole = {low[axis], high[axis]};
        const range part = crowded_range(columns, roles->column[PLM_ROLE_X + axis], whole);
        if (reach_of(part) > near_for_double * (part.high - part.low)) origin[axis] = rounded_middle(part);
    }
}
