/* io/lzf.h: decompression of LZF (M. Lehmann's liblzf), which PCD files use. Internal to io/. */
#ifndef PLANTIMETER_IO_LZF_H
#define PLANTIMETER_IO_LZF_H

#include <stdbool.h>
#include <stddef.h>

/** Most bytes that one compressed byte can become: a back reference of 3 bytes gives at most 264. */
enum { PLM_LZF_MOST = 88 };

/** Decompresses from[0..from_size) into to[0..to_size). True when it fills it exactly; else *at is the byte of `from`
 * at which it failed. */
bool plm_lzf_decompress(const unsigned char *from, size_t from_size, unsigned char *to, size_t to_size, size_t *at);

#endif
