/* The axis of a stem that winds from node to node: its direction is asked for at each node. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/axis.h"

#include <math.h>

enum { POINTS = 4000, PLACES = 9 };

static const double LENGTH = 0.15, RADIUS = 0.0015, SWING = 0.0015;

/* Off the straight line at height z, and its slope: two windings. */
static double winding(double z, double *slope)
{
    const double turns = 4 * PLM_PI / LENGTH;
    *slope = SWING * turns * cos(turns * z);
    return SWING * sin(turns * z);
}

/* Largest angle between the fitted axis and the true one at nine places, degrees. noise: SD along the normal. */
static double most_turned(double noise)
{
    static float xyz[POINTS][3];
    uint64_t state = 11;
    plm_error error = {0};
    for (size_t i = 0; i < POINTS; i++) {
        double slope;
        const double z = LENGTH * test_uniform(&state), middle = winding(z, &slope), stretch = hypot(1, slope);
        const double angle = 2 * PLM_PI * test_uniform(&state), radius = RADIUS + noise * test_normal(&state);
        xyz[i][0] = (float)(middle + radius * cos(angle) / stretch);
        xyz[i][1] = (float)(radius * sin(angle));
        xyz[i][2] = (float)(z - radius * cos(angle) * slope / stretch);
    }
    plm_cloud cloud = {.count = POINTS};
    plm_organ organ = {.label = PLM_LABEL_STEM, .count = POINTS, .xyz = xyz};
    const plm_scene scene = {.cloud = &cloud, .organ = &organ, .organ_count = 1};
    plm_axis axis;
    assert_ok(plm_stem_axis_fit(&scene, &organ, &axis, &error));
    double most = 0;
    for (int k = 1; k <= PLACES; k++) {
        double tangent[3], slope, point[3];
        point[2] = LENGTH * k / (PLACES + 1);
        point[0] = winding(point[2], &slope), point[1] = 0;
        plm_curve_tangent(&axis.line, plm_curve_foot(&axis.line, point), tangent);
        const double across = hypot(tangent[1], tangent[0] - slope * tangent[2]);
        most = fmax(most, plm_degrees(atan2(across, tangent[2] + slope * tangent[0])));
    }
    return most;
}

/* With spans of 40 radii it was up to 6.5 degrees off. */
static void a_sharp_stem_is_followed_from_node_to_node(void **unused)
{
    (void)unused;
    const double most = most_turned(0.005 * RADIUS);
    print_message("%.2f degrees\n", most);
    assert_true(most < 0.3);
}

static void noise_hides_little_of_its_windings(void **unused)
{
    (void)unused;
    const double most = most_turned(0.3 * RADIUS);
    print_message("%.2f degrees\n", most);
    assert_true(most < 1.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sharp_stem_is_followed_from_node_to_node),
        cmocka_unit_test(noise_hides_little_of_its_windings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
