/* selftest/stability_plants.c: plants that are hardly plants: one leaf, 500 leaves, a bare stem, a lawn, a wall, a cube,
 * a few points. Every value must be finite or say why it is not; those with a closed form must be near it. */
#include "cloud/linear.h"
#include "selftest/checks.h"

#include <stdio.h>

static plm_bound near_by(double error, const char *note)
{
    return (plm_bound){.error = error, .condition = NAN, .note = note};
}

static const char *const of_rim = "the rim is known to a point spacing";

static void one_leaf(plm_checker *checker, bool is_labelled)
{
    plm_maker maker;
    plm_measurement plant;
    const double corner[3] = {0, 0, 0.1}, u[3] = {0.06, 0, 0}, v[3] = {0, 0.03, 0.03};
    plm_check_scene(checker, "plant of one leaf, %s", is_labelled ? "labelled" : "unlabelled");
    plm_maker_start(&maker, checker, 3600, 1);
    plm_maker_sheet(&maker, corner, u, v, 60, 0, PLM_LABEL_LEAF, 0);
    if (!is_labelled) plm_maker_unlabel(&maker);
    if (!plm_check_measure(checker, &maker.cloud, NULL, &plant)) return;
    plm_check_trait(checker, &plant, "leaf_count", -1, 1, near_by(0, "exact"), true);
    plm_check_trait(checker, &plant, "total_leaf_area", -1, 0.06 * 0.03 * sqrt(2), near_by(0.03, of_rim), true);
    plm_check_trait(checker, &plant, "leaf_inclination", 0, PLM_PI / 4, near_by(1e-3, NULL), true);
    plm_check_trait(checker, &plant, "plant_height", -1, 0.03, near_by(0.03, of_rim), true);
    plm_measurement_free(&plant);
}

static void many_leaves(plm_checker *checker)
{
    enum { LEAVES = 500, PER_SIDE = 9, STEM = 4000 };
    plm_maker maker;
    plm_measurement plant;
    const double base[3] = {0}, tip[3] = {0, 0, 1};
    plm_check_scene(checker, "plant of 500 leaves");
    plm_maker_start(&maker, checker, STEM + LEAVES * PER_SIDE * PER_SIDE, 2);
    plm_maker_tube(&maker, base, tip, 0.004, 2 * PLM_PI, STEM, 0, PLM_LABEL_STEM, 0);
    for (int leaf = 0; leaf < LEAVES; leaf++) {
        const double turn = 2.399963 * leaf, c = cos(turn), s = sin(turn), z = 0.05 + 0.9 * leaf / LEAVES;
        const double corner[3] = {0.01 * c + 0.01 * s, 0.01 * s - 0.01 * c, z};
        const double u[3] = {0.02 * c, 0.02 * s, 0}, v[3] = {-0.02 * s, 0.02 * c, 0};
        plm_maker_sheet(&maker, corner, u, v, PER_SIDE, 0, PLM_LABEL_LEAF, leaf);
    }
    if (!plm_check_measure(checker, &maker.cloud, "leaf_count,total_leaf_area,plant_height,leaf_inclination", &plant))
        return;
    plm_check_trait(checker, &plant, "leaf_count", -1, LEAVES, near_by(0, "exact"), true);
    plm_check_trait(checker, &plant, "total_leaf_area", -1, LEAVES * 4e-4,
                    near_by(0.06, "81 points a leaf: the rim is a third of them"), true);
    plm_check_trait(checker, &plant, "plant_height", -1, 1, near_by(0.005, NULL), true);
    plm_check_trait(checker, &plant, "leaf_inclination", 250, 0,
                    (plm_bound){.error = 1e-3, .condition = NAN, .scale = 1}, true);
    plm_measurement_free(&plant);
}

static void bare_stem(plm_checker *checker, bool is_labelled, const double tip[3])
{
    plm_maker maker;
    plm_measurement plant;
    const double base[3] = {0};
    plm_check_scene(checker, "bare stem, %s, %s", tip[2] == 0 ? "across zenith" : "along zenith",
                    is_labelled ? "labelled" : "unlabelled");
    plm_maker_start(&maker, checker, 4000, 3);
    plm_maker_tube(&maker, base, tip, 0.004, 2 * PLM_PI, 4000, 0, PLM_LABEL_STEM, 0);
    if (!is_labelled) plm_maker_unlabel(&maker);
    if (!plm_check_measure(checker, &maker.cloud, NULL, &plant)) return;
    plm_check_trait(checker, &plant, "leaf_count", -1, 0, (plm_bound){.error = 0, .condition = NAN, .scale = 1}, false);
    plm_check_trait(checker, &plant, "stem_diameter", 0, 0.008, near_by(0.02, NULL), is_labelled);
    plm_check_trait(checker, &plant, "stem_length", 0, plm_norm(tip), near_by(0.03, NULL), is_labelled);
    plm_check_trait(checker, &plant, "stem_inclination", 0, atan2(hypot(tip[0], tip[1]), tip[2]),
                    (plm_bound){.error = 0.01, .condition = 1, .scale = 1, .note = "radians"}, is_labelled);
    plm_measurement_free(&plant);
}

static void lawn(plm_checker *checker)
{
    plm_maker maker;
    plm_measurement plant;
    plm_check_scene(checker, "lawn of 400 blades");
    plm_maker_start(&maker, checker, 400 * 36, 4);
    for (int blade = 0; blade < 400; blade++) {
        const double corner[3] = {0.01 * (blade % 20), 0.01 * (blade / 20), 0};
        const double lean = 0.02 * plm_maker_uniform(&maker) - 0.01;
        const double u[3] = {0.002, 0.001, 0}, v[3] = {lean, lean, 0.05};
        plm_maker_sheet(&maker, corner, u, v, 6, 0, PLM_LABEL_LEAF, blade);
    }
    plm_maker_unlabel(&maker);
    if (!plm_check_measure(checker, &maker.cloud, NULL, &plant)) return;
    plm_check_trait(checker, &plant, "plant_height", -1, 0.05, near_by(0.05, of_rim), true);
    plm_measurement_free(&plant);
}

static void wall(plm_checker *checker)
{
    plm_maker maker;
    plm_measurement plant;
    const double corner[3] = {0}, u[3] = {0, 0.5, 0}, v[3] = {0, 0, 0.5};
    plm_check_scene(checker, "flat wall");
    plm_maker_start(&maker, checker, 6400, 5);
    plm_maker_sheet(&maker, corner, u, v, 80, 0, PLM_LABEL_OTHER, -1);
    plm_maker_unlabel(&maker);
    if (!plm_check_measure(checker, &maker.cloud, NULL, &plant)) return;
    plm_check_trait(checker, &plant, "plant_height", -1, 0.5, near_by(0.03, of_rim), true);
    plm_check_trait(checker, &plant, "convex_hull_area", -1, 0.5, near_by(0.06, of_rim), false);
    plm_measurement_free(&plant);
}

static void cube(plm_checker *checker)
{
    plm_maker maker;
    plm_measurement plant;
    static const double corner[6][3] = {{0}, {0, 0, 1}, {0}, {0, 1, 0}, {0}, {1, 0, 0}};
    plm_check_scene(checker, "cube");
    plm_maker_start(&maker, checker, 6 * 1600, 6);
    for (int face = 0; face < 6; face++) {
        double at[3], u[3] = {0}, v[3] = {0};
        for (int k = 0; k < 3; k++) at[k] = 0.1 * corner[face][k];
        u[face / 2 == 2 ? 1 : 0] = 0.1;
        v[face / 2 == 0 ? 1 : 2] = 0.1;
        plm_maker_sheet(&maker, at, u, v, 40, 0, PLM_LABEL_OTHER, -1);
    }
    plm_maker_unlabel(&maker);
    if (!plm_check_measure(checker, &maker.cloud, NULL, &plant)) return;
    plm_check_trait(checker, &plant, "convex_hull_volume", -1, 1e-3, near_by(0.01, NULL), false);
    plm_measurement_free(&plant);
}

static void few_points(plm_checker *checker, bool is_labelled)
{
    for (int count = 0; count <= 4; count++) {
        plm_maker maker;
        plm_measurement plant;
        plm_check_scene(checker, "plant of %d points, %s", count, is_labelled ? "labelled" : "unlabelled");
        plm_maker_start(&maker, checker, 4, 7);
        for (int i = 0; i < count; i++) {
            const double point[3] = {0.01 * i, 0.01 * (i == 2), 0.02 * (i == 3)};
            plm_maker_add(&maker, point, PLM_LABEL_LEAF, 0);
        }
        if (!is_labelled) plm_maker_unlabel(&maker);
        if (plm_check_measure(checker, &maker.cloud, NULL, &plant)) plm_measurement_free(&plant);
    }
}

/* Points all in one place, on one line, and on a grid as a whole plant. */
static void degenerate(plm_checker *checker)
{
    static const char *const names[] = {"one place, 1000 times", "upright line of 1000 points",
                                        "lying line of 1000 points", "grid of 10^3 points"};
    for (int which = 0; which < 4; which++) {
        plm_maker maker;
        plm_measurement plant;
        plm_check_scene(checker, "plant: %s", names[which]);
        plm_maker_start(&maker, checker, 1000, 8);
        for (int i = 0; i < 1000; i++) {
            const double grid[3] = {0.01 * (i % 10), 0.01 * (i / 10 % 10), 0.01 * (i / 100)}, step = 1e-4 * i;
            const double at[4][3] = {{1, 2, 3}, {0, 0, step}, {step, 0, 0}, {grid[0], grid[1], grid[2]}};
            plm_maker_add(&maker, at[which], PLM_LABEL_OTHER, -1);
        }
        plm_maker_unlabel(&maker);
        if (plm_check_measure(checker, &maker.cloud, NULL, &plant)) plm_measurement_free(&plant);
    }
}

void plm_stability_plants(plm_checker *checker)
{
    static const double up[3] = {0, 0, 0.2}, across[3] = {0.2, 0, 0};
    for (int labelled = 0; labelled < 2; labelled++) {
        one_leaf(checker, labelled);
        bare_stem(checker, labelled, up);
        bare_stem(checker, labelled, across);
        few_points(checker, labelled);
    }
    many_leaves(checker);
    lawn(checker);
    wall(checker);
    cube(checker);
    degenerate(checker);
}
