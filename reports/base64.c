/* reports/base64.c: bytes as text (RFC 4648). */
#include "reports/base64.h"

char *plm_base64(const void *bytes, size_t size, plm_error *error)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *from = bytes;
    char *text = plm_alloc(size / 3 + 2, 4, error), *to = text;
    if (!text) return NULL;
    for (size_t i = 0; i + 2 < size; i += 3) {
        const uint32_t three = (uint32_t)from[i] << 16 | (uint32_t)from[i + 1] << 8 | from[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6) *to++ = digit[three >> shift & 63];
    }
    const size_t left = size % 3;
    if (left) {
        const uint32_t rest = (uint32_t)from[size - left] << 16 | (left == 2 ? (uint32_t)from[size - 1] << 8 : 0);
        *to++ = digit[rest >> 18 & 63];
        *to++ = digit[rest >> 12 & 63];
        *to++ = left == 2 ? digit[rest >> 6 & 63] : '=';
        *to++ = '=';
    }
    *to = 0;
    return text;
}
