/* traits/plant_foot.c: the plant's foot. Petioles of a rosette run straight out from it, seen from above, however they arch:
 * it is the place nearest to their lines, by least squares with Cauchy's weights. Condition: that of lines from all around,
 * 1, unless all petioles lie on one line. */
#include "traits/plant_foot.h"

#include "cloud/linear.h"
#include "cloud/order.h"

#include <math.h>

enum { FEWEST_POINTS = 8, FEWEST_LINES = 3, ROUNDS = 20 };

/* The stem's lower end: this share of its height, and at least so much. */
static const double lowest_share = 0.02, fewest_metres = 0.002;
static const double seen_unevenly = 0.12; /* of the scatter of its points: some sides are seen more than others */
/* A petiole is so many times as long as it is wide, seen from above, or its direction is unknown. */
static const double elongation = 1.5;
static const double normal_median = 0.6745; /* of |x| of a normal x with SD 1 */

/* Mean of the main stem's lowest points. */
static void stem_foot(const plm_organ *stem, double foot[2], double *std_error)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < stem->count; i++) {
        low = fmin(low, stem->xyz[i][2]);
        high = fmax(high, stem->xyz[i][2]);
    }
    const double limit = low + fmax(lowest_share * (high - low), fewest_metres);
    double sum[2] = {0, 0}, squares = 0, count = 0;
    for (size_t i = 0; i < stem->count; i++) {
        if (stem->xyz[i][2] > limit) continue;
        for (int k = 0; k < 2; k++) sum[k] += stem->xyz[i][k];
        count++;
    }
    for (int k = 0; k < 2; k++) foot[k] = sum[k] / count;
    for (size_t i = 0; i < stem->count; i++) {
        if (stem->xyz[i][2] > limit) continue;
        for (int k = 0; k < 2; k++) squares += (stem->xyz[i][k] - foot[k]) * (stem->xyz[i][k] - foot[k]);
    }
    *std_error = seen_unevenly * sqrt(squares / count);
}

/** A petiole seen from above: a line through a place, by its unit normal. */
typedef struct flat_line {
    double place[2], normal[2];
    double weight;
} flat_line;

/* The line of a petiole; false where it looks round from above. */
static bool line_of(const plm_organ *petiole, flat_line *line)
{
    if (petiole->count < FEWEST_POINTS) return false;
    const double n = (double)petiole->count;
    double mean[2] = {0}, xx = 0, xy = 0, yy = 0;
    for (size_t i = 0; i < petiole->count; i++)
        for (int k = 0; k < 2; k++) mean[k] += petiole->xyz[i][k] / n;
    for (size_t i = 0; i < petiole->count; i++) {
        const double x = petiole->xyz[i][0] - mean[0], y = petiole->xyz[i][1] - mean[1];
        xx += x * x / n, xy += x * y / n, yy += y * y / n;
    }
    const double half = 0.5 * hypot(xx - yy, 2 * xy), middle = 0.5 * (xx + yy);
    if (!(sqrt(middle + half) > elongation * sqrt(fmax(middle - half, 0)))) return false;
    const double angle = 0.5 * atan2(2 * xy, xx - yy);
    *line = (flat_line){{mean[0], mean[1]}, {-sin(angle), cos(angle)}, 1};
    return true;
}

static double offset_of(const flat_line *line, const double place[2])
{
    return (place[0] - line->place[0]) * line->normal[0] + (place[1] - line->place[1]) * line->normal[1];
}

/* The place nearest to weighted lines. inverse_trace: of the normal equations. False: they are parallel. */
static bool meet(const flat_line *line, size_t count, double place[2], double *inverse_trace)
{
    double xx = 0, xy = 0, yy = 0, right[2] = {0};
    for (size_t i = 0; i < count; i++) {
        const double *n = line[i].normal, w = line[i].weight;
        const double at = w * (n[0] * line[i].place[0] + n[1] * line[i].place[1]);
        xx += w * n[0] * n[0], xy += w * n[0] * n[1], yy += w * n[1] * n[1];
        right[0] += at * n[0], right[1] += at * n[1];
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-6 * (xx + yy) * (xx + yy))) return false;
    place[0] = (yy * right[0] - xy * right[1]) / determinant;
    place[1] = (xx * right[1] - xy * right[0]) / determinant;
    *inverse_trace = (xx + yy) / determinant;
    return true;
}

static bool meeting_of(flat_line *line, double *off, size_t count, double foot[2], double *std_error)
{
    double trace = 0, scale = 0, squares = 0, weights = 0;
    if (!meet(line, count, foot, &trace)) return false;
    for (int round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < count; i++) off[i] = fabs(offset_of(&line[i], foot));
        scale = plm_order_median(off, count) / normal_median;
        if (!(scale > 0)) break;
        for (size_t i = 0; i < count; i++) line[i].weight = 1 / (1 + pow(offset_of(&line[i], foot) / scale, 2));
        if (!meet(line, count, foot, &trace)) return false;
    }
    for (size_t i = 0; i < count; i++) {
        squares += line[i].weight * pow(offset_of(&line[i], foot), 2);
        weights += line[i].weight;
    }
    /* two coordinates were taken from count lines */
    *std_error = sqrt(squares / weights * (double)count / (double)(count - 2) * trace / 2);
    return true;
}

static plm_status petioles_foot(const plm_scene *scene, double foot[2], double *std_error, bool *found,
                                plm_error *error)
{
    flat_line *line = plm_alloc(scene->organ_count, sizeof *line, error);
    double *off = plm_alloc(scene->organ_count, sizeof *off, error);
    const plm_status status = line && off ? PLM_OK : PLM_E_MEMORY;
    size_t count = 0;
    for (size_t k = 0; status == PLM_OK && k < scene->organ_count; k++)
        if (scene->organ[k].label == PLM_LABEL_PETIOLE) count += line_of(&scene->organ[k], &line[count]);
    *found = count >= FEWEST_LINES && meeting_of(line, off, count, foot, std_error);
    plm_free(line);
    plm_free(off);
    return status;
}

plm_status plm_plant_foot(const plm_scene *scene, double foot[2], double *std_error, bool *found, plm_error *error)
{
    const plm_organ *stem = plm_scene_organ(scene, PLM_LABEL_STEM, 0);
    *found = stem && stem->count > 0;
    if (!*found) return petioles_foot(scene, foot, std_error, found, error);
    stem_foot(stem, foot, std_error);
    return PLM_OK;
}
