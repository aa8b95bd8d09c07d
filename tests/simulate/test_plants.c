/* Every kind of plant: grows, is what it says, and is the same again for the same seed. */
#include "cloud/linear.h"
#include "simulate/simulate.h"
#include "support/test.h"

static plm_virtual_plant grow(const char *kind, uint64_t seed, double resolution)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    assert_ok(plm_plant_grow(kind, &(plm_plant_options){.seed = seed, .resolution = resolution}, &plant, &error));
    return plant;
}

static void every_kind_grows_with_organs_that_its_faces_name(void **state)
{
    (void)state;
    const plm_plant_kind *kind;
    for (size_t k = 0; (kind = plm_plant_kind_at(k)); k++) {
        plm_virtual_plant plant = grow(kind->name, 5, 0.06);
        assert_string_equal(plant.kind, kind->name);
        assert_true(plant.whole.height > 0 && plant.whole.width > 0);
        if (plant.has_petioles) assert_int_equal(plant.petiole_count, plant.leaf_count);
        size_t faces[PLM_LABEL_COUNT] = {0};
        const size_t organs[PLM_LABEL_COUNT] = {0, plant.stem_count, plant.petiole_count, plant.leaf_count, 0};
        for (size_t f = 0; f < plant.mesh.triangle_count; f++) {
            const uint8_t label = plant.face_label[f];
            assert_true(label < PLM_LABEL_GROUND);
            assert_true(plant.mesh.face_organ[f] < (int32_t)organs[label]);
            for (int i = 0; i < 3; i++) assert_true(plant.mesh.triangle[f][i] < plant.mesh.vertex_count);
            faces[label]++;
        }
        for (int label = PLM_LABEL_STEM; label <= PLM_LABEL_LEAF; label++)
            assert_int_equal(faces[label] > 0, organs[label] > 0);
        for (size_t i = 0; i < 3 * plant.mesh.vertex_count; i++) assert_true(isfinite(plant.mesh.vertex[i / 3][i % 3]));
        plm_virtual_plant_free(&plant);
    }
}

static void a_seed_gives_one_plant_and_another_seed_another(void **state)
{
    (void)state;
    plm_virtual_plant first = grow("pepper", 8, 0.3), again = grow("pepper", 8, 0.3), other = grow("pepper", 9, 0.3);
    assert_int_equal(first.mesh.vertex_count, again.mesh.vertex_count);
    assert_memory_equal(first.mesh.vertex, again.mesh.vertex, first.mesh.vertex_count * sizeof *first.mesh.vertex);
    assert_memory_equal(first.leaf, again.leaf, first.leaf_count * sizeof *first.leaf);
    assert_true(first.whole.height != other.whole.height);
    plm_virtual_plant_free(&first);
    plm_virtual_plant_free(&again);
    plm_virtual_plant_free(&other);
}

/* Largest bend of a plant's true petioles, 1 less their chord over their length. */
static double largest_arch(const plm_virtual_plant *plant)
{
    double most = 0;
    for (size_t k = 0; k < plant->petiole_count; k++)
        if (plant->leaf[k].role == PLM_LEAF_TRUE)
            most = fmax(most, 1 - plant->petiole[k].chord / plant->petiole[k].length);
    return most;
}

static void what_is_no_seedling_does_not_arch(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_virtual_plant plant = grow("maize", 3, 0.1), asked;
    const plm_plant_options options = {.seed = 3, .resolution = 0.1, .is_arched = true};
    assert_ok(plm_plant_grow("maize", &options, &asked, &error));
    assert_false(asked.is_arched);
    assert_int_equal(plant.mesh.vertex_count, asked.mesh.vertex_count);
    assert_memory_equal(plant.mesh.vertex, asked.mesh.vertex, plant.mesh.vertex_count * sizeof *plant.mesh.vertex);
    plm_virtual_plant_free(&plant);
    plm_virtual_plant_free(&asked);
}

static void petioles_arch_where_asked_for(void **state)
{
    (void)state;
    static const char *const kind[] = {"eggplant", "pepper", "okra", "cucumber"};
    for (size_t k = 0; k < COUNT(kind); k++) {
        double straight = 0, arched = 0;
        for (uint64_t seed = 1; seed <= 4; seed++) {
            plm_error error = {0};
            plm_virtual_plant plant = grow(kind[k], seed, 0.1), other;
            const plm_plant_options options = {.seed = seed, .resolution = 0.1, .is_arched = true};
            assert_ok(plm_plant_grow(kind[k], &options, &other, &error));
            assert_int_equal(plant.leaf_count, other.leaf_count);
            assert_true(other.is_arched && !plant.is_arched);
            straight += largest_arch(&plant) / 4;
            arched += largest_arch(&other) / 4;
            plm_virtual_plant_free(&plant);
            plm_virtual_plant_free(&other);
        }
        print_message("%s: %.4f and %.4f of the length\n", kind[k], straight, arched);
        assert_true(arched > 0.015 && arched > 1.5 * straight);
    }
}

static void seedlings_have_the_sizes_of_the_seedling_paper(void **state)
{
    (void)state;
    static const char *const kind[] = {"eggplant", "pepper", "okra", "cucumber"};
    for (size_t k = 0; k < COUNT(kind); k++)
        for (uint64_t seed = 1; seed <= 4; seed++) {
            plm_virtual_plant plant = grow(kind[k], seed, 0.2);
            assert_true(plant.whole.height > 0.05 && plant.whole.height < 0.3);
            assert_true(plant.stem[0].diameter > 0.0015 && plant.stem[0].diameter < 0.0045);
            assert_int_equal(plant.leaf[0].role, PLM_LEAF_COTYLEDON);
            assert_int_equal(plant.leaf[1].role, PLM_LEAF_COTYLEDON);
            assert_int_equal(plant.leaf[2].role, PLM_LEAF_TRUE);
            plm_virtual_plant_free(&plant);
        }
}

static void large_plants_have_the_organs_of_the_laser_scanning_paper(void **state)
{
    (void)state;
    static const struct {
        const char *kind;
        size_t leaves;
        double height, radius;
    } paper[] = {{"tomato_large", 21, 1.7, 0.43},
                 {"cucumber_large", 17, 2.0, 0.43},
                 {"maize_large", 14, 2.5, 0.97},
                 {"arabidopsis_large", 10, 0.03, 0.06}};
    for (size_t k = 0; k < COUNT(paper); k++) {
        plm_virtual_plant plant = grow(paper[k].kind, 1, 0.05);
        assert_int_equal(plant.leaf_count, paper[k].leaves);
        assert_near(plant.whole.height / paper[k].height, 1, 0.25);
        assert_near(plant.whole.width / (2 * paper[k].radius), 1, 0.4);
        plm_virtual_plant_free(&plant);
    }
}

/* What the truth says of a petiole must hold between its numbers. */
static void petioles_leave_the_stem_at_its_surface(void **state)
{
    (void)state;
    plm_virtual_plant plant = grow("cucumber", 4, 0.3);
    for (size_t k = 0; k < plant.petiole_count; k++) {
        const plm_true_petiole *petiole = &plant.petiole[k];
        double chord[3], squared = 0;
        for (int i = 0; i < 3; i++) {
            chord[i] = petiole->junction[i] - petiole->base[i];
            squared += chord[i] * chord[i];
        }
        assert_near(petiole->chord, sqrt(squared), 1e-12);
        assert_near(petiole->inclination, acos(chord[2] / petiole->chord), 1e-9);
        assert_true(petiole->length >= petiole->chord - 1e-9);
        /* the axis and the surface at once: the distance to the chord of a slightly bent stem is its radius, within a fifth */
        double away[3], along[3];
        for (int i = 0; i < 3; i++) {
            along[i] = plant.stem[0].tip[i] - plant.stem[0].base[i];
            away[i] = petiole->base[i] - plant.stem[0].base[i];
        }
        plm_normalise(along);
        const double height = plm_dot(along, away);
        for (int i = 0; i < 3; i++) away[i] -= height * along[i];
        assert_true(plm_norm(away) < 0.5 * plant.stem[0].diameter + 0.15 * plant.stem[0].length);
    }
    plm_virtual_plant_free(&plant);
}

/* The rachis goes on in the petiolule of the last leaflet: the chord and length end where that one's blade begins. */
static void petioles_of_compound_leaves_end_at_the_last_blade(void **state)
{
    (void)state;
    static const char *const kind[] = {"tomato", "soybean"};
    for (size_t j = 0; j < COUNT(kind); j++) {
        plm_virtual_plant plant = grow(kind[j], 3, 0.3);
        size_t compound = 0;
        for (size_t k = 0; k < plant.petiole_count; k++) {
            const plm_true_leaf *leaf = &plant.leaf[k];
            if (!plant.petiole[k].is_compound) continue;
            compound++;
            const plm_true_leaf *last = &plant.leaflet[leaf->first_leaflet + leaf->leaflet_count - 1];
            for (int i = 0; i < 3; i++) assert_near(plant.petiole[k].junction[i], last->base[i], 1e-12);
            assert_true(plant.petiole[k].length >= plant.petiole[k].chord - 1e-9);
        }
        assert_true(compound >= 3);
        plm_virtual_plant_free(&plant);
    }
}

static void an_unknown_kind_names_the_nearest(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_virtual_plant plant;
    assert_int_equal(plm_plant_grow("tomatoe", &(plm_plant_options){.seed = 1}, &plant, &error), PLM_E_ARGUMENT);
    assert_non_null(strstr(error.message, "tomato?"));
    assert_int_equal(plm_plant_grow("maize", &(plm_plant_options){.resolution = 50}, &plant, &error), PLM_E_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_grows_with_organs_that_its_faces_name),
        cmocka_unit_test(a_seed_gives_one_plant_and_another_seed_another),
        cmocka_unit_test(petioles_arch_where_asked_for),
        cmocka_unit_test(what_is_no_seedling_does_not_arch),
        cmocka_unit_test(seedlings_have_the_sizes_of_the_seedling_paper),
        cmocka_unit_test(large_plants_have_the_organs_of_the_laser_scanning_paper),
        cmocka_unit_test(petioles_leave_the_stem_at_its_surface),
        cmocka_unit_test(petioles_of_compound_leaves_end_at_the_last_blade),
        cmocka_unit_test(an_unknown_kind_names_the_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
