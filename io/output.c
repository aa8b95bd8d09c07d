/* io/output.c: the seam through which every file is written: beside its place, and then renamed, so that no reader ever
 * meets half a file. Where the file system can, the file has no name until it is whole: then not even a killed program
 * leaves anything behind. */
#define _GNU_SOURCE /* O_TMPFILE */
#include "io/io.h"
#include "io/number.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct plm_output {
    FILE *file;
    char *path, *part;
    bool is_broken;
    bool is_nameless; /* the file gets its name at the end */
};

static void output_free(plm_output *output)
{
    plm_free(output->path);
    plm_free(output->part);
    plm_free(output);
}

/* The file under the descriptor, as a path that linkat follows. */
static void descriptor_path(int descriptor, char path[64])
{
    snprintf(path, 64, "/proc/self/fd/%d", descriptor);
}

/* A file without a name in the folder of path; NULL where the system has none. */
static FILE *open_nameless(const char *path)
{
#ifdef O_TMPFILE
    char folder[4096], self[64];
    const char *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash - path) : 0;
    if (length >= sizeof folder) return NULL;
    memcpy(folder, path, length);
    folder[length] = 0;
    const int descriptor = open(length ? folder : slash ? "/" : ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor < 0) return NULL;
    descriptor_path(descriptor, self);
    FILE *file = access(self, F_OK) == 0 ? fdopen(descriptor, "wb") : NULL;
    if (!file) close(descriptor);
    return file;
#else
    (void)path;
    return NULL;
#endif
}

/* Gives a nameless file its name beside its place, over what an earlier run may have left there. */
static bool name_file(const plm_output *output)
{
    char self[64];
    descriptor_path(fileno(output->file), self);
    if (linkat(AT_FDCWD, self, AT_FDCWD, output->part, AT_SYMLINK_FOLLOW) == 0) return true;
    return errno == EEXIST && unlink(output->part) == 0 &&
           linkat(AT_FDCWD, self, AT_FDCWD, output->part, AT_SYMLINK_FOLLOW) == 0;
}

plm_status plm_output_open(const char *path, plm_output **output, plm_error *error)
{
    static const char ending[] = ".part";
    plm_output *made = plm_alloc_zero(1, sizeof *made, error);
    if (!made) return PLM_E_MEMORY;
    const size_t length = strlen(path);
    made->path = plm_strdup(path, error);
    made->part = made->path ? plm_alloc(length + sizeof ending, 1, error) : NULL;
    if (!made->part) {
        output_free(made);
        return PLM_E_MEMORY;
    }
    memcpy(made->part, path, length);
    memcpy(made->part + length, ending, sizeof ending);
    made->file = open_nameless(path);
    made->is_nameless = made->file != NULL;
    if (!made->file) made->file = fopen(made->part, "wb");
    if (!made->file) {
        output_free(made);
        return plm_fail(error, PLM_E_WRITE, "%s: cannot be opened for writing: %s", path, strerror(errno));
    }
    *output = made;
    return PLM_OK;
}

/* Only the first failure is told: what follows it is its consequence. */
static plm_status broken(plm_output *output, plm_error *error)
{
    const int reason = errno;
    if (output->is_broken) return PLM_E_WRITE;
    output->is_broken = true;
    return plm_fail(error, PLM_E_WRITE, "%s: cannot be written: %s", output->path, strerror(reason));
}

plm_status plm_output_write(plm_output *output, const void *data, size_t size, plm_error *error)
{
    return size == 0 || fwrite(data, 1, size, output->file) == size ? PLM_OK : broken(output, error);
}

plm_status plm_output_print(plm_output *output, plm_error *error, const char *format, ...)
{
    plm_locale locale = plm_locale_enter(); /* numbers in files have a point, whatever the user's language */
    va_list arguments;
    va_start(arguments, format);
    const int written = vfprintf(output->file, format, arguments);
    va_end(arguments);
    plm_locale_leave(&locale);
    return written >= 0 ? PLM_OK : broken(output, error);
}

plm_status plm_output_close(plm_output *output, bool ok, plm_error *error)
{
    plm_status status = output->is_broken ? PLM_E_WRITE : PLM_OK;
    if (fflush(output->file) != 0) status = broken(output, error);
    bool is_named = !output->is_nameless;
    if (ok && status == PLM_OK && !is_named) {
        is_named = name_file(output);
        if (!is_named) status = broken(output, error);
    }
    if (fclose(output->file) != 0) status = broken(output, error);
    if (ok && status == PLM_OK && rename(output->part, output->path) != 0) status = broken(output, error);
    if (is_named && (!ok || status != PLM_OK)) unlink(output->part);
    output_free(output);
    return status;
}
