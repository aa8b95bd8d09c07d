/* Organs of a plant whose parts are known: made of a tube, thin tubes and discs; and of the clouds with known truth. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/segment.h"
#include "support/label_score.h"

enum { LEAVES = 5, POINTS = 40000 };

typedef struct known_plant {
    plm_cloud cloud;
    uint8_t label[POINTS];
    int32_t organ[POINTS];
} known_plant;

/* A point of a straight tube around the segment from a to b. */
static void on_tube(const double a[3], const double b[3], double radius, uint64_t *state, float out[3])
{
    double axis[3], u[3], v[3];
    for (int i = 0; i < 3; i++) axis[i] = b[i] - a[i];
    plm_normalise(axis);
    plm_frame_of_axis(axis, u, v);
    const double t = test_uniform(state), angle = 2 * PLM_PI * test_uniform(state);
    for (int i = 0; i < 3; i++)
        out[i] = (float)(a[i] + t * (b[i] - a[i]) + radius * (cos(angle) * u[i] + sin(angle) * v[i]));
}

/* A stem of 0.2 m, leaf k (petiole 5 cm, disc of 3 cm radius) at 4 cm (k + 1), a turn of 137.5 degrees further. */
static void make_plant(known_plant *plant, double noise, double unit)
{
    plm_error error = {0};
    uint64_t state = 7;
    assert_ok(plm_cloud_create(POINTS, 0, &plant->cloud, &error));
    for (size_t i = 0; i < POINTS; i++) {
        const double pick = test_uniform(&state);
        const int k = (int)(test_uniform(&state) * LEAVES);
        const double heading = 2.4 * k, out[3] = {cos(heading), sin(heading), 0.4};
        double foot[3] = {0, 0, 0.04 * (k + 1)}, head[3];
        for (int axis = 0; axis < 3; axis++) {
            foot[axis] += 0.002 * out[axis];
            head[axis] = foot[axis] + 0.05 * out[axis];
        }
        float *p = plant->cloud.xyz[i];
        plant->organ[i] = k;
        if (pick < 0.1) {
            const double base[3] = {0, 0, 0}, top[3] = {0, 0, 0.2};
            on_tube(base, top, 0.002, &state, p);
            plant->label[i] = PLM_LABEL_STEM;
            plant->organ[i] = 0;
        } else if (pick < 0.16) {
            on_tube(foot, head, 0.001, &state, p);
            plant->label[i] = PLM_LABEL_PETIOLE;
        } else {
            const double r = 0.03 * sqrt(test_uniform(&state)), angle = 2 * PLM_PI * test_uniform(&state);
            const double along = 0.03 + r * cos(angle), across = r * sin(angle);
            p[0] = (float)(head[0] + along * cos(heading) - across * sin(heading));
            p[1] = (float)(head[1] + along * sin(heading) + across * cos(heading));
            p[2] = (float)(head[2] + 0.2 * along);
            plant->label[i] = PLM_LABEL_LEAF;
        }
        for (int axis = 0; axis < 3; axis++) p[axis] = (float)(unit * (p[axis] + noise * test_normal(&state)));
    }
}

/* Three leaves, two with short petioles, the topmost one's long, nearly as thick as the stem, and rising steeply beside the stem's bare tip: the
 * stem ends at that tip and no petiole point above the node is called stem. */
static void the_stem_ends_where_its_way_turns_into_the_last_petiole(void **unused)
{
    (void)unused;
    static known_plant plant;
    plm_error error = {0};
    uint64_t state = 11;
    plm_segmentation found;
    assert_ok(plm_cloud_create(POINTS, 0, &plant.cloud, &error));
    for (size_t i = 0; i < POINTS; i++) {
        const double pick = test_uniform(&state), height[3] = {0.05, 0.09, 0.13}, rise[3] = {0.5, 0.5, 1.4};
        const int k = (int)(test_uniform(&state) * 3);
        const double heading = 2.4 * k, out[2] = {cos(heading), sin(heading)}, base[3] = {0}, top[3] = {0, 0, 0.134};
        const double foot[3] = {0, 0, height[k]}, length = (k < 2 ? 0.015 : 0.04) / sqrt(1 + rise[k] * rise[k]);
        const double head[3] = {length * out[0], length * out[1], height[k] + length * rise[k]};
        float *p = plant.cloud.xyz[i];
        if (pick < 0.15) {
            on_tube(base, top, 0.002, &state, p);
            plant.label[i] = PLM_LABEL_STEM;
        } else if (pick < 0.25) {
            on_tube(foot, head, 0.0017, &state, p);
            plant.label[i] = PLM_LABEL_PETIOLE;
        } else {
            const double r = 0.03 * sqrt(test_uniform(&state)), angle = 2 * PLM_PI * test_uniform(&state);
            const double along = 0.03 + r * cos(angle), across = r * sin(angle);
            p[0] = (float)(head[0] + along * out[0] - across * out[1]);
            p[1] = (float)(head[1] + along * out[1] + across * out[0]);
            p[2] = (float)(head[2] + 0.2 * along);
            plant.label[i] = PLM_LABEL_LEAF;
        }
        for (int axis = 0; axis < 3; axis++) p[axis] += (float)(0.0003 * test_normal(&state));
    }
    assert_ok(plm_segment(&plant.cloud, NULL, NULL, NULL, &found, &error));
    assert_int_equal(found.leaf_count, 3);
    size_t right[2] = {0}, all[2] = {0};
    for (size_t i = 0; i < POINTS; i++) {
        const bool is_stem = plant.label[i] == PLM_LABEL_STEM && plant.cloud.xyz[i][2] > 0.1;
        if (!is_stem && (plant.label[i] != PLM_LABEL_PETIOLE || plant.cloud.xyz[i][2] < 0.14)) continue;
        all[is_stem]++;
        right[is_stem] += found.label[i] == plant.label[i];
    }
    assert_true((double)right[1] > 0.9 * (double)all[1]);
    assert_true((double)right[0] > 0.9 * (double)all[0]);
    plm_segmentation_free(&found);
    plm_cloud_free(&plant.cloud);
}

/* Two leaves low on the stem, then one on a long level petiole from which the upper stem, thinner than that petiole, goes
 * on straight to two more: the way through thick tubes takes the petiole, and nothing but the upper stem stands where it
 * turns. */
static void the_stem_goes_straight_on_where_a_stout_petiole_leaves_it(void **unused)
{
    (void)unused;
    static known_plant plant;
    static const double height[5] = {0.03, 0.03, 0.06, 0.085, 0.1}, length[5] = {0.006, 0.006, 0.06, 0.03, 0.012};
    static const double rise[5] = {0.6, 0.6, 0.15, 0.8, 1.2}, radius[5] = {0.0008, 0.0008, 0.0011, 0.0008, 0.0006};
    static const double turn[5] = {0.3, 3.4, 1.9, 4.6, 0.8};
    plm_error error = {0};
    uint64_t state = 5;
    plm_segmentation found;
    assert_ok(plm_cloud_create(POINTS, 0, &plant.cloud, &error));
    for (size_t i = 0; i < POINTS; i++) {
        const double pick = test_uniform(&state);
        const int k = (int)(test_uniform(&state) * 5);
        const double out[2] = {cos(turn[k]), sin(turn[k])}, along = length[k] / sqrt(1 + rise[k] * rise[k]);
        const double foot[3] = {0, 0, height[k]}, base[3] = {0}, node[3] = {0, 0, 0.06}, top[3] = {0, 0, 0.1};
        const double head[3] = {along * out[0], along * out[1], height[k] + along * rise[k]};
        float *p = plant.cloud.xyz[i];
        if (pick < 0.12) {
            on_tube(base, node, 0.0012, &state, p);
            plant.label[i] = PLM_LABEL_STEM;
        } else if (pick < 0.18) {
            on_tube(node, top, 0.0008, &state, p);
            plant.label[i] = PLM_LABEL_STEM;
        } else if (pick < 0.3 && (k == 2 || pick < 0.22)) {
            on_tube(foot, head, radius[k], &state, p);
            plant.label[i] = PLM_LABEL_PETIOLE;
        } else {
            const double r = 0.014 * sqrt(test_uniform(&state)), angle = 2 * PLM_PI * test_uniform(&state);
            const double forth = 0.014 + r * cos(angle), across = r * sin(angle);
            p[0] = (float)(head[0] + forth * out[0] - across * out[1]);
            p[1] = (float)(head[1] + forth * out[1] + across * out[0]);
            p[2] = (float)(head[2] + 0.2 * forth);
            plant.label[i] = PLM_LABEL_LEAF;
        }
        for (int axis = 0; axis < 3; axis++) p[axis] += (float)(0.0002 * test_normal(&state));
    }
    assert_ok(plm_segment(&plant.cloud, NULL, NULL, NULL, &found, &error));
    assert_int_equal(found.leaf_count, 5);
    size_t right = 0, all = 0, petiole = 0;
    for (size_t i = 0; i < POINTS; i++) {
        const float *p = plant.cloud.xyz[i];
        if (plant.label[i] == PLM_LABEL_STEM && p[2] > 0.065 && p[2] < 0.095)
            all++, right += found.label[i] == PLM_LABEL_STEM;
        petiole += plant.label[i] == PLM_LABEL_PETIOLE && hypot(p[0], p[1]) > 0.01 && found.label[i] == PLM_LABEL_STEM;
    }
    assert_true((double)right > 0.9 * (double)all);
    assert_int_equal(petiole, 0);
    plm_segmentation_free(&found);
    plm_cloud_free(&plant.cloud);
}

static void check_plant(double noise, double unit)
{
    static known_plant plant;
    plm_error error = {0};
    plm_segmentation found;
    label_score score;
    make_plant(&plant, noise, unit);
    assert_ok(plm_segment(&plant.cloud, NULL, NULL, NULL, &found, &error));
    assert_ok(label_score_compute(POINTS, plant.label, plant.organ, found.label, found.organ, &score, &error));
    assert_int_equal(found.habit, PLM_HABIT_SIMPLE);
    assert_int_equal(found.leaf_count, LEAVES);
    assert_int_equal(found.stem_count, 1);
    assert_true(score.f1 == 1);
    assert_true(score.iou_mean > 0.95);
    assert_true(score.iou[PLM_LABEL_STEM] > 0.85);
    /* Leaf k is the k-th from the base, and petiole k carries it. */
    size_t right[2] = {0}, all[2] = {0};
    for (size_t i = 0; i < POINTS; i++) {
        if (found.label[i] != plant.label[i] || plant.label[i] == PLM_LABEL_STEM) continue;
        const int is_leaf = plant.label[i] == PLM_LABEL_LEAF;
        all[is_leaf]++;
        right[is_leaf] += found.organ[i] == plant.organ[i];
    }
    assert_true((double)right[0] > 0.99 * (double)all[0]);
    assert_true((double)right[1] > 0.99 * (double)all[1]);
    plm_segmentation_free(&found);
    plm_cloud_free(&plant.cloud);
}

static void organs_of_a_simple_plant_are_found_and_numbered(void **unused)
{
    (void)unused;
    check_plant(0, 1);
}

static void organs_are_found_in_noise(void **unused)
{
    (void)unused;
    check_plant(0.0004, 1);
}

static void the_unit_does_not_matter(void **unused)
{
    (void)unused;
    check_plant(0, 1000);
    check_plant(0, 1e-3);
}

static void the_order_of_rows_does_not_matter(void **unused)
{
    (void)unused;
    static known_plant plant;
    static uint32_t row[POINTS];
    plm_error error = {0};
    plm_segmentation first, second;
    plm_cloud shuffled;
    uint64_t state = 3;
    make_plant(&plant, 0.0003, 1);
    for (uint32_t i = 0; i < POINTS; i++) row[i] = i;
    for (uint32_t i = POINTS; i-- > 1;) {
        const uint32_t j = (uint32_t)(test_uniform(&state) * (i + 1)), other = row[i];
        row[i] = row[j];
        row[j] = other;
    }
    assert_ok(plm_cloud_select(&plant.cloud, row, POINTS, &shuffled, &error));
    assert_ok(plm_segment(&plant.cloud, NULL, NULL, NULL, &first, &error));
    assert_ok(plm_segment(&shuffled, NULL, NULL, NULL, &second, &error));
    for (size_t i = 0; i < POINTS; i++) {
        assert_int_equal(second.label[i], first.label[row[i]]);
        assert_int_equal(second.organ[i], first.organ[row[i]]);
    }
    plm_segmentation_free(&first);
    plm_segmentation_free(&second);
    plm_cloud_free(&shuffled);
    plm_cloud_free(&plant.cloud);
}

static void ground_and_noise_keep_their_labels(void **unused)
{
    (void)unused;
    static known_plant plant;
    static uint8_t label[POINTS];
    static bool keep[POINTS];
    plm_error error = {0};
    plm_segmentation found;
    make_plant(&plant, 0, 1);
    for (size_t i = 0; i < POINTS; i++) {
        const float z = plant.cloud.xyz[i][2];
        label[i] = z < 0.01f ? PLM_LABEL_GROUND : PLM_LABEL_OTHER;
        keep[i] = i % 100 != 0;
    }
    for (size_t i = 0; i < POINTS; i += 1000) plant.cloud.xyz[i][0] += 1; /* far from all kept points */
    assert_ok(plm_segment(&plant.cloud, label, keep, NULL, &found, &error));
    for (size_t i = 0; i < POINTS; i++) {
        if (label[i] == PLM_LABEL_GROUND) {
            assert_int_equal(found.label[i], PLM_LABEL_GROUND);
            assert_int_equal(found.organ[i], -1);
        } else if (!keep[i]) {
            assert_int_equal(found.label[i], PLM_LABEL_OTHER);
            assert_int_equal(found.organ[i], -1);
        }
    }
    assert_int_equal(found.leaf_count, LEAVES);
    plm_segmentation_free(&found);
    plm_cloud_free(&plant.cloud);
}

static void clouds_without_structure_are_refused_or_bare(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_segmentation found;
    plm_cloud cloud;
    assert_ok(plm_cloud_create(50, 0, &cloud, &error));
    memset(cloud.xyz, 0, 50 * sizeof *cloud.xyz);
    assert_int_equal(plm_segment(&cloud, NULL, NULL, NULL, &found, &error), PLM_E_DEGENERATE); /* all in one place */
    for (size_t i = 0; i < 50; i++) cloud.xyz[i][2] = (float)i;
    const plm_status status = plm_segment(&cloud, NULL, NULL, NULL, &found, &error); /* a line: any answer, no crash */
    if (status == PLM_OK) plm_segmentation_free(&found);
    cloud.count = 5;
    assert_int_equal(plm_segment(&cloud, NULL, NULL, NULL, &found, &error), PLM_E_DEGENERATE);
    cloud.count = 0;
    assert_int_equal(plm_segment(&cloud, NULL, NULL, NULL, &found, &error), PLM_E_DEGENERATE);
    plm_cloud_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        plant_case(organs_of_a_simple_plant_are_found_and_numbered),
        plant_case(the_stem_ends_where_its_way_turns_into_the_last_petiole),
        plant_case(the_stem_goes_straight_on_where_a_stout_petiole_leaves_it),
        plant_case(organs_are_found_in_noise),
        plant_case(the_unit_does_not_matter),
        plant_case(the_order_of_rows_does_not_matter),
        plant_case(ground_and_noise_keep_their_labels),
        cmocka_unit_test(clouds_without_structure_are_refused_or_bare),
    };
    return run_cases(tests);
}
