/* The truth against closed forms, and against finer meshes of the same plants. */
#include "cloud/linear.h"
#include "simulate/build.h"
#include "simulate/truth.h"
#include "support/test.h"

static void start(plm_builder *builder, plm_virtual_plant *plant, double resolution, plm_error *error)
{
    plm_builder_start(builder, "test", &(plm_plant_options){.resolution = resolution}, plant, error);
}

/* A half ellipse on each side of the midrib is what rise = fall = 1/2 draws. */
static void a_flat_elliptic_blade_has_the_area_and_tilt_of_an_ellipse(void **state)
{
    (void)state;
    plm_error error = {0};
    for (int tilt = 0; tilt <= 90; tilt += 30) {
        plm_builder builder;
        plm_virtual_plant plant;
        plm_blade blade;
        const plm_blade_spec spec = {.length = 0.08, .width = 0.05, .rise = 0.5, .fall = 0.5};
        const plm_frame_at frame = plm_frame_of_direction(plm_radians(90 - tilt), 0.7);
        start(&builder, &plant, 2, &error);
        plm_blade_place(&spec, (double[3]){0.01, -0.02, 0.03}, &frame, &blade);
        builder.label = PLM_LABEL_LEAF;
        builder.organ = 0;
        plm_build_blade(&builder, &blade);
        plant.leaf = plm_alloc_zero(1, sizeof *plant.leaf, &error);
        plant.leaf_count = 1;
        assert_ok(plm_truth_from_faces(&plant, &error));
        assert_near(plant.leaf[0].area / (PLM_PI / 4 * 0.08 * 0.05), 1, 1e-3); /* chords of the margin: (pi / rows)^2 */
        assert_near(plm_degrees(plant.leaf[0].inclination), tilt, 1e-6);
        assert_near(plm_degrees(plant.leaf[0].facet_inclination_mean), tilt, 1e-6);
        assert_near(plant.leaf[0].flatness, 0, 1e-9);
        /* centre of the ellipse: half a length along the midrib */
        for (int i = 0; i < 3; i++)
            assert_near(plant.leaf[0].centroid[i], blade.midrib.point[0][i] + 0.04 * frame.tangent[i], 2e-5);
        double width, chord;
        plm_blade_width(&blade, &width, &chord);
        assert_near(width, 0.05, 1e-5);
        assert_near(chord, 0.05, 1e-5);
        builder.status = PLM_E_ARGUMENT; /* frees the plant */
        plm_builder_finish(&builder);
    }
}

static void a_cupped_and_folded_blade_keeps_its_area_and_its_width_along_the_surface(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_blade flat, bent;
    plm_blade_spec spec = {.length = 0.08, .width = 0.05, .rise = 0.5, .fall = 0.5};
    const plm_frame_at frame = plm_frame_of_direction(1, 0);
    plm_blade_place(&spec, (double[3]){0}, &frame, &flat);
    spec.fold = spec.fold_end = 0.4;
    spec.cup = 0.8;
    plm_blade_place(&spec, (double[3]){0}, &frame, &bent);
    double area[2];
    for (int k = 0; k < 2; k++) {
        plm_builder builder;
        plm_virtual_plant plant;
        start(&builder, &plant, 2, &error);
        builder.label = PLM_LABEL_LEAF;
        plm_build_blade(&builder, k ? &bent : &flat);
        area[k] = 0;
        for (size_t f = 0; f < plant.mesh.triangle_count; f++) {
            plm_moments moments = {0};
            const uint32_t *t = plant.mesh.triangle[f];
            plm_moments_add(&moments, plant.mesh.vertex[t[0]], plant.mesh.vertex[t[1]], plant.mesh.vertex[t[2]]);
            area[k] += moments.area;
        }
        builder.status = PLM_E_ARGUMENT;
        plm_builder_finish(&builder);
    }
    assert_near(area[1] / area[0], 1, 1e-3); /* a sheet that is rolled, not stretched */
    double width, chord;
    plm_blade_width(&bent, &width, &chord);
    assert_near(width, 0.05, 2e-5);
    assert_true(chord < 0.9 * width);
}

static double wall_area(const plm_virtual_plant *plant)
{
    double area = 0;
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        plm_moments moments = {0};
        const uint32_t *t = plant->mesh.triangle[f];
        plm_moments_add(&moments, plant->mesh.vertex[t[0]], plant->mesh.vertex[t[1]], plant->mesh.vertex[t[2]]);
        area += moments.area;
    }
    return area;
}

static void a_tube_has_the_area_of_a_cylinder_and_a_spheroid_that_of_a_half_ellipsoid_twice(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_builder builder;
    plm_virtual_plant plant;
    plm_curve axis;
    const plm_frame_at up = plm_frame_of_direction(0, 0);
    const plm_taper even = {.base = 0.002, .tip = 0.002};
    plm_curve_grow((double[3]){0}, &up, 0.1, &(plm_bend){0}, &axis);
    start(&builder, &plant, 4, &error);
    plm_build_tube(&builder, &axis, &even, 0, 0.1);
    /* the wall, the disc at the foot, the cone of height 0.6 r at the head */
    const double r = 0.002, expected = 2 * PLM_PI * r * 0.1 + PLM_PI * r * r * (1 + sqrt(1 + 0.36));
    assert_near(wall_area(&plant) / expected, 1, 1e-3);
    builder.status = PLM_E_ARGUMENT;
    plm_builder_finish(&builder);

    start(&builder, &plant, 8, &error);
    plm_build_spheroid(&builder, (double[3]){0}, 0.02, 0.6);
    const double e = sqrt(1 - 0.36), half = PLM_PI * 4e-4 * (1 + 0.36 / e * atanh(e)); /* oblate, half of it */
    assert_near(wall_area(&plant) / (2 * half), 1, 1e-3);
    builder.status = PLM_E_ARGUMENT;
    plm_builder_finish(&builder);
}

static void a_curve_of_constant_bend_is_an_arc_of_a_circle(void **state)
{
    (void)state;
    plm_curve curve;
    const plm_frame_at level = plm_frame_of_direction(0.5 * PLM_PI, 0);
    const double radius = 0.1, turn = 1.2;
    double point[3];
    plm_frame_at frame;
    plm_curve_grow((double[3]){0}, &level, radius * turn, &(plm_bend){.pitch = turn}, &curve);
    for (int k = 0; k <= 50; k++) {
        const double angle = turn * k / 50;
        plm_curve_at(&curve, radius * angle, point, &frame);
        assert_near(point[0], radius * sin(angle), 1e-5 * radius * turn); /* chords for arcs: step^2 / 24 */
        assert_near(point[2], radius * (cos(angle) - 1), 1e-5 * radius * turn);
        assert_near(atan2(-frame.tangent[2], frame.tangent[0]), angle, 1e-5);
    }
}

/* Default meshes are converged: what four times as many faces change is far below any measuring error. */
static void truth_from_faces_is_converged_at_resolution_1(void **state)
{
    (void)state;
    static const char *const kind[] = {"eggplant", "okra", "maize"};
    plm_error error = {0};
    for (size_t k = 0; k < COUNT(kind); k++) {
        plm_virtual_plant coarse, fine;
        assert_ok(plm_plant_grow(kind[k], &(plm_plant_options){.seed = 3, .resolution = 1}, &coarse, &error));
        assert_ok(plm_plant_grow(kind[k], &(plm_plant_options){.seed = 3, .resolution = 2}, &fine, &error));
        assert_int_equal(coarse.leaf_count, fine.leaf_count);
        for (size_t i = 0; i < fine.leaf_count; i++) {
            assert_near(coarse.leaf[i].area / fine.leaf[i].area, 1, 0.004);
            assert_near(plm_degrees(coarse.leaf[i].inclination), plm_degrees(fine.leaf[i].inclination), 0.15);
        }
        assert_near(coarse.whole.height / fine.whole.height, 1, 1e-3);
        plm_virtual_plant_free(&coarse);
        plm_virtual_plant_free(&fine);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_elliptic_blade_has_the_area_and_tilt_of_an_ellipse),
        cmocka_unit_test(a_cupped_and_folded_blade_keeps_its_area_and_its_width_along_the_surface),
        cmocka_unit_test(a_tube_has_the_area_of_a_cylinder_and_a_spheroid_that_of_a_half_ellipsoid_twice),
        cmocka_unit_test(a_curve_of_constant_bend_is_an_arc_of_a_circle),
        cmocka_unit_test(truth_from_faces_is_converged_at_resolution_1),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
