/* segment/junction_labels.c: what of a leaf is petiole and what blade, once its junction is known. */
#include "segment/junction.h"

#include "cloud/linear.h"
#include "segment/line_fit.h"

static const double NEAR = 3.2;       /* points within so many widths of a tube station's middle are of the tube */
static const double NEAR_CLEAR = 2.2; /* the same where leaflets may lie beside it */
static const double FOOT_LINE = 2;    /* length of the petiole that gives its line at the foot, in R */
enum { RUN_LEAST = 3 };               /* narrow stations, one after the other, that are the petiole's */

static double gap_squared(const float a[3], const double b[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/* The petiole's line at its foot, from the first stations that are as narrow as a tube: what lies before them, where the
 * stem's remains lie as near, is the petiole's only along this line. begin: distance at which the line begins. false where
 * there are too few. */
static bool foot_line(const plm_leaf_way *way, double origin[3], double along[3], double *begin)
{
    const size_t end = (size_t)(way->junction / way->step),
                 wanted = (size_t)(FOOT_LINE * way->sketch->scale.radius / way->step);
    plm_line_sums sums = {0};
    size_t narrow = 0, k = 0;
    for (; k < end && (narrow < RUN_LEAST || !plm_leaf_is_full(way, k - narrow, k)); k++)
        narrow = way->station[k].count > 1 && way->station[k].width < plm_leaf_wide(way) ? narrow + 1 : 0;
    if (narrow < RUN_LEAST || !plm_leaf_is_full(way, k - narrow, k)) return false;
    const size_t first = k - narrow;
    *begin = (double)first * way->step;
    for (k = first; k < end && k < first + wanted; k++) {
        if (!way->station[k].count || way->station[k].width > plm_leaf_wide(way)) continue;
        plm_line_add(&sums, (double)k * way->step - *begin, way->station[k].middle);
    }
    return plm_line_fit(&sums, origin, along);
}

/* Points before the first clear station that are off the petiole's line are the stem's. */
void plm_leaf_clean_foot(plm_sketch *s, const plm_leaf_way *way)
{
    double origin[3], along[3], begin;
    if (!s->stem.count || !foot_line(way, origin, along, &begin)) return;
    const double reach = NEAR * way->tube;
    for (size_t k = 0; k < way->count && way->distance[way->order[k]] < begin; k++) {
        const uint32_t i = way->order[k];
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = s->working.xyz[i][a] - origin[a];
        const double forward = plm_dot(d, along);
        if (plm_dot(d, d) - forward * forward < reach * reach) {
            s->is_tube[i] = true;
        } else if (s->is_tube[i]) {
            s->leaf[i] = -1; /* tube without leaf: stem */
        }
    }
}

void plm_leaf_relabel_simple(plm_sketch *sketch, const plm_leaf_way *way)
{
    const double reach = NEAR * way->tube;
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        if (way->distance[i] >= way->junction) {
            sketch->is_tube[i] = false;
            continue;
        }
        const plm_station *station = plm_leaf_station(way, way->distance[i]);
        if (station->width < plm_leaf_wide(way))
            sketch->is_tube[i] = gap_squared(sketch->working.xyz[i], station->middle) < reach * reach;
    }
}

void plm_leaf_relabel_compound(plm_sketch *s, const plm_leaf_way *way, const bool *beside)
{
    const uint32_t tip = way->order[way->count - 1];
    for (size_t k = 0; k < way->count; k++) {
        const uint32_t i = way->order[k];
        const plm_station *station = plm_leaf_station(way, way->distance[i]);
        const double reach = (beside[station - way->station] ? NEAR_CLEAR : NEAR) * way->tube;
        if (way->distance[i] >= way->junction) {
            if (!s->is_tube[i] || gap_squared(s->working.xyz[i], station->middle) > 4 * station->width * station->width)
                continue;
            s->is_tube[i] = false;
            s->leaflet[i] = s->leaflet[tip];
        } else if (station->width < plm_leaf_wide(way) &&
                   gap_squared(s->working.xyz[i], station->middle) < reach * reach) {
            s->is_tube[i] = true;
        }
    }
}
