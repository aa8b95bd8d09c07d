/* pca1 and pca2: axes of the surface, not of the points. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/traits.h"

enum { DENSE = 6000, PIECES = 60 /* along a strip: too small for surfaces */ };
static const double LENGTH = 0.06, WIDTH = 0.02, TURN = 1.2, LEAN = 0.8;

/* A strip that begins at the z axis and points to an angle from x; it leans to one side. */
static void place_on(double angle, double along, double across, double height, double xyz[3])
{
    const double aside = across * cos(LEAN);
    xyz[0] = along * cos(angle) - aside * sin(angle);
    xyz[1] = along * sin(angle) + aside * cos(angle);
    xyz[2] = height + across * sin(LEAN);
}

/* Random points of a strip, so many metres apart; in pieces: each small square is an organ of its own. */
static size_t put_strip(plm_cloud *cloud, size_t at, double angle, double height, size_t count, bool pieces)
{
    uint64_t seed = 1 + count;
    for (size_t i = 0; i < count; i++, at++) {
        const double u = test_uniform(&seed), v = test_uniform(&seed);
        double xyz[3];
        place_on(angle, LENGTH * u, WIDTH * (v - 0.5), height, xyz);
        for (int k = 0; k < 3; k++) cloud->xyz[at][k] = (float)xyz[k];
        cloud->label[at] = PLM_LABEL_LEAF;
        cloud->organ[at] = pieces ? 10 + (int)(u * PIECES) * PIECES + (int)(v * PIECES / 3) : height > 0.1;
    }
    return at;
}

/* Extents of both strips along the axes of their area. */
static void built_extents(double extent[2])
{
    enum { FINE = 400 };
    double first[2] = {0}, xx = 0, xy = 0, yy = 0, count = 0;
    for (int strip = 0; strip < 2; strip++)
        for (int i = 0; i < FINE; i++)
            for (int j = 0; j < FINE; j++, count++) {
                double at[3];
                place_on(strip * TURN, LENGTH * (i + 0.5) / FINE, WIDTH * ((j + 0.5) / FINE - 0.5), 0, at);
                first[0] += at[0], first[1] += at[1];
                xx += at[0] * at[0], xy += at[0] * at[1], yy += at[1] * at[1];
            }
    const double x = first[0] / count, y = first[1] / count;
    const double angle = 0.5 * atan2(2 * (xy / count - x * y), xx / count - x * x - yy / count + y * y);
    for (int axis = 0; axis < 2; axis++) {
        const double c = cos(angle + axis * PLM_PI / 2), s = sin(angle + axis * PLM_PI / 2);
        double low = INFINITY, high = -INFINITY;
        for (int corner = 0; corner < 8; corner++) {
            double at[3];
            place_on(corner / 4 * TURN, corner & 1 ? LENGTH : 0, (corner & 2 ? 0.5 : -0.5) * WIDTH, 0, at);
            low = fmin(low, at[0] * c + at[1] * s);
            high = fmax(high, at[0] * c + at[1] * s);
        }
        extent[axis] = high - low;
    }
}

/* share: of the extents by which they may be off. */
static void try_strips(size_t count, bool pieces, double share)
{
    plm_error error = {0};
    plm_cloud cloud;
    plm_measure_options options;
    plm_measurement m;
    double built[2];
    assert_ok(plm_cloud_create(DENSE + count, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    const size_t at = put_strip(&cloud, 0, 0, 0.1, DENSE, false);
    assert_int_equal(put_strip(&cloud, at, TURN, 0.11, count, pieces), cloud.count);
    plm_measure_defaults(&options);
    options.traits = "pca1,pca2";
    options.up = PLM_UP_Z;
    options.ground = PLM_GROUND_NONE;
    assert_ok(plm_measure(&cloud, &options, &m, &error));
    built_extents(built);
    assert_int_equal(m.value_count, 2);
    for (int axis = 0; axis < 2; axis++) {
        const plm_estimate found = m.value[axis].estimate;
        print_message("%zu points: %.2f mm of %.2f, standard error %.2f\n", count, 1e3 * found.value, 1e3 * built[axis],
                      1e3 * found.std_error);
        assert_near(found.value, built[axis], share * built[axis]);
        assert_near(found.value, built[axis], 3 * found.std_error);
    }
    plm_measurement_free(&m);
}

/* A strip that is scanned twenty times as sparsely has as much area: with voxels its axes were 7 degrees off. */
static void a_coarse_leaf_counts_as_its_area(void **unused)
{
    (void)unused;
    try_strips(DENSE, false, 0.01);
    try_strips(DENSE / 20, false, 0.02);
}

/* What has no surface counts by its voxels, about as much as if it had one. */
static void pieces_without_a_surface_count_as_their_area(void **unused)
{
    (void)unused;
    try_strips(DENSE / 2, true, 0.05);
}

/* Points too few to be cut into organs still have axes and a shadow. */
static void a_few_points_have_axes_and_a_shadow(void **unused)
{
    (void)unused;
    enum { POINTS = 15 };
    plm_error error = {0};
    plm_cloud cloud;
    plm_measure_options options;
    plm_measurement m;
    uint64_t seed = 5;
    assert_ok(plm_cloud_create(POINTS, 0, &cloud, &error));
    for (size_t i = 0; i < cloud.count; i++) {
        double xyz[3];
        place_on(0.3, LENGTH * test_uniform(&seed), WIDTH * test_uniform(&seed), 0.1, xyz);
        for (int k = 0; k < 3; k++) cloud.xyz[i][k] = (float)xyz[k];
    }
    plm_measure_defaults(&options);
    options.traits = "pca1,pca2,projected_area,leaf_count";
    options.up = PLM_UP_Z;
    options.ground = PLM_GROUND_NONE;
    assert_ok(plm_measure(&cloud, &options, &m, &error));
    assert_int_equal(m.value_count, 4);
    for (size_t i = 0; i < m.value_count; i++) {
        const plm_estimate *found = &m.value[i].estimate;
        print_message("%s: %g, standard error %g, %s%s\n", m.value[i].trait->name, found->value, found->std_error,
                      found->method, found->reason);
        const bool counted = !strcmp(m.value[i].trait->name, "leaf_count");
        assert_int_equal(found->state, counted ? PLM_STATE_FAILED : PLM_STATE_OK);
    }
    for (size_t i = 0; i < m.value_count; i++) {
        const plm_estimate *found = &m.value[i].estimate;
        const char *name = m.value[i].trait->name;
        if (!strcmp(name, "pca1")) {
            assert_near(found->value, LENGTH, 2 * found->std_error);
            assert_true(found->std_error < 0.35 * LENGTH);
        }
        if (!strcmp(name, "projected_area")) {
            assert_string_equal(found->method, "closed raster");
            assert_true(found->value > 0 && found->value < 2 * LENGTH * WIDTH);
        }
    }
    plm_measurement_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_coarse_leaf_counts_as_its_area),
        cmocka_unit_test(pieces_without_a_surface_count_as_their_area),
        cmocka_unit_test(a_few_points_have_axes_and_a_shadow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
