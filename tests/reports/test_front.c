/* The Pareto front of cost and error, and the cheapest setting for an error. */
#include "support/test.h"

#include "reports/front.h"

#include <math.h>

enum { ROWS = 7 };

static const double cost[ROWS] = {1, 2, 2, 4, 8, 8, 3};
static const double wrong[ROWS] = {9, 5, 6, 5, 1, 1, NAN};
static const bool all[ROWS] = {true, true, true, true, true, true, true};

static void the_front_is_what_nothing_beats(void **unused)
{
    (void)unused;
    bool is_on[ROWS];
    plm_front_mark(cost, wrong, all, ROWS, is_on);
    assert_true(is_on[0]);  /* the cheapest */
    assert_true(is_on[1]);  /* better for more */
    assert_false(is_on[2]); /* as dear as 1 and worse */
    assert_false(is_on[3]); /* as good as 1 and dearer */
    assert_true(is_on[4]);
    assert_true(is_on[5]);  /* equal to 4: both */
    assert_false(is_on[6]); /* no number */
}

static void who_does_not_take_part_beats_nobody(void **unused)
{
    (void)unused;
    bool is_on[ROWS], some[ROWS] = {true, false, true, true, false, false, true};
    plm_front_mark(cost, wrong, some, ROWS, is_on);
    assert_true(is_on[0]);
    assert_false(is_on[1]);
    assert_true(is_on[2]); /* 1 is out */
    assert_true(is_on[3]); /* 4 and 5 are out */
    assert_false(is_on[4]);
}

static void a_front_alone_is_on_itself(void **unused)
{
    (void)unused;
    bool is_on = false;
    plm_front_mark(cost, wrong, all, 1, &is_on);
    assert_true(is_on);
    plm_front_mark(cost, wrong, all, 0, &is_on); /* no row: nothing is touched */
    assert_true(is_on);
}

static void the_cheapest_that_is_good_enough(void **unused)
{
    (void)unused;
    assert_int_equal(plm_front_cheapest(cost, wrong, all, ROWS, 10), 0);
    assert_int_equal(plm_front_cheapest(cost, wrong, all, ROWS, 6), 1); /* of 1 and 2 the better */
    assert_int_equal(plm_front_cheapest(cost, wrong, all, ROWS, 5), 1);
    assert_int_equal(plm_front_cheapest(cost, wrong, all, ROWS, 4.9), 4);
    assert_int_equal(plm_front_cheapest(cost, wrong, all, ROWS, 0.5), ROWS);
    const bool but_first[ROWS] = {false, true, true, true, true, true, true};
    assert_int_equal(plm_front_cheapest(cost, wrong, but_first, ROWS, 10), 1);
}

static void the_cheapest_is_on_the_front(void **unused)
{
    (void)unused;
    bool is_on[ROWS];
    plm_front_mark(cost, wrong, all, ROWS, is_on);
    for (double most = 0; most < 12; most += 0.25) {
        const size_t found = plm_front_cheapest(cost, wrong, all, ROWS, most);
        assert_true(found == ROWS || is_on[found]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_front_is_what_nothing_beats), cmocka_unit_test(who_does_not_take_part_beats_nobody),
        cmocka_unit_test(a_front_alone_is_on_itself),      cmocka_unit_test(the_cheapest_that_is_good_enough),
        cmocka_unit_test(the_cheapest_is_on_the_front),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
