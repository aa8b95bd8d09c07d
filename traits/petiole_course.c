/* traits/petiole_course.c: the course of a petiole among what branches off it. Petiolules are petiole as well, and in noise
 * small leaflets look like them: the farthest of their points need not be the rachis' end. Of the ends that could be, the
 * right one is that to which a gentle line from the base is clearly longest on points. */
#include "traits/petiole_course.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "traits/centre_line.h"

#include <math.h>
#include <string.h>

enum { MOST_ENDS = 8, PARTS = 32, FEWEST_KEPT = 30 };

/* In lengths of the petiole: points so near to a far one are one end with it, those so near are not tried as another; ends
 * are sought among the points so far off the base. */
static const double one_end = 0.06, apart = 0.12, nearest = 0.5;
static const double core = 0.35;     /* quantile of the distances from the line that the tube's own points make */
static const double reach = 2.5;     /* of that quantile: points of the tube */
static const double longer = 1.08;   /* the farthest end stays where no other line is so much longer on points */
static const double branches = 0.15; /* share of the points off the line, from which on they are left out */

typedef struct course {
    double far[3];
    plm_curve curve;
    double core;
    bool is_first; /* to the farthest point */
} course;

/* Distances of the points from a curve, and their parameters on it. */
static void measure(const plm_tube_points *points, const plm_curve *curve, double *distance, double *t)
{
    for (size_t i = 0; i < points->count; i++) {
        double at[3];
        t[i] = plm_curve_foot(curve, points->xyz[i]);
        plm_curve_point(curve, t[i], at);
        distance[i] = plm_distance(at, points->xyz[i]);
    }
}

/* The end at the farthest point that is not used up yet: the mean of the points about it. false: none is far enough. */
static bool next_end(const plm_tube_points *points, const double *from_base, bool *used, double length, double far[3])
{
    size_t farthest = SIZE_MAX, count = 0;
    for (size_t i = 0; i < points->count; i++)
        if (!used[i] && (farthest == SIZE_MAX || from_base[i] > from_base[farthest])) farthest = i;
    if (farthest == SIZE_MAX || from_base[farthest] < nearest * length) return false;
    double tip[3];
    memcpy(tip, points->xyz[farthest], sizeof tip);
    memset(far, 0, 3 * sizeof *far);
    for (size_t i = 0; i < points->count; i++) {
        const double off = plm_distance(points->xyz[i], tip);
        if (off <= apart * length) used[i] = true;
        if (off > one_end * length) continue;
        for (int k = 0; k < 3; k++) far[k] += points->xyz[i][k];
        count++;
    }
    for (int k = 0; k < 3; k++) far[k] /= (double)count;
    return true;
}

/* Length of the curve that has points about it. */
static double supported(const plm_tube_points *points, const course *way, double within, double *distance, double *t)
{
    bool has[PARTS] = {false};
    int parts = 0;
    measure(points, &way->curve, distance, t);
    for (size_t i = 0; i < points->count; i++) {
        if (distance[i] > within || !(fabs(t[i]) < 1)) continue;
        const int at = (int)(0.5 * (t[i] + 1) * PARTS); /* PARTS where t rounds up to 1 */
        bool *part = &has[at < PARTS ? at : PARTS - 1];
        parts += !*part;
        *part = true;
    }
    return parts * way->curve.half;
}

/* Fits the line to one end. PLM_E_DEGENERATE where the points give none. */
static plm_status fit_course(const plm_tube_points *points, const double base[3], course *way, double *distance,
                             double *t)
{
    plm_centre_line line;
    plm_error why = {0};
    const double(*xyz)[3] = (const double(*)[3])points->xyz;
    const plm_status status =
        plm_centre_line_fit(xyz, points->count, base, way->far, (plm_line_shape){3, 1, 0}, &line, &why);
    if (status != PLM_OK) return status;
    way->curve = line.curve;
    measure(points, &way->curve, distance, t);
    way->core = plm_order_quantile(distance, points->count, core);
    return PLM_OK;
}

/* Leaves out what is off the line. */
static void prune(plm_tube_points *points, const course *way, double *distance, double *t)
{
    measure(points, &way->curve, distance, t);
    size_t kept = 0;
    for (size_t i = 0; i < points->count; i++) kept += distance[i] <= reach * way->core;
    if (kept < FEWEST_KEPT || (double)kept > (1 - branches) * (double)points->count) return;
    kept = 0;
    for (size_t i = 0; i < points->count; i++)
        if (distance[i] <= reach * way->core) memmove(points->xyz[kept++], points->xyz[i], sizeof *points->xyz);
    points->count = kept;
}

/* The lines to all ends that could be; of those the one that is longest on points. */
static plm_status find_course(const plm_tube_points *points, const double base[3], double *work, bool *used,
                              course *found, plm_error *error)
{
    double *from_base = work, *distance = work + points->count, *t = distance + points->count;
    double length = 0, thin = INFINITY, most = 0;
    course way[MOST_ENDS];
    size_t count = 0;
    for (size_t i = 0; i < points->count; i++) {
        from_base[i] = plm_distance(points->xyz[i], base);
        length = fmax(length, from_base[i]);
    }
    for (int k = 0; k < MOST_ENDS && next_end(points, from_base, used, length, way[count].far); k++) {
        const plm_status status = fit_course(points, base, &way[count], distance, t);
        if (status == PLM_E_MEMORY) return plm_fail(error, status, "out of memory");
        if (status != PLM_OK) continue;
        way[count].is_first = k == 0;
        thin = fmin(thin, way[count++].core);
    }
    for (size_t k = 0; k < count; k++) {
        const double on = supported(points, &way[k], reach * thin, distance, t);
        if (on <= (k ? longer * most : 0)) continue;
        most = on;
        *found = way[k];
    }
    return most > 0 ? PLM_OK : PLM_E_DEGENERATE;
}

plm_status plm_petiole_course(plm_tube_points *points, const double base[3], double far[3], plm_error *error)
{
    double *work = plm_alloc(3 * points->count, sizeof *work, error);
    bool *used = plm_alloc_zero(points->count, sizeof *used, error);
    plm_status status = PLM_E_MEMORY;
    if (work && used) {
        course way;
        status = find_course(points, base, work, used, &way, error);
        if (status == PLM_OK) {
            if (!way.is_first) memcpy(far, way.far, sizeof way.far);
            prune(points, &way, work + points->count, work + 2 * points->count);
        }
        if (status == PLM_E_DEGENERATE) status = PLM_OK; /* the guess stands */
    }
    plm_free(work);
    plm_free(used);
    return status;
}
