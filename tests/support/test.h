/* tests/support/test.h: what every test includes: cmocka, and small helpers. A test's name is a sentence that the code
 * must make true; a tolerance says where it comes from; a skip says why. */
#ifndef PLANTIMETER_TEST_H
#define PLANTIMETER_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cloud/cloud.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/** Fails unless |value - expected| <= tolerance; NaN fails. */
#define assert_near(value, expected, tolerance) test_near((value), (expected), (tolerance), #value, __FILE__, __LINE__)
void test_near(double value, double expected, double tolerance, const char *text, const char *file, int line);

/** Fails with the error's message unless the call gives PLM_OK. `error` must be in scope. */
#define assert_ok(call) test_ok((call), &error, #call, __FILE__, __LINE__)
void test_ok(plm_status status, const plm_error *error, const char *text, const char *file, int line);

/** Folder of the clouds with known truth beside the checkout, or NULL when it is not there (the test then skips with a
 * message). PLANTIMETER_DATA overrides it. */
const char *test_data_folder(void);

/** A uniform random number in [0, 1) and a standard normal one: SplitMix64, so that tests are the same everywhere. */
double test_uniform(uint64_t *state);
double test_normal(uint64_t *state);

/** A case that takes a second and more, as it measures whole plants; else as cmocka_unit_test. Its file runs its cases by run_cases. */
#define plant_case(function) cmocka_unit_test_setup(function, test_grows_plants)
int test_grows_plants(void **unused);

/** Runs the cases of a file and gives what main has to: all of them, but under sanitizers, with which they take three times as long,
 * every third of the plant cases, which lead through the same code; with PLANTIMETER_EVERY_CASE=1 all there too. */
#define run_cases(cases) test_run((cases), COUNT(cases))
int test_run(const struct CMUnitTest *cases, size_t count);

/** A new empty folder for the test's files; removed by test_remove_folder. */
char *test_make_folder(void);
void test_remove_folder(char *folder);

#endif
