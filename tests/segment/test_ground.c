/* Ground: pots, soil and tables are found, points told apart, and nothing is claimed where there is no ground. */
#include "support/found_ground.h"
#include "support/test.h"

#include "cloud/linear.h"
#include "io/io.h"
#include "segment/segment.h"
#include "simulate/simulate.h"
#include "support/scene.h"

static const test_scene plain = {
    .points = 200000, .leaf_length = 0.35, .noise = 0.001, .outliers = 0.004, .spacing = 0.007, .seed = 5};

static found_ground find_in(const test_scene *scene)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(test_scene_make(scene, &cloud, &error));
    const found_ground o = ground_in(&cloud);
    plm_cloud_free(&cloud);
    return o;
}

/* The bars are the goal of the module: 0.97 of the ground, 0.995 of the plant. */
static void assert_good(found_ground o, const char *what)
{
    if (!o.ground.found || o.iou < 0.97 || o.kept < 0.995)
        fail_msg("%s: found %d, IoU %.4f, plant kept %.4f", what, o.ground.found, o.iou, o.kept);
}

static void a_pot_is_told_from_the_plant(void **unused)
{
    (void)unused;
    for (int i = 0; i < 4; i++) {
        test_scene s = plain;
        s.pot_radius = 0.25, s.pot_height = 0.4, s.rim = i & 1 ? 0.04 : 0, s.square = i > 1;
        const found_ground o = find_in(&s);
        assert_good(o, s.square ? "square pot" : "round pot");
        assert_true(o.ground.has_pot && !o.ground.has_table);
        assert_near(o.ground.soil_height, 0, 0.01); /* half the pot's spacing of patches */
        assert_near(o.ground.rim_height, s.rim, 0.012);
        if (!s.square) assert_near(o.ground.pot_diameter, 0.5, 0.01); /* 2 % */
        assert_near(hypot(o.ground.pot_centre[0], o.ground.pot_centre[1]), 0, 0.01);
    }
}

static void a_pot_on_a_table_is_told_from_both(void **unused)
{
    (void)unused;
    test_scene s = plain;
    s.pot_radius = 0.22, s.pot_height = 0.35, s.rim = 0.03, s.table_radius = 0.45;
    const found_ground o = find_in(&s);
    assert_good(o, "pot on a table");
    assert_true(o.ground.has_pot && o.ground.has_table);
    assert_near(o.ground.table_height, 0.03 - 0.35, 0.01);
}

static void soil_without_a_pot_is_found(void **unused)
{
    (void)unused;
    test_scene s = plain;
    s.table_radius = 0.5;
    for (int i = 0; i < 3; i++) {
        s.noise = 0.002 * i;
        const found_ground o = find_in(&s);
        assert_good(o, "soil");
        assert_false(o.ground.has_pot);
        assert_near(o.ground.soil_height, 0, 0.01);
    }
}

static void a_rosette_over_the_rim_stays_a_plant(void **unused)
{
    (void)unused;
    test_scene s = plain;
    s.rosette = true, s.leaf_length = 0.3, s.pot_radius = 0.25, s.pot_height = 0.4, s.spacing = 0.005;
    const found_ground o = find_in(&s);
    assert_true(o.ground.found && o.ground.has_pot);
    assert_true(o.iou > 0.97 && o.kept > 0.99); /* petioles start in the soil */
}

static void plants_without_ground_claim_none(void **unused)
{
    (void)unused;
    for (int i = 0; i < 8; i++) {
        test_scene s = plain;
        s.rosette = i & 1, s.flat_leaves = i & 2, s.leaf_length = i & 4 ? 0.5 : 0.3;
        const found_ground o = find_in(&s);
        if (o.ground.found) fail_msg("case %d: ground was claimed", i);
    }
    test_scene s = plain;
    s.leaf_length = 0;
    assert_false(find_in(&s).ground.found); /* a bare stem */
}

/* A rosette so flat that it passes for rough soil, with young leaves of another green at its middle. */
static void a_flat_rosette_is_no_ground(void **unused)
{
    (void)unused;
    const plm_scan_options scan = {
        .scanner = PLM_SCANNER_UNIFORM, .seed = 764, .points = 8000, .noise = 0.0005, .outliers = 0.005};
    assert_false(ground_in_plant("arabidopsis", &scan, true).ground.found);
}

/* The lowest leaf of a head is flat, and the stem under it round; floaters lie above a single leaf as above soil; the rim of a
 * cucumber's lowest leaf hangs down like a wall around level soil, but its stem stands below that. */
static void leaves_are_no_ground_and_a_stem_no_pot(void **unused)
{
    (void)unused;
    static const struct {
        const char *kind;
        plm_scan_options scan;
    } plant[] = {
        {"lettuce", {.scanner = PLM_SCANNER_DOME, .seed = 405, .points = 45000}},
        {"lettuce", {.scanner = PLM_SCANNER_SPLAT, .seed = 305, .points = 60000, .noise = 5e-4, .outliers = 0.01}},
        {"lettuce", {.scanner = PLM_SCANNER_DOME, .seed = 603, .points = 200000}},
        {"lettuce", {.scanner = PLM_SCANNER_RGBD, .seed = 79014, .noise = 5e-4, .views = 12}}, /* its stem was a pot */
        {"single_leaf", {.scanner = PLM_SCANNER_SPLAT, .seed = 71, .points = 20000, .noise = 5e-4, .outliers = 0.01}},
        {"cucumber",
         {.scanner = PLM_SCANNER_RGBD,
          .seed = 23005,
          .points = 45000,
          .noise = 5e-4,
          .outliers = 0.005,
          .views = 12,
          .image_width = 1760}}};
    for (size_t i = 0; i < COUNT(plant); i++)
        assert_false(ground_in_plant(plant[i].kind, &plant[i].scan, true).ground.found);
}

/* Single points at the top of the rim, as high over it as the pot's round is off a circle, made this plant's hull twice too large. */
static void the_rim_of_a_pot_leaves_no_points(void **unused)
{
    (void)unused;
    const plm_scan_options scan = {.scanner = PLM_SCANNER_DOME, .seed = 261061, .points = 8049, .has_pot = true};
    const found_ground o = ground_in_plant("pepper", &scan, true);
    print_message("rim: %.4f of the ground left, %.4f of the plant kept\n", o.left, o.kept);
    assert_true(o.ground.found && o.kept > 0.995);
    assert_true(o.left < 0.001);
}

/* The inside of a thick wall was the plant's where the tail of the soil's noise hid its edge from above: a hull 3.4 times too large. */
static void the_inside_of_a_pot_is_its_own(void **unused)
{
    (void)unused;
    const plm_scan_options scan = {.scanner = PLM_SCANNER_RGBD,
                                   .seed = 262005,
                                   .points = 121535,
                                   .noise = 4.6e-4,
                                   .views = 20,
                                   .outliers = 0.005,
                                   .has_pot = true};
    const found_ground o = ground_in_plant("soybean", &scan, true);
    print_message("inside: %.4f of the ground left, %.4f of the plant kept\n", o.left, o.kept);
    assert_true(o.ground.found && o.kept > 0.995);
    assert_true(o.left < 0.003);
}

/* Pots as depth cameras see them, each wrong before. The soybean's: patches of the rim's inside pulled the traced wall in, and its
 * outside was the plant's. A table so wide that its small rosette was less than a hundredth of what was seen: the pot was the plant. A
 * rosette that hangs over its rim: its leaves were wall, and taught the ground their colour. A rim whose upper side lay above where the
 * wall was seen to end: a ring of it was left. Soil so densely seen that its noise filled the pot up to the rim's edge: the inside of
 * the wall was a leaf. A rosette so low that a hundredth of what was seen did not rise above the rim, and one none of
 * which did. */
static void pots_seen_by_depth_cameras_are_whole(void **unused)
{
    (void)unused;
    static const struct {
        const char *kind;
        uint64_t seed;
        bool is_arched, has_table;
        double noise, left, kept;
        int width;
    } scene[] = {{"soybean", 57051, false, false, 5e-4, 0.002, 0.995, 1200},    /* left 0.069 */
                 {"arabidopsis", 57032, false, true, 4e-4, 0.006, 0.98, 1400},  /* 0.48 */
                 {"arabidopsis", 57034, false, true, 4e-4, 0.002, 0.995, 1400}, /* kept 0.91 */
                 {"pepper", 57032, true, true, 4e-4, 0.002, 0.995, 1400},       /* left 0.0052 */
                 {"cucumber", 57082, true, false, 5e-4, 0.002, 0.995, 960},     /* 0.027 */
                 {"soybean", 57082, true, false, 5e-4, 0.002, 0.995, 960},      /* 0.089 */
                 {"maize", 57082, false, false, 5e-4, 0.002, 0.995, 960},       /* 0.025 */
                 {"arabidopsis", 57309, false, false, 5e-4, 0.002, 0.995, 960}, /* 1 */
                 {"arabidopsis", 57149, true, false, 5e-4, 0.002, 0.995, 0}};   /* 1 */
    for (size_t k = 0; k < sizeof scene / sizeof *scene; k++) {
        const plm_scan_options scan = {.scanner = PLM_SCANNER_RGBD,
                                       .seed = scene[k].seed,
                                       .noise = scene[k].noise,
                                       .outliers = 0.005,
                                       .image_width = scene[k].width,
                                       .has_pot = true,
                                       .has_table = scene[k].has_table};
        const found_ground o = ground_in_grown(scene[k].kind, scene[k].is_arched, &scan, true);
        print_message("%s %d: %.4f of the ground left, %.4f of the plant kept\n", scene[k].kind, (int)scene[k].seed,
                      o.left, o.kept);
        assert_true(o.ground.has_pot && o.kept > scene[k].kept && o.left < scene[k].left);
    }
}

typedef struct drawn {
    plm_cloud cloud;
    uint64_t state;
} drawn;

static void add_point(drawn *d, plm_label label, double x, double y, double z)
{
    const double place[3] = {x, y, z};
    const size_t i = d->cloud.count++;
    for (int a = 0; a < 3; a++) d->cloud.xyz[i][a] = (float)(place[a] + 2e-4 * (test_uniform(&d->state) - 0.5));
    d->cloud.label[i] = (uint8_t)label;
}

/* Half of a pot, from the side that was photographed; what was made of the other side is a sheet from the rim down across the pot. */
static void a_pot_of_which_half_is_made_up_is_one(void **unused)
{
    (void)unused;
    enum { SOIL = 4000, WALL = 6000, SHEET = 3000, STEM = 1500, BLADE = 3000 };
    static const double width = 0.14, depth = 0.15, height = 1;
    plm_error error = {0};
    drawn d = {.state = 7};
    assert_ok(plm_cloud_create(SOIL + WALL + SHEET + STEM + 4 * BLADE, PLM_HAS_LABEL, &d.cloud, &error));
    const size_t rows = d.cloud.count;
    d.cloud.count = 0;
    for (int k = 0; k < SOIL; k++) {
        const double r = width * sqrt(test_uniform(&d.state)), way = 2 * PLM_PI * test_uniform(&d.state);
        add_point(&d, PLM_LABEL_GROUND, r * cos(way), r * sin(way), 0);
    }
    for (int k = 0; k < WALL; k++) {
        const double down = test_uniform(&d.state), way = 2 * PLM_PI * (0.05 + 0.6 * test_uniform(&d.state));
        const double r = width * (1 - 0.2 * down);
        add_point(&d, PLM_LABEL_GROUND, r * cos(way), r * sin(way), -depth * down);
    }
    for (int k = 0; k < SHEET; k++) {
        const double down = test_uniform(&d.state), across = 1.6 * (test_uniform(&d.state) - 0.5);
        add_point(&d, PLM_LABEL_GROUND, width * (0.75 - 1.2 * down),
                  width * across * sqrt(1 - down * down) - 0.3 * width, -depth * (0.05 + 0.9 * down));
    }
    for (int k = 0; k < STEM; k++) {
        const double way = 2 * PLM_PI * test_uniform(&d.state);
        add_point(&d, PLM_LABEL_STEM, 0.01 * cos(way), 0.01 * sin(way), height * test_uniform(&d.state));
    }
    for (int leaf = 0; leaf < 4; leaf++)
        for (int k = 0; k < BLADE; k++) {
            const double along = test_uniform(&d.state), side = 0.04 * (test_uniform(&d.state) - 0.5) * (1 - along);
            const double out = 0.01 + 0.4 * along, rise = 0.4 + 0.15 * leaf + 0.3 * along - 0.25 * along * along;
            const double way = 1.3 + 2.6 * leaf;
            add_point(&d, PLM_LABEL_LEAF, out * cos(way) - side * sin(way), out * sin(way) + side * cos(way), rise);
        }
    assert_true(d.cloud.count == rows);
    assert_good(ground_in(&d.cloud), "half a pot");
    plm_cloud_free(&d.cloud);
}

static void colour_is_not_needed_and_not_trusted(void **unused)
{
    (void)unused;
    plm_error error = {0};
    test_scene s = plain;
    s.pot_radius = 0.25, s.pot_height = 0.4, s.rim = 0.04, s.table_radius = 0.5;
    for (int i = 0; i < 3; i++) {
        plm_cloud cloud;
        assert_ok(test_scene_make(&s, &cloud, &error));
        uint64_t state = 9;
        for (size_t k = 0; k < cloud.count && i < 2; k++)
            for (int c = 0; c < 3; c++)
                cloud.rgb[k][c] = (uint8_t)(i ? (c == 1 ? 140 : 60) : 255 * test_uniform(&state));
        if (i == 2) {
            plm_free(cloud.rgb);
            cloud.rgb = NULL;
        }
        assert_good(ground_in(&cloud), i == 0 ? "noise for colour" : i == 1 ? "all green" : "no colour");
        plm_cloud_free(&cloud);
    }
}

/* A scene in any unit, far from the origin, a little tilted, in any order of rows: the same points are ground. */
static void unit_place_tilt_and_order_change_nothing(void **unused)
{
    (void)unused;
    plm_error error = {0};
    test_scene s = plain;
    s.pot_radius = 0.25, s.pot_height = 0.4, s.rim = 0.04, s.table_radius = 0.5, s.points = 60000, s.spacing = 0.012;
    plm_cloud cloud;
    assert_ok(test_scene_make(&s, &cloud, &error));
    assert_good(ground_in(&cloud), "as it is");
    const size_t n = cloud.count;
    uint8_t *label = calloc(n, 1), *other = calloc(n, 1);
    uint32_t *order = malloc(n * sizeof *order);
    plm_ground ground;
    assert_ok(plm_find_ground(&cloud, PLM_GROUND_AUTO, 0, label, &ground, &error));
    uint64_t state = 3;
    for (size_t i = 0; i < n; i++) order[i] = (uint32_t)i;
    for (size_t i = n - 1; i > 0; i--) {
        const size_t j = (size_t)(test_uniform(&state) * (double)(i + 1));
        const uint32_t swap = order[i];
        order[i] = order[j];
        order[j] = swap;
    }
    plm_cloud shuffled;
    plm_ground again;
    assert_ok(plm_cloud_select(&cloud, order, n, &shuffled, &error));
    assert_ok(plm_find_ground(&shuffled, PLM_GROUND_AUTO, 0, other, &again, &error));
    size_t different = 0;
    for (size_t i = 0; i < n; i++) different += label[order[i]] != other[i];
    assert_int_equal(different, 0);
    assert_near(again.soil_height, ground.soil_height, 1e-6);
    for (int i = 0; i < 3; i++) {
        const double scale = i == 0 ? 1000 : i == 1 ? 1e-3 : 1, tilt = i == 2 ? plm_radians(6) : 0;
        for (size_t k = 0; k < n; k++) {
            const float x = shuffled.xyz[k][0], z = shuffled.xyz[k][2];
            cloud.xyz[k][0] = (float)(scale * (x * cos(tilt) + z * sin(tilt)));
            cloud.xyz[k][1] = (float)(scale * shuffled.xyz[k][1]);
            cloud.xyz[k][2] = (float)(scale * (z * cos(tilt) - x * sin(tilt)));
            cloud.label[k] = shuffled.label[k];
            memcpy(cloud.rgb[k], shuffled.rgb[k], 3);
        }
        cloud.origin[0] = 478700, cloud.origin[1] = 5427000, cloud.origin[2] = 300;
        const found_ground o = ground_in(&cloud);
        assert_good(o, i == 0 ? "mm" : i == 1 ? "km" : "tilted");
        assert_near(o.ground.soil_height, 300, 0.012 * scale);
    }
    free(order);
    free(label);
    free(other);
    plm_cloud_free(&shuffled);
    plm_cloud_free(&cloud);
}

static void clouds_without_shape_do_no_harm(void **unused)
{
    (void)unused;
    plm_error error = {0};
    uint64_t state = 4;
    for (int kind = 0; kind < 6; kind++)
        for (size_t count = 0; count <= 4000; count = count < 20 ? count + 1 : count * 200) {
            plm_cloud cloud;
            assert_ok(plm_cloud_create(count, PLM_HAS_LABEL, &cloud, &error));
            for (size_t i = 0; i < count; i++) {
                const double u = test_uniform(&state), v = test_uniform(&state), w = test_uniform(&state);
                const double side = floor(3 * u),
                             p[6][3] = {
                                 {1, 2, 3},
                                 {u, 0, 0},
                                 {0, 0, u},
                                 {u, v, 0},
                                 {0, u, v},
                                 {side == 0 ? v > 0.5 : v, side == 1 ? w > 0.5 : w, side == 2 ? (v + w > 1) : u}};
                for (int a = 0; a < 3; a++) cloud.xyz[i][a] = (float)p[kind][a];
                cloud.label[i] = PLM_LABEL_LEAF;
            }
            assert_false(ground_in(&cloud).ground.found); /* a plane alone is no ground: nothing stands on it */
            plm_cloud_free(&cloud);
        }
}

static void height_and_none_do_as_they_say(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(3, 0, &cloud, &error));
    cloud.origin[2] = 100;
    for (int i = 0; i < 3; i++) cloud.xyz[i][0] = cloud.xyz[i][1] = 0, cloud.xyz[i][2] = (float)i;
    uint8_t label[3] = {PLM_LABEL_LEAF, PLM_LABEL_LEAF, PLM_LABEL_LEAF};
    plm_ground ground;
    assert_ok(plm_find_ground(&cloud, PLM_GROUND_NONE, 0, label, &ground, &error));
    assert_false(ground.found);
    assert_ok(plm_find_ground(&cloud, PLM_GROUND_HEIGHT, 101.5, label, &ground, &error));
    assert_true(ground.found && ground.soil_height == 101.5);
    const uint8_t expected[3] = {PLM_LABEL_GROUND, PLM_LABEL_GROUND, PLM_LABEL_LEAF};
    assert_memory_equal(label, expected, 3);
    assert_int_equal(plm_find_ground(&cloud, PLM_GROUND_HEIGHT, NAN, label, &ground, &error), PLM_E_ARGUMENT);
    plm_cloud_free(&cloud);
}

static void clouds_with_known_truth_keep_their_plants(void **unused)
{
    (void)unused;
    static const char *with[] = {"arabidopsis_24_rgbd_pot", "pepper_22_rgbd_pot", "okra_32_3dgs"};
    static const char *without[] = {"cucumber_14_clean", "cucumber_23_rgbd",    "soybean_33_splat",
                                    "eggplant_11_3dgs",  "maize_15_clean",      "tomato_16_clean",
                                    "okra_13_clean",     "single_leaf_35_clean"};
    const char *folder = test_data_folder();
    if (!folder) skip();
    plm_error error = {0};
    for (size_t i = 0; i < COUNT(with) + COUNT(without); i++) {
        const char *name = i < COUNT(with) ? with[i] : without[i - COUNT(with)];
        char path[600];
        snprintf(path, sizeof path, "%s/dev/%s.labelled.ply", folder, name);
        plm_cloud cloud;
        assert_ok(plm_cloud_read(path, &(plm_read_options){.label_field = "label"}, &cloud, NULL, &error));
        assert_non_null(cloud.label);
        const found_ground o = ground_in(&cloud);
        if (i < COUNT(with))
            assert_good(o, name);
        else if (o.ground.found)
            fail_msg("%s: ground was claimed", name);
        plm_cloud_free(&cloud);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pot_is_told_from_the_plant),
        cmocka_unit_test(a_pot_on_a_table_is_told_from_both),
        cmocka_unit_test(soil_without_a_pot_is_found),
        cmocka_unit_test(a_rosette_over_the_rim_stays_a_plant),
        cmocka_unit_test(plants_without_ground_claim_none),
        plant_case(a_flat_rosette_is_no_ground),
        plant_case(leaves_are_no_ground_and_a_stem_no_pot),
        cmocka_unit_test(the_rim_of_a_pot_leaves_no_points),
        plant_case(the_inside_of_a_pot_is_its_own),
        plant_case(pots_seen_by_depth_cameras_are_whole),
        cmocka_unit_test(a_pot_of_which_half_is_made_up_is_one),
        cmocka_unit_test(colour_is_not_needed_and_not_trusted),
        cmocka_unit_test(unit_place_tilt_and_order_change_nothing),
        cmocka_unit_test(clouds_without_shape_do_no_harm),
        cmocka_unit_test(height_and_none_do_as_they_say),
        plant_case(clouds_with_known_truth_keep_their_plants),
    };
    return run_cases(tests);
}
