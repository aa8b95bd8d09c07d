/* segment/balls.c: a sphere is fitted to the points about a point, then to all that lie on it (linear least squares: I. Kasa, A
 * circle fitting procedure and its error analysis, 1976), and judged by the directions that these cover. (On virtual plants spheres
 * of fruits have 0.01 to 0.05 of their radius as roughness and nothing inside, those through leaves 0.066 and more, where half of the
 * directions are covered.) */
#include "segment/balls.h"

#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "segment/scratch.h"

#include <math.h>

enum {
    SEEDS = 4000,
    LOCAL = 64,        /* points of a local fit */
    FEWEST_LOCAL = 16, /* ... at least */
    FEWEST = 30,       /* points of a ball */
    ROUNDS = 8,
    PASSES = 2, /* the second one looks beside what was found */
    LEAST_BINS = 12,
    MOST_BINS = 48, /* of directions */
    POINTS_PER_BIN = 4,
    MOST_BALLS = 512
};
static const double STEP = 1.5;                    /* from one reach of local fits to the next */
static const double NEAREST = 0.5, FARTHEST = 1.2; /* radii that a local fit tells, in its reach */
static const double ROUGH = 0.055; /* RMS distance from the sphere at most, of its radius, beside the noise */
static const double THICK = 0.15, THICK_NOISE = 2,
                    THICK_CELLS = 1; /* off the sphere is on it: in radii, noise, cells */
/* Of the directions. One point covers a bin, so that a rim covers more than there is: points must also balance. Of a cap the mean of
 * the directions is as long as its share is less than 1; so little of that is enough. */
static const double COVERED = 0.6, COVERED_BESIDE = 0.5, BALANCED = 0.47, BALANCED_BESIDE = 0.35;
static const double BESIDE = 1.4; /* middles are so many sums of radii apart, at most */
static const double APART = 0.7;  /* of the larger radius: nearer middles are of one ball */
static const double INSIDE = 0.1; /* points inside, of those on the sphere */
static const double DENSE = 0.25; /* of the points that what is covered should have */
static const double SETTLED = 0.01;

typedef struct search {
    const plm_ball_query *query;
    plm_index *index;
    uint32_t *row; /* room for all points: of the last query */
    float *squared;
    bool *taken;
    plm_ball *ball;
    size_t found;
} search;

static void place_of(const plm_ball_query *q, size_t i, double place[3])
{
    for (int k = 0; k < 3; k++) place[k] = q->xyz[i][k];
}

/* The sphere through rows of points: |x - o|^2 = 2 c (x - o) + d, in units near the radius. */
static bool fit_sphere(const search *s, size_t count, const double origin[3], double unit, plm_ball *ball, double *rms)
{
    const plm_ball_query *q = s->query;
    double normal[16] = {0}, right[4] = {0}, squares = 0;
    for (size_t j = 0; j < count; j++) {
        double x[4] = {0, 0, 0, 1}, square = 0;
        for (int k = 0; k < 3; k++) {
            x[k] = (q->xyz[s->row[j]][k] - origin[k]) / unit;
            square += x[k] * x[k];
        }
        for (int a = 0; a < 4; a++) {
            for (int b = 0; b <= a; b++) normal[a * 4 + b] += x[a] * x[b];
            right[a] += x[a] * square;
        }
    }
    if (!plm_solve_spd(4, normal, right)) return false;
    const double square = right[3] + 0.25 * plm_dot(right, right);
    if (!(square > 0)) return false;
    for (int k = 0; k < 3; k++) ball->centre[k] = origin[k] + 0.5 * right[k] * unit;
    ball->radius = sqrt(square) * unit;
    for (size_t j = 0; j < count; j++) {
        double at[3];
        place_of(q, s->row[j], at);
        const double off = plm_distance(at, ball->centre) - ball->radius;
        squares += off * off;
    }
    *rms = sqrt(squares / (double)count);
    return true;
}

static double roughest(const plm_ball_query *q, double radius)
{
    return hypot(ROUGH * radius, q->noise);
}

static bool is_asked(const plm_ball_query *q, const plm_ball *ball)
{
    return ball->radius >= q->least_radius && ball->radius <= q->most_radius;
}

/* The sphere of the points about a seed. */
static bool guess(search *s, size_t seed, double reach, plm_ball *ball)
{
    const plm_ball_query *q = s->query;
    const size_t found = plm_index_ball(s->index, q->xyz[seed], (float)reach, q->count, s->row, s->squared);
    const size_t step = found / LOCAL + 1;
    size_t used = 0;
    for (size_t j = 0; j < found; j += step)
        if (q->may_be[s->row[j]]) s->row[used++] = s->row[j];
    double origin[3], rms;
    place_of(q, seed, origin);
    if (used < FEWEST_LOCAL || !fit_sphere(s, used, origin, reach, ball, &rms)) return false;
    const bool is_told = ball->radius >= NEAREST * reach && ball->radius <= FARTHEST * reach;
    return is_told && is_asked(q, ball) && rms <= roughest(q, ball->radius);
}

static double thickness(const plm_ball_query *q, double radius)
{
    return fmax(THICK * radius, fmax(THICK_NOISE * q->noise, THICK_CELLS * q->cell));
}

/* Rows of what lies on the sphere go first. Gives how many; inside: out. */
static size_t on_sphere(search *s, const plm_ball *ball, size_t *inside)
{
    const plm_ball_query *q = s->query;
    const double thick = thickness(q, ball->radius);
    const float centre[3] = {(float)ball->centre[0], (float)ball->centre[1], (float)ball->centre[2]};
    const size_t found = plm_index_ball(s->index, centre, (float)(ball->radius + thick), q->count, s->row, s->squared);
    size_t used = 0;
    *inside = 0;
    for (size_t j = 0; j < found; j++) {
        if (sqrt((double)s->squared[j]) < ball->radius - thick)
            ++*inside;
        else if (q->may_be[s->row[j]])
            s->row[used++] = s->row[j];
    }
    return used;
}

/* Fits the sphere to all that lies on it, some rounds or until it stays. Gives how many points that are, 0: there is none. */
static size_t refine(search *s, plm_ball *ball, double *rms, size_t *inside)
{
    size_t used = on_sphere(s, ball, inside);
    for (int round = 0; round < ROUNDS; round++) {
        const plm_ball before = *ball;
        if (used < FEWEST || !fit_sphere(s, used, before.centre, before.radius, ball, rms)) return 0;
        if (!is_asked(s->query, ball)) return 0;
        used = on_sphere(s, ball, inside);
        if (plm_distance(before.centre, ball->centre) < SETTLED * ball->radius) break;
    }
    return used < FEWEST ? 0 : used;
}

/* Share of all directions, evenly spread along a spiral, that the first rows of points cover. */
static double covered_share(const search *s, const plm_ball *ball, size_t used)
{
    bool seen[MOST_BINS] = {false};
    double direction[MOST_BINS][3];
    size_t bins = used / POINTS_PER_BIN, count = 0;
    bins = bins < LEAST_BINS ? LEAST_BINS : bins > MOST_BINS ? MOST_BINS : bins;
    for (size_t b = 0; b < bins; b++) {
        const double z = 1 - (2 * (double)b + 1) / (double)bins, turn = PLM_PI * (3 - sqrt(5)) * (double)b;
        direction[b][0] = sqrt(1 - z * z) * cos(turn);
        direction[b][1] = sqrt(1 - z * z) * sin(turn);
        direction[b][2] = z;
    }
    for (size_t j = 0; j < used; j++) {
        double d[3], most = -INFINITY;
        size_t best = 0;
        place_of(s->query, s->row[j], d);
        for (int k = 0; k < 3; k++) d[k] -= ball->centre[k];
        for (size_t b = 0; b < bins; b++) {
            const double along = plm_dot(d, direction[b]);
            if (along > most) most = along, best = b;
        }
        seen[best] = true;
    }
    for (size_t b = 0; b < bins; b++) count += seen[b];
    return (double)count / (double)bins;
}

/* How well the first rows of points balance about the middle: 1 all around, 0 to one side. */
static double balance(const search *s, const plm_ball *ball, size_t used)
{
    double sum[3] = {0};
    for (size_t j = 0; j < used; j++) {
        double d[3];
        place_of(s->query, s->row[j], d);
        for (int k = 0; k < 3; k++) d[k] -= ball->centre[k];
        plm_normalise(d);
        for (int k = 0; k < 3; k++) sum[k] += d[k];
    }
    return 1 - plm_norm(sum) / (double)used;
}

static bool is_found(const search *s, const plm_ball *ball)
{
    for (size_t b = 0; b < s->found; b++)
        if (plm_distance(ball->centre, s->ball[b].centre) < APART * fmax(ball->radius, s->ball[b].radius)) return true;
    return false;
}

/* Rows of points that are on no other ball go first, of the first so many. Gives how many. */
static size_t own_points(search *s, size_t used)
{
    size_t own = 0;
    for (size_t j = 0; j < used; j++)
        if (!s->taken[s->row[j]]) s->row[own++] = s->row[j];
    return own;
}

/* Whether a ball of this middle and radius would be next to one that was found. */
static bool is_beside(const search *s, const double centre[3], double radius)
{
    for (size_t b = 0; b < s->found; b++)
        if (plm_distance(centre, s->ball[b].centre) < BESIDE * (radius + s->ball[b].radius)) return true;
    return false;
}

static void try_seed(search *s, size_t seed, double reach)
{
    const plm_ball_query *q = s->query;
    plm_ball ball;
    double rms;
    size_t inside;
    if (s->found == MOST_BALLS || !guess(s, seed, reach, &ball)) return;
    size_t used = refine(s, &ball, &rms, &inside);
    if (!used || rms > roughest(q, ball.radius) || (double)inside > INSIDE * (double)used) return;
    if (is_found(s, &ball)) return;
    used = own_points(s, used);
    if (used < FEWEST) return;
    const bool beside = is_beside(s, ball.centre, ball.radius);
    const double covered = covered_share(s, &ball, used);
    const double full = covered * 4 * PLM_PI * ball.radius * ball.radius / (q->cell * q->cell);
    if (covered < (beside ? COVERED_BESIDE : COVERED) || (double)used < DENSE * full) return;
    if (balance(s, &ball, used) < (beside ? BALANCED_BESIDE : BALANCED)) return;
    ball.thick = fmax(THICK * ball.radius, THICK_NOISE * q->noise);
    s->ball[s->found++] = ball;
    for (size_t j = 0; j < used; j++) s->taken[s->row[j]] = true;
}

/* Seeds all over the plant, and then all points beside what was found. */
static void look(search *s)
{
    const plm_ball_query *q = s->query;
    size_t before = 0;
    for (int pass = 0; pass < PASSES && (!pass || s->found > before); pass++) {
        const size_t step = pass ? 1 : q->count / SEEDS + 1;
        before = s->found;
        for (double reach = q->least_radius; reach < q->most_radius; reach *= STEP)
            for (size_t i = 0; i < q->count; i += step) {
                double at[3];
                place_of(q, i, at);
                if (!q->may_be[i] || s->taken[i] || (pass && !is_beside(s, at, reach))) continue;
                try_seed(s, i, reach);
            }
    }
}

plm_status plm_balls_find(const plm_ball_query *query, plm_ball **ball, size_t *count, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    search s = {.query = query};
    s.row = plm_scratch_take(&scratch, query->count + 1, sizeof *s.row);
    s.squared = plm_scratch_take(&scratch, query->count + 1, sizeof *s.squared);
    s.taken = plm_scratch_take(&scratch, query->count + 1, sizeof *s.taken);
    s.ball = plm_scratch_take(&scratch, MOST_BALLS, sizeof *s.ball);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) status = plm_index_build(query->xyz, query->count, &s.index, error);
    if (status == PLM_OK) {
        if (query->least_radius > 0) look(&s);
        *ball = s.ball;
        *count = s.found;
    }
    plm_index_free(s.index);
    plm_scratch_free(&scratch, status == PLM_OK ? s.ball : NULL);
    return status;
}
