/* Small linear algebra: eigenvectors stay orthonormal and exact where eigenvalues coincide or scales are extreme. */
#include "support/test.h"

#include "cloud/linear.h"

static void eigenvectors_rebuild_the_matrix_at_any_scale(void **unused)
{
    (void)unused;
    uint64_t state = 3;
    for (int trial = 0; trial < 200; trial++) {
        const double scale = pow(10, test_uniform(&state) * 40 - 20);
        double m[6];
        for (int i = 0; i < 6; i++) m[i] = (test_uniform(&state) - 0.5) * scale;
        if (trial % 4 == 0) m[0] = m[3] = m[5], m[1] = m[2] = m[4] = 0; /* three equal eigenvalues */
        if (trial % 4 == 1) m[1] = m[2] = m[4] = 1e-18 * scale;
        double value[3], vector[3][3];
        plm_eigen3(m, value, vector);
        const double full[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                double rebuilt = 0;
                for (int k = 0; k < 3; k++) rebuilt += value[k] * vector[k][i] * vector[k][j];
                assert_near(rebuilt, full[i][j], 1e-14 * scale); /* a few roundings of double */
                assert_near(plm_dot(vector[i], vector[j]), i == j, 1e-14);
            }
        assert_true(value[0] >= value[1] && value[1] >= value[2]);
    }
}

static void positive_definite_systems_are_solved_and_others_refused(void **unused)
{
    (void)unused;
    double matrix[4] = {4, 2, 2, 3}, right[2] = {10, 8};
    assert_int_equal(plm_solve_spd(2, matrix, right), 1);
    assert_near(right[0], 1.75, 1e-15);
    assert_near(right[1], 1.5, 1e-15);
    double singular[4] = {1, 1, 1, 1}, any[2] = {1, 1};
    assert_int_equal(plm_solve_spd(2, singular, any), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eigenvectors_rebuild_the_matrix_at_any_scale),
        cmocka_unit_test(positive_definite_systems_are_solved_and_others_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
