/* io/sha256.c: SHA-256 (NIST, FIPS PUB 180-4, 2015), to say in run.json which file was measured. */
#include "io/io.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

typedef struct sha256 {
    uint32_t state[8];
    uint64_t length; /* bytes so far */
    unsigned char block[64];
} sha256;

/* Section 4.2.2: fractional parts of the cube roots of the first 64 primes. */
static const uint32_t constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t rotate(uint32_t x, int by)
{
    return x >> by | x << (32 - by);
}

/* Section 6.2.2, one block of 64 bytes. */
static void add_block(uint32_t state[8], const unsigned char block[64])
{
    uint32_t w[64], v[8];
    for (int t = 0; t < 16; t++)
        w[t] = (uint32_t)block[4 * t] << 24 | (uint32_t)block[4 * t + 1] << 16 | (uint32_t)block[4 * t + 2] << 8 |
               block[4 * t + 3];
    for (int t = 16; t < 64; t++) {
        const uint32_t s0 = rotate(w[t - 15], 7) ^ rotate(w[t - 15], 18) ^ w[t - 15] >> 3;
        const uint32_t s1 = rotate(w[t - 2], 17) ^ rotate(w[t - 2], 19) ^ w[t - 2] >> 10;
        w[t] = w[t - 16] + s0 + w[t - 7] + s1;
    }
    memcpy(v, state, sizeof v);
    for (int t = 0; t < 64; t++) {
        const uint32_t s1 = rotate(v[4], 6) ^ rotate(v[4], 11) ^ rotate(v[4], 25);
        const uint32_t s0 = rotate(v[0], 2) ^ rotate(v[0], 13) ^ rotate(v[0], 22);
        const uint32_t first = v[7] + s1 + ((v[4] & v[5]) ^ (~v[4] & v[6])) + constants[t] + w[t];
        const uint32_t second = s0 + ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
        memmove(v + 1, v, 7 * sizeof *v);
        v[4] += first;
        v[0] = first + second;
    }
    for (int i = 0; i < 8; i++) state[i] += v[i];
}

static void add(sha256 *sum, const unsigned char *data, size_t size)
{
    size_t used = sum->length % 64;
    sum->length += size;
    while (size) {
        const size_t piece = size < 64 - used ? size : 64 - used;
        memcpy(sum->block + used, data, piece);
        used += piece;
        data += piece;
        size -= piece;
        if (used == 64) {
            add_block(sum->state, sum->block);
            used = 0;
        }
    }
}

static void finish(sha256 *sum, char digest[65])
{
    const uint64_t bits = sum->length * 8;
    const unsigned char one = 0x80, zero = 0;
    add(sum, &one, 1);
    while (sum->length % 64 != 56) add(sum, &zero, 1);
    for (int i = 7; i >= 0; i--) {
        const unsigned char byte = (unsigned char)(bits >> (8 * i));
        add(sum, &byte, 1);
    }
    for (int i = 0; i < 8; i++) snprintf(digest + 8 * i, 9, "%08x", sum->state[i]);
}

plm_status plm_file_sha256(const char *path, char digest[65], plm_error *error)
{
    enum { PIECE = 1 << 16 };
    sha256 sum = {
        .state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
    FILE *file = fopen(path, "rb");
    if (!file) return plm_fail(error, PLM_E_READ, "%s: cannot be opened: %s", path, strerror(errno));
    unsigned char *piece = plm_alloc(PIECE, 1, error);
    plm_status status = piece ? PLM_OK : PLM_E_MEMORY;
    while (status == PLM_OK) {
        const size_t got = fread(piece, 1, PIECE, file);
        add(&sum, piece, got);
        if (got < PIECE) break;
    }
    if (status == PLM_OK && ferror(file))
        status = plm_fail(error, PLM_E_READ, "%s: cannot be read: %s", path, strerror(errno));
    if (status == PLM_OK) finish(&sum, digest);
    plm_free(piece);
    fclose(file);
    return status;
}
