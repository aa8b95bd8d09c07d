/* io/origin.c: where a cloud's origin is put.
 *
 * Offsets are float32: they round at 2^-25 to 2^-24 of their size, so the origin must be near the plant, and not in the
 * middle between the plant at UTM coordinates and a forgotten row of zeros. Where 98 % of the rows lie in a small part
 * of the bounding box (along each axis), the box is narrowed to that part, until it is filled. The box depends on
 * counts alone, so the order of rows does not matter. */
#include "io/origin.h"

#include <math.h>
#include <string.h>

enum { BINS = 64, STEP = 512, LONGEST_ZOOM = 64 };

static const double tail = 0.01;            /* share of the rows that may lie beyond each side of the box */
static const double narrower = 1.0 / 16;    /* a box that shrinks by less is filled well enough */
static const double near_for_double = 1.5;  /* in sizes of the cloud: 1.5 * 2^-24 is 1e-7 of it */
static const double near_for_single = 10.0; /* a float32 file loses nothing by an origin of 0 */

typedef struct histogram {
    uint64_t bin[3][BINS];
    uint64_t rows[3];
} histogram;

static void count_rows(const plm_column *column, const double low, const double high, uint64_t bin[BINS],
                       uint64_t *inside, size_t rows)
{
    const double scale = high > low ? BINS / (high - low) : 0;
    double value[STEP];
    for (size_t first = 0; first < rows; first += STEP) {
        const size_t count = rows - first < STEP ? rows - first : STEP;
        plm_column_load(column, first, count, value);
        for (size_t i = 0; i < count; i++) {
            if (!(value[i] >= low && value[i] <= high)) continue; /* NaN too */
            const int at = (int)((value[i] - low) * scale);
            bin[at < BINS ? at : BINS - 1]++;
            ++*inside;
        }
    }
}

/* Narrows [low, high] to the bins between the two tails. */
static void narrow(const uint64_t bin[BINS], uint64_t rows, double *low, double *high)
{
    const uint64_t outside = (uint64_t)(tail * (double)rows);
    const double from = *low, width = (*high - *low) / BINS;
    int first = 0, last = BINS - 1;
    for (uint64_t below = bin[0]; below <= outside && first < BINS - 1; below += bin[first]) first++;
    for (uint64_t above = bin[BINS - 1]; above <= outside && last > first; above += bin[last]) last--;
    *low = from + first * width;
    *high = last == BINS - 1 ? *high : from + (last + 1) * width;
}

static double size_of(const double low[3], const double high[3])
{
    return fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
}

static double reach_of(const double low[3], const double high[3])
{
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) reach = fmax(reach, fmax(fabs(low[axis]), fabs(high[axis])));
    return reach;
}

static void crowded_box(const plm_columns *columns, const plm_roles *roles, double low[3], double high[3])
{
    for (int zoom = 0; zoom < LONGEST_ZOOM && size_of(low, high) > 0; zoom++) {
        histogram counted = {0};
#pragma omp parallel for if (columns->rows > 100000)
        for (int axis = 0; axis < 3; axis++)
            count_rows(roles->column[PLM_ROLE_X + axis], low[axis], high[axis], counted.bin[axis], &counted.rows[axis],
                       columns->rows);
        double lower[3], higher[3];
        for (int axis = 0; axis < 3; axis++) {
            lower[axis] = low[axis];
            higher[axis] = high[axis];
            narrow(counted.bin[axis], counted.rows[axis], &lower[axis], &higher[axis]);
        }
        if (size_of(lower, higher) > narrower * size_of(low, high)) return;
        memcpy(low, lower, 3 * sizeof *low);
        memcpy(high, higher, 3 * sizeof *high);
    }
}

/* The middle, rounded to a multiple of a power of two of at most an eighth of the box: origin + offset then needs few
 * digits, and a cloud that is written and read again finds the same origin. */
static double rounded_middle(double low, double high, double size)
{
    const double middle = low + (high - low) / 2;
    if (size == 0) return middle;
    int exponent;
    frexp(size / 8, &exponent);
    const double grain = ldexp(1, exponent - 1);
    return floor(middle / grain + 0.5) * grain;
}

void plm_choose_origin(const plm_columns *columns, const plm_roles *roles, const double low[3], const double high[3],
                       double origin[3])
{
    double box[2][3];
    memcpy(box[0], low, sizeof box[0]);
    memcpy(box[1], high, sizeof box[1]);
    bool is_single = true;
    for (int axis = 0; axis < 3; axis++) is_single &= roles->column[PLM_ROLE_X + axis]->type == PLM_FLOAT32;
    const bool is_near = is_single && reach_of(low, high) <= near_for_single * size_of(low, high);
    if (!is_near) crowded_box(columns, roles, box[0], box[1]);
    const double size = size_of(box[0], box[1]);
    const bool is_zero = is_near || reach_of(box[0], box[1]) <= near_for_double * size;
    for (int axis = 0; axis < 3; axis++) origin[axis] = is_zero ? 0 : rounded_middle(box[0][axis], box[1][axis], size);
}
