/* tests/fuzz/fuzz_pcd.c: the reader of PCD. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_reader(plm_pcd_read, PLM_FORMAT_PCD, data, size);
    return 0;
}
