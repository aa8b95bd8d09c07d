/* Loss of geometry: what the laser-scanning paper found must hold on a coarse plant too. */
#include "mesh/mesh.h"
#include "simulate/simulate.h"
#include "support/test.h"

typedef struct fixture {
    plm_virtual_plant plant;
    plm_thinning *thinning;
} fixture;

static int prepare(void **state)
{
    static fixture made;
    plm_error error = {0};
    const plm_thinning_options options = {.seed = 1, .density = 5000, .light_rays = 20000, .hull = plm_convex_hull};
    if (plm_plant_grow("cucumber_large", &(plm_plant_options){.seed = 1, .resolution = 0.12}, &made.plant, &error) !=
        PLM_OK)
        return 1;
    *state = &made;
    return plm_thinning_start(&made.plant, &options, &made.thinning, &error) != PLM_OK;
}

static int clean(void **state)
{
    fixture *made = *state;
    plm_thinning_free(made->thinning);
    plm_virtual_plant_free(&made->plant);
    return 0;
}

static void height_survives_the_loss_and_area_falls_with_it(void **state)
{
    const fixture *made = *state;
    plm_error error = {0};
    double intact[PLM_THIN_COUNT], less[PLM_THIN_COUNT];
    for (int loss = 0; loss < PLM_LOSS_COUNT; loss++) {
        assert_ok(plm_thinning_step(made->thinning, (plm_loss)loss, 0, intact, &error));
        assert_ok(plm_thinning_step(made->thinning, (plm_loss)loss, 30, less, &error));
        assert_near(intact[PLM_THIN_SF_T], 0, 1e-9);
        for (int trait = 0; trait < PLM_THIN_COUNT; trait++) assert_true(isfinite(less[trait]));
        assert_near(less[PLM_THIN_HEIGHT] / intact[PLM_THIN_HEIGHT], 1, 0.02); /* the paper: unaffected up to 30 % */
        assert_true(less[PLM_THIN_AREA] < 0.85 * intact[PLM_THIN_AREA]);
        assert_true(less[PLM_THIN_VISIBLE_AREA] < intact[PLM_THIN_VISIBLE_AREA]);
        assert_true(less[PLM_THIN_VISIBLE_AREA] <= less[PLM_THIN_AREA]);
        assert_true(less[PLM_THIN_ABSORBED] < intact[PLM_THIN_ABSORBED]);
    }
}

static void the_outside_is_what_the_hull_hangs_on(void **state)
{
    const fixture *made = *state;
    plm_error error = {0};
    double value[PLM_LOSS_COUNT][PLM_THIN_COUNT];
    for (int loss = 0; loss < PLM_LOSS_COUNT; loss++)
        assert_ok(plm_thinning_step(made->thinning, (plm_loss)loss, 20, value[loss], &error));
    assert_true(value[PLM_LOSS_OUTSIDE_IN][PLM_THIN_HULL_VOLUME] < 0.7 * value[PLM_LOSS_RANDOM][PLM_THIN_HULL_VOLUME]);
    assert_true(value[PLM_LOSS_OUTSIDE_IN][PLM_THIN_PCA1] < 0.8 * value[PLM_LOSS_RANDOM][PLM_THIN_PCA1]);
}

static void losses_beyond_the_plant_are_refused(void **state)
{
    const fixture *made = *state;
    plm_error error = {0};
    double value[PLM_THIN_COUNT];
    assert_int_equal(plm_thinning_step(made->thinning, PLM_LOSS_RANDOM, 100, value, &error), PLM_E_ARGUMENT);
    assert_int_equal(plm_thinning_step(made->thinning, PLM_LOSS_COUNT, 10, value, &error), PLM_E_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(height_survives_the_loss_and_area_falls_with_it),
        cmocka_unit_test(the_outside_is_what_the_hull_hangs_on),
        cmocka_unit_test(losses_beyond_the_plant_are_refused),
    };
    return cmocka_run_group_tests(tests, prepare, clean);
}
