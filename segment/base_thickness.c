/* segment/base_thickness.c: the place of the junction by thickness: about the petiole's course, a tube's points lie off by its
 * radius, a blade's by no more than its noise. */
#include "segment/blade_base.h"

#include "cloud/linear.h"

#include <math.h>
#include <stdlib.h>

static const double CLEAR_NOISE = 0.2; /* of the petiole's radius: beyond, thickness tells nothing */
static const double REACH = 2;         /* in R */
static const double LOCAL = 0.33;      /* in R: neighbours that weigh a point */
static const double THINNEST = 0.035;  /* SD of a blade, of the petiole's radius, at least */
enum { FEWEST = 15, FEWEST_SIDE = 6, ROUNDS = 3, DEGREE = 3 };

static int by_place(const void *a, const void *b)
{
    const plm_base_height *p = a, *q = b;
    return (p->along > q->along) - (p->along < q->along);
}

/* Takes a cubic of the place along, by weighted least squares, off the heights. */
static bool take_off_course(plm_base_height *list, size_t count, double scale, double *rest)
{
    double matrix[(DEGREE + 1) * (DEGREE + 1)] = {0}, right[DEGREE + 1] = {0};
    for (size_t i = 0; i < count; i++) {
        double power[DEGREE + 1] = {1};
        for (int k = 1; k <= DEGREE; k++) power[k] = power[k - 1] * list[i].along / scale;
        for (int k = 0; k <= DEGREE; k++) {
            right[k] += list[i].weight * power[k] * list[i].off;
            for (int m = 0; m <= DEGREE; m++) matrix[k * (DEGREE + 1) + m] += list[i].weight * power[k] * power[m];
        }
    }
    if (!plm_solve_spd(DEGREE + 1, matrix, right)) return false;
    for (size_t i = 0; i < count; i++) {
        const double x = list[i].along / scale;
        rest[i] = list[i].off - (right[0] + x * (right[1] + x * (right[2] + x * right[3])));
    }
    return true;
}

/* Weights by the mean square of the rests nearby: the blade tells the course better than the tube. */
static void weigh(plm_base_height *list, const double *rest, size_t count, double reach, double least)
{
    size_t begin = 0, end = 0;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        while (end < count && list[end].along < list[i].along + reach) sum += rest[end] * rest[end], end++;
        while (list[begin].along < list[i].along - reach) sum -= rest[begin] * rest[begin], begin++;
        list[i].weight = 1 / fmax(sum / (double)(end - begin), least * least);
    }
}

bool plm_base_is_noisy(const plm_base_view *view)
{
    return view->noise > CLEAR_NOISE * view->radius;
}

size_t plm_base_heights(const plm_base_view *v, plm_base_height *list, double *rest, double *cumulated)
{
    const double R = v->scale;
    size_t count = 0;
    if (plm_base_is_noisy(v)) return 0;
    for (size_t i = 0; i < v->count; i++) {
        const double *p = v->place[i];
        if (fabs(p[1]) < v->radius && fabs(p[0]) < REACH * R) list[count++] = (plm_base_height){p[0], p[2], 1};
    }
    if (count < FEWEST) return 0;
    qsort(list, count, sizeof *list, by_place);
    for (int round = 0; round < ROUNDS; round++) {
        if (!take_off_course(list, count, R, rest)) return 0;
        if (round < ROUNDS - 1) weigh(list, rest, count, LOCAL * R, THINNEST * v->radius);
    }
    cumulated[0] = 0;
    for (size_t i = 0; i < count; i++) cumulated[i + 1] = cumulated[i] + rest[i] * rest[i];
    return count;
}

double plm_base_thickness(const plm_base_view *v, const plm_base_height *list, const double *cumulated, size_t count,
                          double at)
{
    if (!count) return 0;
    const double least = THINNEST * THINNEST * v->radius * v->radius,
                 all = fmax(cumulated[count] / (double)count, least);
    size_t before = 0;
    while (before < count && list[before].along < at) before++;
    const size_t after = count - before;
    if (before >= FEWEST_SIDE && after >= FEWEST_SIDE) {
        const double tube = fmax(cumulated[before] / (double)before, least),
                     blade = fmax((cumulated[count] - cumulated[before]) / (double)after, least);
        if (tube > blade) return -0.5 * ((double)before * log(tube) + (double)after * log(blade));
    }
    return -0.5 * (double)count * log(all);
}
