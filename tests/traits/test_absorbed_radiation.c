/* absorbed_radiation runs only where it is named, on the measured surfaces, by the ray tracer that the caller gives. */
#include "support/test.h"

#include "traits/plan.h"

/** What the ray tracer was shown. */
static struct {
    int calls;
    double area[8];
} seen;

/* Absorbs 100 W/m2 of each face, with an error of 1 %. */
static plm_status lamp(const plm_mesh *mesh, const int32_t *face_group, size_t group_count, uint64_t seed,
                       double *group_power, double *group_std_error, double *power, double *std_error, plm_error *error)
{
    (void)seed;
    *power = 0;
    for (size_t g = 0; g < group_count; g++) group_power[g] = seen.area[g] = 0;
    for (size_t f = 0; f < mesh->triangle_count; f++) {
        double area;
        plm_mesh face = *mesh;
        face.triangle = mesh->triangle + f;
        face.triangle_count = 1;
        assert_int_equal(plm_mesh_area(&face, &area, error), PLM_OK);
        seen.area[face_group[f]] += area;
        group_power[face_group[f]] += 100 * area;
        *power += 100 * area;
    }
    for (size_t g = 0; g < group_count; g++) group_std_error[g] = 0.01 * group_power[g];
    *std_error = 0.01 * *power;
    seen.calls++;
    return PLM_OK;
}

/* A level square leaf of 4 x 4 cm at a height of 10 cm, and a stem of 6 mm across below it. */
static plm_cloud little_plant(void)
{
    enum { SIDE = 81, AROUND = 24, RINGS = 201 };
    plm_error error = {0};
    plm_cloud cloud;
    size_t at = 0;
    assert_ok(plm_cloud_create(SIDE * SIDE + AROUND * RINGS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++, at++) {
            cloud.xyz[at][0] = 0.0005F * (float)(i - SIDE / 2) + 0.03F;
            cloud.xyz[at][1] = 0.0005F * (float)(j - SIDE / 2);
            cloud.xyz[at][2] = 0.1F;
            cloud.label[at] = PLM_LABEL_LEAF;
            cloud.organ[at] = 0;
        }
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < AROUND; j++, at++) {
            const double angle = 2 * 3.14159265358979 * j / AROUND;
            cloud.xyz[at][0] = (float)(0.003 * cos(angle));
            cloud.xyz[at][1] = (float)(0.003 * sin(angle));
            cloud.xyz[at][2] = 0.0005F * (float)i;
            cloud.label[at] = PLM_LABEL_STEM;
            cloud.organ[at] = 0;
        }
    return cloud;
}

static plm_measurement measured(const char *traits, plm_light_function *light)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measurement measurement;
    plm_cloud cloud = little_plant();
    plm_measure_defaults(&options);
    options.traits = traits;
    options.up = PLM_UP_Z;
    options.ground = PLM_GROUND_NONE;
    options.light = light;
    assert_ok(plm_measure(&cloud, &options, &measurement, &error));
    return measurement;
}

static const plm_estimate *estimate_of(const plm_measurement *measurement, const char *trait)
{
    for (size_t i = 0; i < measurement->value_count; i++)
        if (!strcmp(measurement->value[i].trait->name, trait)) return &measurement->value[i].estimate;
    return NULL;
}

static void it_is_not_run_unless_it_is_named(void **state)
{
    (void)state;
    static const char *const lists[] = {NULL, "all", "leaf", "plant,leaf_area"};
    for (size_t k = 0; k < COUNT(lists); k++) {
        seen.calls = 0;
        plm_measurement measurement = measured(lists[k], lamp);
        assert_int_equal(seen.calls, 0);
        assert_null(estimate_of(&measurement, "absorbed_radiation"));
        assert_null(estimate_of(&measurement, "leaf_absorbed_radiation"));
        assert_false(measurement.plan.stage[PLM_STAGE_LIGHT].runs);
        assert_non_null(strstr(measurement.plan.stage[PLM_STAGE_LIGHT].why, "not asked for"));
        plm_measurement_free(&measurement);
    }
}

static void the_light_falls_on_leaves_and_on_stems_as_tubes(void **state)
{
    (void)state;
    seen.calls = 0;
    plm_measurement measurement = measured("absorbed_radiation,leaf_absorbed_radiation,leaf_area", lamp);
    const plm_estimate *plant = estimate_of(&measurement, "absorbed_radiation"),
                       *leaf = estimate_of(&measurement, "leaf_absorbed_radiation"),
                       *area = estimate_of(&measurement, "leaf_area");
    assert_int_equal(seen.calls, 1);
    assert_int_equal(plant->state, PLM_STATE_OK);
    assert_near(leaf->value, 100 * 0.0016, 0.05 * 0.16); /* the surface without its rim's correction */
    assert_near(seen.area[0], 2 * 3.14159265 * 0.003 * 0.1, 0.05 * 0.0019); /* the stem: the fitted tube */
    assert_near(plant->value, leaf->value + 100 * seen.area[0], 1e-12);
    const double share = area->std_error / area->value;
    assert_near(leaf->std_error, leaf->value * hypot(0.01, share), 1e-12);
    assert_near(plant->std_error, plant->value * hypot(0.01, share), 1e-12);
    plm_measurement_free(&measurement);
}

static void without_a_ray_tracer_it_is_not_applicable(void **state)
{
    (void)state;
    plm_measurement measurement = measured("absorbed_radiation", NULL);
    assert_int_equal(estimate_of(&measurement, "absorbed_radiation")->state, PLM_STATE_NOT_APPLICABLE);
    assert_non_null(strstr(estimate_of(&measurement, "absorbed_radiation")->reason, "no ray tracer"));
    plm_measurement_free(&measurement);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_not_run_unless_it_is_named),
        cmocka_unit_test(the_light_falls_on_leaves_and_on_stems_as_tubes),
        cmocka_unit_test(without_a_ray_tracer_it_is_not_applicable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
