/* The course of a rachis among leaflets that were taken for petiole. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/petiole_course.h"

enum { RACHIS = 600, LEAFLET = 110, LEAFLETS = 4, POINTS = RACHIS + LEAFLETS * LEAFLET };

/* A gently bent rachis along x, 0.1 m long, and leaflets of 6 mm to both sides: the last lies farther from the base than the
 * rachis' end. */
static void make(double (*xyz)[3], size_t leaflets)
{
    static const double middle[LEAFLETS][2] = {{0.05, 0.02}, {0.055, -0.02}, {0.085, -0.022}, {0.1, 0.042}};
    uint64_t state = 4;
    for (size_t i = 0; i < RACHIS + leaflets * LEAFLET; i++) {
        if (i < RACHIS) {
            const double t = test_uniform(&state), turn = 2 * PLM_PI * test_uniform(&state);
            xyz[i][0] = 0.1 * t;
            xyz[i][1] = 0.001 * cos(turn);
            xyz[i][2] = 0.02 * t * (1 - t) + 0.001 * sin(turn);
            continue;
        }
        const double *at = middle[(i - RACHIS) / LEAFLET];
        xyz[i][0] = at[0] + 0.003 * test_normal(&state);
        xyz[i][1] = at[1] + 0.003 * test_normal(&state);
        xyz[i][2] = 0.001 * test_normal(&state);
    }
}

static void the_rachis_goes_on_past_its_leaflets(void **unused)
{
    (void)unused;
    static double xyz[POINTS][3];
    const double base[3] = {0};
    double far[3] = {0.11, 0.042, 0};
    plm_error error = {0};
    plm_tube_points points = {POINTS, xyz};
    make(xyz, LEAFLETS);
    assert_ok(plm_petiole_course(&points, base, far, &error));
    assert_near(far[0], 0.097, 0.004);
    assert_near(far[1], 0, 0.001);
    assert_in_range(points.count, RACHIS - 30, RACHIS + 30); /* the leaflets are left out */
}

static void a_bare_petiole_stays_as_it_is(void **unused)
{
    (void)unused;
    static double xyz[POINTS][3];
    const double base[3] = {0};
    double far[3] = {0.1, 0, 0};
    plm_error error = {0};
    plm_tube_points points = {RACHIS, xyz};
    make(xyz, 0);
    assert_ok(plm_petiole_course(&points, base, far, &error));
    assert_true(far[0] == 0.1 && far[1] == 0 && far[2] == 0);
    assert_int_equal(points.count, RACHIS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rachis_goes_on_past_its_leaflets),
        cmocka_unit_test(a_bare_petiole_stays_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
