/* Curves over a chord: basis, derivatives, lengths, feet. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/axis_curve.h"

static plm_curve bent(int degree, int spans, uint64_t *state)
{
    const double begin[3] = {0.1, -0.2, 0.3}, end[3] = {0.4, 0.5, 1.1};
    plm_curve curve;
    assert_true(plm_curve_line(begin, end, degree, spans, &curve));
    for (int c = 0; c < 2; c++)
        for (int k = 0; k < plm_curve_basis_count(&curve); k++) curve.offset[c][k] = 0.1 * test_normal(state);
    return curve;
}

/* The definition: the recursion of Cox and de Boor on the clamped knots. */
static double knot(int degree, int spans, int i)
{
    return i <= degree ? -1 : i >= degree + spans ? 1 : -1 + 2.0 * (i - degree) / spans;
}

static double recursion(int degree, int top, int spans, int i, double t)
{
    const double low = knot(top, spans, i), next = knot(top, spans, i + 1);
    if (degree == 0) return low <= t && t < next;
    const double high = knot(top, spans, i + degree + 1), left = knot(top, spans, i + degree) - low,
                 right = high - next;
    double sum = 0;
    if (left > 0) sum += (t - low) / left * recursion(degree - 1, top, spans, i, t);
    if (right > 0) sum += (high - t) / right * recursion(degree - 1, top, spans, i + 1, t);
    return sum;
}

static void basis_functions_are_those_of_the_recursion(void **unused)
{
    (void)unused;
    uint64_t state = 6;
    for (int degree = 1; degree <= 3; degree++)
        for (int spans = 1; spans <= PLM_CURVE_SPANS; spans++) {
            const plm_curve curve = bent(degree, spans, &state);
            for (int trial = 0; trial < 60; trial++) {
                const double t = -1 + 2 * test_uniform(&state);
                double value[4], first[4], second[4];
                const int begin = plm_curve_basis(&curve, t, value, first, second);
                for (int i = 0; i < degree + spans; i++)
                    assert_near(i >= begin && i <= begin + degree ? value[i - begin] : 0,
                                recursion(degree, degree, spans, i, t), 1e-14);
            }
        }
}

static void basis_functions_sum_to_one_and_derivatives_are_differences(void **unused)
{
    (void)unused;
    uint64_t state = 4;
    for (int degree = 1; degree <= 3; degree++)
        for (int spans = 1; spans <= 7; spans++) {
            const plm_curve curve = bent(degree, spans, &state);
            for (int trial = 0; trial < 40; trial++) {
                const double t = -1.2 + 2.4 * test_uniform(&state), h = 1e-6;
                double value[4], first[4], second[4], sum = 0, slopes = 0;
                plm_curve_basis(&curve, t, value, first, second);
                for (int k = 0; k <= degree; k++) sum += value[k], slopes += first[k];
                assert_near(sum, 1, 1e-12);
                assert_near(slopes, 0, 1e-11);
                double at[3], d1[3], d2[3], before[3], after[3], slope_before[3], slope_after[3], none[3];
                plm_curve_derivatives(&curve, t, at, d1, d2);
                plm_curve_derivatives(&curve, t - h, before, slope_before, none);
                plm_curve_derivatives(&curve, t + h, after, slope_after, none);
                const double inner = 0.5 * (t + 1) * spans;
                if (fabs(inner - round(inner)) < 1e-4) continue; /* a knot: the second derivative jumps */
                for (int k = 0; k < 3; k++) {
                    assert_near((after[k] - before[k]) / (2 * h), d1[k], 1e-7); /* rounding of the difference */
                    assert_near((slope_after[k] - slope_before[k]) / (2 * h), d2[k], 1e-6);
                }
            }
        }
}

static void the_length_of_a_parabola_is_its_closed_form_and_walking_inverts_it(void **unused)
{
    (void)unused;
    const double begin[3] = {0, 0, 0}, end[3] = {2, 0, 0};
    plm_curve curve;
    assert_true(plm_curve_line(begin, end, 2, 1, &curve));
    const double sagitta = 0.3; /* u = sagitta (1 - t^2): Bernstein coefficients 0, 2 sagitta, 0 */
    curve.offset[0][1] = 2 * sagitta;
    const double a = 2 * sagitta, exact = sqrt(1 + a * a) + asinh(a) / a;
    assert_near(plm_curve_length(&curve, -1, 1), exact, 1e-6);
    assert_near(plm_curve_length(&curve, 1, -1), -exact, 1e-6);
    assert_near(plm_curve_walk(&curve, -1, exact), 1, 1e-6);
    assert_near(plm_curve_walk(&curve, 0.2, plm_curve_length(&curve, 0.2, -0.7)), -0.7, 1e-9);
}

static void the_foot_is_the_nearest_point(void **unused)
{
    (void)unused;
    uint64_t state = 9;
    for (int trial = 0; trial < 200; trial++) {
        const plm_curve curve = bent(3, 1 + trial % 4, &state);
        double at[3], first[3], second[3], point[3], gap[3];
        const double t = -1 + 2 * test_uniform(&state);
        plm_curve_derivatives(&curve, t, at, first, second);
        double across[3] = {test_normal(&state), test_normal(&state), test_normal(&state)};
        const double along = plm_dot(across, first) / plm_dot(first, first);
        for (int k = 0; k < 3; k++) point[k] = at[k] + 0.01 * (across[k] - along * first[k]);
        const double foot = plm_curve_foot(&curve, point);
        plm_curve_derivatives(&curve, foot, at, first, second);
        for (int k = 0; k < 3; k++) gap[k] = point[k] - at[k];
        assert_near(plm_dot(gap, first), 0, 1e-12);
        assert_near(foot, t, 1e-9);
    }
}

static void coincident_ends_make_no_curve(void **unused)
{
    (void)unused;
    const double point[3] = {1, 2, 3};
    plm_curve curve;
    assert_false(plm_curve_line(point, point, 3, 1, &curve));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(basis_functions_are_those_of_the_recursion),
        cmocka_unit_test(basis_functions_sum_to_one_and_derivatives_are_differences),
        cmocka_unit_test(the_length_of_a_parabola_is_its_closed_form_and_walking_inverts_it),
        cmocka_unit_test(the_foot_is_the_nearest_point),
        cmocka_unit_test(coincident_ends_make_no_curve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
