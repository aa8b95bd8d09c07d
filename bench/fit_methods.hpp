/* bench/fit_methods.hpp: ways to solve the problems of fit_problems.hpp: the library's scaled trust region, the same of GSL,
 * and what it is compared with: Gauss-Newton, Levenberg-Marquardt, Adam. All but Adam end by the same rule, a step below
 * 1e-9 of what is typical of each parameter. */
#ifndef PLANTIMETER_FIT_METHODS_HPP
#define PLANTIMETER_FIT_METHODS_HPP

#include "fit_problems.hpp"

extern "C" {
#include "cloud/linear.h"
#include "cloud/trust_region.h"
}

#include <cstring>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

namespace fits
{

constexpr double TOLERANCE = 1e-9;
constexpr int MOST_STEPS = 200, ADAM_STEPS = 5000;

struct Result {
    Parameters x{};
    int steps = 0;
};

using Method = Result (*)(const Problem &, const Parameters &);

inline bool is_small(const Problem &problem, const double *step)
{
    for (int a = 0; a < problem.size; a++)
        if (!(std::fabs(step[a]) <= TOLERANCE * problem.typical[static_cast<size_t>(a)])) return false;
    return true;
}

inline Result trust_region(const Problem &problem, const Parameters &start)
{
    plm_least_squares squares{};
    squares.size = problem.size;
    squares.context = const_cast<Problem *>(&problem);
    squares.move = [](void *context, const double *x) { return static_cast<Problem *>(context)->cost(x); };
    squares.normal = [](void *context, const double *x, double *matrix, double *gradient) {
        static_cast<Problem *>(context)->model(x, matrix, gradient);
    };
    squares.typical = problem.typical.data();
    Result result{start, 0};
    double work[2 * MOST * MOST];
    plm_fit_report report;
    plm_trust_region(&squares, result.x.data(), TOLERANCE, MOST_STEPS, work, &report);
    result.steps = report.iteration_count;
    return result;
}

/** The whole step each time. */
inline Result gauss_newton(const Problem &problem, const Parameters &start)
{
    Result result{start, 0};
    double matrix[MOST * MOST], step[MOST];
    while (result.steps < MOST_STEPS) {
        problem.model(result.x.data(), matrix, step);
        result.steps++;
        if (!plm_solve_spd(problem.size, matrix, step)) break;
        for (int a = 0; a < problem.size; a++) result.x[static_cast<size_t>(a)] -= step[a];
        if (is_small(problem, step)) break;
    }
    return result;
}

/** D. Marquardt's (1963): the diagonal times 1 + lambda, lambda a tenth after a step that gained, else ten times. */
inline Result levenberg_marquardt(const Problem &problem, const Parameters &start)
{
    const int n = problem.size;
    Result result{start, 0};
    double matrix[MOST * MOST], damped[MOST * MOST], gradient[MOST], step[MOST], lambda = 1e-3;
    double cost = problem.cost(result.x.data());
    bool moved = true;
    for (; result.steps < MOST_STEPS; result.steps++) {
        if (moved) problem.model(result.x.data(), matrix, gradient);
        std::memcpy(damped, matrix, sizeof damped);
        for (int a = 0; a < n; a++) {
            damped[a * n + a] *= 1 + lambda;
            step[a] = -gradient[a];
        }
        Parameters tried = result.x;
        moved = plm_solve_spd(n, damped, step);
        if (moved) {
            for (int a = 0; a < n; a++) tried[static_cast<size_t>(a)] += step[a];
            const double there = problem.cost(tried.data());
            moved = there <= cost;
            if (moved) result.x = tried, cost = there;
            if (is_small(problem, step)) break;
        }
        lambda = moved ? std::fmax(lambda / 10, 1e-12) : lambda * 10;
        if (lambda > 1e16) break;
    }
    return result;
}

/** D. Kingma and J. Ba's Adam (2015), rates as published, on parameters scaled by what is typical: a hundredth of it a step. */
inline Result adam(const Problem &problem, const Parameters &start)
{
    constexpr double RATE = 0.01, MEAN = 0.9, SQUARE = 0.999;
    Result result{start, 0};
    double matrix[MOST * MOST], gradient[MOST], mean[MOST] = {}, square[MOST] = {};
    double mean_left = 1, square_left = 1, before = INFINITY;
    while (result.steps < ADAM_STEPS) {
        problem.model(result.x.data(), matrix, gradient);
        mean_left *= MEAN, square_left *= SQUARE;
        for (int a = 0; a < problem.size; a++) {
            const double typical = problem.typical[static_cast<size_t>(a)], g = gradient[a] * typical;
            mean[a] = MEAN * mean[a] + (1 - MEAN) * g;
            square[a] = SQUARE * square[a] + (1 - SQUARE) * g * g;
            const double root = std::sqrt(square[a] / (1 - square_left));
            if (root > 0) result.x[static_cast<size_t>(a)] -= RATE * typical * mean[a] / (1 - mean_left) / root;
        }
        if (++result.steps % 100) continue;
        const double cost = problem.cost(result.x.data());
        if (std::fabs(before - cost) <= 1e-10 * cost) break;
        before = cost;
    }
    return result;
}

/** GSL's trust region with More's scaling, on the whole Jacobian. */
inline Result gsl(const Problem &problem, const Parameters &start)
{
    const size_t n = static_cast<size_t>(problem.size);
    gsl_set_error_handler_off();
    gsl_multifit_nlinear_fdf functions{};
    functions.n = problem.count, functions.p = n, functions.params = const_cast<Problem *>(&problem);
    functions.f = [](const gsl_vector *x, void *context, gsl_vector *out) {
        const Problem &own = *static_cast<const Problem *>(context);
        for (size_t i = 0; i < own.count; i++) gsl_vector_set(out, i, own.residual(i, x->data, nullptr));
        return static_cast<int>(GSL_SUCCESS);
    };
    functions.df = [](const gsl_vector *x, void *context, gsl_matrix *out) {
        const Problem &own = *static_cast<const Problem *>(context);
        Row row{};
        for (size_t i = 0; i < own.count; i++) {
            own.residual(i, x->data, &row);
            for (size_t a = 0; a < static_cast<size_t>(own.size); a++) gsl_matrix_set(out, i, a, row[a]);
        }
        return static_cast<int>(GSL_SUCCESS);
    };
    gsl_multifit_nlinear_parameters options = gsl_multifit_nlinear_default_parameters();
    options.scale = gsl_multifit_nlinear_scale_more;
    options.solver = gsl_multifit_nlinear_solver_cholesky;
    gsl_multifit_nlinear_workspace *work =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &options, problem.count, n);
    Result result{start, 0};
    gsl_vector_view x = gsl_vector_view_array(result.x.data(), n);
    gsl_multifit_nlinear_init(&x.vector, &functions, work);
    while (result.steps < MOST_STEPS) {
        result.steps++;
        if (gsl_multifit_nlinear_iterate(work) != GSL_SUCCESS) break;
        if (is_small(problem, work->dx->data)) break;
    }
    gsl_vector_memcpy(&x.vector, work->x);
    gsl_multifit_nlinear_free(work);
    return result;
}

} // namespace fits

#endif
