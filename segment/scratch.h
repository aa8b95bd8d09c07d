/* segment/scratch.h: blocks that live as long as one stage, freed together, so that a stage has one way out. Internal. */
#ifndef PLANTIMETER_SEGMENT_SCRATCH_H
#define PLANTIMETER_SEGMENT_SCRATCH_H

#include "cloud/cloud.h"

enum { PLM_SCRATCH_BLOCKS = 40 };

/** Start with {.error = error}. */
typedef struct plm_scratch {
    void *block[PLM_SCRATCH_BLOCKS];
    int count;
    bool failed; /**< some block was not to be had: the stage must end with PLM_E_MEMORY */
    plm_error *error;
} plm_scratch;

/** Room for count elements of size bytes each, filled with zero bytes; NULL (and failed set) when there is no memory. */
static inline void *plm_scratch_take(plm_scratch *scratch, size_t count, size_t size)
{
    void *block = NULL;
    if (scratch->count < PLM_SCRATCH_BLOCKS) block = plm_alloc_zero(count, size, scratch->error);
    if (block)
        scratch->block[scratch->count++] = block;
    else
        scratch->failed = true;
    return block;
}

/** Frees every block but keep (may be NULL), which becomes the caller's. */
static inline void plm_scratch_free(plm_scratch *scratch, const void *keep)
{
    for (int i = 0; i < scratch->count; i++)
        if (scratch->block[i] != keep) plm_free(scratch->block[i]);
    scratch->count = 0;
}

#endif
