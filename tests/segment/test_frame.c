/* Zenith: told by ground or stems whatever axis is up, z where nothing tells. */
#include "support/test.h"

#include "cloud/linear.h"
#include "io/io.h"
#include "segment/frame.h"
#include "segment/segment.h"
#include "support/scene.h"
#include "support/virtual_plant.h"

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
            /* Leaves sit all along this stem: upside down it is not clear enough against z. */
            const bool unclear = !pot && up == PLM_UP_MINUS_Z;
            assert_int_equal(frame.up, unclear ? PLM_UP_Z : up);
            assert_string_equal(frame.evidence, pot ? "ground" : unclear ? "default" : "posture");
            assert_true(unclear ? frame.confidence <= 0.3 : frame.confidence > 0.5 && frame.confidence <= 1);
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
    assert_true(posture.sign[0][PLM_SIGN_LINES] > 0.7 && posture.sign[2][PLM_SIGN_LINES] < 0.3);
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

/* A rod of height 1 with a disc of radius 0.5 on it: ways from its foot to the disc turn once, those from the disc's rim
 * do not turn until they reach the rod. */
static void the_signs_of_an_umbrella_are_known(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    plm_posture posture;
    uint64_t state = 7;
    double expected = 0;
    assert_ok(plm_cloud_create(8000, 0, &cloud, &error));
    for (size_t i = 0; i < cloud.count; i++) {
        const bool on_rod = i % 8 == 0;
        const double angle = 2 * PLM_PI * test_uniform(&state),
                     reach = on_rod ? 0.02 : 0.5 * sqrt(test_uniform(&state)),
                     height = on_rod ? test_uniform(&state) : 1;
        cloud.xyz[i][0] = (float)(reach * cos(angle));
        cloud.xyz[i][1] = (float)(reach * sin(angle));
        cloud.xyz[i][2] = (float)height;
        if (!on_rod) expected += log((1 + reach) / hypot(1, reach)) / (7.0 / 8 * (double)cloud.count);
    }
    assert_ok(plm_find_posture(&cloud, &posture, &error));
    const double *up = posture.sign[2], *down = posture.sign[5], *side = posture.sign[0];
    assert_true(posture.is_known);
    assert_true(up[PLM_SIGN_LINES] > 0.8 && up[PLM_SIGN_LINES] == down[PLM_SIGN_LINES] && side[PLM_SIGN_LINES] < 0.1);
    assert_true(up[PLM_SIGN_FLAT] > 0.7 && up[PLM_SIGN_FLAT] == down[PLM_SIGN_FLAT] && side[PLM_SIGN_FLAT] < 0.3);
    assert_near(up[PLM_SIGN_TOP], 0.5 - 0.5 / 8, 0.03);
    assert_near(down[PLM_SIGN_TOP], -up[PLM_SIGN_TOP], 1e-5);
    assert_near(side[PLM_SIGN_TOP], 0, 0.02);
    assert_near(up[PLM_SIGN_ASIDE], 0, 0.03);
    assert_near(up[PLM_SIGN_DETOUR], expected, 0.06); /* ways along the graph are a little longer than straight ones */
    plm_frame frame; /* a disc so nearly flat could be ground, and the plant would stand on its head */
    for (size_t i = 0; i < cloud.count; i++)
        if (i % 8) cloud.xyz[i][2] += 0.02F * sinf(6 * cloud.xyz[i][0]);
    assert_ok(plm_find_up(&cloud, PLM_UP_AUTO, &frame, &error));
    assert_int_equal(frame.up, PLM_UP_Z);
    assert_string_equal(frame.evidence, "posture");
    plm_cloud_free(&cloud);
}

static void cut_out(plm_cloud *cloud, double low, double high)
{
    size_t kept = 0;
    for (size_t i = 0; i < cloud->count; i++)
        if (!(cloud->xyz[i][2] > low && cloud->xyz[i][2] < high))
            memcpy(cloud->xyz[kept++], cloud->xyz[i], sizeof *cloud->xyz);
    cloud->count = kept;
}

/* Ways bridge a gap in the scan of a stem; where it is too wide, a foot that leads nowhere is not better for it. */
static void a_gap_in_the_stem_does_not_shorten_ways(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    plm_posture whole, cut;
    assert_ok(test_scene_make(&plant, &cloud, &error));
    assert_ok(plm_find_posture(&cloud, &whole, &error));
    cut_out(&cloud, 0.12, 0.2);
    assert_ok(plm_find_posture(&cloud, &cut, &error));
    assert_near(cut.sign[2][PLM_SIGN_DETOUR], whole.sign[2][PLM_SIGN_DETOUR], 0.05);
    cut_out(&cloud, 0.12, 0.33);
    assert_ok(plm_find_posture(&cloud, &cut, &error));
    assert_true(cut.sign[2][PLM_SIGN_DETOUR] > whole.sign[2][PLM_SIGN_DETOUR]);
    plm_cloud_free(&cloud);
}

static plm_up up_of(const plm_cloud *cloud, plm_up side, const char **evidence)
{
    plm_error error = {0};
    plm_cloud turned;
    plm_frame frame;
    double direction[3];
    axis_direction(side, direction);
    assert_ok(plm_cloud_create(cloud->count, 0, &turned, &error));
    memcpy(turned.xyz, cloud->xyz, cloud->count * sizeof *turned.xyz);
    lay(&turned, direction);
    assert_ok(plm_find_up(&turned, PLM_UP_AUTO, &frame, &error));
    plm_cloud_free(&turned);
    *evidence = frame.evidence;
    return frame.up;
}

/* Rosettes and noisy plants, not clean stems alone; a single leaf tells nothing, and a blade is no ground. */
static void virtual_plants_tell_any_axis(void **unused)
{
    (void)unused;
    static const struct {
        const char *kind, *evidence;
        plm_scan_options scan;
        plm_up side[2], up[2];
    } known[] = {
        {"arabidopsis",
         "posture",
         {.scanner = PLM_SCANNER_DOME, .seed = 9101, .points = 30000},
         {PLM_UP_X, PLM_UP_MINUS_Y},
         {PLM_UP_X, PLM_UP_MINUS_Y}},
        {"cucumber",
         "posture",
         {.scanner = PLM_SCANNER_RGBD, .seed = 9002, .points = 45000, .noise = 0.0005, .outliers = 0.005},
         {PLM_UP_Y, PLM_UP_Z},
         {PLM_UP_Y, PLM_UP_Z}},
        {"tomato",
         "posture",
         {.scanner = PLM_SCANNER_RGBD, .seed = 9101, .points = 45000, .noise = 0.0005, .outliers = 0.005},
         {PLM_UP_MINUS_X, PLM_UP_MINUS_Z},
         {PLM_UP_MINUS_X, PLM_UP_MINUS_Z}},
        {"single_leaf",
         "default",
         {.scanner = PLM_SCANNER_DOME, .seed = 35, .points = 20000},
         {PLM_UP_Z, PLM_UP_X},
         {PLM_UP_Z, PLM_UP_Z}},
    };
    for (size_t i = 0; i < COUNT(known); i++) {
        virtual_plant made = virtual_plant_make(known[i].kind, 1, &known[i].scan);
        for (int k = 0; k < 2; k++) {
            const char *evidence;
            assert_int_equal(up_of(&made.scan.cloud, known[i].side[k], &evidence), known[i].up[k]);
            assert_string_equal(evidence, known[i].evidence);
        }
        virtual_plant_free(&made);
    }
}

static void clouds_with_known_truth_stand_up(void **unused)
{
    (void)unused;
    static const char *name[] = {"dev/eggplant_11_rgbd.ply", "dev/arabidopsis_24_rgbd_pot.ply",
                                 "dev/soybean_33_splat.ply", "real/maize_pot/plant_9.rgb.xyz"};
    static const plm_up side[] = {PLM_UP_Z, PLM_UP_Y, PLM_UP_MINUS_X};
    const char *folder = test_data_folder();
    if (!folder) skip();
    plm_error error = {0};
    for (size_t i = 0; i < COUNT(name); i++)
        for (size_t k = 0; k < COUNT(side); k++) {
            char path[600];
            snprintf(path, sizeof path, "%s/%s", folder, name[i]);
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
        plant_case(stems_and_pots_tell_any_axis),
        cmocka_unit_test(a_tilted_table_keeps_its_axis_until_it_is_another_frame),
        cmocka_unit_test(where_nothing_tells_z_is_up),
        cmocka_unit_test(the_signs_of_an_umbrella_are_known),
        cmocka_unit_test(a_gap_in_the_stem_does_not_shorten_ways),
        plant_case(virtual_plants_tell_any_axis),
        plant_case(clouds_with_known_truth_stand_up),
    };
    return run_cases(tests);
}
