/* traits/centre_line.c: a penalised spline (P. H. C. Eilers and B. D. Marx, Flexible smoothing with B-splines and
 * penalties, Statistical Science 11, 1996; the penalties here are integrals of the squared second and, where a line's shape asks for it,
 * third derivative) through the centroids of a tube's points.
 *
 * Centroids beat fitted circles where noise is near the radius: a view that sees one side only shifts both ends alike and
 * leaves the direction alone, while a ring fit must find a centre that noise hides. */
#include "traits/centre_line.h"

#include "cloud/linear.h"
#include "cloud/order.h"

#include <string.h>

enum { ROUNDS = 8, BINS_PER_COEFFICIENT = 8, QUADRATURE = 3, SECTORS = 8, POINTS_PER_RING = 64, MOST_RINGS = 12 };

static const double distance_limit = 2.2; /* median distances at which a point's weight is one half */
static const double inlying = 2.5;        /* median distances within which a point counts as the tube's */
/* Square root of the integral of u''^2 over the chord's parameter, in lengths of the chord, that a tube is expected to
 * have: it gives the quadratic and cubic Legendre terms prior SDs of 0.05 and 0.02 lengths. */
static const double expected_bend = 0.3;
static const double CUBIC_THIRD = 15; /* third derivative of the cubic Legendre polynomial */
/* Degrees of freedom of the prior of the cubic term, Student's t for u and v together: few lines are hooks, but those are far more
 * skew than others. Found by expectation and maximisation along with the weights. */
static const double SKEW_FREEDOM = 4;

typedef struct work {
    const double (*xyz)[3];
    size_t count;
    double *t, *weight, *distance, *scratch;
    int *cell;
    double *sum;               /* weights of the cells */
    int bin_count, ring_count; /* parts of the chord that weigh alike, and those within which directions do */
} work;

static void parameters(const plm_curve *curve, work *w)
{
    for (size_t i = 0; i < w->count; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = w->xyz[i][k] - curve->origin[k];
        w->t[i] = plm_dot(d, curve->along) / curve->half;
    }
}

/* Distances of the points from the line in the plane across the chord; gives their median. */
static double distances(const plm_curve *curve, work *w)
{
    for (size_t i = 0; i < w->count; i++) {
        double at[3], d[3];
        plm_curve_point(curve, w->t[i], at);
        for (int k = 0; k < 3; k++) d[k] = w->xyz[i][k] - at[k];
        w->distance[i] = plm_norm(d);
    }
    memcpy(w->scratch, w->distance, w->count * sizeof *w->scratch);
    return plm_order_median(w->scratch, w->count);
}

/* Number of the equal part of [-1, 1], of count, that t lies in. */
static int part_of(double t, int count)
{
    const double place = 0.5 * (t + 1) * count;
    return place < 0 ? 0 : place >= count ? count - 1 : (int)place;
}

/* Multiplies the weights so that the cells weigh alike; cell[i] is the cell of point i. No point gains more than most
 * times: a stray point in an empty cell must not carry that cell. */
static void equalise(work *w, const int *cell, int cell_count, double most)
{
    memset(w->sum, 0, (size_t)cell_count * sizeof *w->sum);
    for (size_t i = 0; i < w->count; i++) w->sum[cell[i]] += w->weight[i];
    double total = 0;
    int filled = 0;
    for (int c = 0; c < cell_count; c++) {
        total += w->sum[c];
        filled += w->sum[c] > 0;
    }
    for (size_t i = 0; i < w->count; i++) w->weight[i] *= fmin(total / filled / w->sum[cell[i]], most);
}

/* Robust weights; then equal weight for equal lengths of the chord and, along it, for all directions around the line:
 * the side that is seen best must not draw the line towards it, more so where the tube is thick than where it is thin. */
static void weigh(const plm_curve *curve, double median, work *w)
{
    for (size_t i = 0; i < w->count; i++) {
        const double ratio = median > 0 ? w->distance[i] / (distance_limit * median) : 0;
        w->weight[i] = 1 / (1 + ratio * ratio * ratio * ratio);
    }
    for (size_t i = 0; i < w->count; i++) {
        double at[3], d[3];
        plm_curve_point(curve, w->t[i], at);
        for (int k = 0; k < 3; k++) d[k] = w->xyz[i][k] - at[k];
        const double turn = atan2(plm_dot(d, curve->across[1]), plm_dot(d, curve->across[0])) / (2 * PLM_PI) + 0.5;
        const int sector = (int)(turn * SECTORS) % SECTORS;
        w->cell[i] = part_of(w->t[i], w->ring_count) * SECTORS + sector;
    }
    equalise(w, w->cell, w->ring_count * SECTORS, 4);
    for (size_t i = 0; i < w->count; i++) w->cell[i] = part_of(w->t[i], w->bin_count);
    equalise(w, w->cell, w->bin_count, 4);
}

/* Adds factor x the integral over [-1, 1] of u''^2, as a quadratic form of the coefficients. */
static void add_penalty(const plm_curve *curve, double factor, double *matrix)
{
    static const double node[QUADRATURE] = {-0.7745966692414834, 0, 0.7745966692414834};
    static const double weight[QUADRATURE] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    const int n = plm_curve_basis_count(curve);
    const double half = 1.0 / curve->spans;
    for (int span = 0; span < curve->spans; span++)
        for (int q = 0; q < QUADRATURE; q++) {
            double value[4], first[4], second[4];
            const int begin = plm_curve_basis(curve, -1 + half * (2 * span + 1 + node[q]), value, first, second);
            for (int a = 0; a <= curve->degree; a++)
                for (int b = 0; b <= curve->degree; b++)
                    matrix[(begin + a) * n + begin + b] += factor * half * weight[q] * second[a] * second[b];
        }
}

/* How the third derivative within a span, which is one number there, follows from four coefficients; gives the number of the first. */
static int third_derivative(const plm_curve *curve, int span, double third[4])
{
    const double length = 2.0 / curve->spans, middle = -1 + length * (span + 0.5), inside = 0.25 * length;
    double value[4], first[4], low[4], high[4];
    const int begin = plm_curve_basis(curve, middle - inside, value, first, low);
    plm_curve_basis(curve, middle + inside, value, first, high);
    for (int a = 0; a < 4; a++) third[a] = (high[a] - low[a]) / (2 * inside);
    return begin;
}

/* Adds factor x the integral of u'''^2 likewise. */
static void add_skew_penalty(const plm_curve *curve, double factor, double *matrix)
{
    const int n = plm_curve_basis_count(curve);
    for (int span = 0; span < curve->spans; span++) {
        double third[4];
        const int begin = third_derivative(curve, span, third);
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++)
                matrix[(begin + a) * n + begin + b] += factor * (2.0 / curve->spans) * third[a] * third[b];
    }
}

/* Mean square of the cubic term of u and v, in squared lengths of the chord: of a line that is no cubic the one of as large a third
 * derivative. */
static double squared_skew(const plm_curve *curve)
{
    double mean = 0;
    for (int span = 0; span < curve->spans; span++) {
        double third[4];
        const int begin = third_derivative(curve, span, third);
        for (int c = 0; c < 2; c++) {
            double here = 0;
            for (int a = 0; a < 4; a++) here += third[a] * curve->offset[c][begin + a];
            mean += 0.5 * here * here / curve->spans;
        }
    }
    const double unit = CUBIC_THIRD * 2 * curve->half;
    return mean / (unit * unit);
}

/* Solves for the coefficients with the present weights; scatter is the SD of the points across the line, by which the
 * penalty is weighed; skew2: variance of the cubic term, 0: no prior. covariance (may be NULL): inverse of the normal
 * matrix. false where it is singular. */
static bool solve(const work *w, plm_curve *curve, double scatter, double skew2,
                  double covariance[PLM_CURVE_BASIS][PLM_CURVE_BASIS])
{
    const int n = plm_curve_basis_count(curve);
    double matrix[PLM_CURVE_BASIS * PLM_CURVE_BASIS] = {0}, right[2][PLM_CURVE_BASIS] = {{0}};
    for (size_t i = 0; i < w->count; i++) {
        double value[4], first[4], d[3];
        const int begin = plm_curve_basis(curve, w->t[i], value, first, NULL);
        for (int k = 0; k < 3; k++) d[k] = w->xyz[i][k] - curve->origin[k];
        const double u[2] = {plm_dot(d, curve->across[0]), plm_dot(d, curve->across[1])};
        for (int a = 0; a <= curve->degree; a++) {
            const double weighted = w->weight[i] * value[a];
            for (int b = 0; b <= curve->degree; b++) matrix[(begin + a) * n + begin + b] += weighted * value[b];
            for (int c = 0; c < 2; c++) right[c][begin + a] += weighted * u[c];
        }
    }
    const double bend = expected_bend * 2 * curve->half;
    add_penalty(curve, scatter * scatter / (bend * bend), matrix);
    const double third = CUBIC_THIRD * 2 * curve->half;
    if (skew2 > 0) add_skew_penalty(curve, scatter * scatter / (2 * third * third * skew2), matrix);
    double trace = 0, factor[PLM_CURVE_BASIS * PLM_CURVE_BASIS];
    for (int a = 0; a < n; a++) trace += matrix[a * n + a];
    for (int a = 0; a < n; a++) matrix[a * n + a] += 1e-12 * trace; /* empty spans */
    for (int c = 0; c < 2; c++) {
        memcpy(factor, matrix, sizeof factor);
        if (!plm_solve_spd(n, factor, right[c])) return false;
        memcpy(curve->offset[c], right[c], (size_t)n * sizeof **right);
    }
    for (int a = 0; covariance && a < n; a++) {
        double unit[PLM_CURVE_BASIS] = {0};
        unit[a] = 1;
        memcpy(factor, matrix, sizeof factor);
        if (!plm_solve_spd(n, factor, unit)) return false;
        for (int b = 0; b < n; b++) covariance[a][b] = unit[b];
    }
    return true;
}

/* Weighted SD of the points across the line. */
static double scatter_of(const work *w)
{
    double sum = 0, weights = 0;
    for (size_t i = 0; i < w->count; i++) {
        sum += w->weight[i] * w->distance[i] * w->distance[i];
        weights += w->weight[i];
    }
    return sqrt(0.5 * sum / weights);
}

static bool fit(work *w, double skew, plm_centre_line *out)
{
    plm_curve *curve = &out->curve;
    parameters(curve, w);
    for (size_t i = 0; i < w->count; i++) { /* first: medians of the offsets, which outliers do not move */
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = w->xyz[i][k] - curve->origin[k];
        w->distance[i] = plm_dot(d, curve->across[0]);
        w->scratch[i] = plm_dot(d, curve->across[1]);
    }
    const double middle[2] = {plm_order_median(w->distance, w->count), plm_order_median(w->scratch, w->count)};
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < plm_curve_basis_count(curve); a++) curve->offset[c][a] = middle[c];
    double skew2 = curve->degree == 3 ? skew * skew : 0;
    for (int round = 0; round < ROUNDS; round++) {
        weigh(curve, distances(curve, w), w);
        if (!solve(w, curve, scatter_of(w), skew2, round == ROUNDS - 1 ? out->covariance : NULL)) return false;
        if (skew2 > 0)
            skew2 = (SKEW_FREEDOM * skew * skew + 2 * squared_skew(curve)) / (SKEW_FREEDOM + 2 * curve->spans);
    }
    out->distance = distances(curve, w);
    out->scatter = scatter_of(w);
    for (size_t i = 0; i < w->count; i++) out->inlier_count += w->distance[i] <= inlying * out->distance;
    return true;
}

plm_status plm_centre_line_fit(const double (*xyz)[3], size_t count, const double begin[3], const double end[3],
                               plm_line_shape shape, plm_centre_line *line, plm_error *error)
{
    plm_centre_line out = {0};
    if (!plm_curve_line(begin, end, shape.degree, shape.spans, &out.curve))
        return plm_fail(error, PLM_E_DEGENERATE, "the ends of the centre line coincide");
    const int coefficients = plm_curve_basis_count(&out.curve);
    if (count <= (size_t)coefficients)
        return plm_fail(error, PLM_E_DEGENERATE, "%zu points are too few for a centre line; %d are needed", count,
                        coefficients + 1);
    work w = {.xyz = xyz, .count = count, .bin_count = BINS_PER_COEFFICIENT * coefficients};
    const size_t rings = count / POINTS_PER_RING;
    w.ring_count = rings < 1 ? 1 : rings > MOST_RINGS ? MOST_RINGS : (int)rings;
    const int cells = w.ring_count * SECTORS > w.bin_count ? w.ring_count * SECTORS : w.bin_count;
    plm_status status = PLM_E_MEMORY;
    double *block = plm_alloc(4 * count + (size_t)cells, sizeof *block, error);
    w.cell = plm_alloc(count, sizeof *w.cell, error);
    if (block && w.cell) {
        w.t = block, w.weight = block + count, w.distance = block + 2 * count, w.scratch = block + 3 * count;
        w.sum = block + 4 * count;
        status = fit(&w, shape.skew, &out)
                     ? PLM_OK
                     : plm_fail(error, PLM_E_DEGENERATE, "the %zu points determine no centre line", count);
    }
    plm_free(block);
    plm_free(w.cell);
    if (status == PLM_OK) *line = out;
    return status;
}

double plm_centre_line_direction_error(const plm_centre_line *line, double a, double b)
{
    const int n = plm_curve_basis_count(&line->curve);
    double row[PLM_CURVE_BASIS], variance = 0, from[3], to[3];
    plm_curve_difference(&line->curve, a, b, row);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) variance += row[i] * line->covariance[i][j] * row[j];
    plm_curve_point(&line->curve, a, from);
    plm_curve_point(&line->curve, b, to);
    for (int i = 0; i < 3; i++) to[i] -= from[i];
    return line->scatter * sqrt(fmax(variance, 0)) / plm_norm(to);
}
