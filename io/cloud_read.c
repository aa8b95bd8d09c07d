/* io/cloud_read.c: finding out what a file is, by its content. */
#include "io/ascii.h"
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

static bool is_las(const plm_bytes *bytes)
{
    return begins_with(bytes, "LASF");
}

/* Comments, and then a line VERSION or FIELDS. */
static bool is_pcd(const plm_bytes *bytes)
{
    const char *end = (const char *)bytes->data + bytes->size;
    for (const char *at = (const char *)bytes->data; at < end;) {
        const plm_line line = plm_line_at(at, end);
        at = line.next;
        if (plm_line_is_empty(&line, true)) continue;
        const plm_bytes rest = {.data = (const unsigned char *)line.begin, .size = (size_t)(line.end - line.begin)};
        return begins_with(&rest, "VERSION ") || begins_with(&rest, "FIELDS ") || begins_with(&rest, "COLUMNS ");
    }
    return false;
}

/* No control characters near the beginning. */
static bool is_text(const plm_bytes *bytes)
{
    enum { LOOKED_AT = 1024 };
    for (size_t i = 0; i < bytes->size && i < LOOKED_AT; i++)
        if (bytes->data[i] < 0x20 && !memchr("\t\n\r\f", bytes->data[i], 4)) return false;
    return true;
}

static const struct {
    plm_format format;
    bool (*is_it)(const plm_bytes *bytes);
    plm_reader *read;
} readers[] = {
    {PLM_FORMAT_PLY, is_ply, plm_ply_read},
    {PLM_FORMAT_LAS, is_las, plm_las_read},
    {PLM_FORMAT_PCD, is_pcd, plm_pcd_read},
    {PLM_FORMAT_TEXT, is_text, plm_text_read},
};

/* What users try and what they can do about it. */
static const struct {
    const char *beginning, *advice;
} others[] = {
    {"\x1f\x8b", "is compressed by gzip: unpack it first"},
    {"PK\x03\x04", "is a zip archive (or a spreadsheet): unpack it, or export it as CSV"},
    {"\xff\xfe", "is UTF-16 text: save it as UTF-8"},
    {"\xfe\xff", "is UTF-16 text: save it as UTF-8"},
    {"ASTM-E57", "is an E57 file: convert it to PLY or LAS"},
};

static plm_status unknown(const plm_bytes *bytes, plm_error *error)
{
    char shown[PLM_SHOWN_LENGTH];
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (begins_with(bytes, others[i].beginning))
            return plm_fail(error, PLM_E_FORMAT, "%s: byte 0: %s", bytes->name, others[i].advice);
    return plm_fail(error, PLM_E_FORMAT,
                    "%s: byte 0: begins with \"%s\"; PLY, PCD, LAS or text with rows of numbers was expected",
                    bytes->name, plm_show(bytes->data, bytes->size < 8 ? bytes->size : 8, shown));
}

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
    return unknown(bytes, error);
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
