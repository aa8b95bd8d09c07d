/* tests/fuzz/fuzz_number.c: the number parser against strtod: what both take for a number is the same number. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/number.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[600], *stop;
    double value = 0;
    if (size >= sizeof text) return 0;
    memcpy(text, data, size);
    text[size] = 0;
    const char *end = plm_number_scan(text, text + size, '.', &value);
    if (end != text + size || strpbrk(text, "xX#nN") || strlen(text) != size) return 0;
    const double expected = strtod(text, &stop);
    if (stop == text + size && memcmp(&value, &expected, sizeof value) == 0) return 0;
    fprintf(stderr, "\"%s\" is read as %.17g, strtod has %.17g\n", text, value, expected);
    abort();
}
