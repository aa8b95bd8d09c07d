/* tests/fuzz/fuzz_las.c: the reader of LAS. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_reader(plm_las_read, PLM_FORMAT_LAS, data, size);
    return 0;
}
