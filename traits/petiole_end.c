/* traits/petiole_end.c: a petiole's end as the place farthest along from its foot. Deep lobes lie along the petiole: where the leaf
 * comes nearest to it may be anywhere beside it. Condition: length over thickness of the petiole. */
#include "traits/petiole_end.h"

#include "cloud/linear.h"
#include "cloud/order.h"

#include <string.h>

/* Of the points: so many lie beyond the band whose mean tells an end, and so many in it. */
static const double beyond = 0.01, band = 0.03;

static void place_of(const float xyz[3], double place[3])
{
    for (int i = 0; i < 3; i++) place[i] = xyz[i];
}

/* Mean of the points whose keys are large, but for the largest, which may be strays'. scratch: as many as points. */
static void mean_of_band(const plm_organ *organ, const double *key, double *scratch, double mean[3])
{
    const double last = (double)(organ->count - 1);
    memcpy(scratch, key, organ->count * sizeof *key);
    const double high = plm_order_select(scratch, organ->count, (size_t)((1 - beyond) * last));
    const double low = plm_order_select(scratch, organ->count, (size_t)((1 - beyond - band) * last));
    size_t count = 0;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t j = 0; j < organ->count; j++) {
        if (key[j] < low || key[j] > high) continue;
        for (int i = 0; i < 3; i++) mean[i] += organ->xyz[j][i];
        count++;
    }
    for (int i = 0; i < 3; i++) mean[i] /= (double)count;
}

double plm_organ_gap(const plm_organ *organ, const double place[3])
{
    double least = INFINITY, point[3];
    for (size_t j = 0; j < organ->count; j++) {
        place_of(organ->xyz[j], point);
        least = fmin(least, plm_distance(point, place));
    }
    return least;
}

plm_status plm_petiole_end(const plm_organ *petiole, const plm_organ *stem, const plm_organ *leaf, double end[3],
                           bool *found, plm_error *error)
{
    double *key = plm_alloc(2 * petiole->count, sizeof *key, error);
    if (!key) return PLM_E_MEMORY;
    double *scratch = key + petiole->count, point[3], foot[3];
    for (size_t j = 0; j < petiole->count; j++) {
        float squared;
        place_of(petiole->xyz[j], point);
        if (stem) plm_index_nearest(stem->index, petiole->xyz[j], 1, NULL, &squared);
        key[j] = stem ? -(double)squared : plm_distance(point, leaf->centroid);
    }
    mean_of_band(petiole, key, scratch, foot);
    for (size_t j = 0; j < petiole->count; j++) {
        place_of(petiole->xyz[j], point);
        key[j] = plm_distance(point, foot);
    }
    mean_of_band(petiole, key, scratch, end);
    /* a share of the points is a share of the way */
    for (int i = 0; i < 3; i++) end[i] = foot[i] + (end[i] - foot[i]) / (1 - beyond - 0.5 * band);
    *found = plm_organ_gap(leaf, end) < plm_organ_gap(leaf, foot);
    plm_free(key);
    return PLM_OK;
}
