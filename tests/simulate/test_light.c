/* Light against closed forms. */
#include <omp.h>

#include "cloud/linear.h"
#include "simulate/simulate.h"
#include "support/test.h"

/* Square plates of side 0.2 m, level, at the given heights: two triangles each. */
static plm_mesh plates(const double *height, size_t count)
{
    plm_error error = {0};
    plm_mesh mesh;
    assert_ok(plm_mesh_create(4 * count, 2 * count, &mesh, &error));
    for (size_t k = 0; k < count; k++) {
        for (size_t i = 0; i < 4; i++) {
            mesh.vertex[4 * k + i][0] = (i == 1 || i == 2) ? 0.1 : -0.1;
            mesh.vertex[4 * k + i][1] = i >= 2 ? 0.1 : -0.1;
            mesh.vertex[4 * k + i][2] = height[k];
        }
        const uint32_t a = (uint32_t)(4 * k);
        memcpy(mesh.triangle[2 * k], (uint32_t[3]){a, a + 1, a + 2}, sizeof *mesh.triangle);
        memcpy(mesh.triangle[2 * k + 1], (uint32_t[3]){a, a + 2, a + 3}, sizeof *mesh.triangle);
    }
    return mesh;
}

static plm_light_options black(double radius)
{
    plm_light_options options;
    plm_light_defaults(&options);
    options.rays = 400000;
    options.radius = radius;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) options.reflectance[b] = options.transmittance[b] = 0;
    return options;
}

static double sine_of_circle(int circle)
{
    return sin(0.5 * PLM_PI * (circle + 0.5) / 6);
}

static void a_black_plate_absorbs_what_its_projections_catch(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_light light;
    const double height = 0, radius = 0.3;
    plm_mesh mesh = plates(&height, 1);
    const plm_light_options options = black(radius);
    const int32_t group[2] = {0, 0};
    assert_ok(plm_light_trace(&mesh, group, 1, &options, &light, &error));
    double expected = 0;
    for (int circle = 0; circle < 6; circle++)
        expected += 1000.0 / 6 * 0.04 * sine_of_circle(circle) / (PLM_PI * radius * radius);
    assert_near(light.absorbed / expected, 1, 2e-3);
    assert_near(light.absorbed, expected, 5 * light.absorbed_std_error + 1e-9);
    assert_true(light.absorbed_std_error < 5e-3 * expected);
    assert_near(light.group_power[0], light.absorbed, 1e-9);
    assert_near(light.face_power[0], light.face_power[1], 0.02 * expected);
    assert_near(light.absorbed + light.escaped, light.emitted, 1e-6 * light.emitted);
    plm_light_free(&light);
    plm_mesh_free(&mesh);
}

/* The upper plate's shadow on the lower one is the plate, shifted by gap / tan(elevation). */
static void a_plate_below_another_gets_what_the_upper_ones_shadow_leaves(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_light light;
    const double height[2] = {0, 0.05}, radius = 0.3, side = 0.2;
    plm_mesh mesh = plates(height, 2);
    const plm_light_options options = black(radius);
    const int32_t group[4] = {0, 0, 1, 1};
    assert_ok(plm_light_trace(&mesh, group, 2, &options, &light, &error));
    double lower = 0, upper = 0;
    for (int circle = 0; circle < 6; circle++)
        for (int k = 0; k < 12; k++) {
            const double azimuth = 2 * PLM_PI * (k + 0.5 * (circle % 2)) / 12, sine = sine_of_circle(circle);
            const double shift = 0.05 * sqrt(1 - sine * sine) / sine;
            const double x = fmax(side - fabs(shift * cos(azimuth)), 0), y = fmax(side - fabs(shift * sin(azimuth)), 0);
            const double flux = 1000.0 / 72 * sine / (PLM_PI * radius * radius);
            lower += flux * (side * side - x * y);
            upper += flux * side * side;
        }
    assert_near(light.group_power[0] / lower, 1, 5e-3);
    assert_near(light.group_power[1] / upper, 1, 3e-3);
    plm_light_free(&light);
    plm_mesh_free(&mesh);
}

/* One plate in the open: what it scatters never comes back, so it absorbs its absorptance's share of what falls on it. */
static void a_grey_plate_absorbs_its_share(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_light dark, grey;
    const double height = 0;
    plm_mesh mesh = plates(&height, 1);
    plm_light_options options = black(0.3);
    assert_ok(plm_light_trace(&mesh, NULL, 0, &options, &dark, &error));
    plm_light_defaults(&options);
    options.rays = 400000;
    options.radius = 0.3;
    assert_ok(plm_light_trace(&mesh, NULL, 0, &options, &grey, &error));
    /* red and blue: 0.9 each; green: nothing */
    assert_near(grey.absorbed / dark.absorbed, 0.6, 1e-9);
    assert_near(grey.absorbed + grey.escaped, grey.emitted, 1e-6 * grey.emitted);
    plm_light_free(&dark);
    plm_light_free(&grey);
    plm_mesh_free(&mesh);
}

/* Between two wide plates of which the lower one is black: of what the upper one lets through, and of what it reflects
 * downwards, nothing gets lost. Checked by energy alone on a whole plant. */
static void energy_is_conserved_and_threads_change_no_digit(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_light one, three;
    plm_light_options options;
    const int threads = omp_get_max_threads();
    plm_light_defaults(&options);
    options.rays = 50000;
    assert_ok(plm_plant_grow("pepper", &(plm_plant_options){.seed = 2, .resolution = 0.2}, &plant, &error));
    omp_set_num_threads(1);
    assert_ok(plm_light_trace(&plant.mesh, plant.mesh.face_organ, plant.leaf_count, &options, &one, &error));
    omp_set_num_threads(3);
    assert_ok(plm_light_trace(&plant.mesh, plant.mesh.face_organ, plant.leaf_count, &options, &three, &error));
    omp_set_num_threads(threads);
    assert_memory_equal(one.face_power, three.face_power, one.face_count * sizeof *one.face_power);
    assert_true(one.absorbed == three.absorbed && one.ray_count == three.ray_count);
    assert_true(one.ray_count > options.rays);
    double sum = 0;
    for (size_t f = 0; f < one.face_count; f++) sum += one.face_power[f];
    assert_near(sum, one.absorbed, 1e-9 * one.absorbed);
    assert_near(one.absorbed + one.escaped, one.emitted, 1e-6 * one.emitted);
    plm_light_free(&one);
    plm_light_free(&three);
    plm_virtual_plant_free(&plant);
}

/* A low-discrepancy start halves the error for twice the rays, or nearly: between 1/2 and the 0.71 of plain draws. */
static void standard_errors_fall_with_rays_and_tell_the_scatter_between_seeds(void **state)
{
    (void)state;
    enum { SEEDS = 24 };
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_light_options options;
    double mean = 0, squares = 0, told = 0, fewer = 0;
    plm_light_defaults(&options);
    assert_ok(plm_plant_grow("eggplant", &(plm_plant_options){.seed = 2, .resolution = 0.2}, &plant, &error));
    for (int k = 0; k < SEEDS; k++) {
        plm_light light;
        options.seed = (uint64_t)k + 1;
        options.rays = 20000;
        assert_ok(plm_light_trace(&plant.mesh, NULL, 0, &options, &light, &error));
        const double change = light.absorbed - mean;
        mean += change / (k + 1);
        squares += change * (light.absorbed - mean);
        told += light.absorbed_std_error / SEEDS;
        plm_light_free(&light);
        options.rays = 5000;
        assert_ok(plm_light_trace(&plant.mesh, NULL, 0, &options, &light, &error));
        fewer += light.absorbed_std_error / SEEDS;
        plm_light_free(&light);
    }
    const double scatter = sqrt(squares / (SEEDS - 1));
    assert_true(told / scatter > 0.6 && told / scatter < 1.6); /* an SD of 24 is known to 15 % */
    assert_true(fewer / told > 1.7);                           /* four times the rays: 2 for plain draws */
    plm_virtual_plant_free(&plant);
}

static void impossible_options_are_refused(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_light light;
    const double height = 0;
    plm_mesh mesh = plates(&height, 1), none = {0};
    plm_light_options options = black(0);
    options.reflectance[1] = 0.7;
    options.transmittance[1] = 0.4;
    assert_int_equal(plm_light_trace(&mesh, NULL, 0, &options, &light, &error), PLM_E_ARGUMENT);
    options = black(0);
    assert_int_equal(plm_light_trace(&none, NULL, 0, &options, &light, &error), PLM_E_DEGENERATE);
    options.depth = 0;
    assert_int_equal(plm_light_trace(&mesh, NULL, 0, &options, &light, &error), PLM_E_ARGUMENT);
    plm_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_black_plate_absorbs_what_its_projections_catch),
        cmocka_unit_test(a_plate_below_another_gets_what_the_upper_ones_shadow_leaves),
        cmocka_unit_test(a_grey_plate_absorbs_its_share),
        cmocka_unit_test(energy_is_conserved_and_threads_change_no_digit),
        cmocka_unit_test(standard_errors_fall_with_rays_and_tell_the_scatter_between_seeds),
        cmocka_unit_test(impossible_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
