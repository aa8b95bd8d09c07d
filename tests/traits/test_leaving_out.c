/* What a scene does not need is not run: counted at the functions that would do the work, by the stages of the plan, and by the
 * clock with much slack. The linker sends calls of these functions through the counters (tests/CMakeLists.txt). */
#include "support/test.h"

#include "cloud/all_nearest.h"
#include "io/geographic.h"
#include "io/io.h"
#include "segment/sparse_tips.h"
#include "support/scene.h"
#include "traits/axis.h"
#include "traits/plan.h"

#include <time.h>

enum { POINTS = 60000 };

static struct counts {
    size_t indices, indexed_points, scene_index, all_nearest, segment, clean, stem, surfaces, axes, geographic;
} calls;

static size_t made; /* points of the plant */

struct plm_sketch; /* segment/sketch.h and traits/axis.h have a name in common */

/* Each is called from the library in place of the function of its name, counts, and calls that. */
plm_status __real_plm_index_build(const float (*xyz)[3], size_t count, plm_index **index, plm_error *error);
plm_status __wrap_plm_index_build(const float (*xyz)[3], size_t count, plm_index **index, plm_error *error);
plm_status __wrap_plm_index_build(const float (*xyz)[3], size_t count, plm_index **index, plm_error *error)
{
#pragma omp critical
    {
        calls.indices++;
        if (count > calls.indexed_points) calls.indexed_points = count;
    }
    return __real_plm_index_build(xyz, count, index, error);
}

#define COUNTED(counter, name, parameters, arguments)                                                                  \
    plm_status __real_##name parameters;                                                                               \
    plm_status __wrap_##name parameters;                                                                               \
    plm_status __wrap_##name parameters                                                                                \
    {                                                                                                                  \
        _Pragma("omp atomic") calls.counter++;                                                                         \
        return __real_##name arguments;                                                                                \
    }

COUNTED(all_nearest, plm_all_nearest,
        (const float (*xyz)[3], size_t count, size_t k, plm_neighbour_visit visit, void *user, plm_error *error),
        (xyz, count, k, visit, user, error))
COUNTED(segment, plm_segment,
        (const plm_cloud *cloud, const uint8_t *label, const bool *keep, const plm_segment_options *options,
         plm_segmentation *result, plm_error *error),
        (cloud, label, keep, options, result, error))
COUNTED(clean, plm_clean_but_tips,
        (const plm_cloud *cloud, const uint8_t *label, bool *keep, bool *tip, double *spacing, plm_error *error),
        (cloud, label, keep, tip, spacing, error))
COUNTED(stem, plm_sketch_stem, (struct plm_sketch * sketch, plm_error *error), (sketch, error))
COUNTED(surfaces, plm_leaf_surface_make,
        (const float (*xyz)[3], size_t count, const plm_surface_options *options, plm_leaf_surface *surface,
         plm_error *error),
        (xyz, count, options, surface, error))
COUNTED(scene_index, plm_scene_index, (plm_scene * scene, plm_error *error), (scene, error))
COUNTED(axes, plm_scene_fit_axes, (plm_scene * scene, plm_error *error), (scene, error))
COUNTED(geographic, plm_geographic_to_geodetic,
        (const plm_crs *crs, double (*point)[3], size_t count, plm_error *error), (crs, point, count, error))
COUNTED(geographic, plm_geographic_to_earth, (double (*point)[3], size_t count, plm_error *error),
        (point, count, error))

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A plant with a stem and leaves, measured. Gives the processor time; the counts are those of this plant. */
static double measure(const char *traits, bool is_labelled, plm_habit habit, plm_plan *plan)
{
    plm_error error = {0};
    const test_scene scene = {
        .points = POINTS, .leaf_length = 0.3, .spacing = 0.005, .seed = 3, .rosette = habit == PLM_HABIT_ROSETTE};
    plm_cloud cloud;
    assert_ok(test_scene_make(&scene, &cloud, &error));
    made = cloud.count;
    if (!is_labelled) {
        plm_free(cloud.label);
        plm_free(cloud.organ);
        cloud.label = NULL;
        cloud.organ = NULL;
    }
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    options.habit = habit;
    options.up = PLM_UP_Z;
    plm_measurement plant;
    calls = (struct counts){0};
    const double begin = seconds();
    assert_ok(plm_measure(&cloud, &options, &plant, &error));
    const double taken = seconds() - begin;
    *plan = plant.plan;
    for (size_t i = 0; i < plan->stage_count; i++)
        if (!plan->stage[i].runs) assert_true(plan->stage[i].why[0] && plan->stage[i].seconds == 0);
    plm_measurement_free(&plant);
    return taken;
}

/* Cleaning has a small index of its own, over a thinned copy of at most some 80 000 points (segment/clean.c); a cloud whose
 * labels make cleaning needless has none but those of the bands at the top and the foot. */
static void a_height_alone_touches_no_index_of_the_cloud(void **unused)
{
    (void)unused;
    plm_plan plan;
    const double height = measure("plant_height", false, PLM_HABIT_UNKNOWN, &plan);
    assert_int_equal(calls.scene_index, 0);
    assert_int_equal(calls.segment + calls.surfaces + calls.axes, 0);
    assert_false(plan.stage[PLM_STAGE_INDEX].runs);
    measure("plant_height", true, PLM_HABIT_UNKNOWN, &plan);
    print_message("%zu points, the largest index for a height has %zu\n", made, calls.indexed_points);
    assert_int_equal(calls.scene_index + calls.clean + calls.all_nearest, 0);
    assert_true(calls.indexed_points < made / 4);
    const double all = measure(NULL, false, PLM_HABIT_UNKNOWN, &plan);
    assert_true(calls.indexed_points >= made / 2); /* the counters do count */
    assert_int_equal(calls.scene_index, 1);
    assert_int_equal(calls.segment, 1);
    assert_int_equal(calls.clean, 1);
    assert_int_equal(calls.axes, 1);
    assert_true(calls.surfaces > 0);
    print_message("%zu points: height %.3f s, all traits %.3f s\n", made, height, all);
    assert_true(height < 0.5 * all);
}

static void labels_that_came_along_are_not_found_again(void **unused)
{
    (void)unused;
    plm_plan plan;
    measure("leaf_count,leaf_area", true, PLM_HABIT_UNKNOWN, &plan);
    assert_int_equal(calls.segment + calls.clean + calls.stem, 0);
    assert_true(calls.surfaces > 0);
    assert_false(plan.stage[PLM_STAGE_SEGMENT].runs);
    assert_int_equal(calls.axes, 0); /* nobody asked for a stem */
}

static void a_rosette_has_no_search_for_a_stem(void **unused)
{
    (void)unused;
    plm_plan plan;
    measure("leaf_count", false, PLM_HABIT_ROSETTE, &plan);
    assert_int_equal(calls.segment, 1);
    assert_int_equal(calls.stem, 0);
    assert_int_equal(calls.axes, 0);
    measure("leaf_count", false, PLM_HABIT_UNKNOWN, &plan);
    assert_int_equal(calls.stem, 1);
}

static void no_place_on_the_earth_is_worked_out_unasked(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    static const char text[] = "500000 5000000 10\n500001 5000000 10\n500000 5000001 11\n";
    calls = (struct counts){0};
    assert_ok(plm_cloud_parse(text, sizeof text - 1, "far", NULL, &cloud, NULL, &error));
    plm_plan plan;
    measure(NULL, true, PLM_HABIT_UNKNOWN, &plan);
    assert_int_equal(calls.geographic, 0);
    const plm_crs crs = {.utm_zone = 33};
    plm_georeference reference;
    assert_ok(plm_cloud_georeference(&cloud, &crs, &reference, &error));
    assert_true(calls.geographic > 0); /* the counters do count */
    plm_cloud_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_height_alone_touches_no_index_of_the_cloud),
        cmocka_unit_test(labels_that_came_along_are_not_found_again),
        cmocka_unit_test(a_rosette_has_no_search_for_a_stem),
        cmocka_unit_test(no_place_on_the_earth_is_worked_out_unasked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
