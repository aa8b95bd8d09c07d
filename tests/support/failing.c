/* tests/support/failing.c: an allocator that fails once, at a chosen call. */
#include "support/failing.h"

#include <stdlib.h>

static void *failing_reallocate(void *block, size_t size, void *user)
{
    test_failing *state = user;
    if (state->calls++ == state->fail_at) return NULL;
    void *result = realloc(block, size);
    state->alive += !block && result;
    return result;
}

static void failing_release(void *block, void *user)
{
    test_failing *state = user;
    state->alive -= block != NULL;
    free(block);
}

plm_allocator test_failing_allocator(test_failing *state)
{
    return (plm_allocator){failing_reallocate, failing_release, state};
}
