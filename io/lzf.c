/* io/lzf.c: decompression of LZF.
 *
 *   000LLLLL <L + 1 bytes>            literals
 *   LLLOOOOO OOOOOOOO                 copy L + 2 bytes from O + 1 bytes back (L = 1 to 6)
 *   111OOOOO LLLLLLLL OOOOOOOO        copy L + 9 bytes from O + 1 bytes back */
#include "io/lzf.h"

#include <string.h>

bool plm_lzf_decompress(const unsigned char *from, size_t from_size, unsigned char *to, size_t to_size, size_t *at)
{
    size_t in = 0, out = 0;
    while (in < from_size) {
        *at = in;
        const unsigned control = from[in++];
        if (control < 32) {
            const size_t length = control + 1;
            if (length > from_size - in || length > to_size - out) return false;
            memcpy(to + out, from + in, length);
            in += length;
            out += length;
            continue;
        }
        size_t length = control >> 5;
        if (from_size - in < (length == 7 ? 2u : 1u)) return false;
        if (length == 7) length += from[in++];
        const size_t back = ((size_t)(control & 31) << 8 | from[in++]) + 1;
        length += 2;
        if (back > out || length > to_size - out) return false;
        for (; length; length--, out++) to[out] = to[out - back]; /* may overlap: that is how runs are made */
    }
    *at = in;
    return out == to_size;
}
