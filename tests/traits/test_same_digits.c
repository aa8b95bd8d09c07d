/* Same input, same digits: for any number of threads, and, to 1e-6, for any order of the file's rows. */
#include "support/test.h"

#include "io/io.h"
#include "traits/traits.h"

#include <omp.h>

static plm_cloud read_example(void)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_read(TEST_SOURCE_DIR "/examples/data/eggplant.ply", NULL, &cloud, NULL, &error));
    return cloud;
}

static plm_measurement measure(plm_cloud *cloud, int threads)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    plm_measurement plant;
    omp_set_num_threads(threads);
    assert_ok(plm_measure(cloud, &options, &plant, &error));
    return plant;
}

static void one_thread_and_three_give_the_same_digits(void **unused)
{
    (void)unused;
    plm_cloud first = read_example(), second = read_example();
    plm_measurement one = measure(&first, 1), three = measure(&second, 3);
    assert_int_equal(one.value_count, three.value_count);
    for (size_t i = 0; i < one.value_count; i++) {
        const plm_trait_value *a = &one.value[i], *b = &three.value[i];
        assert_ptr_equal(a->trait, b->trait);
        assert_int_equal(a->organ_id, b->organ_id);
        assert_int_equal(a->estimate.state, b->estimate.state);
        const bool same = !memcmp(&a->estimate.value, &b->estimate.value, sizeof(double)) &&
                          !memcmp(&a->estimate.std_error, &b->estimate.std_error, sizeof(double));
        if (!same)
            fail_msg("%s %d: %.17g and %.17g", a->trait->name, a->organ_id, a->estimate.value, b->estimate.value);
    }
    assert_memory_equal(one.cloud.label, three.cloud.label, one.cloud.count);
    plm_measurement_free(&one);
    plm_measurement_free(&three);
}

/* A permutation of the rows, the same on every machine. */
static void shuffle(uint32_t *order, size_t count)
{
    uint64_t state = 21;
    for (size_t i = 0; i < count; i++) order[i] = (uint32_t)i;
    for (size_t i = count - 1; i > 0; i--) {
        const size_t j = (size_t)(test_uniform(&state) * (double)(i + 1));
        const uint32_t other = order[i];
        order[i] = order[j];
        order[j] = other;
    }
}

static void assert_alike(const plm_trait_value *a, const plm_trait_value *b)
{
    assert_ptr_equal(a->trait, b->trait);
    assert_int_equal(a->organ_id, b->organ_id);
    if (a->estimate.state != b->estimate.state) fail_msg("%s %d: another state", a->trait->name, a->organ_id);
    if (a->estimate.state != PLM_STATE_OK) return;
    const double tolerance = a->trait->unit == PLM_NUMBER && isnan(a->estimate.std_error)
                                 ? 0
                                 : 1e-6 * fmax(fabs(a->estimate.value), fabs(b->estimate.value));
    if (!(fabs(a->estimate.value - b->estimate.value) <= tolerance))
        fail_msg("%s %d: %.17g and %.17g", a->trait->name, a->organ_id, a->estimate.value, b->estimate.value);
}

static void shuffled_rows_give_the_same_labels_and_values(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud first = read_example(), second = read_example(), shuffled;
    const size_t count = second.count;
    uint32_t *order = malloc(count * sizeof *order);
    assert_non_null(order);
    shuffle(order, count);
    assert_ok(plm_cloud_select(&second, order, count, &shuffled, &error));
    plm_cloud_free(&second);
    plm_measurement a = measure(&first, 2), b = measure(&shuffled, 2);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(b.cloud.label[i], a.cloud.label[order[i]]);
        assert_int_equal(b.cloud.organ[i], a.cloud.organ[order[i]]);
    }
    assert_int_equal(a.value_count, b.value_count);
    for (size_t i = 0; i < a.value_count; i++) assert_alike(&a.value[i], &b.value[i]);
    plm_measurement_free(&a);
    plm_measurement_free(&b);
    free(order);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thread_and_three_give_the_same_digits),
        cmocka_unit_test(shuffled_rows_give_the_same_labels_and_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
