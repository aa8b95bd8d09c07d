/* segment/leaf_sinus.c: the sinus of a lobed leaf base. The lobes' inner edges converge on the junction, so the line
 * through the half gaps between the petiole and the lobes is carried on to where nothing is left of it: a gap of several
 * millimetres is seen in any noise, the last one is not. */
#include "segment/junction.h"

#include "segment/line_fit.h"

#include <math.h>
#include <string.h>

static const double LINE = 2;     /* length of the petiole before the junction that gives its direction, in R */
static const double BACK = 3;     /* the sinus is looked for from so far before the junction, ... */
static const double FORWARD = 3;  /* ... in R, to so far beyond */
static const double SIDE = 2.5;   /* and within so much to either side, in R */
static const double THICK = 0.5;  /* and so much off the blade's plane, in R */
static const double PLANE = 2;    /* blade within so much of the junction gives the plane, in R */
static const double SLENDER = 2;  /* half of the petiole's breadth, in widths (SDs) of its stations */
static const double CLEAR = 1.2;  /* a half gap that is seen, and ... */
static const double ROUGH = 0.7;  /* scatter of the half gaps about their line, at most: else it is no edge */
static const double OPEN = 3.5;   /* ... one where the lobes turn away, in half breadths */
static const double CLOSED = 0.6; /* half gap at the junction, in half breadths */
static const double STEEP = 0.15; /* half gap lost over the length, at least: else nothing closes */
static const double BIN = 1.5;    /* length of a bin, in steps */
/* The junction that the widths tell is too early by at most so much, in R and in SDs of the noise. */
static const double FARTHEST = 0.75, FARTHEST_NOISE = 6;
enum { BINS = 64, FEWEST_BINS = 4 };

/* Middle and direction of the petiole's last piece. */
static bool last_piece(const plm_leaf_way *way, double origin[3], double along[3])
{
    const double R = way->sketch->scale.radius;
    size_t end = (size_t)(way->junction / way->step), begin = end;
    if (end > 1) end -= 1; /* a window that holds nothing of the blade */
    const size_t length = (size_t)(LINE * R / way->step);
    begin = end > length ? end - length : 0;
    plm_line_sums sums = {0};
    for (size_t k = begin; k < end; k++)
        if (way->station[k].count) plm_line_add(&sums, (double)k * way->step - way->junction, way->station[k].middle);
    return plm_line_fit(&sums, origin, along);
}

/* Normal of the blade around the junction, at right angles to the petiole. */
static bool blade_normal(const plm_leaf_way *way, const double origin[3], const double along[3], double normal[3])
{
    const plm_sketch *s = way->sketch;
    const double reach = PLANE * s->scale.radius;
    double moment[6] = {0}, sum[3] = {0}, n = 0, value[3], vector[3][3];
    for (int turn = 0; turn < 2; turn++)
        for (size_t k = way->count; k-- > 0;) {
            const uint32_t i = way->order[k];
            if (way->distance[i] < way->junction + way->window) break;
            double d[3], off[3];
            for (int a = 0; a < 3; a++) off[a] = s->working.xyz[i][a] - origin[a];
            if (plm_dot(off, off) > reach * reach) continue;
            for (int a = 0; a < 3; a++) d[a] = off[a] - (turn ? sum[a] / n : 0);
            if (turn == 0) {
                for (int a = 0; a < 3; a++) sum[a] += off[a];
                n++;
            } else {
                for (int a = 0, m = 0; a < 3; a++)
                    for (int c = a; c < 3; c++) moment[m++] += d[a] * d[c];
            }
        }
    if (n < 12) return false;
    plm_eigen3(moment, value, vector);
    const double forward = plm_dot(vector[2], along);
    for (int a = 0; a < 3; a++) normal[a] = vector[2][a] - forward * along[a];
    return plm_normalise(normal) > 0.5;
}

/* Half gaps along the petiole: the nearest blade beyond the petiole's breadth to either side, about its middle, which is
 * followed from bin to bin. gap[b] is NAN where one side has none. Bins are BIN steps long, from low on. */
static void measure_gaps(const plm_leaf_way *way, double low, double slender, const float *place, size_t count,
                         double gap[BINS])
{
    double middle = 0;
    for (int b = 0; b < BINS; b++) {
        const double begin = low + b * way->step, end = begin + BIN * way->step;
        double sum = 0, n = 0, right = INFINITY, left = INFINITY;
        for (size_t k = 0; k < count; k++) {
            const double s = place[2 * k], y = place[2 * k + 1] - middle;
            if (s < begin || s >= end) continue;
            if (fabs(y) <= slender) sum += y, n++;
            if (y > slender) right = fmin(right, y);
            if (y < -slender) left = fmin(left, -y);
        }
        gap[b] = isfinite(right) && isfinite(left) ? 0.5 * (right + left) : NAN;
        const bool clear = fmin(right, left) > CLEAR * slender;
        if (n > 0 && clear) middle += 0.5 * sum / n; /* between lobes the petiole is alone */
    }
}

double plm_leaf_sinus(const plm_leaf_way *way, double origin[3], double along[3], float *scratch)
{
    const plm_sketch *s = way->sketch;
    const double R = s->scale.radius, slender = SLENDER * way->tube;
    double normal[3], across[3];
    if (!last_piece(way, origin, along) || !blade_normal(way, origin, along, normal)) return 0;
    plm_cross(normal, along, across);
    size_t count = 0;
    for (size_t k = 0; k < way->count; k++) {
        const float *p = s->working.xyz[way->order[k]];
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = p[a] - origin[a];
        const double forward = plm_dot(d, along), side = plm_dot(d, across);
        if (forward < -BACK * R || forward > FORWARD * R || fabs(side) > SIDE * R) continue;
        if (fabs(plm_dot(d, normal)) > THICK * R) continue;
        scratch[2 * count] = (float)forward;
        scratch[2 * count++ + 1] = (float)side;
    }
    double gap[BINS];
    const double low = fmax(-BACK * R, -0.5 * BINS * way->step);
    measure_gaps(way, low, slender, scratch, count, gap);
    /* The line through the gaps that are clear, up to the first two that are not. */
    double n = 0, at = 0, value = 0, square = 0, product = 0, squares = 0, first = INFINITY;
    int closed = 0;
    for (int b = 0; b < BINS && closed < 2; b++) {
        if (!isgreater(gap[b], 0)) continue; /* NAN where there is none: a quiet comparison */
        if (gap[b] < CLEAR * slender) {
            closed++;
            continue;
        }
        closed = 0;
        if (gap[b] > OPEN * slender) continue;
        const double place = low + (b + 0.5 * BIN) * way->step;
        n++, at += place, value += gap[b], square += place * place, product += place * gap[b];
        squares += gap[b] * gap[b], first = fmin(first, place);
    }
    if (n < FEWEST_BINS) return 0;
    const double spread = square - at * at / n;
    if (!(spread > 0)) return 0;
    const double slope = (product - at * value / n) / spread;
    const double scatter = sqrt(fmax(squares - value * value / n - slope * slope * spread, 0) / (n - 2));
    if (!(slope < -STEEP) || scatter > ROUGH * slender || first > 0) return 0;
    const double meet = at / n + (CLOSED * slender - value / n) / slope;
    return meet > 0 ? fmin(meet, fmin(FORWARD * R, FARTHEST * R + FARTHEST_NOISE * s->scale.noise)) : 0;
}
