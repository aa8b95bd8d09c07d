/* segment/stem_fit.c: the stem's line and radius sharpened: at each node of the path a circle is fitted to the tube points
 * around it, seen along the stem, against which the feet of petioles are outliers. */
#include "segment/stem_fit.h"

#include "cloud/linear.h"
#include "segment/scratch.h"

#include <math.h>
#include <string.h>

static const double WINDOW = 1;          /* half window along the stem, in R */
static const double REACH = 1.8;         /* points within so many radii of the line are looked at */
static const double OUTLIER = 0.35;      /* Tukey's cutoff, in radii, at least */
static const double OUTLIER_SIGMAS = 4;  /* and in sigmas */
static const double SHIFT_PRIOR = 0.3;   /* SD of the centre's shift, in radii: holds it where only one side was seen */
static const double RADIUS_PRIOR = 0.25; /* SD of the radius' change, in radii */
enum { ROUNDS = 2, STEPS = 6, LEAST_POINTS = 8 };

/* A point as the stem's line sees it. */
typedef struct offset_point {
    double along;
    double offset[3]; /* from the nearest place of the line */
} offset_point;

static size_t gather(const plm_sketch *sketch, const plm_stem_path *stem, offset_point *point)
{
    size_t count = 0;
    for (size_t i = 0; i < sketch->working.count; i++) {
        if (!sketch->is_tube[i]) continue;
        plm_stem_place place;
        if (plm_stem_nearest(stem, sketch->working.xyz[i], &place) > REACH * place.radius) continue;
        offset_point *p = &point[count++];
        p->along = place.along;
        memcpy(p->offset, place.offset, sizeof p->offset);
    }
    return count;
}

/* One Gauss-Newton step of min sum w (|e - c| - r)^2 / s^2 + priors; x is c and r. Gives the number of points used. */
static size_t circle_step(const double (*e)[2], size_t count, double radius0, double scatter, double cutoff,
                          double x[3])
{
    double matrix[9] = {0}, right[3] = {0};
    size_t used = 0;
    for (size_t i = 0; i < count; i++) {
        const double dx = e[i][0] - x[0], dy = e[i][1] - x[1], d = hypot(dx, dy);
        const double residual = d - x[2], t = residual / cutoff;
        if (fabs(t) >= 1 || !(d > 0)) continue;
        const double w = (1 - t * t) * (1 - t * t) / (scatter * scatter);
        const double g[3] = {-dx / d, -dy / d, -1};
        for (int a = 0; a < 3; a++) {
            right[a] -= w * g[a] * residual;
            for (int b = 0; b < 3; b++) matrix[3 * a + b] += w * g[a] * g[b];
        }
        used++;
    }
    /* Neighbouring points are not independent: the data count as 30 points at most. */
    const double share = used > 30 ? 30.0 / (double)used : 1;
    for (int a = 0; a < 9; a++) matrix[a] *= share;
    for (int a = 0; a < 3; a++) right[a] *= share;
    const double prior[3] = {SHIFT_PRIOR * radius0, SHIFT_PRIOR * radius0, RADIUS_PRIOR * radius0};
    const double middle[3] = {0, 0, radius0};
    for (int a = 0; a < 3; a++) {
        matrix[4 * a] += 1 / (prior[a] * prior[a]);
        right[a] += (middle[a] - x[a]) / (prior[a] * prior[a]);
    }
    if (used < LEAST_POINTS || !plm_solve_spd(3, matrix, right)) return 0;
    for (int a = 0; a < 3; a++) x[a] += right[a];
    return used;
}

size_t plm_stem_circle(const double (*e)[2], size_t count, double scatter, double cutoff, double x[3])
{
    const double radius = x[2];
    size_t used = 0;
    for (int step = 0; step < STEPS; step++) used = circle_step(e, count, radius, scatter, cutoff, x);
    return used && x[2] > 0.3 * radius ? used : 0;
}

/* Moves one node to the centre of its circle. e: scratch. */
static void fit_node(const plm_sketch *sketch, plm_stem_path *stem, size_t n, const offset_point *point, size_t count,
                     double (*e)[2])
{
    const size_t a = n ? n - 1 : n, b = n + 1 < stem->count ? n + 1 : n;
    double tangent[3], u[3], v[3];
    for (int axis = 0; axis < 3; axis++) tangent[axis] = stem->node[b][axis] - stem->node[a][axis];
    plm_normalise(tangent);
    plm_frame_of_axis(tangent, u, v);
    const double window = WINDOW * sketch->scale.radius, radius = stem->radius[n];
    size_t near = 0;
    for (size_t i = 0; i < count; i++) {
        if (fabs(point[i].along - stem->along[n]) > window) continue;
        e[near][0] = plm_dot(point[i].offset, u);
        e[near++][1] = plm_dot(point[i].offset, v);
    }
    const double noise = sketch->scale.noise;
    const double scatter = fmax(noise, 0.05 * radius), cutoff = fmax(OUTLIER * radius, OUTLIER_SIGMAS * noise);
    double x[3] = {0, 0, radius};
    if (!plm_stem_circle((const double(*)[2])e, near, scatter, cutoff, x)) return;
    for (int axis = 0; axis < 3; axis++) stem->node[n][axis] += x[0] * u[axis] + x[1] * v[axis];
    stem->radius[n] = x[2];
}

static void smooth_radius(plm_stem_path *stem, float *buffer, float *value)
{
    for (size_t n = 0; n < stem->count; n++) buffer[n] = (float)stem->radius[n];
    for (size_t n = 0; n < stem->count; n++) {
        size_t members = 0;
        for (size_t j = n < 3 ? 0 : n - 3; j <= n + 3 && j < stem->count; j++) value[members++] = buffer[j];
        stem->radius[n] = plm_quantile(value, members, 0.5);
    }
}

plm_status plm_stem_fit(const plm_sketch *sketch, plm_stem_path *stem, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    offset_point *point = plm_scratch_take(&scratch, sketch->working.count, sizeof *point);
    double(*e)[2] = plm_scratch_take(&scratch, sketch->working.count, sizeof *e);
    double(*buffer)[3] = plm_scratch_take(&scratch, stem->count, sizeof *buffer);
    float *radius = plm_scratch_take(&scratch, stem->count, sizeof *radius);
    float *value = plm_scratch_take(&scratch, stem->count + 8, sizeof *value);
    for (int round = 0; round < ROUNDS && !scratch.failed; round++) {
        const size_t count = gather(sketch, stem, point);
        for (size_t n = 0; n < stem->count; n++) fit_node(sketch, stem, n, point, count, e);
        plm_stem_smooth(stem, 2, buffer);
        smooth_radius(stem, radius, value);
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
