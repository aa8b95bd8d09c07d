/* tests/fuzz/fuzz_text.c: the reader of text. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_reader(plm_text_read, PLM_FORMAT_TEXT, data, size);
    return 0;
}
