/* traits/projection.c: points of a noisy surface projected onto the quadrics through their neighbours, and what noise is left in
 * how high they lie then. Condition: 1 for sheets as wide as ten noise; thinner ones, tubes and where surfaces meet count as they
 * were seen. */
#include "traits/projection.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

enum {
    BALL_ROOM = 1024,
    QUADRIC_POINTS = 400,
    QUADRIC_USUAL = 48, /* fewer leave half of the noise in the projected points */
    QUADRIC_FEWEST = 12,
    PROJECTION_STEPS = 2,
    FIT_POINTS = 160
};

/* Neighbours that lie off the quadric by so much more than the noise, as much again by their shape, are no one surface: thin
 * tubes that meet, as the petioles at a rosette's foot. A point there is as high as it was seen, with all of its noise. */
static const double no_surface = 1.4;
/* So are neighbours that lie hardly less far off their surface than they reach across it, as a tube thinner than the noise and the
 * end of any have them: their normal points anywhere. What was seen counts there, with the noise across the tube. (Below 1.3 and
 * above 1.7 tops and feet of 96 virtual splats are worse.) */
static const double least_flatness = 1.5;
/* A projection whose last step is shorter than this much of the noise is done. */
static const double settled = 0.4;

typedef struct patch {
    double (*local)[3]; /* u, v, height of the neighbours about the point, in the tangent frame */
    double *weight;
    size_t count;
} patch;

/* Tangent frame of weighted neighbours: axis[2] is the normal. Gives their flatness (see plm_projection). */
static double tangent_frame(const double (*offset)[3], const double *weight, size_t count, double axis[3][3])
{
    double sum = 0, mean[3] = {0}, moment[6] = {0}, value[3];
    for (size_t i = 0; i < count; i++) {
        sum += weight[i];
        for (int k = 0; k < 3; k++) mean[k] += weight[i] * offset[i][k];
    }
    for (int k = 0; k < 3; k++) mean[k] /= sum;
    for (size_t i = 0; i < count; i++) {
        const double x = offset[i][0] - mean[0], y = offset[i][1] - mean[1], z = offset[i][2] - mean[2];
        moment[0] += weight[i] * x * x, moment[1] += weight[i] * x * y, moment[2] += weight[i] * x * z;
        moment[3] += weight[i] * y * y, moment[4] += weight[i] * y * z, moment[5] += weight[i] * z * z;
    }
    plm_eigen3(moment, value, axis);
    return value[0] > 0 ? value[1] / fmax(value[2], 1e-12 * value[0]) : INFINITY;
}

/* The products of powers of u and v up to the fourth, and which of them is the product of two terms of a quadric. */
enum { TERMS = 6, PRODUCTS = 15 };

static const unsigned char product[TERMS][TERMS] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},
                                                    {2, 4, 5, 7, 8, 9},    {3, 6, 7, 10, 11, 12},
                                                    {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};

/** Sums over the neighbours, by weight and by its square. */
typedef struct quadric_sums {
    double product[PRODUCTS], product_squared[PRODUCTS], right[TERMS], squares;
} quadric_sums;

static quadric_sums sum_up(const patch *p, double scale)
{
    quadric_sums sum = {0};
    for (size_t i = 0; i < p->count; i++) {
        const double u = p->local[i][0] / scale, v = p->local[i][1] / scale, uu = u * u, uv = u * v, vv = v * v;
        const double of[PRODUCTS] = {1,      u,      v,       uu,      uv,      vv,      u * uu, v * uu,
                                     u * vv, v * vv, uu * uu, uu * uv, uu * vv, uv * vv, vv * vv};
        const double w = p->weight[i], squared = w * w, h = p->local[i][2];
        for (int k = 0; k < PRODUCTS; k++) sum.product[k] += w * of[k];
        for (int k = 0; k < PRODUCTS; k++) sum.product_squared[k] += squared * of[k];
        for (int k = 0; k < TERMS; k++) sum.right[k] += w * h * of[k];
        sum.squares += w * h * h;
    }
    return sum;
}

/* The weighted quadric at u = v = 0: its height, its leverage (the variance of that height per variance of the points), and
 * the points' root mean square distance from it. False where the neighbours do not determine it. */
static bool quadric_height(const patch *p, double scale, double *height, double *leverage, double *rest)
{
    const quadric_sums sum = sum_up(p, scale);
    double normal[TERMS * TERMS], factor[TERMS * TERMS], solved[TERMS], unit[TERMS] = {1}, squares = sum.squares;
    for (int a = 0; a < TERMS; a++)
        for (int b = 0; b < TERMS; b++) normal[a * TERMS + b] = sum.product[product[a][b]];
    for (int a = 1; a < TERMS; a++) normal[a * (TERMS + 1)] *= 1 + 1e-6; /* a ridge for slivers */
    memcpy(solved, sum.right, sizeof solved);
    memcpy(factor, normal, sizeof factor);
    if (!plm_solve_spd(TERMS, normal, solved) || !plm_solve_spd(TERMS, factor, unit)) return false;
    *height = solved[0];
    *leverage = 0;
    for (int a = 0; a < TERMS; a++) squares -= solved[a] * sum.right[a];
    *rest = sqrt(fmax(squares, 0) / sum.product[0]);
    for (int a = 0; a < TERMS; a++)
        for (int b = 0; b < TERMS; b++) *leverage += unit[a] * sum.product_squared[product[a][b]] * unit[b];
    return true;
}

/* Fits the quadric through the neighbours of a place but the point `without`, weighted down by distance, and moves the
 * place onto it. False where they determine none. */
static bool step_to_surface(const plm_subset *points, const float without[3], double noise, const double place[3],
                            double moved[3], plm_projection *onto)
{
    const plm_index *index = points->index;
    const float(*xyz)[3] = points->xyz;
    uint32_t row[BALL_ROOM];
    float squared[BALL_ROOM];
    const float centre[3] = {(float)place[0], (float)place[1], (float)place[2]};
    size_t found = plm_index_ball(index, centre, (float)(5 * noise), BALL_ROOM, row, squared);
    if (found < QUADRIC_USUAL) found = plm_index_nearest(index, centre, QUADRIC_USUAL, row, squared);
    if (found > BALL_ROOM) found = plm_index_nearest(index, centre, BALL_ROOM, row, squared);
    if (found < QUADRIC_FEWEST) return false;
    const size_t stride = (found + QUADRIC_POINTS - 1) / QUADRIC_POINTS;
    double offset[QUADRIC_POINTS][3], weight[QUADRIC_POINTS], local[QUADRIC_POINTS][3], axis[3][3];
    patch p = {local, weight, 0};
    for (size_t i = 0; i < found; i += stride) {
        if (memcmp(xyz[row[i]], without, sizeof xyz[row[i]]) == 0) continue;
        const double d = sqrt((double)squared[i]) / (3 * noise);
        weight[p.count] = 1 / (1 + d * d * d * d);
        for (int k = 0; k < 3; k++) offset[p.count][k] = (double)xyz[row[i]][k] - place[k];
        p.count++;
    }
    if (p.count < QUADRIC_FEWEST) return false;
    onto->flatness = tangent_frame((const double(*)[3])offset, weight, p.count, axis);
    for (size_t i = 0; i < p.count; i++)
        for (int k = 0; k < 3; k++) local[i][k] = plm_dot(offset[i], axis[k]);
    double height;
    if (!quadric_height(&p, 5 * noise, &height, &onto->leverage, &onto->rest) || !(fabs(height) < 4 * noise))
        return false;
    onto->leverage = fmin(onto->leverage, 1);
    for (int k = 0; k < 3; k++) {
        moved[k] = place[k] + height * axis[2][k];
        onto->normal[k] = axis[2][k];
        onto->axis[k] = axis[0][k];
    }
    return true;
}

/* An outermost point is one that noise threw out: it would draw the surface to itself, so it has no say in it, and what lies
 * beside it, which counts more, was thrown out like it: the step is repeated from where it led to. */
bool plm_project_to_surface(const plm_subset *points, const float point[3], double noise, plm_projection *onto)
{
    double place[3] = {point[0], point[1], point[2]}, moved[3];
    for (int step = 0; step < PROJECTION_STEPS; step++) {
        if (!step_to_surface(points, point, noise, place, moved, onto)) return false;
        double squares = 0;
        for (int k = 0; k < 3; k++) squares += pow(moved[k] - place[k], 2), place[k] = moved[k];
        if (squares < pow(settled * noise, 2)) break;
    }
    /* Steps on a tube that is thinner than the fit is wide drift along it: only what lies across the surface is noise. */
    double across = 0;
    for (int k = 0; k < 3; k++) across += (place[k] - point[k]) * onto->normal[k];
    for (int k = 0; k < 3; k++) onto->place[k] = (float)(point[k] + across * onto->normal[k]);
    return true;
}

/* A ball of 5 noise holds at least FIT_POINTS of a sheet, up to twice as many, all of which are fitted to: QUADRIC_POINTS leave room for
 * what is denser. More would cost more than they tell (with four times as many, heights of rosettes as splats are no better). */
plm_status plm_fit_points(const plm_index *index, const float (*xyz)[3], size_t count, const plm_sampling *sampling,
                          plm_subset *points, plm_error *error)
{
    const double reach = 5 * sampling->noise / sampling->spacing;
    return plm_subset_take(index, xyz, count, FIT_POINTS / (PLM_PI * reach * reach), points, error);
}

double plm_projected_height(const plm_projection *onto, const float seen[3], const double direction[3],
                            const plm_blur *blur, plm_height *height)
{
    const double noise = blur->sampling->noise;
    const bool fused = blur->sampling->fused, cut = blur->cut;
    const bool thin = onto->flatness < least_flatness && !(fused && cut); /* voxel means keep a stem's end a surface */
    const bool as_seen = thin || onto->rest > no_surface * noise;
    const float *place = as_seen ? seen : onto->place;
    const double leverage = as_seen ? 1 : onto->leverage;
    const double across = plm_dot(onto->normal, direction), run = fmin(fabs(plm_dot(onto->axis, direction)), 1);
    const double squared = thin ? 1 - run * run : as_seen ? 1 : across * across;
    height->at = 0;
    for (int k = 0; k < 3; k++) height->at += place[k] * direction[k];
    const bool unknown = as_seen && cut && !fused;
    height->spread = unknown ? 0 : noise * sqrt(squared * leverage);
    height->along = unknown ? noise : noise * sqrt(fmax(1 - squared, 0));
    if (fused) height->spread = hypot(height->spread, blur->along * height->along), height->along = 0;
    return squared;
}
