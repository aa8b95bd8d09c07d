/* projected_area: the shadow of the measured surfaces from above. */
#include "support/test.h"

#include "simulate/simulate.h"
#include "traits/traits.h"

static const double PI = 3.14159265358979;

/* projected_area of the cloud, which is freed. */
static plm_estimate shadow_of(plm_cloud *cloud)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measurement m;
    plm_measure_defaults(&options);
    options.traits = "projected_area";
    options.up = PLM_UP_Z;
    options.ground = PLM_GROUND_NONE;
    assert_ok(plm_measure(cloud, &options, &m, &error));
    assert_int_equal(m.value_count, 1);
    const plm_estimate made = m.value[0].estimate;
    assert_int_equal(made.state, PLM_STATE_OK);
    plm_measurement_free(&m);
    return made;
}

static void put(plm_cloud *cloud, size_t at, const double xyz[3], plm_label label, int32_t organ)
{
    for (int k = 0; k < 3; k++) cloud->xyz[at][k] = (float)xyz[k];
    cloud->label[at] = label;
    cloud->organ[at] = organ;
}

/* Two level leaves of 4 x 4 cm, one over a half of the other; an upright stem of 6 mm across beside them; and a level square
 * of 2.1 x 2.1 cm beside the stem, as pieces that are too small for surfaces. */
static void leaves_stems_and_the_rest_cast_their_shadow(void **unused)
{
    (void)unused;
    enum { SIDE = 81, AROUND = 24, RINGS = 201, REST = 42 };
    plm_error error = {0};
    plm_cloud cloud;
    size_t at = 0;
    assert_ok(plm_cloud_create(2 * SIDE * SIDE + AROUND * RINGS + REST * REST, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud,
                               &error));
    for (int leaf = 0; leaf < 2; leaf++)
        for (int i = 0; i < SIDE; i++)
            for (int j = 0; j < SIDE; j++)
                put(&cloud, at++, (double[3]){0.01 + 0.02 * leaf + 5e-4 * i, 5e-4 * (j - SIDE / 2), 0.1 + 0.02 * leaf},
                    PLM_LABEL_LEAF, leaf);
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < AROUND; j++) {
            const double angle = 2 * PI * j / AROUND;
            put(&cloud, at++, (double[3]){3e-3 * cos(angle), 3e-3 * sin(angle), 5e-4 * i}, PLM_LABEL_STEM, 0);
        }
    for (int i = 0; i < REST; i++)
        for (int j = 0; j < REST; j++)
            put(&cloud, at++, (double[3]){-0.0235 + 5e-4 * i, 5e-4 * (j - REST / 2), 0.1}, PLM_LABEL_LEAF,
                2 + i / 3 + REST / 3 * (j / 3));
    const plm_estimate made = shadow_of(&cloud);
    const double truth = 0.06 * 0.04 + PI * 9e-6 + 0.021 * 0.021;
    print_message("%.3f cm2 of %.3f, standard error %.3f\n", 1e4 * made.value, 1e4 * truth, 1e4 * made.std_error);
    assert_near(made.value, truth, 0.012 * truth);
    assert_true(fabs(made.value - truth) < 3 * made.std_error);
}

/* A tube about the x axis, 2 mm across. */
static size_t put_level_tube(plm_cloud *cloud, size_t at, double x, double y, plm_label label)
{
    enum { AROUND = 16, RINGS = 61 };
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < AROUND; j++) {
            const double angle = 2 * PI * j / AROUND;
            put(cloud, at++, (double[3]){x + 5e-4 * i, y + 1e-3 * cos(angle), 0.05 + 1e-3 * sin(angle)}, label, 0);
        }
    return at;
}

/* A surface does not stand for points of its organ that lie elsewhere: two strands of one petiole, of which no tube is about both. And a
 * stem alone has a standard error. */
static void points_off_the_surface_of_their_organ_count(void **unused)
{
    (void)unused;
    enum { TUBE = 16 * 61 };
    for (int strands = 1; strands <= 2; strands++) {
        plm_error error = {0};
        plm_cloud cloud;
        const plm_label label = strands == 1 ? PLM_LABEL_STEM : PLM_LABEL_PETIOLE;
        size_t at = 0;
        assert_ok(plm_cloud_create((size_t)strands * TUBE, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
        for (int k = 0; k < strands; k++) at = put_level_tube(&cloud, at, 0.01 * k, 0.012 * k, label);
        const plm_estimate made = shadow_of(&cloud);
        const double truth = strands * 0.03 * 0.002;
        print_message("%d strands: %.3f cm2 of %.3f, standard error %.3f, %s\n", strands, 1e4 * made.value, 1e4 * truth,
                      1e4 * made.std_error, made.method);
        assert_near(made.value, truth, 0.15 * truth);
        assert_true(fabs(made.value - truth) < 3 * made.std_error && made.std_error < 0.2 * truth);
    }
}

typedef struct shadow_case {
    const char *kind;
    plm_scanner scanner;
    double most, before; /* error in %: bound, and of points closed by a disc */
} shadow_case;

/* Narrow parts that lie apart ran together, and noise made rims wider than its SD tells. */
static void shadows_of_virtual_plants_are_known(void **unused)
{
    (void)unused;
    static const shadow_case cases[] = {{"tomato", PLM_SCANNER_DOME, 1.2, 4.4},
                                        {"tomato", PLM_SCANNER_RGBD, 4, 12.5},
                                        {"cucumber", PLM_SCANNER_RGBD, 1.5, 3.6},
                                        {"eggplant", PLM_SCANNER_SPLAT, 1.5, 0.7}};
    for (size_t k = 0; k < COUNT(cases); k++) {
        plm_error error = {0};
        plm_virtual_plant plant;
        plm_scan scan;
        const plm_scan_options options = {.scanner = cases[k].scanner,
                                          .seed = 48001,
                                          .points = 40000,
                                          .noise = cases[k].scanner == PLM_SCANNER_DOME ? 0 : 4e-4,
                                          .views = 12};
        const plm_plant_options grow = {.seed = 48001};
        assert_ok(plm_plant_grow(cases[k].kind, &grow, &plant, &error));
        assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
        const double truth = plant.whole.projected_area;
        const plm_estimate made = shadow_of(&scan.cloud);
        const double off = 100 * (made.value / truth - 1);
        print_message("%s: %+.2f %% (%.1f before), %.1f standard errors\n", cases[k].kind, off, cases[k].before,
                      (made.value - truth) / made.std_error);
        assert_true(fabs(off) < cases[k].most);
        assert_true(fabs(made.value - truth) < 3 * made.std_error);
        scan.cloud = (plm_cloud){0};
        plm_scan_free(&scan);
        plm_virtual_plant_free(&plant);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leaves_stems_and_the_rest_cast_their_shadow),
        cmocka_unit_test(points_off_the_surface_of_their_organ_count),
        cmocka_unit_test(shadows_of_virtual_plants_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
