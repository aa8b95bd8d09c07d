/* Axes of stems and petioles: a made-up plant of known angles and lengths, and the labelled development clouds. */
#include "support/test.h"

#include <jansson.h>

#include "cloud/linear.h"
#include "cloud/trust_region.h"
#include "io/io.h"
#include "support/tubes.h"
#include "traits/traits.h"

enum { STEM = 3000, PETIOLE = 500, PETIOLES = 3, POINTS = STEM + PETIOLE * PETIOLES };

static const double stem_radius = 0.002, stem_length = 0.1, petiole_radius = 0.0008, petiole_length = 0.03;
static const double node[PETIOLES] = {0.04, 0.04, 0.07}; /* the first two stand opposite */
static const double inclination[PETIOLES] = {40, 65, 80};

/* A vertical stem and straight petioles that start on its surface. No point lies inside of the stem. */
static plm_cloud plant_with_petioles(double thickness, double noise)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(POINTS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    double(*xyz)[3] = malloc(POINTS * sizeof *xyz);
    assert_non_null(xyz);
    uint64_t state = 21;
    const test_tube stem = {.end = {0, 0, stem_length}, .radius = {stem_radius, stem_radius}, .arc = {0, 2 * PLM_PI}};
    test_tube_points(&stem, STEM, &state, xyz);
    for (int p = 0; p < PETIOLES; p++) {
        const double tilt = plm_radians(inclination[p]), heading = PLM_PI * p + 0.4;
        const double direction[3] = {sin(tilt) * cos(heading), sin(tilt) * sin(heading), cos(tilt)};
        test_tube tube = {.radius = {thickness, thickness}, .arc = {0, 2 * PLM_PI}};
        const double surface[3] = {stem_radius * cos(heading), stem_radius * sin(heading), node[p]};
        for (int k = 0; k < 3; k++) { /* from inside the stem, so that the cut is oblique */
            tube.base[k] = surface[k] - 0.003 * direction[k];
            tube.end[k] = surface[k] + petiole_length * direction[k];
        }
        for (size_t i = STEM + PETIOLE * (size_t)p; i < STEM + PETIOLE * (size_t)(p + 1);) {
            test_tube_points(&tube, 1, &state, xyz + i);
            i += hypot(xyz[i][0], xyz[i][1]) > stem_radius;
        }
    }
    for (size_t i = 0; i < POINTS; i++) {
        for (int k = 0; k < 3; k++) cloud.xyz[i][k] = (float)(xyz[i][k] + noise * test_normal(&state));
        cloud.label[i] = i < STEM ? PLM_LABEL_STEM : PLM_LABEL_PETIOLE;
        cloud.organ[i] = i < STEM ? 0 : (int32_t)((i - STEM) / PETIOLE);
    }
    free(xyz);
    return cloud;
}

static plm_cloud made_plant(double noise)
{
    return plant_with_petioles(petiole_radius, noise);
}

static plm_measurement measure(plm_cloud *cloud)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = "stem,petiole";
    options.up = PLM_UP_Z;
    plm_measurement plant;
    assert_ok(plm_measure(cloud, &options, &plant, &error));
    return plant;
}

static const plm_estimate *find(const plm_measurement *plant, const char *trait, int32_t organ)
{
    for (size_t i = 0; i < plant->value_count; i++)
        if (!strcmp(plant->value[i].trait->name, trait) && plant->value[i].organ_id == organ)
            return &plant->value[i].estimate;
    fail_msg("no %s of organ %d", trait, organ);
    return NULL;
}

static void a_clean_plant_is_measured_to_its_built_angles_and_lengths(void **unused)
{
    (void)unused;
    plm_cloud cloud = made_plant(0);
    plm_measurement plant = measure(&cloud);
    assert_near(find(&plant, "stem_length", 0)->value, stem_length, 2e-4);
    assert_near(find(&plant, "stem_diameter", 0)->value, 2 * stem_radius, 4e-6);
    assert_near(find(&plant, "stem_inclination", 0)->value, 0, plm_radians(0.05));
    for (int p = 0; p < PETIOLES; p++) {
        assert_near(plm_degrees(find(&plant, "petiole_inclination", p)->value), inclination[p], 0.2);
        assert_near(find(&plant, "petiole_length", p)->value, petiole_length, 3e-4);
        assert_near(find(&plant, "petiole_diameter", p)->value, 2 * petiole_radius, 5e-6);
    }
    assert_int_equal(find(&plant, "internode_length", 0)->state, PLM_STATE_NOT_APPLICABLE);
    assert_int_equal(find(&plant, "internode_length", 1)->state, PLM_STATE_NOT_APPLICABLE); /* the same node */
    assert_near(find(&plant, "internode_length", 2)->value, 0.03, 3e-4);
    plm_measurement_free(&plant);
}

/* Every value of a stem tells of the fit behind it; what was not measured tells of none. */
static void fits_tell_steps_condition_and_end(void **unused)
{
    (void)unused;
    plm_cloud cloud = made_plant(0);
    plm_measurement plant = measure(&cloud);
    static const char *const fitted[] = {"stem_diameter", "stem_length", "stem_inclination", "petiole_inclination",
                                         "petiole_diameter"};
    for (size_t i = 0; i < sizeof fitted / sizeof *fitted; i++) {
        const plm_fit_note *fit = &find(&plant, fitted[i], 0)->fit;
        assert_in_range(fit->step_count, 1, 500);
        assert_true(fit->condition >= 1 && fit->condition < 1e6);
        assert_true(!strcmp(fit->end, plm_fit_end_name(PLM_FIT_SMALL_STEP)) ||
                    !strcmp(fit->end, plm_fit_end_name(PLM_FIT_SMALL_GAIN)));
    }
    assert_int_equal(find(&plant, "internode_length", 0)->fit.step_count, 0);
    plm_measurement_free(&plant);
}

/* Points of a blade or ghosts about a petiole fit a wide tube: wider than the stem is no petiole. A little less may be one. */
static void a_tube_wider_than_its_stem_is_no_petioles_diameter(void **unused)
{
    (void)unused;
    for (int wide = 0; wide < 2; wide++) {
        const double radius = (wide ? 1.05 : 0.95) * stem_radius;
        plm_cloud cloud = plant_with_petioles(radius, 0);
        plm_measurement plant = measure(&cloud);
        for (int p = 0; p < PETIOLES; p++) {
            const plm_estimate *diameter = find(&plant, "petiole_diameter", p);
            assert_int_equal(diameter->state, wide ? PLM_STATE_FAILED : PLM_STATE_OK);
            if (wide)
                assert_non_null(strstr(diameter->reason, "wider than the stem"));
            else
                assert_near(diameter->value, 2 * radius, 2e-5);
        }
        plm_measurement_free(&plant);
    }
}

static void noise_is_covered_by_the_standard_errors(void **unused)
{
    (void)unused;
    plm_cloud cloud = made_plant(3e-4);
    plm_measurement plant = measure(&cloud);
    for (size_t i = 0; i < plant.value_count; i++) {
        const plm_trait_value *value = &plant.value[i];
        if (value->estimate.state != PLM_STATE_OK) continue;
        assert_true(value->estimate.std_error > 0);
        if (!strcmp(value->trait->name, "petiole_inclination")) {
            const double off = value->estimate.value - plm_radians(inclination[value->organ_id]);
            assert_true(fabs(off) < 3 * value->estimate.std_error);
            assert_true(value->estimate.std_error < plm_radians(1.5));
        }
    }
    plm_measurement_free(&plant);
}

/* A blade at the end that is nearer to the stem: that end is the junction, and the stem beside it is not the petiole's. */
static void a_petiole_ends_where_its_blade_begins(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    uint64_t state = 8;
    enum { BLADE = 2000 };
    static double xyz[POINTS + BLADE][3];
    assert_ok(plm_cloud_create(STEM + PETIOLE + BLADE, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    const test_tube stem = {.end = {0, 0, stem_length}, .radius = {stem_radius, stem_radius}, .arc = {0, 2 * PLM_PI}};
    const test_tube petiole = {.base = {0.03, 0, 0.05},
                               .end = {0.004, 0, 0.06},
                               .radius = {petiole_radius, petiole_radius},
                               .arc = {0, 2 * PLM_PI}};
    test_tube_points(&stem, STEM, &state, xyz);
    test_tube_points(&petiole, PETIOLE, &state, xyz + STEM);
    for (size_t i = STEM + PETIOLE; i < STEM + PETIOLE + BLADE; i++) {
        xyz[i][0] = 0.004;
        xyz[i][1] = 0.02 * (test_uniform(&state) - 0.5);
        xyz[i][2] = 0.0608 + 0.02 * test_uniform(&state);
    }
    for (size_t i = 0; i < cloud.count; i++) {
        for (int k = 0; k < 3; k++) cloud.xyz[i][k] = (float)xyz[i][k];
        cloud.label[i] = i < STEM ? PLM_LABEL_STEM : i < STEM + PETIOLE ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF;
        cloud.organ[i] = 0;
    }
    plm_measurement plant = measure(&cloud);
    assert_near(plm_degrees(find(&plant, "petiole_inclination", 0)->value), plm_degrees(atan2(0.026, 0.01)), 0.5);
    plm_measurement_free(&plant);
}

/* A petiole that stands beside the stem, whose line passes it by: the farthest place at which a crossing was sought stood for
 * one, and the petiole was 1.2 mm too long. (Its end is cut square, not by a stem: a little of the length is lacking.) */
static void a_line_that_passes_the_stem_by_tells_no_base(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    uint64_t state = 9;
    static double xyz[STEM + PETIOLE][3];
    assert_ok(plm_cloud_create(STEM + PETIOLE, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    const test_tube stem = {.end = {0, 0, stem_length}, .radius = {stem_radius, stem_radius}, .arc = {0, 2 * PLM_PI}};
    const double beside = 1.2 * stem_radius, tilt = plm_radians(65);
    const test_tube petiole = {
        .base = {beside, 0, 0.05},
        .end = {beside, petiole_length * sin(tilt), 0.05 + petiole_length * cos(tilt)},
        .radius = {petiole_radius, petiole_radius},
        .arc = {0, 2 * PLM_PI},
    };
    test_tube_points(&stem, STEM, &state, xyz);
    test_tube_points(&petiole, PETIOLE, &state, xyz + STEM);
    for (size_t i = 0; i < cloud.count; i++) {
        for (int k = 0; k < 3; k++) cloud.xyz[i][k] = (float)xyz[i][k];
        cloud.label[i] = i < STEM ? PLM_LABEL_STEM : PLM_LABEL_PETIOLE, cloud.organ[i] = 0;
    }
    plm_measurement plant = measure(&cloud);
    print_message("length %.2f mm\n", 1e3 * find(&plant, "petiole_length", 0)->value);
    assert_near(find(&plant, "petiole_length", 0)->value, petiole_length, 6e-4);
    plm_measurement_free(&plant);
}

/* The foot of a petiole was not scanned: its line still meets the stem, far behind the first points, and what is lacking is
 * within the standard error. A line that met the stem only beyond the search once passed for one that misses it. */
static void a_foot_that_was_not_seen_is_within_the_error(void **unused)
{
    (void)unused;
    const double gap = 0.003;
    plm_cloud cloud = made_plant(0);
    size_t kept = STEM;
    for (size_t i = STEM; i < cloud.count; i++) {
        const float *xyz = cloud.xyz[i];
        if (hypot((double)xyz[0], (double)xyz[1]) < stem_radius + gap * sin(plm_radians(inclination[cloud.organ[i]])))
            continue;
        memmove(cloud.xyz[kept], xyz, sizeof *cloud.xyz);
        cloud.label[kept] = cloud.label[i], cloud.organ[kept] = cloud.organ[i];
        kept++;
    }
    cloud.count = kept;
    plm_measurement plant = measure(&cloud);
    for (int p = 0; p < PETIOLES; p++) {
        const plm_estimate *length = find(&plant, "petiole_length", p);
        print_message("%.0f degrees: length %.2f +- %.2f mm\n", inclination[p], 1e3 * length->value,
                      1e3 * length->std_error);
        assert_true(fabs(length->value - petiole_length) < 3 * length->std_error);
    }
    plm_measurement_free(&plant);
}

/* A topmost petiole that goes up along the stem's side before it bends outward: where its line crosses the stem's surface is
 * nearly anywhere, and its first points tell the base. */
static void a_petiole_along_the_stem_begins_near_its_first_points(void **unused)
{
    (void)unused;
    enum { RING = 16, RINGS = 100 };
    const double base = 0.092, length = 0.022, before = 0.002;
    plm_error error = {0};
    plm_cloud cloud;
    uint64_t state = 5;
    static double xyz[STEM][3];
    assert_ok(plm_cloud_create(STEM + RING * RINGS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    const test_tube stem = {.end = {0, 0, stem_length}, .radius = {stem_radius, stem_radius}, .arc = {0, 2 * PLM_PI}};
    test_tube_points(&stem, STEM, &state, xyz);
    for (size_t i = 0; i < STEM; i++)
        for (int k = 0; k < 3; k++) cloud.xyz[i][k] = (float)xyz[i][k];
    const double beside = 1.1 * stem_radius;
    double place[3] = {beside, 0, base - before}, end[3] = {0};
    size_t count = STEM;
    for (int ring = 0; ring < RINGS; ring++) {
        const double step = (length + before) / RINGS, s = ring * step - before,
                     turned = 0.02 + 50 * fmax(s - 0.006, 0);
        for (int i = 0; i < RING; i++) {
            const double angle = 2 * PLM_PI * test_uniform(&state), out = petiole_radius * cos(angle);
            const double point[3] = {place[0] + out * cos(turned), petiole_radius * sin(angle),
                                     place[2] - out * sin(turned)};
            if (hypot(point[0], point[1]) < stem_radius && point[2] < stem_length) continue;
            for (int k = 0; k < 3; k++) cloud.xyz[count][k] = (float)point[k];
            count++;
        }
        memcpy(end, place, sizeof end);
        place[0] += step * sin(turned), place[2] += step * cos(turned);
    }
    cloud.count = count;
    for (size_t i = 0; i < count; i++)
        cloud.label[i] = i < STEM ? PLM_LABEL_STEM : PLM_LABEL_PETIOLE, cloud.organ[i] = 0;
    plm_measurement plant = measure(&cloud);
    const double found_inclination = plm_degrees(find(&plant, "petiole_inclination", 0)->value),
                 truth = plm_degrees(atan2(end[0] - beside, end[2] - base));
    print_message("inclination %.2f, in truth %.2f\n", found_inclination, truth);
    assert_near(found_inclination, truth, 1);
    plm_measurement_free(&plant);
}

/* The three points farthest from the middle may be strays to three sides, whose mean is the middle: no end of the petiole. */
static void strays_to_all_sides_are_no_end(void **unused)
{
    (void)unused;
    enum { TUBE = 140, STRAYS = 3, LEAF = 60, ALL = TUBE + STRAYS + LEAF };
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(ALL, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    double xyz[TUBE][3];
    uint64_t state = 3;
    const double tilt = plm_radians(50);
    const test_tube tube = {.base = {-0.005 * sin(tilt), 0, -0.005 * cos(tilt)},
                            .end = {0.005 * sin(tilt), 0, 0.005 * cos(tilt)},
                            .radius = {5e-4, 5e-4},
                            .arc = {0, 2 * PLM_PI}};
    test_tube_points(&tube, TUBE, &state, xyz);
    for (int i = 0; i < ALL; i++) {
        const int s = i - TUBE, b = s - STRAYS;
        for (int k = 0; k < 3; k++) cloud.xyz[i][k] = i < TUBE ? (float)xyz[i][k] : 0;
        if (i >= TUBE)
            cloud.xyz[i][0] = (float)(s < STRAYS ? 0.008 * cos(2.0 * PLM_PI * s / STRAYS) : 0.012 + 1e-4 * b);
        if (i >= TUBE) cloud.xyz[i][1] = (float)(s < STRAYS ? 0.008 * sin(2.0 * PLM_PI * s / STRAYS) : 1e-3 * (b % 7));
        if (s >= STRAYS) cloud.xyz[i][2] = 0.008F;
        cloud.label[i] = s < STRAYS ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF;
        cloud.organ[i] = 0;
    }
    plm_measurement plant = measure(&cloud);
    const plm_estimate *angle = find(&plant, "petiole_inclination", 0);
    assert_int_equal(angle->state, PLM_STATE_OK);
    assert_near(angle->value, tilt, plm_radians(5));
    plm_measurement_free(&plant);
    plm_cloud_free(&cloud);
}

static void the_order_of_rows_does_not_matter(void **unused)
{
    (void)unused;
    plm_cloud one = made_plant(2e-4), other = made_plant(2e-4);
    for (size_t i = 0; i < POINTS; i++) /* the same points, backwards */
        for (int k = 0; k < 3; k++) other.xyz[i][k] = one.xyz[POINTS - 1 - i][k];
    for (size_t i = 0; i < POINTS; i++) {
        other.label[i] = one.label[POINTS - 1 - i];
        other.organ[i] = one.organ[POINTS - 1 - i];
    }
    plm_measurement a = measure(&one), b = measure(&other);
    assert_int_equal(a.value_count, b.value_count);
    for (size_t i = 0; i < a.value_count; i++) {
        assert_int_equal(a.value[i].estimate.state, b.value[i].estimate.state);
        if (a.value[i].estimate.state != PLM_STATE_OK) continue;
        const double value = a.value[i].estimate.value;
        assert_near(b.value[i].estimate.value, value, 1e-6 * fabs(value) + 1e-12);
    }
    plm_measurement_free(&a);
    plm_measurement_free(&b);
}

/* ---- The development clouds ------------------------------------------------------------------------------------ */

typedef struct tally {
    double squares;
    int count, covered;
} tally;

static void add(tally *sum, const plm_estimate *estimate, double truth, double factor)
{
    if (estimate->state != PLM_STATE_OK) return;
    const double off = estimate->value * factor - truth;
    sum->squares += off * off;
    sum->covered += fabs(off) < 1.96 * factor * estimate->std_error;
    sum->count++;
}

/* Adds a labelled cloud's errors: stems' diameters (mm) and inclinations (degrees) of petioles from 12 mm up. */
static void add_case(const char *folder, const char *name, tally *diameter, tally *angle)
{
    plm_error error = {0};
    char path[4200];
    snprintf(path, sizeof path, "%s/dev/%s.labelled.ply", folder, name);
    const plm_read_options options = {.label_field = "label"};
    plm_cloud cloud;
    assert_ok(plm_cloud_read(path, &options, &cloud, NULL, &error));
    plm_measurement plant = measure(&cloud);
    snprintf(path, sizeof path, "%s/dev/%s.truth.json", folder, name);
    json_t *truth = json_load_file(path, 0, NULL), *organ;
    assert_non_null(truth);
    size_t i;
    json_array_foreach(json_object_get(truth, "organs"), i, organ)
    {
        const char *kind = json_string_value(json_object_get(organ, "organ"));
        const int32_t id = (int32_t)json_integer_value(json_object_get(organ, "organ_id"));
        if (!strcmp(kind, "stem"))
            add(diameter, find(&plant, "stem_diameter", id),
                1e3 * json_number_value(json_object_get(organ, "stem_diameter")), 1e3);
        if (!strcmp(kind, "petiole") && json_number_value(json_object_get(organ, "petiole_length")) > 0.012)
            add(angle, find(&plant, "petiole_inclination", id),
                json_number_value(json_object_get(organ, "petiole_inclination")), plm_degrees(1));
    }
    json_decref(truth);
    plm_measurement_free(&plant);
}

static void labelled_clouds_give_the_true_diameters_and_angles(void **unused)
{
    (void)unused;
    const char *folder = test_data_folder();
    if (!folder) skip();
    static const struct {
        const char *name[3];
        double diameter, angle; /* largest RMSE, mm and degrees */
    } kinds[] = {
        {{"eggplant_11_clean", "pepper_12_clean", "okra_13_clean"}, 0.02, 0.6},
        {{"eggplant_11_rgbd", "cucumber_23_rgbd", "pepper_22_rgbd_pot"}, 0.2, 1.6},
        {{"eggplant_11_3dgs", "okra_32_3dgs", "cucumber_34_splat"}, 0.12, 1.3},
    };
    tally all = {0};
    for (size_t k = 0; k < COUNT(kinds); k++) {
        tally diameter = {0}, angle = {0};
        for (size_t i = 0; i < COUNT(kinds[k].name); i++) add_case(folder, kinds[k].name[i], &diameter, &angle);
        const double diameter_rmse = sqrt(diameter.squares / diameter.count), rmse = sqrt(angle.squares / angle.count);
        print_message("%s and two more: stem diameter RMSE %.3f mm (%d, %d covered), petiole inclination RMSE %.2f "
                      "degrees (%d, %d covered)\n",
                      kinds[k].name[0], diameter_rmse, diameter.count, diameter.covered, rmse, angle.count,
                      angle.covered);
        assert_true(diameter_rmse < kinds[k].diameter);
        assert_true(rmse < kinds[k].angle);
        all.count += angle.count;
        all.covered += angle.covered;
    }
    assert_true(all.covered >= 0.88 * all.count);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clean_plant_is_measured_to_its_built_angles_and_lengths),
        cmocka_unit_test(fits_tell_steps_condition_and_end),
        cmocka_unit_test(a_tube_wider_than_its_stem_is_no_petioles_diameter),
        cmocka_unit_test(a_petiole_ends_where_its_blade_begins),
        cmocka_unit_test(a_line_that_passes_the_stem_by_tells_no_base),
        cmocka_unit_test(a_foot_that_was_not_seen_is_within_the_error),
        cmocka_unit_test(a_petiole_along_the_stem_begins_near_its_first_points),
        cmocka_unit_test(noise_is_covered_by_the_standard_errors),
        cmocka_unit_test(strays_to_all_sides_are_no_end),
        cmocka_unit_test(the_order_of_rows_does_not_matter),
        cmocka_unit_test(labelled_clouds_give_the_true_diameters_and_angles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
