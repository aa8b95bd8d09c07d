/* simulate/packed.h: a row of a binary file that is being filled. Internal. */
#ifndef PLANTIMETER_SIMULATE_PACKED_H
#define PLANTIMETER_SIMULATE_PACKED_H

#include <stdint.h>
#include <string.h>

typedef struct plm_packed {
    unsigned char bytes[128];
    size_t used;
} plm_packed;

static inline void plm_pack(plm_packed *row, const void *value, size_t size)
{
    memcpy(row->bytes + row->used, value, size);
    row->used += size;
}

/** "little" or "big", as PLY names this machine's order of bytes. */
static inline const char *plm_byte_order(void)
{
    const uint16_t one = 1;
    return *(const uint8_t *)&one == 1 ? "little" : "big";
}

#endif
