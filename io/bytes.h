/* io/bytes.h: the bytes of an input file, in memory. Internal to io/.
 *
 * Files are read whole; of big ones the pages are given back as they are done with (plm_bytes_drop), so that no second copy
 * of them is held beside what is made of them. A file that is cut while it is read ends where it was cut. */
#ifndef PLANTIMETER_IO_BYTES_H
#define PLANTIMETER_IO_BYTES_H

#include "cloud/cloud.h"

enum { PLM_SHOWN_LENGTH = 40, PLM_SHOWN_NAME_LENGTH = 168 };

typedef struct plm_bytes {
    const unsigned char *data;
    size_t size;
    char name[PLM_SHOWN_NAME_LENGTH]; /* for messages; a long path is cut at its front */
    void *owned;                      /* block to free, or NULL */
    size_t page_bytes;                /* of the pages that data lies in, to unmap; 0: none */
} plm_bytes;

/** The bytes of a file; path "-" is standard input. PLM_E_READ, PLM_E_MEMORY. Free with plm_bytes_close. */
plm_status plm_bytes_open(const char *path, plm_bytes *bytes, plm_error *error);

/** Bytes that belong to the caller. */
plm_bytes plm_bytes_wrap(const void *data, size_t size, const char *name);

void plm_bytes_close(plm_bytes *bytes);

/** Says that [begin, begin + size) will not be read again: its pages leave the process, and hold nothing afterwards.
 * Addresses outside the file are allowed and ignored. */
void plm_bytes_drop(const plm_bytes *bytes, const unsigned char *begin, size_t size);

/** A piece of a file made fit for a message: cut, and without control characters. Gives shown. */
const char *plm_show(const void *text, size_t size, char shown[PLM_SHOWN_LENGTH]);

#endif
