/* traits/tube_fit.c: the robust tube fit. Distances to a curved axis and their derivatives follow from the foot point:
 * as the gap between point and foot is at right angles to the curve, moving the foot changes the distance in second
 * order only, so d(distance)/d(coefficient) = -normal . d(axis)/d(coefficient) at the foot; the radius, where it changes
 * along t, adds the movement of the foot. */
#include "traits/tube_fit.h"

#include "cloud/linear.h"
#include "cloud/order.h"

#include <string.h>

enum { ROUNDS = 5, FIRST_TRIMMED = 2, STEPS = 40 };

static const double loss_scale = 1.5; /* f over the robust SD: soft-L1 then is 95 % efficient in normal noise */
static const double inlying = 3.0;    /* robust SDs within which a point is of the tube */
/* Robust SDs beyond which points are left out of the last rounds: soft-L1 alone lets one-sided outliers (the stub of a
 * petiole, ghosts behind an edge) pull for ever. */
static const double trimmed = 4.0;
static const double misfit = 0.15; /* share of the radius that a real stem may be off its tube: never left out */
static const double settled = 1e-4,
                    converged = 1e-9; /* last step over the radius: between rescalings, and at the end */
static const double flare_start = 0.3, flare_radii = 3; /* of a petiole's foot: share of the radius, length in radii */
/* Logarithms of a flare's length: where there is none, nothing else holds it. */
static const double shortest_flare = -7, longest_flare = 0;
static const double smallest_scale = 1e-7; /* f over the radius: below it residuals are rounding of float coordinates */

typedef struct problem {
    const double (*xyz)[3];
    size_t count;
    plm_curve axis; /* frame and form; offsets are those of the last evaluation */
    int basis;      /* coefficients of u, and of v */
    plm_tube_form form;
    int size;     /* parameters */
    double *foot; /* t of each point */
    double *
        known; /* the feet from which those of a trial are found: of the last accepted axis, so that a trial's cost does
                       not depend on the trials before it where a point has two feet */
    double *residual, *scratch;
    double limit; /* residuals beyond count as a constant cost: the point is left out */
} problem;

typedef struct fit {
    double x[PLM_TUBE_PARAMETERS];
    double scale;
    int steps;
    plm_fit_end end;
} fit;

static void set_axis(problem *p, const double x[])
{
    for (int c = 0; c < 2; c++) memcpy(p->axis.offset[c], x + c * p->basis, (size_t)p->basis * sizeof *x);
}

/* Foot of a point on the axis, from a near guess. */
static double refine_foot(const plm_curve *axis, const double point[3], double t, double at[3], double first[3],
                          double second[3], double gap[3])
{
    for (int step = 0;; step++) {
        plm_curve_derivatives(axis, t, at, first, second);
        for (int i = 0; i < 3; i++) gap[i] = point[i] - at[i];
        const double speed = plm_dot(first, first), newton = speed - plm_dot(gap, second);
        const double change = plm_dot(gap, first) / (newton > 0.2 * speed ? newton : speed);
        if (step == 8 || fabs(change) < 1e-10) return t;
        t += fmin(fmax(change, -0.5), 0.5);
    }
}

/* Of the radius with the parameters r[] at t: the value, its change by t, and by each of the parameters. */
static double radius_at(plm_tube_form form, const double r[], double t, double *slope, double change[4])
{
    change[0] = 1;
    *slope = 0;
    if (form == PLM_TUBE_EVEN) return r[0];
    change[1] = t;
    *slope = r[1];
    if (form == PLM_TUBE_TAPERED) return r[0] + r[1] * t;
    const double length = exp(r[3]), along = (t + 1) / length;
    change[2] = exp(-fmax(along, -1)); /* it stays as it is from one length before the axis' begin */
    change[3] = along > -1 ? r[2] * change[2] * along : 0;
    if (along > -1) *slope -= r[2] * change[2] / length;
    return r[0] + r[1] * t + r[2] * change[2];
}

/* Residuals and feet at x. */
static void evaluate(problem *p, const double x[])
{
    set_axis(p, x);
    for (size_t i = 0; i < p->count; i++) {
        double at[3], first[3], second[3], gap[3];
        p->foot[i] = refine_foot(&p->axis, p->xyz[i], p->known[i], at, first, second, gap);
        double slope, change[4];
        p->residual[i] = plm_norm(gap) - radius_at(p->form, x + 2 * p->basis, p->foot[i], &slope, change);
    }
}

/* Derivatives of point i's residual by the parameters, at the axis and feet of the last evaluation. Gives how many
 * there are; column[] are their numbers. */
static int derivatives(const problem *p, const double x[], size_t i, int column[], double value[])
{
    const double t = p->foot[i];
    double n0[4], n1[4], at[3], first[3], second[3], gap[3];
    plm_curve_derivatives(&p->axis, t, at, first, second);
    const int begin = plm_curve_basis(&p->axis, t, n0, n1, NULL);
    for (int k = 0; k < 3; k++) gap[k] = p->xyz[i][k] - at[k];
    const double speed = plm_dot(first, first), newton = speed - plm_dot(gap, second);
    const double bend = newton > 0.2 * speed ? newton : speed;
    double slope, change[4];
    radius_at(p->form, x + 2 * p->basis, t, &slope, change);
    const double distance = plm_norm(gap);
    int used = 0;
    for (int c = 0; c < 2; c++) {
        const double toward = plm_dot(gap, p->axis.across[c]);
        const double along = plm_dot(first, p->axis.across[c]);
        for (int k = 0; k <= p->axis.degree; k++) {
            const double moved = (toward * n1[k] - along * n0[k]) / bend; /* d(foot) / d(coefficient) */
            column[used] = c * p->basis + begin + k;
            value[used++] = -(distance > 0 ? toward / distance : 0) * n0[k] - slope * moved;
        }
    }
    for (int k = 0; k < p->size - 2 * p->basis; k++) {
        column[used] = 2 * p->basis + k;
        value[used++] = -change[k];
    }
    return used;
}

/* Normal matrix and gradient of the residuals within limit, by the loss' first and second derivative at the scale: weights
 * q and q^3 with q = 1 / sqrt(1 + (residual / scale)^2); or 1 for scale 0. */
static void accumulate(const problem *p, const double x[], double scale, double limit, double *matrix, double *gradient)
{
    const int n = p->size;
    memset(matrix, 0, (size_t)(n * n) * sizeof *matrix);
    memset(gradient, 0, (size_t)n * sizeof *gradient);
    for (size_t i = 0; i < p->count; i++) {
        const double r = p->residual[i];
        if (!(fabs(r) <= limit)) continue;
        const double weight = scale > 0 ? 1 / sqrt(1 + (r / scale) * (r / scale)) : 1, bend = weight * weight * weight;
        int column[2 * 4 + 4];
        double value[2 * 4 + 4];
        const int used = derivatives(p, x, i, column, value);
        for (int a = 0; a < used; a++) {
            gradient[column[a]] += weight * value[a] * r;
            for (int b = 0; b <= a; b++) matrix[column[a] * n + column[b]] += bend * value[a] * value[b];
        }
    }
    for (int a = 0; a < n; a++)
        for (int b = 0; b < a; b++) matrix[b * n + a] = matrix[a * n + b];
}

static double cost_of(const problem *p, double scale)
{
    double sum = 0;
    for (size_t i = 0; i < p->count; i++) {
        const double z = fmin(fabs(p->residual[i]), p->limit) / scale;
        sum += z * z / (sqrt(1 + z * z) + 1); /* sqrt(1 + z^2) - 1 without cancellation */
    }
    return sum * scale * scale;
}

/* What the descent moves: the cost at the scale of the round. */
typedef struct descent {
    problem *p;
    double scale;
} descent;

static double move_to(void *context, const double *x)
{
    const descent *d = context;
    const double log_length = x[d->p->size - 1];
    if (d->p->form == PLM_TUBE_FLARED && !(log_length > shortest_flare && log_length < longest_flare)) return INFINITY;
    evaluate(d->p, x);
    return cost_of(d->p, d->scale);
}

static void normal_at(void *context, const double *x, double *matrix, double *gradient)
{
    const descent *d = context;
    memcpy(d->p->known, d->p->foot, d->p->count * sizeof *d->p->foot);
    accumulate(d->p, x, d->scale, d->p->limit, matrix, gradient);
}

/* Descent at a fixed scale. Feet and residuals are those of f->x before and after. */
static void descend(problem *p, fit *f, double tolerance, double *work)
{
    double typical[PLM_TUBE_PARAMETERS];
    for (int a = 0; a < p->size; a++) typical[a] = fabs(f->x[2 * p->basis]) + 1e-15;
    if (p->form == PLM_TUBE_FLARED) typical[p->size - 1] = 1; /* a logarithm */
    descent context = {p, f->scale};
    const plm_least_squares squares = {
        .size = p->size, .context = &context, .move = move_to, .normal = normal_at, .typical = typical};
    plm_fit_report report;
    plm_trust_region(&squares, f->x, tolerance, STEPS, work, &report);
    f->steps += report.iteration_count;
    f->end = report.end;
}

static double robust_sd(const problem *p)
{
    memcpy(p->scratch, p->residual, p->count * sizeof *p->residual);
    return plm_order_robust_sd(p->scratch, p->count, 0);
}

/* Residuals at x, the feet found anew from the projections onto the chord. */
static void evaluate_afresh(problem *p, const double x[])
{
    for (size_t i = 0; i < p->count; i++) {
        double from_middle[3];
        for (int k = 0; k < 3; k++) from_middle[k] = p->xyz[i][k] - p->axis.origin[k];
        p->known[i] = plm_dot(from_middle, p->axis.along) / p->axis.half;
    }
    evaluate(p, x);
}

/* Rounds of descent from the start in f->x. */
static void solve(problem *p, fit *f, double *work)
{
    evaluate_afresh(p, f->x);
    for (int round = 0; round < ROUNDS; round++) {
        const double sd = fmax(robust_sd(p), smallest_scale * fabs(f->x[2 * p->basis]) + 1e-30);
        f->scale = loss_scale * sd;
        const double limit = fmax(trimmed * sd, misfit * fabs(f->x[2 * p->basis]));
        p->limit = round < FIRST_TRIMMED ? INFINITY : limit;
        descend(p, f, round < ROUNDS - 1 ? settled : converged, work);
    }
}

/* Start at the given axis: radius is the median distance from it; a flare starts as those of seedlings' petioles are. */
static void start_at_axis(problem *p, const plm_curve *start, fit *f)
{
    memset(f, 0, sizeof *f);
    for (int c = 0; c < 2; c++) memcpy(f->x + c * p->basis, start->offset[c], (size_t)p->basis * sizeof *f->x);
    for (size_t i = 0; i < p->count; i++) {
        double at[3], gap[3];
        plm_curve_point(start, plm_curve_foot(start, p->xyz[i]), at);
        for (int k = 0; k < 3; k++) gap[k] = p->xyz[i][k] - at[k];
        p->scratch[i] = plm_norm(gap);
    }
    const double radius = plm_order_median(p->scratch, p->count);
    double *r = f->x + 2 * p->basis;
    r[0] = radius;
    if (p->form != PLM_TUBE_FLARED) return;
    r[2] = flare_start * radius;
    r[3] = log(fmin(fmax(flare_radii * radius / p->axis.half, 2e-3), 0.9));
}

/* Start at the algebraic circle (I. Kasa, 1976) of the points in the planes across the given axis: right where less than
 * half of the circumference is seen and the given axis lies on the seen side. Points beyond 2.5 median distances are left
 * out. false where no circle is determined. */
static bool start_at_circle(const problem *p, const plm_curve *start, const fit *at_axis, fit *f)
{
    const double limit = 2.5 * at_axis->x[2 * p->basis];
    double matrix[9] = {0}, right[3] = {0};
    if (!(limit > 0)) return false; /* all on the axis */
    for (size_t i = 0; i < p->count; i++) {
        double at[3], gap[3];
        plm_curve_point(start, plm_curve_foot(start, p->xyz[i]), at);
        for (int k = 0; k < 3; k++) gap[k] = p->xyz[i][k] - at[k];
        const double x = plm_dot(gap, start->across[0]) / limit, y = plm_dot(gap, start->across[1]) / limit;
        const double square = x * x + y * y;
        if (!(square <= 1)) continue;
        const double row[3] = {x, y, 1};
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < 3; b++) matrix[a * 3 + b] += row[a] * row[b];
            right[a] += row[a] * square;
        }
    }
    if (!plm_solve_spd(3, matrix, right)) return false;
    const double square = right[2] + 0.25 * (right[0] * right[0] + right[1] * right[1]);
    if (!(square > 0)) return false;
    *f = *at_axis;
    for (int k = 0; k < p->basis; k++) {
        f->x[k] += 0.5 * right[0] * limit;
        f->x[p->basis + k] += 0.5 * right[1] * limit;
    }
    f->x[2 * p->basis] = sqrt(square) * limit;
    return true;
}

/* Share of the directions around the axis in which inlying points lie. */
static double coverage_of(const problem *p, double limit)
{
    bool seen[PLM_TUBE_SECTORS] = {false};
    int filled = 0;
    for (size_t i = 0; i < p->count; i++) {
        if (!(fabs(p->residual[i]) <= limit)) continue;
        double at[3], gap[3];
        plm_curve_point(&p->axis, p->foot[i], at);
        for (int k = 0; k < 3; k++) gap[k] = p->xyz[i][k] - at[k];
        const double angle = atan2(plm_dot(gap, p->axis.across[1]), plm_dot(gap, p->axis.across[0]));
        int sector = (int)floor((angle / (2 * PLM_PI) + 0.5) * PLM_TUBE_SECTORS);
        if (sector >= PLM_TUBE_SECTORS) sector = PLM_TUBE_SECTORS - 1;
        if (!seen[sector]) filled++;
        seen[sector] = true;
    }
    return (double)filled / PLM_TUBE_SECTORS;
}

/* Writes the result of the better fit, whose residuals and feet are in p. false where its matrix is singular. */
static bool conclude(problem *p, const fit *best, double *matrix, double *inverse, double *work, plm_tube *tube)
{
    const int n = p->size;
    plm_tube out = {.axis = p->axis,
                    .iteration_count = best->steps,
                    .converged = best->end == PLM_FIT_SMALL_STEP || best->end == PLM_FIT_SMALL_GAIN,
                    .end = best->end,
                    .form = p->form,
                    .flare_length = 1,
                    .parameter_count = n};
    const double *r = best->x + 2 * p->basis;
    out.radius[0] = r[0];
    if (p->form != PLM_TUBE_EVEN) out.radius[1] = r[1];
    if (p->form == PLM_TUBE_FLARED) out.flare = r[2], out.flare_length = exp(r[3]);
    out.robust_sd = robust_sd(p);
    const double limit = inlying * fmax(out.robust_sd, smallest_scale * fabs(out.radius[0]));
    double squares = 0, gradient[PLM_TUBE_PARAMETERS];
    for (size_t i = 0; i < p->count; i++)
        if (fabs(p->residual[i]) <= limit) {
            squares += p->residual[i] * p->residual[i];
            out.inlier_count++;
        }
    if (out.inlier_count <= (size_t)n) return false;
    out.spread = sqrt(squares / (double)(out.inlier_count - (size_t)n));
    out.coverage = coverage_of(p, limit);
    accumulate(p, best->x, 0, limit, matrix, gradient);
    out.condition = plm_normal_condition(n, matrix, inverse, work);
    if (!isfinite(out.condition)) return false;
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) out.covariance[a][b] = inverse[a * n + b] * out.spread * out.spread;
    if (!(out.radius[0] > 0) || !isfinite(out.radius[0] + out.radius[1])) return false;
    *tube = out;
    return true;
}

plm_status plm_tube_fit(const double (*xyz)[3], size_t count, const plm_curve *start, plm_tube_form form,
                        plm_tube *tube, plm_error *error)
{
    const int basis = plm_curve_basis_count(start), size = 2 * basis + (form == PLM_TUBE_FLARED ? 4 : 1 + (int)form);
    if (count < 2 * (size_t)size)
        return plm_fail(error, PLM_E_DEGENERATE, "%zu points are too few for a tube of %d parameters; %d are needed",
                        count, size, 2 * size);
    problem p = {.xyz = xyz, .count = count, .axis = *start, .basis = basis, .form = form, .size = size};
    double *vectors = plm_alloc(4 * count, sizeof *vectors, error);
    double *matrix = plm_alloc(3 * (size_t)(size * size), sizeof *matrix, error);
    plm_status status = vectors && matrix ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        p.foot = vectors, p.known = vectors + count, p.residual = vectors + 2 * count, p.scratch = vectors + 3 * count;
        fit at_axis, at_circle;
        start_at_axis(&p, start, &at_axis);
        const bool two = start_at_circle(&p, start, &at_axis, &at_circle);
        solve(&p, &at_axis, matrix);
        fit *best = &at_axis;
        if (two) {
            solve(&p, &at_circle, matrix);
            /* Costs at their own scales do not compare; the robust scales do. */
            if (at_circle.x[2 * basis] > 0 && at_circle.scale < at_axis.scale * (1 - 1e-6)) best = &at_circle;
        }
        evaluate_afresh(&p, best->x);
        if (!conclude(&p, best, matrix, matrix + size * size, matrix + 2 * size * size, tube))
            status = plm_fail(error, PLM_E_DEGENERATE, "the %zu points determine no tube", count);
    }
    plm_free(vectors);
    plm_free(matrix);
    return status;
}

plm_fit_note plm_tube_note(const plm_tube *tube)
{
    return (plm_fit_note){tube->iteration_count, tube->condition, plm_fit_end_name(tube->end)};
}

double plm_tube_radius(const plm_tube *tube, double t, double *std_error)
{
    const int at = 2 * plm_curve_basis_count(&tube->axis), own = tube->parameter_count - at;
    const double r[4] = {tube->radius[0], tube->radius[1], tube->flare, log(tube->flare_length)};
    double slope, change[4], variance = 0;
    const double radius = radius_at(tube->form, r, t, &slope, change);
    for (int a = 0; a < own; a++)
        for (int b = 0; b < own; b++) variance += change[a] * tube->covariance[at + a][at + b] * change[b];
    if (std_error) *std_error = sqrt(fmax(variance, 0));
    return radius;
}

double plm_tube_direction_error(const plm_tube *tube, double a, double b)
{
    const int n = plm_curve_basis_count(&tube->axis);
    double row[PLM_CURVE_BASIS], variance = 0, from[3], to[3];
    plm_curve_difference(&tube->axis, a, b, row);
    for (int c = 0; c < 2; c++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) variance += 0.5 * row[i] * tube->covariance[c * n + i][c * n + j] * row[j];
    plm_curve_point(&tube->axis, a, from);
    plm_curve_point(&tube->axis, b, to);
    for (int i = 0; i < 3; i++) to[i] -= from[i];
    return sqrt(fmax(variance, 0)) / plm_norm(to);
}
