/* segment/rosette_core.c: petioles of a rosette lie on each other at its core. Nearness along the graph gives many of the
 * core's points to the wrong one, those of high young petioles to old ones below, whose lines then seem to rise inwards. But
 * where they are clear of each other petioles are nearly straight: a point of the core is of the one whose line, prolonged
 * inwards, passes far nearer. */
#include "segment/rosette_core.h"

#include "segment/line_fit.h"
#include "segment/scratch.h"

#include <math.h>

/* Distances from the core's rim, in R, between which petioles tell their lines. */
static const double CLEAR = 0.6, CLEAR_END = 2.6;
static const double BEHIND = 1.5;    /* a line is followed so far inwards of the rim, in R: a little past the middle */
static const double SHORTEST = 1;    /* length of the clear part, in R: from less no line is prolonged */
static const double NEARER = 0.5;    /* of the distance from the present line: where lines cross, others are as good */
static const double MOST_LOST = 0.5; /* of a petiole's points: one that would lose more has a wrong line */
enum { FEWEST = 8 };

/* The line of a petiole, from the core's rim towards its tip. */
typedef struct core_line {
    plm_line_sums sums;
    double nearest, farthest; /* distances from the rim */
    size_t points, lost;      /* of the petiole */
    bool known;
    double origin[3], along[3];
} core_line;

static void add(core_line *line, const float xyz[3], double distance, double R)
{
    line->points++;
    if (!(distance >= CLEAR * R && distance < CLEAR_END * R)) return;
    line->nearest = line->sums.n > 0 ? fmin(line->nearest, distance) : distance;
    line->farthest = fmax(line->farthest, distance);
    plm_line_add(&line->sums, distance, (double[3]){xyz[0], xyz[1], xyz[2]});
}

static void fit(core_line *line, double least)
{
    if (line->sums.n < FEWEST || line->farthest - line->nearest < least) return;
    line->known = plm_line_fit(&line->sums, line->origin, line->along);
}

/* Distance of a point from the line; INFINITY too far beyond the core. */
static double off_line(const core_line *line, const float xyz[3], double behind)
{
    double d[3];
    if (!line->known) return INFINITY;
    for (int k = 0; k < 3; k++) d[k] = xyz[k] - line->origin[k];
    const double forward = plm_dot(d, line->along);
    return forward < -behind ? INFINITY : sqrt(fmax(plm_dot(d, d) - forward * forward, 0));
}

/* The petiole whose line passes a point far nearer than that of its own does, or its own. */
static int32_t nearest_line(const plm_sketch *sketch, const core_line *line, uint32_t point)
{
    const int32_t own = sketch->leaf[point];
    const float *xyz = sketch->working.xyz[point];
    const double behind = BEHIND * sketch->scale.radius;
    int32_t best = own;
    double least = NEARER * off_line(&line[own], xyz, INFINITY);
    for (size_t k = 0; k < sketch->leaf_count; k++) {
        const double off = off_line(&line[k], xyz, behind);
        if (off < least) least = off, best = (int32_t)k;
    }
    return best;
}

plm_status plm_rosette_core(plm_sketch *sketch, const float *distance, plm_error *error)
{
    const size_t count = sketch->working.count;
    const double R = sketch->scale.radius, clear = CLEAR * R;
    plm_scratch scratch = {.error = error};
    core_line *line = plm_scratch_take(&scratch, sketch->leaf_count + 1, sizeof *line);
    int32_t *next = plm_scratch_take(&scratch, count, sizeof *next);
    if (!scratch.failed) {
        for (size_t i = 0; i < count; i++)
            if (sketch->leaf[i] >= 0 && sketch->is_tube[i])
                add(&line[sketch->leaf[i]], sketch->working.xyz[i], distance[i], R);
        for (size_t k = 0; k < sketch->leaf_count; k++) fit(&line[k], SHORTEST * R);
        for (uint32_t i = 0; i < count; i++) {
            const int32_t own = next[i] = sketch->leaf[i];
            if (own < 0 || !sketch->is_tube[i] || !(distance[i] < clear) || !line[own].known) continue;
            next[i] = nearest_line(sketch, line, i);
            line[own].lost += next[i] != own;
        }
        for (size_t i = 0; i < count; i++) {
            const core_line *own = next[i] >= 0 ? &line[sketch->leaf[i]] : NULL;
            if (own && (double)own->lost <= MOST_LOST * (double)own->points) sketch->leaf[i] = next[i];
        }
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
