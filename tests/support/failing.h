/* tests/support/failing.h: an allocator that fails once, at a chosen call, and counts the blocks alive. */
#ifndef PLANTIMETER_TEST_FAILING_H
#define PLANTIMETER_TEST_FAILING_H

#include "cloud/cloud.h"

typedef struct test_failing {
    long calls, fail_at, alive;
} test_failing;

/** For plm_set_allocator; state must outlive the allocator's use. */
plm_allocator test_failing_allocator(test_failing *state);

#endif
