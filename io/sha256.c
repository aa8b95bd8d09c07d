/* io/sha256.c: SHA-256 (NIST, FIPS PUB 180-4, 2015) by Nettle, to say in run.json which file was measured. */
#include "io/io.h"

#include <errno.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

plm_status plm_file_sha256(const char *path, char digest[65], plm_error *error)
{
    enum { PIECE = 1 << 16 };
    FILE *file = fopen(path, "rb");
    if (!file) return plm_fail(error, PLM_E_READ, "%s: cannot be opened: %s", path, strerror(errno));
    struct sha256_ctx sum;
    sha256_init(&sum);
    unsigned char *piece = plm_alloc(PIECE, 1, error);
    plm_status status = piece ? PLM_OK : PLM_E_MEMORY;
    while (status == PLM_OK) {
        const size_t got = fread(piece, 1, PIECE, file);
        sha256_update(&sum, got, piece);
        if (got < PIECE) break;
    }
    if (status == PLM_OK && ferror(file))
        status = plm_fail(error, PLM_E_READ, "%s: cannot be read: %s", path, strerror(errno));
    if (status == PLM_OK) {
        uint8_t bytes[SHA256_DIGEST_SIZE];
        sha256_digest(&sum, sizeof bytes, bytes);
        for (size_t i = 0; i < sizeof bytes; i++) snprintf(digest + 2 * i, 3, "%02x", bytes[i]);
    }
    plm_free(piece);
    fclose(file);
    return status;
}
