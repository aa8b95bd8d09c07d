/* Scanners: what they see lies where they say, and is the same on any number of threads. */
#include <omp.h>

#include "simulate/scan.h"
#include "support/test.h"

static plm_virtual_plant grow(const char *kind, uint64_t seed)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    assert_ok(plm_plant_grow(kind, &(plm_plant_options){.seed = seed, .resolution = 0.4}, &plant, &error));
    return plant;
}

static plm_scan scan(plm_virtual_plant *plant, const plm_scan_options *options)
{
    plm_error error = {0};
    plm_scan result;
    assert_ok(plm_scan_plant(plant, options, &result, &error));
    return result;
}

static const plm_scan_options each[] = {
    {.scanner = PLM_SCANNER_DOME, .seed = 2, .points = 6000, .noise = 2e-4, .outliers = 0.02, .has_pot = true},
    {.scanner = PLM_SCANNER_RGBD, .seed = 2, .noise = 5e-4, .image_width = 320, .views = 5, .has_table = true},
    {.scanner = PLM_SCANNER_UNIFORM, .seed = 2, .points = 6000, .noise = 2e-4},
    {.scanner = PLM_SCANNER_SPLAT, .seed = 2, .points = 6000, .noise = 4e-4, .outliers = 0.01, .is_gaussians = true},
};

static void every_scanner_gives_the_same_points_on_one_thread_and_on_three(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    for (size_t k = 0; k < COUNT(each); k++) {
        plm_virtual_plant plant = grow("pepper", 6);
        omp_set_num_threads(1);
        plm_scan one = scan(&plant, &each[k]);
        const double seen = plant.leaf[0].visible_fraction;
        omp_set_num_threads(3);
        plm_scan three = scan(&plant, &each[k]);
        assert_int_equal(one.cloud.count, three.cloud.count);
        assert_memory_equal(one.cloud.xyz, three.cloud.xyz, one.cloud.count * sizeof *one.cloud.xyz);
        assert_memory_equal(one.cloud.label, three.cloud.label, one.cloud.count);
        assert_true(seen == plant.leaf[0].visible_fraction);
        plm_scan_free(&one);
        plm_scan_free(&three);
        plm_virtual_plant_free(&plant);
    }
    omp_set_num_threads(threads);
}

static void the_dome_gives_as_many_plant_points_as_were_asked_for(void **state)
{
    (void)state;
    plm_virtual_plant plant = grow("eggplant", 3);
    plm_scan result =
        scan(&plant, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .points = 12345, .has_table = true});
    assert_int_equal(result.cloud.count - result.class_points[PLM_LABEL_GROUND], 12345);
    assert_true(result.class_points[PLM_LABEL_GROUND] > 0);
    plm_scan_free(&result);
    result = scan(&plant, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .density = 1e6});
    assert_near(result.hits_per_area, 1e6, 1e3);
    plm_scan_free(&result);
    plm_virtual_plant_free(&plant);
}

/* Squared distance of a point from a segment of the plant's faces would need a search; points of a flat leaf alone lie in its
 * plane. */
static void a_noise_free_scan_lies_on_the_surface_and_noise_has_its_size(void **state)
{
    (void)state;
    plm_virtual_plant plant = grow("single_leaf", 3);
    for (size_t v = 0; v < plant.mesh.vertex_count; v++) plant.mesh.vertex[v][2] = 0; /* press it flat */
    for (int noisy = 0; noisy < 2; noisy++) {
        plm_scan result =
            scan(&plant, &(plm_scan_options){.scanner = PLM_SCANNER_DOME, .points = 20000, .noise = noisy * 3e-4});
        double sum = 0;
        for (size_t k = 0; k < result.cloud.count; k++)
            sum += (double)result.cloud.xyz[k][2] * (double)result.cloud.xyz[k][2];
        const double sd = sqrt(sum / (double)result.cloud.count);
        /* 20 000 draws know their SD to 0.5 %; floats at 3.6 m from the scanner round at 4e-7 m */
        if (noisy)
            assert_near(sd / 3e-4, 1, 0.02);
        else
            assert_true(sd < 1e-6);
        plm_scan_free(&result);
    }
    plm_virtual_plant_free(&plant);
}

static void a_leaf_alone_is_seen_whole_and_a_stem_inside_a_head_is_not(void **state)
{
    (void)state;
    plm_virtual_plant leaf = grow("single_leaf", 1), head = grow("lettuce", 2);
    const plm_scan_options dome = {.scanner = PLM_SCANNER_DOME, .points = 3000};
    plm_scan result = scan(&leaf, &dome);
    assert_true(leaf.leaf[0].visible_fraction > 0.99);
    assert_int_equal(leaf.leaf[0].points, 3000);
    plm_scan_free(&result);
    result = scan(&head, &dome);
    assert_true(head.stem[0].visible_fraction < 0.9);
    size_t points = 0;
    for (size_t k = 0; k < head.leaf_count; k++) points += head.leaf[k].points;
    assert_int_equal(points, result.class_points[PLM_LABEL_LEAF]);
    plm_scan_free(&result);
    plm_virtual_plant_free(&leaf);
    plm_virtual_plant_free(&head);
}

static void splat_density_is_uneven_as_asked_and_uniform_density_is_even(void **state)
{
    (void)state;
    plm_virtual_plant plant = grow("single_leaf", 1);
    double ratio[2];
    for (int k = 0; k < 2; k++) {
        enum { CELLS = 5 };
        plm_scan_options options = {
            .scanner = k ? PLM_SCANNER_SPLAT : PLM_SCANNER_UNIFORM, .points = 40000, .unevenness = 12};
        plm_scan result = scan(&plant, &options);
        size_t count[CELLS] = {0}, most = 0, least = SIZE_MAX;
        /* along the leaf's azimuth, only its middle part: cells of like area */
        const double *from = plant.leaf[0].base, *to = plant.leaf[0].tip;
        double length = 0;
        for (int i = 0; i < 3; i++) length += (to[i] - from[i]) * (to[i] - from[i]);
        for (size_t p = 0; p < result.cloud.count; p++) {
            double at = 0;
            for (int i = 0; i < 3; i++) at += ((double)result.cloud.xyz[p][i] - from[i]) * (to[i] - from[i]) / length;
            if (at > 0.25 && at < 0.75) count[(int)((at - 0.25) / 0.5 * CELLS)]++;
        }
        for (int i = 0; i < CELLS; i++) {
            most = count[i] > most ? count[i] : most;
            least = count[i] < least ? count[i] : least;
        }
        ratio[k] = (double)most / (double)least;
        plm_scan_free(&result);
    }
    assert_true(ratio[0] < 1.7); /* the leaf's outline */
    assert_true(ratio[1] > 2);
    plm_virtual_plant_free(&plant);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_scan result;
    plm_virtual_plant plant = grow("single_leaf", 1);
    static const plm_scan_options bad[] = {{.scanner = PLM_SCANNER_NONE},
                                           {.scanner = (plm_scanner)9},
                                           {.scanner = PLM_SCANNER_DOME, .noise = -1},
                                           {.scanner = PLM_SCANNER_DOME, .outliers = NAN},
                                           {.scanner = PLM_SCANNER_RGBD, .views = 5000},
                                           {.scanner = PLM_SCANNER_DOME, .density = -2}};
    for (size_t k = 0; k < COUNT(bad); k++)
        assert_int_equal(plm_scan_plant(&plant, &bad[k], &result, &error), PLM_E_ARGUMENT);
    plm_virtual_plant_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_scanner_gives_the_same_points_on_one_thread_and_on_three),
        cmocka_unit_test(the_dome_gives_as_many_plant_points_as_were_asked_for),
        cmocka_unit_test(a_noise_free_scan_lies_on_the_surface_and_noise_has_its_size),
        cmocka_unit_test(a_leaf_alone_is_seen_whole_and_a_stem_inside_a_head_is_not),
        cmocka_unit_test(splat_density_is_uneven_as_asked_and_uniform_density_is_even),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
