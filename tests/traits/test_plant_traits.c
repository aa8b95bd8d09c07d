/* Plant-level traits against closed forms and against plants with known truth. */
#include "support/test.h"

#include "io/io.h"
#include "traits/traits.h"

#include <jansson.h>

/* Points of an ellipsoid's surface, noisy or not, as a labelled leaf so that nothing is segmented. */
static plm_cloud ellipsoid(size_t count, const double radius[3], double noise, const double place[3], uint64_t seed)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(count, PLM_HAS_LABEL | PLM_HAS_ORGAN | PLM_HAS_RGB, &cloud, &error));
    memcpy(cloud.origin, place, sizeof cloud.origin);
    uint64_t state = seed;
    for (size_t i = 0; i < count;) {
        double p[3], length = 0;
        for (int k = 0; k < 3; k++) p[k] = test_normal(&state);
        length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        /* uniform on the ellipsoid: accept by the stretch of the area there */
        double stretch = 0, largest = 0;
        for (int k = 0; k < 3; k++) {
            p[k] /= length;
            stretch += pow(p[k] / radius[k], 2);
            largest = fmax(largest, 1 / radius[k]);
        }
        if (test_uniform(&state) > sqrt(stretch) / largest) continue;
        for (int k = 0; k < 3; k++)
            cloud.xyz[i][k] =
                (float)(p[k] * radius[k] + noise * p[k] / radius[k] / sqrt(stretch) * test_normal(&state));
        cloud.rgb[i][0] = 60, cloud.rgb[i][1] = 160, cloud.rgb[i][2] = 40;
        cloud.label[i] = PLM_LABEL_LEAF;
        cloud.organ[i++] = 0;
    }
    return cloud;
}

static const plm_estimate *find(const plm_measurement *m, const char *trait)
{
    for (size_t i = 0; i < m->value_count; i++)
        if (!strcmp(m->value[i].trait->name, trait)) return &m->value[i].estimate;
    fail_msg("no trait %s", trait);
    return NULL;
}

/* Without noise: the caps that 20 000 points, 1.2 mm apart, miss, and the turn of an estimated axis. With 0.5 mm of noise, near
 * the spacing, the quadrics keep a part of it: the standard error must know. */
static void assert_extent(const plm_measurement *m, const char *trait, double truth, bool noisy)
{
    const plm_estimate *extent = find(m, trait);
    assert_near(extent->value, truth, noisy ? 3 * extent->std_error : 0.00015);
    assert_true(extent->std_error < 0.0015);
}

static void ellipsoids_have_their_extents_hull_and_shadow(void **unused)
{
    (void)unused;
    static const double radius[3] = {0.05, 0.03, 0.08}, at_home[3] = {0}, far[3] = {500000, 5000000, 300};
    static const char list[] =
        "plant_height,plant_width,bounding_box_x,bounding_box_y,bounding_box_z,pca1,pca2,pca3d_1,pca3d_2,"
        "pca3d_3,convex_hull_volume,projected_area,gli,hue_mean,plant_height_p98,plant_height_top10,"
        "smoothness_factor_mean,boundary_share,convex_hull_area";
    for (int noisy = 0; noisy < 2; noisy++)
        for (int place = 0; place < 2; place++) {
            plm_error error = {0};
            plm_cloud cloud = ellipsoid(20000, radius, noisy ? 0.0005 : 0, place ? far : at_home, 3);
            plm_measure_options options;
            plm_measure_defaults(&options);
            options.traits = list;
            options.up = PLM_UP_Z;
            options.ground = PLM_GROUND_NONE;
            plm_measurement m;
            assert_ok(plm_measure(&cloud, &options, &m, &error));
            /* 20 000 points lie 1.3 mm apart: the caps that they miss, and what noise leaves after projection */
            assert_extent(&m, "plant_height", 0.16, noisy);
            assert_extent(&m, "bounding_box_x", 0.10, noisy);
            assert_extent(&m, "bounding_box_y", 0.06, noisy);
            assert_extent(&m, "bounding_box_z", 0.16, noisy);
            assert_extent(&m, "plant_width", 0.10, noisy);
            assert_extent(&m, "pca1", 0.10, noisy);
            assert_extent(&m, "pca2", 0.06, noisy);
            assert_extent(&m, "pca3d_1", 0.16, noisy);
            assert_extent(&m, "pca3d_3", 0.06, noisy);
            const double volume = 4.18879020478639 * 0.05 * 0.03 * 0.08;
            const plm_estimate *hull = find(&m, "convex_hull_volume");
            assert_near(hull->value, volume, noisy ? 3 * hull->std_error : 0.002 * volume);
            assert_true(hull->std_error < 0.015 * volume);
            assert_near(find(&m, "projected_area")->value, 3.14159265358979 * 0.05 * 0.03,
                        0.07 * 0.00471); /* a solid's rim is dense: no inset; noise */
            assert_near(find(&m, "gli")->value, 220.0 / 420, 1e-6);
            assert_near(find(&m, "hue_mean")->value * 57.29577951308232, 111.0517,
                        1e-3); /* atan2(sqrt(3) / 2 (G - B), R - (G + B) / 2) */
            assert_true(find(&m, "plant_height_p98")->value < find(&m, "plant_height")->value);
            assert_true(find(&m, "plant_height_top10")->value < find(&m, "plant_height_p98")->value);
            assert_true(find(&m, "boundary_share")->value < 0.2);
            plm_measurement_free(&m);
        }
}

/* Narrow triangles about a middle, of which the hull's corners are the tips. */
static plm_cloud star(void)
{
    enum { RAYS = 10, ON_RAY = 600 };
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create((size_t)RAYS * ON_RAY, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    uint64_t state = 6;
    for (int i = 0; i < RAYS * ON_RAY; i++) {
        const double turn = 2.4 * (i / ON_RAY), rise = -0.8 + 1.6 * (i / ON_RAY) / (RAYS - 1);
        const double along = 0.1 * (1 - sqrt(test_uniform(&state)));
        const double across = 0.15 * (0.1 - along) * (test_uniform(&state) - 0.5);
        cloud.xyz[i][0] = (float)(along * cos(turn) * cos(rise) - across * sin(turn));
        cloud.xyz[i][1] = (float)(along * sin(turn) * cos(rise) + across * cos(turn));
        cloud.xyz[i][2] = (float)(along * sin(rise));
        cloud.label[i] = PLM_LABEL_LEAF;
        cloud.organ[i] = i / ON_RAY;
    }
    return cloud;
}

/* What a hull lacks is told by random halves of the points: which ones is chance, and must not show. */
static void hulls_hardly_depend_on_the_seed(void **unused)
{
    (void)unused;
    enum { SEEDS = 24 };
    plm_error error = {0};
    double sum = 0, squares = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        plm_cloud cloud = star();
        plm_measure_options options;
        plm_measure_defaults(&options);
        options.traits = "convex_hull_volume";
        options.up = PLM_UP_Z;
        options.ground = PLM_GROUND_NONE;
        options.seed = seed;
        plm_measurement m;
        assert_ok(plm_measure(&cloud, &options, &m, &error));
        const double volume = find(&m, "convex_hull_volume")->value;
        sum += volume, squares += volume * volume;
        plm_measurement_free(&m);
    }
    const double mean = sum / SEEDS, sd = sqrt(squares / SEEDS - mean * mean) / mean;
    print_message("SD over seeds: %.4f %%\n", 100 * sd);
    assert_true(sd < 0.0115); /* 0.0124 where halves are drawn apart from each other */
}

/* Far more points than the noise lets through: the highest of them are those that noise threw out, and must not draw the surface
 * to themselves. */
static void the_noise_of_dense_clouds_does_not_swell_a_plant(void **unused)
{
    (void)unused;
    static const double radius[3] = {0.03, 0.02, 0.01}, at_home[3] = {0};
    static const size_t points[] = {20000, 200000};
    for (size_t i = 0; i < COUNT(points); i++) {
        plm_error error = {0};
        plm_cloud cloud = ellipsoid(points[i], radius, 0.0005, at_home, 5);
        plm_measure_options options;
        plm_measure_defaults(&options);
        options.traits = "plant_height,convex_hull_volume";
        options.up = PLM_UP_Z;
        options.ground = PLM_GROUND_NONE;
        plm_measurement m;
        assert_ok(plm_measure(&cloud, &options, &m, &error));
        const double volume = 4.18879020478639 * 0.03 * 0.02 * 0.01;
        const plm_estimate *height = find(&m, "plant_height"), *hull = find(&m, "convex_hull_volume");
        print_message("%zu points: height %.3f mm (SE %.3f) of 20, hull %.4f (SE %.4f) of 1\n", points[i],
                      1e3 * height->value, 1e3 * height->std_error, hull->value / volume, hull->std_error / volume);
        assert_near(height->value, 0.02, 0.00045); /* less than the noise at either end */
        assert_near(hull->value, volume, 0.02 * volume);
        assert_near(hull->value, volume, 2 * hull->std_error);
        plm_measurement_free(&m);
    }
}

/* Of a truth file: the plant's value, or NAN. */
static double truth_of(const char *path, const char *key)
{
    json_error_t trouble;
    json_t *root = json_load_file(path, 0, &trouble);
    assert_non_null(root);
    json_t *value = json_object_get(json_object_get(root, "plant"), key);
    const double number = json_is_number(value) ? json_number_value(value) : NAN;
    json_decref(root);
    return number;
}

static void known_plants_are_measured_within_the_bounds(void **unused)
{
    (void)unused;
    const char *data = test_data_folder();
    if (!data) skip();
    /* bounds: regression bounds for mean absolute relative errors, true labels, some above what is measured today */
    static const struct {
        const char *trait;
        double bound;
    } traits[] = {{"plant_height", 0.004},       {"plant_width", 0.006},     {"pca1", 0.01},          {"pca2", 0.01},
                  {"convex_hull_volume", 0.013}, {"convex_hull_area", 0.01}, {"projected_area", 0.03}};
    static const char *const cases[] = {"eggplant_11_clean", "pepper_12_clean",   "tomato_16_clean",
                                        "maize_15_clean",    "eggplant_11_rgbd",  "cucumber_23_rgbd",
                                        "soybean_33_splat",  "cucumber_34_splat", "eggplant_11_3dgs"};
    double sum[COUNT(traits)] = {0};
    for (size_t c = 0; c < COUNT(cases); c++) {
        plm_error error = {0};
        char path[4096];
        snprintf(path, sizeof path, "%s/dev/%s.labelled.ply", data, cases[c]);
        plm_cloud cloud;
        const plm_read_options read = {.label_field = "label"};
        assert_ok(plm_cloud_read(path, &read, &cloud, NULL, &error));
        plm_measure_options options;
        plm_measure_defaults(&options);
        options.traits = "plant_height,plant_width,pca1,pca2,convex_hull_volume,convex_hull_area,projected_area";
        options.up = PLM_UP_Z;
        plm_measurement m;
        assert_ok(plm_measure(&cloud, &options, &m, &error));
        snprintf(path, sizeof path, "%s/dev/%s.truth.json", data, cases[c]);
        for (size_t t = 0; t < COUNT(traits); t++) {
            const plm_estimate *e = find(&m, traits[t].trait);
            assert_int_equal(e->state, PLM_STATE_OK);
            const double truth = truth_of(path, traits[t].trait), relative = e->value / truth - 1;
            print_message("%-18s %-20s %9.5f %+8.3f %%  %+6.2f standard errors\n", cases[c], traits[t].trait, e->value,
                          100 * relative, (e->value - truth) / e->std_error);
            sum[t] += fabs(relative);
        }
        plm_measurement_free(&m);
    }
    for (size_t t = 0; t < COUNT(traits); t++) {
        print_message("%-20s mean absolute error %.3f %%\n", traits[t].trait, 100 * sum[t] / COUNT(cases));
        assert_true(sum[t] / COUNT(cases) <= traits[t].bound);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        plant_case(ellipsoids_have_their_extents_hull_and_shadow),
        cmocka_unit_test(hulls_hardly_depend_on_the_seed),
        plant_case(the_noise_of_dense_clouds_does_not_swell_a_plant),
        plant_case(known_plants_are_measured_within_the_bounds),
    };
    return run_cases(tests);
}
