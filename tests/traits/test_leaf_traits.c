/* Traits of leaves: a made-up plant whose leaf is known in closed form, and virtual plants with their true labels. */
#include "support/test.h"

#include <jansson.h>

#include "cloud/linear.h"
#include "io/io.h"
#include "simulate/simulate.h"
#include "traits/petiole_end.h"
#include "traits/traits.h"

enum { STEM = 3000, PETIOLE = 800, BLADE = 6000, POINTS = STEM + PETIOLE + BLADE };

static const double tilt = 0.5, heading = 2.0; /* of the blade below the horizontal, and as seen from above */
static const double length = 0.08, width = 0.05, stalk = 0.03;

static void put(plm_cloud *cloud, size_t row, double x, double y, double z, plm_label label)
{
    cloud->xyz[row][0] = (float)(x * cos(heading) - y * sin(heading));
    cloud->xyz[row][1] = (float)(x * sin(heading) + y * cos(heading));
    cloud->xyz[row][2] = (float)z;
    cloud->label[row] = (uint8_t)label;
    cloud->organ[row] = 0;
}

/* A stem along z, a petiole that leaves it at 6 cm, and an ellipse (power 2; more: blunter) at its end. */
static plm_cloud make_plant_of(double power, uint64_t seed)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(POINTS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    for (size_t i = 0; i < POINTS;) {
        const double u = test_uniform(&seed), v = test_uniform(&seed), turn = 2 * PLM_PI * v;
        if (i < STEM) {
            put(&cloud, i++, 0.002 * cos(turn), 0.002 * sin(turn), 0.1 * u, PLM_LABEL_STEM);
        } else if (i < STEM + PETIOLE) {
            put(&cloud, i++, 0.002 + stalk * u, 0.001 * cos(turn), 0.06 + 0.001 * sin(turn), PLM_LABEL_PETIOLE);
        } else if (pow(fabs(2 * u - 1), power) + pow(fabs(2 * v - 1), power) < 1) {
            put(&cloud, i++, 0.002 + stalk + length * u * cos(tilt), width * (v - 0.5), 0.06 - length * u * sin(tilt),
                PLM_LABEL_LEAF);
        }
    }
    return cloud;
}

static plm_cloud make_plant(void)
{
    return make_plant_of(2, 21);
}

static plm_measurement measure(plm_cloud *cloud)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.up = PLM_UP_Z;
    plm_measurement measurement;
    assert_ok(plm_measure(cloud, &options, &measurement, &error));
    return measurement;
}

/* The estimate of a trait of an organ (-1: of the plant), in the unit of the reports. */
static plm_estimate find(const plm_measurement *plant, const char *name, int32_t organ)
{
    for (size_t i = 0; i < plant->value_count; i++) {
        const plm_trait_value *value = &plant->value[i];
        if (strcmp(value->trait->name, name) || value->organ_id != organ) continue;
        plm_estimate estimate = value->estimate;
        estimate.value *= plm_unit_factor(value->trait->unit);
        estimate.std_error *= plm_unit_factor(value->trait->unit);
        return estimate;
    }
    fail_msg("%s of organ %d was not measured", name, organ);
    return (plm_estimate){0};
}

static void traits_of_a_plane_ellipse_are_those_that_were_built(void **unused)
{
    (void)unused;
    plm_cloud cloud = make_plant();
    plm_measurement plant = measure(&cloud);
    const double area = 1e4 * PLM_PI / 4 * length * width;
    const struct {
        const char *name;
        int32_t organ;
        double value, tolerance;
    } expected[] = {
        {"leaf_area", 0, area, 0.01 * area},
        {"total_leaf_area", -1, area, 0.01 * area},
        {"leaf_inclination", 0, plm_degrees(tilt), 0.05},
        {"facet_inclination_mean", 0, plm_degrees(tilt), 0.05},
        {"facet_inclination_sd", 0, 0, 0.05},
        {"flatness", 0, 0, 1e-6},
        {"leaf_azimuth", 0, plm_degrees(heading), 2.0}, /* half a spacing at either end: 1.2 degrees */
        {"leaf_azimuth_from_stem", 0, plm_degrees(heading), 0.5},
        {"leaf_length", 0, 1e3 * length, 2.0},
        {"leaf_width", 0, 1e3 * width, 1.0},
        {"leaf_alpha_sensitivity", 0, 0, 0.05},
    };
    for (size_t i = 0; i < COUNT(expected); i++) {
        const plm_estimate estimate = find(&plant, expected[i].name, expected[i].organ);
        assert_int_equal(estimate.state, PLM_STATE_OK);
        if (fabs(estimate.value - expected[i].value) > expected[i].tolerance) print_error("%s:\n", expected[i].name);
        assert_near(estimate.value, expected[i].value, expected[i].tolerance);
    }
    assert_true(plant.leaves.triangle_count > BLADE);
    assert_int_equal(plant.leaves.face_organ[0], 0);
    plm_measurement_free(&plant);
}

/* A level heart: a disk of 60 mm with a sinus whose sides lie near to the petiole all along, and one stray of the petiole where
 * that is wanted. */
static plm_cloud make_heart(double sinus, bool has_stray)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(POINTS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    uint64_t seed = 22;
    const double radius = 0.03, slope = 0.35, thin = 0.0005;
    for (size_t i = 0; i < POINTS;) {
        const double u = test_uniform(&seed), v = test_uniform(&seed), turn = 2 * PLM_PI * v;
        const double ahead = 2 * radius * u - sinus, side = 2 * radius * (v - 0.5);
        if (i < STEM)
            put(&cloud, i++, 0.002 * cos(turn), 0.002 * sin(turn), 0.1 * u, PLM_LABEL_STEM);
        else if (i < STEM + PETIOLE)
            put(&cloud, i++, 0.002 + stalk * u, thin * cos(turn), 0.06 + thin * sin(turn), PLM_LABEL_PETIOLE);
        else if (hypot(ahead + sinus - radius, side) < radius && (ahead > 0 || fabs(side) > -slope * ahead))
            put(&cloud, i++, 0.002 + stalk + ahead, side, 0.06, PLM_LABEL_LEAF);
    }
    if (has_stray) put(&cloud, STEM, 0.09, 0, 0.06, PLM_LABEL_PETIOLE);
    return cloud;
}

/* 4 mm too long as long as what was nearest to the petiole at any place made the junction. */
static void a_leaf_with_lobes_beside_its_petiole_begins_where_that_ends(void **unused)
{
    (void)unused;
    const double sinus[] = {0.01, 0.01, 0.022}; /* the last: lobes come nearest to the petiole in its lower half */
    for (size_t k = 0; k < COUNT(sinus); k++) {
        plm_cloud cloud = make_heart(sinus[k], k == 1);
        plm_measurement plant = measure(&cloud);
        const plm_estimate estimate = find(&plant, "leaf_length", 0);
        assert_int_equal(estimate.state, PLM_STATE_OK);
        print_message("sinus of %.0f mm: %.2f mm long\n", 1e3 * sinus[k], estimate.value);
        assert_near(estimate.value, 1e3 * (0.06 - sinus[k]), 1.0);
        plm_measurement_free(&plant);
    }
}

/* So few that no point lay between two quantiles of them. */
static void a_petiole_of_a_few_points_has_an_end(void **unused)
{
    (void)unused;
    for (size_t count = 1; count < 40; count++) {
        float xyz[40][3] = {{0}}, blade[2][3] = {{0.05f, 0.001f, 0}, {0.06f, -0.001f, 0}};
        for (size_t i = 0; i < count; i++) xyz[i][0] = 0.04f * (float)(i + 1) / (float)count;
        const plm_organ petiole = {.label = PLM_LABEL_PETIOLE, .count = count, .xyz = xyz};
        const plm_organ leaf = {.label = PLM_LABEL_LEAF, .count = 2, .xyz = blade, .centroid = {0.055, 0, 0}};
        double end[3];
        bool found;
        plm_error error = {0};
        assert_ok(plm_petiole_end(&petiole, NULL, &leaf, end, &found, &error));
        assert_true(isfinite(end[0]) && isfinite(end[1]) && isfinite(end[2]));
        if (count >= 12) assert_near(end[0], 0.04, 0.005);
    }
}

/* The furthest point of a blunt leaf lies anywhere along its end, and the leaf pointed there: RMSE 4.4 degrees, six of twelve within the
 * 95 % interval. */
static void a_blunt_leaf_points_to_the_middle_of_its_end(void **unused)
{
    (void)unused;
    enum { TRIALS = 12 };
    double squares = 0;
    int covered = 0;
    for (uint64_t seed = 1; seed <= TRIALS; seed++) {
        plm_cloud cloud = make_plant_of(3.5, seed);
        plm_measurement plant = measure(&cloud);
        const plm_estimate azimuth = find(&plant, "leaf_azimuth", 0);
        assert_int_equal(azimuth.state, PLM_STATE_OK);
        const double off = remainder(azimuth.value - plm_degrees(heading), 360);
        squares += off * off;
        covered += fabs(off) < 1.96 * azimuth.std_error;
        plm_measurement_free(&plant);
    }
    print_message("%.2f degrees, %d of %d\n", sqrt(squares / TRIALS), covered, TRIALS);
    assert_true(sqrt(squares / TRIALS) < 3);
    assert_true(covered >= TRIALS - 2);
}

/* Place along a strap that goes out 60 mm, turns back below itself within 8 mm, and ends, 40 mm on, in a hook of 5 mm towards its upper
 * limb. */
static void along_hairpin(double s, double *x, double *z)
{
    const double out = 0.06, radius = 0.004, back = 0.04, turn = PLM_PI * radius;
    *x = s, *z = 0.08;
    if (s > out) {
        const double angle = fmin(s - out, turn) / radius;
        *x = out + radius * sin(angle);
        *z = 0.08 - radius * (1 - cos(angle));
    }
    if (s > out + turn) *x = out - fmin(s - out - turn, back);
    if (s > out + turn + back) *z += s - out - turn - back;
}

/* The tip was sought beyond the leaf, found at its other limb, and the midrib ended there: 9.7 mm. A line of three bends cuts the
 * hook and the turn: 105 of 118 mm. */
static void a_leaf_that_hangs_beside_itself_ends_at_its_tip(void **unused)
{
    (void)unused;
    const double whole = 0.105 + PLM_PI * 0.004;
    plm_error error = {0};
    plm_cloud cloud;
    uint64_t seed = 4;
    assert_ok(plm_cloud_create(STEM + BLADE, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    for (size_t i = 0; i < STEM + BLADE; i++) {
        const double u = test_uniform(&seed), v = test_uniform(&seed);
        double x, z;
        along_hairpin(whole * u, &x, &z);
        if (i < STEM)
            put(&cloud, i, 0.002 * cos(2 * PLM_PI * v), 0.002 * sin(2 * PLM_PI * v), 0.1 * u, PLM_LABEL_STEM);
        else
            put(&cloud, i, 0.002 + x, 0.008 * (v - 0.5) * fmin(8 * (1 - u), 1), z, PLM_LABEL_LEAF);
    }
    plm_measurement plant = measure(&cloud);
    const double found = find(&plant, "leaf_length", 0).value;
    print_message("%.1f mm of %.1f\n", found, 1e3 * whole);
    assert_true(found > 0.85e3 * whole && found < 1.1e3 * whole);
    plm_measurement_free(&plant);
}

/* Without stem and petiole there is no junction: the midrib's traits say so, the others stand. */
static void a_blade_alone_has_area_but_no_length(void **unused)
{
    (void)unused;
    plm_cloud cloud = make_plant(), blade;
    plm_error error = {0};
    uint32_t *row = malloc(BLADE * sizeof *row);
    assert_non_null(row);
    for (uint32_t i = 0; i < BLADE; i++) row[i] = STEM + PETIOLE + i;
    assert_ok(plm_cloud_select(&cloud, row, BLADE, &blade, &error));
    plm_measurement plant = measure(&blade);
    assert_int_equal(find(&plant, "leaf_area", 0).state, PLM_STATE_OK);
    assert_int_equal(find(&plant, "leaf_length", 0).state, PLM_STATE_NOT_APPLICABLE);
    assert_int_equal(find(&plant, "leaf_azimuth", 0).state, PLM_STATE_NOT_APPLICABLE);
    assert_int_equal(find(&plant, "leaf_azimuth_from_stem", 0).state, PLM_STATE_NOT_APPLICABLE);
    plm_measurement_free(&plant);
    plm_cloud_free(&cloud);
    free(row);
}

enum { ROSETTE_LEAVES = 5, STALK_POINTS = 200, DISC_POINTS = 1500 };

/* Petioles that arch up and out from a place, each with a disc at its end; the last one is bent aside, seen from above. */
static plm_cloud make_rosette(const double foot[2])
{
    plm_error error = {0};
    plm_cloud cloud;
    const size_t each = STALK_POINTS + DISC_POINTS;
    assert_ok(plm_cloud_create(ROSETTE_LEAVES * each, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    uint64_t seed = 5;
    for (size_t i = 0; i < ROSETTE_LEAVES * each; i++) {
        const size_t leaf = i / each;
        const bool on_stalk = i % each < STALK_POINTS;
        const double angle = 2.4 * (double)leaf + 0.3, u = test_uniform(&seed), turn = 2 * PLM_PI * test_uniform(&seed);
        const double r = on_stalk ? 0.001 + 0.009 * u : 0.017 + 0.007 * sqrt(u) * cos(turn);
        const double across = on_stalk ? 0.0004 * cos(turn) : 0.007 * sqrt(u) * sin(turn);
        const double aside = on_stalk && leaf == ROSETTE_LEAVES - 1 ? 0.002 + 0.3 * r : 0;
        cloud.xyz[i][0] = (float)(foot[0] + r * cos(angle) - (across + aside) * sin(angle));
        cloud.xyz[i][1] = (float)(foot[1] + r * sin(angle) + (across + aside) * cos(angle));
        cloud.xyz[i][2] = (float)(0.3 * r + (on_stalk ? 20 * r * r + 0.0004 * sin(turn) : 0.002));
        cloud.label[i] = on_stalk ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF;
        cloud.organ[i] = (int32_t)leaf;
    }
    return cloud;
}

/* A rosette has no stem: it stands where its petioles meet. */
static void leaves_of_a_rosette_point_away_from_where_petioles_meet(void **unused)
{
    (void)unused;
    const double foot[2] = {0.03, -0.02};
    plm_cloud cloud = make_rosette(foot);
    plm_measurement plant = measure(&cloud);
    for (int32_t leaf = 0; leaf < ROSETTE_LEAVES; leaf++) {
        const plm_estimate azimuth = find(&plant, "leaf_azimuth_from_stem", leaf);
        assert_int_equal(azimuth.state, PLM_STATE_OK);
        const double off = remainder(azimuth.value - plm_degrees(2.4 * leaf + 0.3), 360);
        assert_near(off, 0, 1.5);
        assert_true(fabs(off) < 3 * azimuth.std_error);
    }
    plm_measurement_free(&plant);
}

/* Mean error in per cent of the leaves' areas and root mean square error in degrees of their inclinations. */
static void compare_with_truth(const char *folder, const char *name, double *area, double *inclination)
{
    char path[5000];
    plm_error error = {0};
    const plm_read_options options = {.label_field = "label"};
    plm_cloud cloud;
    snprintf(path, sizeof path, "%s/dev/%s.labelled.ply", folder, name);
    assert_ok(plm_cloud_read(path, &options, &cloud, NULL, &error));
    plm_measurement plant = measure(&cloud);
    snprintf(path, sizeof path, "%s/dev/%s.truth.json", folder, name);
    json_t *truth = json_load_file(path, 0, NULL);
    assert_non_null(truth);
    double areas = 0, squares = 0, count = 0;
    size_t i;
    json_t *organ;
    json_array_foreach(json_object_get(truth, "organs"), i, organ)
    {
        if (strcmp(json_string_value(json_object_get(organ, "organ")), "leaf")) continue;
        const int32_t id = (int32_t)json_integer_value(json_object_get(organ, "organ_id"));
        const double true_area = 1e4 * json_number_value(json_object_get(organ, "leaf_area"));
        const double true_tilt = json_number_value(json_object_get(organ, "leaf_inclination"));
        areas += 100 * fabs(find(&plant, "leaf_area", id).value / true_area - 1);
        squares += pow(find(&plant, "leaf_inclination", id).value - true_tilt, 2);
        count++;
    }
    *area = areas / count;
    *inclination = sqrt(squares / count);
    json_decref(truth);
    plm_measurement_free(&plant);
}

/* The project's goals for true labels; the figures reached are a third to two thirds of them. */
static void virtual_plants_are_within_the_goals(void **unused)
{
    (void)unused;
    const char *folder = test_data_folder();
    if (!folder) skip();
    const struct {
        const char *name;
        double area, inclination;
    } cases[] = {{"eggplant_11_clean", 1.2, 0.3}, {"cucumber_23_rgbd", 2.5, 0.4}, {"soybean_33_splat", 3.5, 0.8}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        double area, inclination;
        compare_with_truth(folder, cases[i].name, &area, &inclination);
        assert_near(area, 0, cases[i].area);
        assert_near(inclination, 0, cases[i].inclination);
    }
}

/* An arched strap is nearly as deep as wide, and half a millimetre of surface that is missing at its ends turns its plane: leaf 3
 * was 11 degrees off and said 2.6. */
static void the_error_of_an_arched_strap_tells_how_little_a_plane_is_determined(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    const plm_scan_options options = {.scanner = PLM_SCANNER_SPLAT, .seed = 704, .points = 45000, .noise = 5e-4};
    assert_ok(plm_plant_grow("maize", &(plm_plant_options){.seed = 704}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
    plm_measurement measured = measure(&scan.cloud);
    assert_true(plant.leaf[3].flatness > 0.7);
    for (int32_t leaf = 2; leaf <= 4; leaf++) {
        const plm_estimate found = find(&measured, "leaf_inclination", leaf);
        assert_near(found.value, plm_degrees(plant.leaf[leaf].inclination), 2.5 * found.std_error);
        assert_true(leaf == 3 ? found.std_error > 4 : found.std_error < 2);
    }
    plm_measurement_free(&measured);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(traits_of_a_plane_ellipse_are_those_that_were_built),
        plant_case(a_leaf_with_lobes_beside_its_petiole_begins_where_that_ends),
        cmocka_unit_test(a_petiole_of_a_few_points_has_an_end),
        plant_case(a_blunt_leaf_points_to_the_middle_of_its_end),
        plant_case(a_leaf_that_hangs_beside_itself_ends_at_its_tip),
        cmocka_unit_test(a_blade_alone_has_area_but_no_length),
        cmocka_unit_test(leaves_of_a_rosette_point_away_from_where_petioles_meet),
        plant_case(the_error_of_an_arched_strap_tells_how_little_a_plane_is_determined),
        plant_case(virtual_plants_are_within_the_goals),
    };
    return run_cases(tests);
}
