/* io/cloud_read.c: finding out what a file is, by its content. */
#include "io/readers.h"

#include <string.h>

static bool begins_with(const plm_bytes *bytes, const char *text)
{
    const size_t length = strlen(text);
    return bytes->size >= length && memcmp(bytes->data, text, length) == 0;
}

static bool is_ply(const plm_bytes *bytes)
{
    return begins_with(bytes, "ply\n") || begins_with(bytes, "ply\r\n");
}

static const struct {
    plm_format format;
    bool (*is_it)(const plm_bytes *bytes);
    plm_reader *read;
} readers[] = {
    {PLM_FORMAT_PLY, is_ply, plm_ply_read},
};

static plm_status read_bytes(const plm_bytes *bytes, const plm_read_options *options, plm_cloud *cloud,
                             plm_read_report *report, plm_error *error)
{
    static const plm_read_options defaults = {0};
    plm_read_report met = {0};
    plm_cloud made = {0};
    if (bytes->size == 0) return plm_fail(error, PLM_E_FORMAT, "%s: is empty, a point cloud was expected", bytes->name);
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++) {
        if (!readers[i].is_it(bytes)) continue;
        met.format = readers[i].format;
        const plm_status status = readers[i].read(bytes, options ? options : &defaults, &made, &met, error);
        if (status != PLM_OK) return status;
        *cloud = made;
        if (report) *report = met;
        return PLM_OK;
    }
    char shown[PLM_SHOWN_LENGTH];
    return plm_fail(error, PLM_E_FORMAT, "%s: byte 0: begins with \"%s\", a PLY file was expected", bytes->name,
                    plm_show(bytes->data, bytes->size < 8 ? bytes->size : 8, shown));
}

plm_status plm_cloud_read(const char *path, const plm_read_options *options, plm_cloud *cloud, plm_read_report *report,
                          plm_error *error)
{
    plm_bytes bytes;
    plm_status status = plm_bytes_open(path, &bytes, error);
    if (status != PLM_OK) return status;
    status = read_bytes(&bytes, options, cloud, report, error);
    plm_bytes_close(&bytes);
    return status;
}

plm_status plm_cloud_parse(const void *data, size_t size, const char *name, const plm_read_options *options,
                           plm_cloud *cloud, plm_read_report *report, plm_error *error)
{
    const plm_bytes bytes = plm_bytes_wrap(data, size, name);
    return read_bytes(&bytes, options, cloud, report, error);
}
