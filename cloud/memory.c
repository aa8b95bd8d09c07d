/* cloud/memory.c: the one seam through which the library allocates, so that a test can fail any allocation. */
#include "cloud/cloud.h"

#include <stdlib.h>
#include <string.h>

static void *system_reallocate(void *block, size_t size, void *user)
{
    (void)user;
    return realloc(block, size);
}

static void system_release(void *block, void *user)
{
    (void)user;
    free(block);
}

static const plm_allocator system_allocator = {system_reallocate, system_release, NULL};
static plm_allocator current = {system_reallocate, system_release, NULL};

void plm_set_allocator(const plm_allocator *allocator)
{
    current = allocator ? *allocator : system_allocator;
}

void *plm_realloc(void *block, size_t count, size_t size, plm_error *error)
{
    if (size && count > SIZE_MAX / size) {
        plm_fail(error, PLM_E_MEMORY, "out of memory: %zu elements of %zu bytes exceed the address space", count, size);
        return NULL;
    }
    const size_t bytes = count * size;
    void *result = current.reallocate(block, bytes ? bytes : 1, current.user);
    if (!result) plm_fail(error, PLM_E_MEMORY, "out of memory: %zu bytes could not be had", bytes);
    return result;
}

void *plm_alloc(size_t count, size_t size, plm_error *error)
{
    return plm_realloc(NULL, count, size, error);
}

void *plm_alloc_zero(size_t count, size_t size, plm_error *error)
{
    void *block = plm_alloc(count, size, error);
    if (block) memset(block, 0, count * size);
    return block;
}

void plm_free(void *block)
{
    current.release(block, current.user);
}

char *plm_strdup(const char *text, plm_error *error)
{
    const size_t size = strlen(text) + 1;
    char *copy = plm_alloc(size, 1, error);
    if (copy) memcpy(copy, text, size);
    return copy;
}
