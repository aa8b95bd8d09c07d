/* Zenith: told by ground or stems whatever axis is up, z where nothing tells. */
#include "support/test.h"

#include "cloud/linear.h"
#include "io/io.h"
#include "segment/frame.h"
#include "segment/segment.h"
#include "support/scene.h"

static const test_scene plant = {.points = 100000, .leaf_length = 0.35, .noise = 0.001, .spacing = 0.008, .seed = 5};

/* Turns a cloud that stands along z so that the given direction is up. */
static void lay(plm_cloud *cloud, const double up[3])
{
    double u[3], v[3];
    plm_frame_of_axis(up, u, v);
    for (size_t i = 0; i < cloud->count; i++) {
        const float x = cloud->xyz[i][0], y = cloud->xyz[i][1], z = cloud->xyz[i][2];
        for (int a = 0; a < 3; a++) cloud->xyz[i][a] = (float)(x * u[a] + y * v[a] + z * up[a]);
    }
}

static void axis_direction(plm_up up, double direction[3])
{
    const int axis = (int)up - PLM_UP_X;
    for (int i = 0; i < 3; i++) direction[i] = i == axis % 3 ? (axis < 3 ? 1 : -1) : 0;
}

static double distance_from_rotation(const plm_frame *frame)
{
    double worst = 0, cross[3];
    plm_cross(frame->rotation[0], frame->rotation[1], cross);
    for (int i = 0; i < 3; i++) {
        worst = fmax(worst, fabs(cross[i] - frame->rotation[2][i]));
        worst = fmax(worst, fabs(plm_norm(frame->rotation[i]) - 1));
    }
    return fmax(worst, fabs(plm_dot(frame->rotation[0], frame->rotation[1])));
}

static void what_the_caller_says_is_taken(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(1, PLM_HAS_NORMAL, &cloud, &error));
    for (plm_up up = PLM_UP_X; up <= PLM_UP_MINUS_Z; up++) {
        double direction[3];
        axis_direction(up, direction);
        for (int i = 0; i < 3; i++) {
            cloud.origin[i] = 1e6 * direction[i];
            cloud.xyz[0][i] = (float)(2 * direction[i]);
            cloud.normal[0][i] = (float)direction[i];
        }
        plm_frame frame;
        assert_ok(plm_find_up(&cloud, up, &frame, &error));
        assert_int_equal(frame.up, up);
        assert_string_equal(frame.evidence, "given");
        assert_true(frame.confidence == 1 && distance_from_rotation(&frame) == 0);
        plm_frame_apply(&frame, &cloud);
        const double expected[3] = {0, 0, 1};
        for (int i = 0; i < 3; i++) {
            assert_true(cloud.origin[i] == 1e6 * expected[i]);
            assert_true(cloud.xyz[0][i] == 2 * expected[i] && cloud.normal[0][i] == expected[i]);
        }
    }
    plm_frame frame = {.evidence = "untouched"};
    assert_int_equal(plm_find_up(&cloud, (plm_up)7, &frame, &error), PLM_E_ARGUMENT);
    cloud.count = 0;
    assert_int_equal(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error), PLM_E_DEGENERATE);
    assert_string_equal(frame.evidence, "untouched");
    plm_cloud_free(&cloud);
}

static void stems_and_pots_tell_any_axis(void **unused)
{
    (void)unused;
    plm_error error = {0};
    for (int pot = 0; pot < 2; pot++)
        for (plm_up up = PLM_UP_X; up <= PLM_UP_MINUS_Z; up++) {
            test_scene s = plant;
            if (pot) s.pot_radius = 0.25, s.pot_height = 0.4, s.table_radius = 0.4;
            plm_cloud cloud;
            plm_frame frame;
            double direction[3];
            axis_direction(up, direction);
            assert_ok(test_scene_make(&s, &cloud, &error));
            lay(&cloud, direction);
            assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
            assert_int_equal(frame.up, up);
            assert_string_equal(frame.evidence, pot ? "ground" : "tubes");
            assert_true(frame.confidence > 0.5 && frame.confidence <= 1);
            plm_cloud_free(&cloud);
        }
}

/* 8 degrees are a tilted table, and z stays up; 40 degrees are another frame. */
static void a_tilted_table_keeps_its_axis_until_it_is_another_frame(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static const double tilt[] = {8, 40};
    for (int i = 0; i < 2; i++) {
        test_scene s = plant;
        s.pot_radius = 0.25, s.pot_height = 0.4, s.table_radius = 0.5;
        const double up[3] = {sin(plm_radians(tilt[i])), 0, cos(plm_radians(tilt[i]))};
        plm_cloud cloud;
        plm_frame frame;
        assert_ok(test_scene_make(&s, &cloud, &error));
        lay(&cloud, up);
        assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
        assert_int_equal(frame.up, i ? PLM_UP_AUTO : PLM_UP_Z);
        assert_near(plm_degrees(acos(plm_dot(frame.rotation[2], up))), i ? 0 : 8, 1);
        assert_near(distance_from_rotation(&frame), 0, 1e-12);
        plm_cloud_free(&cloud);
    }
}

static void where_nothing_tells_z_is_up(void **unused)
{
    (void)unused;
    plm_error error = {0};
    test_scene s = plant;
    s.rosette = true;
    plm_cloud cloud;
    plm_frame frame;
    assert_ok(test_scene_make(&s, &cloud, &error));
    assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
    assert_int_equal(frame.up, PLM_UP_Z);
    for (size_t i = 0; i < cloud.count; i++) cloud.xyz[i][1] *= 0.3f; /* the petioles run along x: they are no stem */
    plm_posture posture;
    assert_ok(plm_find_posture(&cloud, &posture, &error));
    assert_true(posture.along[0] > 0.7 && posture.along[2] < 0.2);
    assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
    assert_int_equal(frame.up, PLM_UP_Z);
    plm_cloud_free(&cloud);
    uint64_t state = 1;
    for (int kind = 0; kind < 3; kind++)
        for (size_t count = 1; count < 2000; count = count < 20 ? count + 1 : count * 9) {
            assert_ok(plm_cloud_create(count, 0, &cloud, &error));
            for (size_t i = 0; i < count; i++)
                for (int a = 0; a < 3; a++)
                    cloud.xyz[i][a] = kind == 0 ? 3 : kind == 1 ? (float)i : (float)test_uniform(&state);
            assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
            assert_int_equal(frame.up, PLM_UP_Z);
            assert_true(frame.confidence < 0.5);
            plm_cloud_free(&cloud);
        }
}

static void clouds_with_known_truth_stand_up(void **unused)
{
    (void)unused;
    static const char *name[] = {"eggplant_11_rgbd", "arabidopsis_24_rgbd_pot", "soybean_33_splat"};
    static const plm_up side[] = {PLM_UP_Z, PLM_UP_Y, PLM_UP_MINUS_X};
    const char *folder = test_data_folder();
    if (!folder) skip();
    plm_error error = {0};
    for (size_t i = 0; i < COUNT(name); i++)
        for (size_t k = 0; k < COUNT(side); k++) {
            char path[600];
            snprintf(path, sizeof path, "%s/dev/%s.ply", folder, name[i]);
            plm_cloud cloud;
            plm_frame frame;
            double direction[3];
            axis_direction(side[k], direction);
            assert_ok(plm_cloud_read(path, NULL, &cloud, NULL, &error));
            lay(&cloud, direction);
            assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
            assert_int_equal(frame.up, side[k]);
            plm_cloud_free(&cloud);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_the_caller_says_is_taken),
        cmocka_unit_test(stems_and_pots_tell_any_axis),
        cmocka_unit_test(a_tilted_table_keeps_its_axis_until_it_is_another_frame),
        cmocka_unit_test(where_nothing_tells_z_is_up),
        cmocka_unit_test(clouds_with_known_truth_stand_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
