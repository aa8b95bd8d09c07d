/* selftest/stability_eigenvectors.c: symmetric matrices V diag(d) V' of integers, so that binary holds them exactly:
 * equal and nearly equal eigenvalues, graded ones, and units up to the ends of double. */
#include "cloud/linear.h"
#include "selftest/checks.h"

#include <float.h>

static const double turn[3][3] = {{1, 2, 2}, {2, 1, -2}, {2, -2, 1}}; /* columns: eigenvectors of length 3 */

/* Of A v = lambda v, the largest entry of the difference over the largest eigenvalue. */
static double residual(const double m[6], const double value[3], double vector[3][3])
{
    const double full[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
    double worst = 0;
    for (int i = 0; i < 3; i++)
        for (int row = 0; row < 3; row++)
            worst = fmax(worst, fabs(plm_dot(full[row], vector[i]) - value[i] * vector[i][row]) / value[0]);
    return worst;
}

static double skewness(double vector[3][3])
{
    double worst = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) worst = fmax(worst, fabs(plm_dot(vector[i], vector[j]) - (i == j)));
    return worst;
}

static void check_matrix(plm_checker *checker, const double d[3], int power)
{
    double m[6], value[3], vector[3][3];
    for (int i = 0, entry = 0; i < 3; i++)
        for (int j = i; j < 3; j++, entry++) {
            m[entry] = 0;
            for (int k = 0; k < 3; k++) m[entry] += turn[i][k] * d[k] * turn[j][k];
            m[entry] = ldexp(m[entry], power);
        }
    plm_eigen3(m, value, vector);
    static const char *const names[3] = {"largest eigenvalue", "middle eigenvalue", "smallest eigenvalue"};
    for (int i = 0; i < 3; i++)
        plm_check_value(checker, names[i], value[i], ldexp(9 * d[i], power),
                        (plm_bound){.error = 8 * DBL_EPSILON,
                                    .condition = d[0] / fmax(d[i], 1e-300),
                                    .scale = ldexp(9 * d[0], power),
                                    .note = "8 roundings of the largest eigenvalue"});
    plm_check_value(checker, "eigenvectors, residual", residual(m, value, vector), 0,
                    (plm_bound){.error = 8 * DBL_EPSILON, .condition = 1, .scale = 1});
    plm_check_value(checker, "eigenvectors, orthogonal", skewness(vector), 0,
                    (plm_bound){.error = 8 * DBL_EPSILON, .condition = 1, .scale = 1});
}

void plm_stability_eigenvectors(plm_checker *checker)
{
    static const struct {
        const char *name;
        double d[3];
        int power;
    } cases[] = {
        {"three equal eigenvalues", {5, 5, 5}, 0},
        {"two equal eigenvalues (a round leaf)", {7, 7, 1}, 0},
        {"two equal eigenvalues (a round stem)", {7, 2, 2}, 0},
        {"eigenvalues that differ in the 12th digit", {1099511627777, 1099511627776, 1}, 0},
        {"eigenvalues that differ in the 15th digit", {281474976710657, 281474976710656, 281474976710656}, 0},
        {"eigenvalues 1e12 : 1e6 : 1", {1e12, 1e6, 1}, 0},
        {"rank one", {3, 0, 0}, 0},
        {"eigenvalues 3 : 2 : 1, unit 2^-900", {3, 2, 1}, -900},
        {"eigenvalues 3 : 2 : 1, unit 2^900", {3, 2, 1}, 900},
        {"eigenvalues 3 : 2 : 1, unit 2^-1010", {3, 2, 1}, -1010},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        plm_check_scene(checker, "%s", cases[i].name);
        check_matrix(checker, cases[i].d, cases[i].power);
    }
}
