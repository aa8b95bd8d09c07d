/* tests/traits/test_extreme.c: how far noisy surfaces reach where no quadric fits: the cut end of a stem, a tube as thin as the
 * noise. Points have noise off their surface and a quarter of it along it, as fits to photographs do. */
#include "support/test.h"

#include "cloud/linear.h"
#include "traits/extreme.h"

#include <math.h>
#include <stdlib.h>

enum { TRIALS = 24 };

static const double noise = 5e-4, along = 0.25;

/** Points of a tube that begins at the origin and runs along the x or z axis. */
typedef struct tube {
    double radius, length;
    size_t points;
    bool upright;
} tube;

static void put_tube(const tube *t, uint64_t *seed, float (*xyz)[3])
{
    for (size_t i = 0; i < t->points; i++) {
        const double turn = 2 * PLM_PI * test_uniform(seed), out = t->radius + noise * test_normal(seed);
        const double run = t->length * test_uniform(seed) + along * noise * test_normal(seed);
        const double side[2] = {out * cos(turn), out * sin(turn)};
        xyz[i][0] = (float)(t->upright ? side[0] : run);
        xyz[i][1] = (float)side[1];
        xyz[i][2] = (float)(t->upright ? run : side[0]);
    }
}

/* Mean and root mean square of how much too far the tube seems to reach down. */
static void reach_down(const tube *t, const plm_extreme_options *options, double built, double *mean, double *rms)
{
    static const double down[3] = {0, 0, -1};
    float(*xyz)[3] = malloc(t->points * sizeof *xyz);
    uint64_t seed = 11;
    assert_non_null(xyz);
    *mean = *rms = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        plm_error error = {0};
        plm_extreme found;
        put_tube(t, &seed, xyz);
        assert_ok(plm_extreme_along((const float(*)[3])xyz, t->points, down, options, &found, &error));
        *mean += (found.value - built) / TRIALS;
        *rms += pow(found.value - built, 2) / TRIALS;
        assert_near(found.value, built, 3 * found.std_error);
    }
    *rms = sqrt(*rms);
    free(xyz);
    print_message("%.3f mm too far, RMS %.3f\n", 1e3 * *mean, 1e3 * *rms);
}

/* About a cut end the neighbours are a ball: surfaces through them drew its points half a millimetre into the stem, and noise that
 * was taken for what leaves' rims have moved the end up by 0.2 mm. */
static void a_stem_ends_where_it_is_cut(void **unused)
{
    (void)unused;
    const tube stem = {1.2e-3, 0.04, 3200, true};
    double mean, rms;
    reach_down(&stem, &(plm_extreme_options){.noise = noise, .cut = true}, 0, &mean, &rms);
    assert_near(mean, 0, 0.08e-3);
    assert_true(rms < 0.12e-3);
}

/* The normal of a tube thinner than the noise points anywhere, and what noise was left was taken for a half of what it is: 1 mm. */
static void a_tube_thinner_than_the_noise_has_an_underside(void **unused)
{
    (void)unused;
    const tube petiole = {0.3e-3, 0.02, 3600, false};
    double mean, rms;
    reach_down(&petiole, &(plm_extreme_options){.least_noise = noise}, petiole.radius, &mean, &rms);
    assert_true(rms < 0.4e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stem_ends_where_it_is_cut),
        cmocka_unit_test(a_tube_thinner_than_the_noise_has_an_underside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
