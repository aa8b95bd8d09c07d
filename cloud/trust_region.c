/* cloud/trust_region.c: the scaled trust region, on the normal matrix: fits have at most 36 parameters, and the cost of
 * a step is that of walking the points once. With columns scaled to length 1 the matrix keeps the digits that squaring the
 * Jacobian would else lose to units. */
#include "cloud/trust_region.h"

#include "cloud/linear.h"

#include <stdbool.h>
#include <string.h>

enum { MULTIPLIER_STEPS = 12 };

static const double boundary = 0.1; /* a step is on the boundary when its length is within this share of the radius */
static const double worth_taking = 1e-4; /* gain over the promised gain from which a step is accepted */
static const double poor = 0.25, good = 0.75;
/* Share of the cost below which differences of costs are rounding. A step that gains so little moves n points' fit by some
 * 1e-6 sqrt(n) of its standard errors. */
static const double rounding = 1e-12;
static const double smallest_radius = 1e-18; /* over the first radius: below it nothing moves any more */

typedef struct region {
    int n;
    double *matrix, *factor; /* J'WJ with scaled columns, and room for its Cholesky factor */
    double gradient[PLM_FIT_MOST_PARAMETERS], scale[PLM_FIT_MOST_PARAMETERS];
    double step[PLM_FIT_MOST_PARAMETERS]; /* scaled */
    double radius, length;                /* of the region, and of the step */
    bool is_full;                         /* the step is undamped: the model's minimum */
} region;

const char *plm_fit_end_name(plm_fit_end end)
{
    static const char *const name[] = {"steps spent", "small step", "small gain", "no descent"};
    return name[end];
}

static double norm(int n, const double *v)
{
    double sum = 0;
    for (int a = 0; a < n; a++) sum += v[a] * v[a];
    return sqrt(sum);
}

/* Step of the damped system into r->step. false where it is not positive definite. */
static bool damped_step(region *r, double multiplier)
{
    const int n = r->n;
    memcpy(r->factor, r->matrix, (size_t)(n * n) * sizeof *r->factor);
    for (int a = 0; a < n; a++) {
        r->factor[a * n + a] += multiplier;
        r->step[a] = -r->gradient[a];
    }
    if (!plm_solve_spd(n, r->factor, r->step)) return false;
    r->length = norm(n, r->step);
    return isfinite(r->length);
}

/* |L^-1 step|^2 with the factor of the last damped step: how fast its length falls with the multiplier. */
static double fall(const region *r)
{
    double solved[PLM_FIT_MOST_PARAMETERS], sum = 0;
    for (int i = 0; i < r->n; i++) {
        solved[i] = r->step[i];
        for (int k = 0; k < i; k++) solved[i] -= r->factor[i * r->n + k] * solved[k];
        solved[i] /= r->factor[i * r->n + i];
        sum += solved[i] * solved[i];
    }
    return sum;
}

/* The step that the region allows. false for a gradient of zero or of no number. */
static bool find_step(region *r)
{
    const double slope = norm(r->n, r->gradient);
    if (!(slope > 0) || !isfinite(slope)) return false;
    r->is_full = damped_step(r, 0) && r->length <= (1 + boundary) * r->radius;
    if (r->is_full) return true;
    double low = 0, high = slope / r->radius, multiplier = 1e-3 * high;
    for (int k = 0; k < MULTIPLIER_STEPS; k++) {
        if (!damped_step(r, multiplier)) {
            low = multiplier;
            multiplier = fmax(sqrt(low * high), 0.1 * high);
            continue;
        }
        const double over = r->length - r->radius;
        if (fabs(over) <= boundary * r->radius) return true;
        if (over > 0)
            low = multiplier;
        else
            high = multiplier;
        multiplier += over / r->radius * r->length * r->length / fall(r);
        if (!(multiplier > low && multiplier < high)) multiplier = fmax(sqrt(low * high), 1e-3 * high);
    }
    if (!damped_step(r, high)) return false;
    return true;
}

/* Scales the normal matrix and gradient by the columns' norms, the largest so far. */
static void scale_model(region *r)
{
    const int n = r->n;
    for (int a = 0; a < n; a++) {
        const double column = sqrt(fmax(r->matrix[a * n + a], 0));
        r->scale[a] = fmax(r->scale[a], column);
    }
    for (int a = 0; a < n; a++) {
        const double own = r->scale[a] > 0 ? 1 / r->scale[a] : 1;
        r->gradient[a] *= own;
        for (int b = 0; b < n; b++) r->matrix[a * n + b] *= own * (r->scale[b] > 0 ? 1 / r->scale[b] : 1);
    }
}

/* What the model promises for the step: the fall of the cost. */
static double promised(const region *r)
{
    double sum = 0;
    for (int a = 0; a < r->n; a++) {
        double half = 0;
        for (int b = 0; b < r->n; b++) half += r->matrix[a * r->n + b] * r->step[b];
        sum -= r->step[a] * (r->gradient[a] + 0.5 * half);
    }
    return sum;
}

static double first_radius(const plm_least_squares *problem, const region *r)
{
    double sum = 0;
    for (int a = 0; a < r->n; a++) sum += pow(r->scale[a] * problem->typical[a], 2);
    return sqrt(sum);
}

void plm_trust_region(const plm_least_squares *problem, double *x, double tolerance, int most_steps, double *work,
                      plm_fit_report *report)
{
    const int n = problem->size;
    region r = {.n = n, .matrix = work, .factor = work + n * n};
    double tried[PLM_FIT_MOST_PARAMETERS];
    *report = (plm_fit_report){.cost = problem->move(problem->context, x), .end = PLM_FIT_STEPS_SPENT};
    bool moved = true, at_x = true, is_done = false;
    double start = 0;
    for (; report->iteration_count < most_steps && !is_done; report->iteration_count++) {
        if (moved) {
            problem->normal(problem->context, x, r.matrix, r.gradient);
            scale_model(&r);
            if (report->iteration_count == 0) r.radius = start = first_radius(problem, &r);
        }
        if (!find_step(&r)) {
            report->end = norm(n, r.gradient) <= 0 ? PLM_FIT_SMALL_STEP : PLM_FIT_NO_DESCENT;
            break;
        }
        bool is_small = true;
        for (int a = 0; a < n; a++) {
            const double step = r.scale[a] > 0 ? r.step[a] / r.scale[a] : 0;
            tried[a] = x[a] + step;
            is_small = is_small && fabs(step) <= tolerance * problem->typical[a];
        }
        const double gain = promised(&r), cost = problem->move(problem->context, tried);
        const double ratio = gain > 0 ? (report->cost - cost) / gain : -1;
        const bool is_rounding = r.is_full && gain <= rounding * report->cost;
        moved = at_x = ratio >= worth_taking || (is_rounding && cost <= report->cost);
        if (is_small && (moved || r.is_full)) {
            report->end = PLM_FIT_SMALL_STEP;
            is_done = true;
        } else if (is_rounding) {
            report->end = PLM_FIT_SMALL_GAIN;
            is_done = true;
        }
        if (moved) {
            memcpy(x, tried, (size_t)n * sizeof *x);
            report->cost = cost;
        }
        if (!(ratio >= poor))
            r.radius = poor * fmin(r.radius, r.length);
        else if (ratio > good)
            r.radius = fmax(r.radius, 2 * r.length);
        if (!is_done && r.radius < smallest_radius * start) {
            report->end = PLM_FIT_NO_DESCENT;
            break;
        }
    }
    if (!at_x) problem->move(problem->context, x);
}

double plm_normal_condition(int size, const double *matrix, double *inverse, double *work)
{
    double scale[PLM_FIT_MOST_PARAMETERS], right[PLM_FIT_MOST_PARAMETERS];
    for (int a = 0; a < size; a++) {
        if (!(matrix[a * size + a] > 0)) return INFINITY;
        scale[a] = 1 / sqrt(matrix[a * size + a]);
    }
    double forward = 0, back = 0;
    for (int column = 0; column < size; column++) {
        double sum = 0, solved = 0;
        for (int a = 0; a < size; a++)
            for (int b = 0; b < size; b++) work[a * size + b] = matrix[a * size + b] * scale[a] * scale[b];
        for (int a = 0; a < size; a++) {
            sum += fabs(work[a * size + column]);
            right[a] = a == column;
        }
        if (!plm_solve_spd(size, work, right)) return INFINITY;
        for (int a = 0; a < size; a++) {
            solved += fabs(right[a]);
            inverse[a * size + column] = right[a] * scale[a] * scale[column];
        }
        forward = fmax(forward, sum);
        back = fmax(back, solved);
    }
    return forward * back;
}
