/* tests/fuzz/fuzz_ply.c: the reader of PLY. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_reader(plm_ply_read, PLM_FORMAT_PLY, data, size);
    return 0;
}
