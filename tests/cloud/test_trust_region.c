/* The scaled trust region: hard problems with known minima, units that differ by 1e12, and what it says of how it ended. */
#include "support/test.h"

#include "cloud/trust_region.h"

enum { MOST = 4 };

/* Residuals of a classic problem at x, and their derivatives; x is brought from the problem's units by unit. */
typedef struct classic {
    int size, residuals;
    double unit[MOST];
    void (*at)(const double *x, double *residual, double jacobian[][MOST]);
    int moves;
} classic;

static void residuals_at(const classic *c, const double *x, double *residual, double jacobian[][MOST])
{
    double own[MOST] = {0};
    for (int a = 0; a < c->size; a++) own[a] = x[a] / c->unit[a];
    memset(jacobian, 0, MOST * sizeof *jacobian);
    c->at(own, residual, jacobian);
    for (int i = 0; i < c->residuals; i++)
        for (int a = 0; a < c->size; a++) jacobian[i][a] /= c->unit[a];
}

static double move(void *context, const double *x)
{
    classic *c = context;
    double residual[MOST], jacobian[MOST][MOST], sum = 0;
    c->moves++;
    residuals_at(c, x, residual, jacobian);
    for (int i = 0; i < c->residuals; i++) sum += 0.5 * residual[i] * residual[i];
    return sum;
}

static void normal(void *context, const double *x, double *matrix, double *gradient)
{
    const classic *c = context;
    const int n = c->size;
    double residual[MOST], jacobian[MOST][MOST];
    residuals_at(c, x, residual, jacobian);
    for (int a = 0; a < n; a++) {
        gradient[a] = 0;
        for (int i = 0; i < c->residuals; i++) gradient[a] += jacobian[i][a] * residual[i];
        for (int b = 0; b < n; b++) {
            matrix[a * n + b] = 0;
            for (int i = 0; i < c->residuals; i++) matrix[a * n + b] += jacobian[i][a] * jacobian[i][b];
        }
    }
}

static plm_fit_report minimise(classic *c, double *x, int steps)
{
    double work[2 * MOST * MOST];
    const plm_least_squares problem = {
        .size = c->size, .context = c, .move = move, .normal = normal, .typical = c->unit};
    plm_fit_report report;
    plm_trust_region(&problem, x, 1e-10, steps, work, &report);
    return report;
}

/* H. Rosenbrock's valley (1960): minimum 0 at (1, 1). */
static void valley(const double *x, double *residual, double jacobian[][MOST])
{
    residual[0] = 10 * (x[1] - x[0] * x[0]);
    residual[1] = 1 - x[0];
    jacobian[0][0] = -20 * x[0], jacobian[0][1] = 10;
    jacobian[1][0] = -1;
}

/* M. Powell's singular problem (1962): minimum 0 at 0, where the Jacobian has rank 2. */
static void singular(const double *x, double *residual, double jacobian[][MOST])
{
    const double u = x[1] - 2 * x[2], v = x[0] - x[3];
    residual[0] = x[0] + 10 * x[1];
    residual[1] = sqrt(5) * (x[2] - x[3]);
    residual[2] = u * u;
    residual[3] = sqrt(10) * v * v;
    jacobian[0][0] = 1, jacobian[0][1] = 10;
    jacobian[1][2] = sqrt(5), jacobian[1][3] = -sqrt(5);
    jacobian[2][1] = 2 * u, jacobian[2][2] = -4 * u;
    jacobian[3][0] = 2 * sqrt(10) * v, jacobian[3][3] = -2 * sqrt(10) * v;
}

/* Residuals that never vanish: minimum at x = 0, cost 1/2 (1 + 1). */
static void never_zero(const double *x, double *residual, double jacobian[][MOST])
{
    residual[0] = x[0] + 1;
    residual[1] = 0.5 * x[0] * x[0] + x[0] - 1;
    jacobian[0][0] = 1;
    jacobian[1][0] = x[0] + 1;
}

/* Derivatives that point the wrong way: nothing lowers the cost. */
static void liar(const double *x, double *residual, double jacobian[][MOST])
{
    residual[0] = 1 + x[0];
    jacobian[0][0] = -1;
}

static void a_curved_valley_is_followed_in_any_units(void **unused)
{
    (void)unused;
    static const double units[][2] = {{1, 1}, {1e-6, 1e6}, {1e6, 1e-6}, {1e-9, 1e-9}};
    int first_moves = 0;
    for (size_t i = 0; i < COUNT(units); i++) {
        classic c = {.size = 2, .residuals = 2, .unit = {units[i][0], units[i][1]}, .at = valley};
        double x[MOST] = {-1.2 * c.unit[0], 1 * c.unit[1]};
        const plm_fit_report report = minimise(&c, x, 100);
        assert_int_equal(report.end, PLM_FIT_SMALL_STEP);
        assert_near(x[0] / c.unit[0], 1, 1e-9);
        assert_near(x[1] / c.unit[1], 1, 1e-9);
        if (i == 0) first_moves = c.moves;
        assert_true(abs(c.moves - first_moves) <= 2); /* units change nothing but roundings */
    }
    assert_true(first_moves < 40);
}

static void a_singular_minimum_is_reached(void **unused)
{
    (void)unused;
    classic c = {.size = 4, .residuals = 4, .unit = {1, 1, 1, 1}, .at = singular};
    double x[MOST] = {3, -1, 0, 1};
    const plm_fit_report report = minimise(&c, x, 100);
    assert_true(report.end != PLM_FIT_STEPS_SPENT);
    assert_true(report.cost < 1e-20);
    for (int a = 0; a < 4; a++) assert_near(x[a], 0, 1e-5);
}

static void ends_say_what_happened(void **unused)
{
    (void)unused;
    classic c = {.size = 2, .residuals = 2, .unit = {1, 1}, .at = valley};
    double x[MOST] = {-1.2, 1};
    plm_fit_report report = minimise(&c, x, 3);
    assert_int_equal(report.end, PLM_FIT_STEPS_SPENT);
    assert_int_equal(report.iteration_count, 3);

    c = (classic){.size = 1, .residuals = 2, .unit = {1}, .at = never_zero};
    x[0] = 0.7;
    report = minimise(&c, x, 100);
    assert_true(report.end == PLM_FIT_SMALL_STEP || report.end == PLM_FIT_SMALL_GAIN);
    assert_near(x[0], 0, 1e-5);
    assert_near(report.cost, 1, 1e-12);

    c = (classic){.size = 1, .residuals = 1, .unit = {1}, .at = liar};
    x[0] = 0;
    report = minimise(&c, x, 100);
    assert_int_equal(report.end, PLM_FIT_NO_DESCENT);
    assert_near(x[0], 0, 0);

    x[0] = -1; /* the minimum itself: the gradient is nothing */
    report = minimise(&c, x, 100);
    assert_int_equal(report.end, PLM_FIT_SMALL_STEP);
    for (plm_fit_end end = PLM_FIT_STEPS_SPENT; end <= PLM_FIT_NO_DESCENT; end++)
        assert_true(strlen(plm_fit_end_name(end)) > 0);
}

static void the_condition_does_not_depend_on_units(void **unused)
{
    (void)unused;
    /* Unit diagonal and 0.6 beside it: 1-norms 1.6 and 1 / 0.4. */
    for (int power = -12; power <= 12; power += 6) {
        const double u = pow(10, power), matrix[4] = {u * u, 0.6 * u, 0.6 * u, 1};
        double inverse[4], work[4];
        assert_near(plm_normal_condition(2, matrix, inverse, work), 4, 1e-12);
        assert_near(inverse[0] * u * u, 1 / 0.64, 1e-12);
        assert_near(inverse[1] * u, -0.6 / 0.64, 1e-12);
        assert_near(inverse[3], 1 / 0.64, 1e-12);
    }
    const double flat[4] = {1, 1, 1, 1}, none[4] = {1, 0, 0, 0};
    double inverse[4], work[4];
    assert_true(isinf(plm_normal_condition(2, flat, inverse, work)));
    assert_true(isinf(plm_normal_condition(2, none, inverse, work)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_curved_valley_is_followed_in_any_units),
        cmocka_unit_test(a_singular_minimum_is_reached),
        cmocka_unit_test(ends_say_what_happened),
        cmocka_unit_test(the_condition_does_not_depend_on_units),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
