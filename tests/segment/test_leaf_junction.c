/* In noise narrow blades pass as tubes: the petioles of larger leaves tell how wide a tube is, and what is wide about a foot
 * is no blade. */
#include "support/test.h"

#include "support/virtual_plant.h"

enum { MOST = 16 };

/* The largest share of a true blade's points that are called petiole. blade: of all true petioles' points those called blade. */
static double largest_share(const virtual_plant *made, double *blade)
{
    size_t petiole = 0, called_blade = 0;
    size_t points[MOST] = {0}, wrong[MOST] = {0};
    double largest = 0;
    for (size_t i = 0; i < made->found.count; i++) {
        petiole += made->scan.cloud.label[i] == PLM_LABEL_PETIOLE;
        called_blade += made->scan.cloud.label[i] == PLM_LABEL_PETIOLE && made->found.label[i] == PLM_LABEL_LEAF;
        if (made->scan.cloud.label[i] != PLM_LABEL_LEAF) continue;
        const int32_t leaf = made->scan.cloud.organ[i];
        assert_in_range(leaf, 0, MOST - 1);
        points[leaf]++;
        wrong[leaf] += made->found.label[i] == PLM_LABEL_PETIOLE;
    }
    for (int leaf = 0; leaf < MOST; leaf++)
        if (points[leaf]) largest = fmax(largest, (double)wrong[leaf] / (double)points[leaf]);
    *blade = (double)called_blade / (double)petiole;
    return largest;
}

/* Peppers whose cotyledons are 6 mm wide; the second one's topmost leaf has a foot amid others. */
static void narrow_blades_are_no_petioles(void **unused)
{
    (void)unused;
    static const struct {
        uint64_t seed;
        int width;
        double noise;
    } scan[] = {{32003, 1740, 6.226e-4}, {32004, 1110, 9.6e-4}};
    for (size_t k = 0; k < sizeof scan / sizeof *scan; k++) {
        const plm_scan_options options = {.scanner = PLM_SCANNER_RGBD,
                                          .seed = scan[k].seed,
                                          .points = 45000,
                                          .noise = scan[k].noise,
                                          .outliers = 0.005,
                                          .image_width = scan[k].width};
        virtual_plant made = virtual_plant_make("pepper", 0, &options);
        double blade;
        const double share = largest_share(&made, &blade);
        print_message("%d: habit %s, %.3f of a blade at most is petiole, %.3f of petioles blade\n", (int)scan[k].seed,
                      plm_habit_name(made.found.habit), share, blade);
        assert_int_equal(made.found.habit, PLM_HABIT_SIMPLE);
        assert_int_equal(made.found.leaf_count, made.plant.leaf_count);
        assert_true(share < 0.2);
        assert_true(blade < 0.1);
        virtual_plant_free(&made);
    }
}

/* Of the first two leaves of soybeans, which are simple, points of petioles called blade and the other way round. */
static void the_simple_leaves_of_a_compound_plant_have_their_outlines_asked(void **unused)
{
    (void)unused;
    size_t wrong = 0, all = 0;
    for (uint64_t seed = 73003; seed <= 73004; seed++) {
        const plm_scan_options options = {.scanner = PLM_SCANNER_DOME, .seed = seed, .points = 60000};
        virtual_plant made = virtual_plant_make("soybean", 0, &options);
        const plm_cloud *cloud = &made.scan.cloud;
        assert_int_equal(made.found.habit, PLM_HABIT_COMPOUND);
        for (size_t i = 0; i < cloud->count; i++) {
            const uint8_t built = cloud->label[i], found = made.found.label[i];
            if (cloud->organ[i] > 1 || (built != PLM_LABEL_LEAF && built != PLM_LABEL_PETIOLE)) continue;
            all++;
            wrong += found != built && (found == PLM_LABEL_LEAF || found == PLM_LABEL_PETIOLE);
        }
        virtual_plant_free(&made);
    }
    print_message("%zu points of %zu on the wrong side\n", wrong, all);
    assert_true(all > 2000 && wrong < 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(narrow_blades_are_no_petioles),
        cmocka_unit_test(the_simple_leaves_of_a_compound_plant_have_their_outlines_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
