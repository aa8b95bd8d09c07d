/* io/bytes.c: reading input files. */
#define _DEFAULT_SOURCE /* madvise: the C library's posix_madvise leaves POSIX_MADV_DONTNEED undone */
#include "io/bytes.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* Files are read, never mapped: a mapping that someone cuts meanwhile ends the process (SIGBUS). Larger ones go into pages of
 * their own, which can be given back one by one, piece by piece by all threads. */
enum { SMALL_FILE = 16 << 20, FIRST_PIECE = 1 << 16, BIG_PIECE = 4 << 20 };

static void set_name(plm_bytes *bytes, const char *name)
{
    const size_t length = strlen(name), room = sizeof bytes->name - 1;
    if (length <= room) {
        memcpy(bytes->name, name, length + 1);
        return;
    }
    memcpy(bytes->name, "...", 3);
    memcpy(bytes->name + 3, name + length - (room - 3), room - 2);
}

/* Reads to the end of the file; expected is how much there probably is. */
static plm_status read_all(int file, size_t expected, plm_bytes *bytes, plm_error *error)
{
    size_t room = expected ? expected + 1 : FIRST_PIECE, size = 0;
    unsigned char *block = plm_alloc(room, 1, error);
    plm_status status = block ? PLM_OK : PLM_E_MEMORY;
    while (status == PLM_OK) {
        if (size == room) {
            room += room / 2;
            unsigned char *larger = plm_realloc(block, room, 1, error);
            if (!larger) {
                status = PLM_E_MEMORY;
                break;
            }
            block = larger;
        }
        const ssize_t got = read(file, block + size, room - size);
        if (got == 0) break;
        if (got > 0) size += (size_t)got;
        if (got < 0 && errno != EINTR)
            status =
                plm_fail(error, PLM_E_READ, "%s: byte %zu: cannot be read: %s", bytes->name, size, strerror(errno));
    }
    if (status != PLM_OK) {
        plm_free(block);
        return status;
    }
    bytes->data = bytes->owned = block;
    bytes->size = size;
    return PLM_OK;
}

/* Reads size bytes from offset on; gives how many there were, and the error's number in *failure, 0 for none. */
static size_t read_piece(int file, unsigned char *to, size_t size, size_t offset, int *failure)
{
    size_t done = 0;
    *failure = 0;
    while (done < size) {
        const ssize_t got = pread(file, to + done, size - done, (off_t)(offset + done));
        if (got == 0) break;
        if (got > 0) done += (size_t)got;
        if (got < 0 && errno != EINTR) {
            *failure = errno;
            break;
        }
    }
    return done;
}

/* Reads a big regular file into pages. What a file that is cut meanwhile still holds is what there is. */
static plm_status read_pages(int file, size_t size, plm_bytes *bytes, plm_error *error)
{
    unsigned char *pages = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) return plm_fail(error, PLM_E_MEMORY, "%s: out of memory for %zu bytes", bytes->name, size);
    madvise(pages, size, MADV_HUGEPAGE); /* fewer faults; where there are none, nothing is lost */
    size_t end = size;
    int failure = 0;
#pragma omp parallel for schedule(static)
    for (size_t begin = 0; begin < size; begin += BIG_PIECE) {
        const size_t wanted = size - begin < BIG_PIECE ? size - begin : BIG_PIECE;
        int own_failure;
        const size_t got = read_piece(file, pages + begin, wanted, begin, &own_failure);
        if (got == wanted) continue;
#pragma omp critical
        if (begin + got < end) {
            end = begin + got;
            failure = own_failure;
        }
    }
    if (failure) {
        munmap(pages, size);
        return plm_fail(error, PLM_E_READ, "%s: byte %zu: cannot be read: %s", bytes->name, end, strerror(failure));
    }
    bytes->data = pages;
    bytes->size = end;
    bytes->page_bytes = size;
    return PLM_OK;
}

static plm_status read_file(int file, plm_bytes *bytes, plm_error *error)
{
    struct stat found;
    if (fstat(file, &found) != 0)
        return plm_fail(error, PLM_E_READ, "%s: cannot be read: %s", bytes->name, strerror(errno));
    if (S_ISDIR(found.st_mode)) return plm_fail(error, PLM_E_READ, "%s: is a folder, a file was expected", bytes->name);
    const bool is_regular = S_ISREG(found.st_mode) && found.st_size > 0;
    if (is_regular && found.st_size > SMALL_FILE && lseek(file, 0, SEEK_CUR) == 0)
        return read_pages(file, (size_t)found.st_size, bytes, error);
    return read_all(file, is_regular ? (size_t)found.st_size : 0, bytes, error);
}

plm_status plm_bytes_open(const char *path, plm_bytes *bytes, plm_error *error)
{
    const bool is_input = !strcmp(path, "-");
    plm_bytes opened = {0};
    set_name(&opened, is_input ? "standard input" : path);
    const int file = is_input ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return plm_fail(error, PLM_E_READ, "%s: cannot be opened: %s", opened.name, strerror(errno));
    const plm_status status = read_file(file, &opened, error);
    if (!is_input) close(file);
    if (status == PLM_OK) *bytes = opened;
    return status;
}

plm_bytes plm_bytes_wrap(const void *data, size_t size, const char *name)
{
    plm_bytes bytes = {.data = data, .size = size};
    set_name(&bytes, name ? name : "data");
    return bytes;
}

void plm_bytes_close(plm_bytes *bytes)
{
    if (bytes->page_bytes) munmap((void *)(uintptr_t)bytes->data, bytes->page_bytes);
    plm_free(bytes->owned);
    *bytes = (plm_bytes){0};
}

void plm_bytes_drop(const plm_bytes *bytes, const unsigned char *begin, size_t size)
{
    if (!bytes->page_bytes) return;
    const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), start = (uintptr_t)bytes->data;
    const uintptr_t wanted = (uintptr_t)begin;
    if (wanted < start || wanted > start + bytes->size || size > start + bytes->size - wanted) return;
    const uintptr_t first = (wanted + page - 1) / page * page, last = (wanted + size) / page * page;
    if (last > first) madvise((void *)first, last - first, MADV_DONTNEED);
}

const char *plm_show(const void *text, size_t size, char shown[PLM_SHOWN_LENGTH])
{
    const unsigned char *from = text;
    size_t used = 0;
    for (; used < size && used < PLM_SHOWN_LENGTH - 4; used++)
        shown[used] = from[used] >= 0x20 && from[used] < 0x7f ? (char)from[used] : '?';
    if (used < size)
        for (int i = 0; i < 3; i++) shown[used++] = '.';
    shown[used] = 0;
    return shown;
}
