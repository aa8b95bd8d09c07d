/* segment/rachis.c: where leaflets sit on the rachis of a compound leaf, balls see blade on both sides and call the rachis
 * blade. Between two stretches that are as narrow as the tube it goes straight on. */
#include "segment/junction.h"

#include "cloud/linear.h"

#include <math.h>

static const double WIDE = 1.6;  /* widths of the tube: a station beyond has leaflets in it */
static const double REACH = 2.2; /* widths of the tube from the rachis' line to its points: the tube's radius is 1.4 */
static const double GAP = 4;     /* in R: a longer way among leaflets need not be straight */
enum { RUN = 3, ENDS = 5 };      /* stations: of the shortest narrow stretch; that give the place of its end */

/* The next stretch of narrow stations from station k on: [*begin, *end). false: there is none before the last. */
static bool next_run(const plm_leaf_way *way, size_t k, size_t last, size_t *begin, size_t *end)
{
    while (k < last) {
        while (k < last && !(way->station[k].count && way->station[k].width < WIDE * way->tube)) k++;
        *begin = k;
        while (k < last && way->station[k].count && way->station[k].width < WIDE * way->tube) k++;
        *end = k;
        if (*end - *begin >= RUN) return true;
    }
    return false;
}

/* Mean of the middles of stations [begin, end). */
static void mean_middle(const plm_leaf_way *way, size_t begin, size_t end, double middle[3])
{
    for (int a = 0; a < 3; a++) middle[a] = 0;
    for (size_t k = begin; k < end; k++)
        for (int a = 0; a < 3; a++) middle[a] += way->station[k].middle[a] / (double)(end - begin);
}

/* Calls the points near the line between two stretches tube. */
static void fill(plm_sketch *sketch, const plm_leaf_way *way, const double from[3], const double to[3])
{
    double along[3];
    for (int a = 0; a < 3; a++) along[a] = to[a] - from[a];
    const double length = plm_normalise(along), reach = REACH * way->tube;
    if (!(length > 0) || length > GAP * sketch->scale.radius) return;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = sketch->working.xyz[i][a] - from[a];
        const double forward = plm_dot(d, along);
        if (forward < 0 || forward > length || plm_dot(d, d) - forward * forward > reach * reach) continue;
        sketch->is_tube[i] = true;
        sketch->leaflet[i] = -1;
    }
}

void plm_leaf_rachis(plm_sketch *sketch, const plm_leaf_way *way)
{
    const size_t junction = (size_t)(way->junction / way->step);
    const size_t last = junction < way->station_count ? junction : way->station_count;
    size_t begin, end, next_begin, next_end;
    if (!next_run(way, 0, last, &begin, &end)) return;
    for (; next_run(way, end, last, &next_begin, &next_end); begin = next_begin, end = next_end) {
        double from[3], to[3];
        mean_middle(way, end - begin > ENDS ? end - ENDS : begin, end, from);
        mean_middle(way, next_begin, next_end - next_begin > ENDS ? next_begin + ENDS : next_end, to);
        fill(sketch, way, from, to);
    }
}
