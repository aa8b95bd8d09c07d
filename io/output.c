/* io/output.c: the seam through which every file is written: beside its place, and then renamed, so that no reader ever
 * meets half a file. */
#include "io/io.h"
#include "io/number.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct plm_output {
    FILE *file;
    char *path, *part;
    bool is_broken;
};

static void output_free(plm_output *output)
{
    plm_free(output->path);
    plm_free(output->part);
    plm_free(output);
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
    made->file = fopen(made->part, "wb");
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
    if (fclose(output->file) != 0) status = broken(output, error);
    if (ok && status == PLM_OK && rename(output->part, output->path) != 0) status = broken(output, error);
    if (!ok || status != PLM_OK) unlink(output->part);
    output_free(output);
    return status;
}
