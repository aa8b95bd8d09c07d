/* Points at the middle of a rosette go to the petioles whose lines lead there; petioles too short to have a line keep theirs. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/rosette_core.h"

enum { LEAVES = 4, ALONG = 40, ROWS = LEAVES * ALONG };
static const double R = 2.5e-3;

static float xyz[ROWS][3], distance[ROWS];
static bool is_tube[ROWS];
static int32_t leaf[ROWS];

/* Leaf k leaves the middle at height k mm to azimuth 100 k degrees; the last is so short that all of it lies at the core. */
static void make(plm_sketch *sketch)
{
    for (int k = 0; k < LEAVES; k++)
        for (int i = 0; i < ALONG; i++) {
            const double out = (k == LEAVES - 1 ? 3e-3 : 10e-3) * (i + 1) / ALONG, azimuth = 100 * k * PLM_PI / 180;
            float *p = xyz[k * ALONG + i];
            p[0] = (float)(out * cos(azimuth));
            p[1] = (float)(out * sin(azimuth));
            p[2] = (float)(1e-3 * k + 0.3 * out);
            distance[k * ALONG + i] = (float)fmax(out - 1.2 * R, 0);
            is_tube[k * ALONG + i] = true;
            leaf[k * ALONG + i] = k;
        }
    *sketch = (plm_sketch){.is_tube = is_tube, .leaf = leaf, .leaf_count = LEAVES};
    sketch->working.xyz = xyz;
    sketch->working.count = ROWS;
    sketch->scale.radius = R;
}

static void points_go_to_the_petiole_that_leads_there(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_sketch sketch;
    make(&sketch);
    leaf[2 * ALONG + 3] = leaf[2 * ALONG + 4] = leaf[2 * ALONG + 5] = 0; /* of the high petiole, called the low one's */
    assert_ok(plm_rosette_core(&sketch, distance, &error));
    for (int i = 0; i < ROWS; i++) assert_int_equal(leaf[i], i / ALONG);
}

static void blades_and_what_lies_far_out_stay(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_sketch sketch;
    make(&sketch);
    leaf[2 * ALONG + 4] = 0, is_tube[2 * ALONG + 4] = false;
    leaf[2 * ALONG + 30] = 0;
    assert_ok(plm_rosette_core(&sketch, distance, &error));
    assert_int_equal(leaf[2 * ALONG + 4], 0);
    assert_int_equal(leaf[2 * ALONG + 30], 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(points_go_to_the_petiole_that_leads_there),
                                       cmocka_unit_test(blades_and_what_lies_far_out_stay)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
