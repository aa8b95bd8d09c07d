/* io/read_las.c: LAS 1.0 to 1.4 (American Society for Photogrammetry and Remote Sensing, LAS Specification 1.4 - R15,
 * 2019), uncompressed, point formats 0-3 and 6-8.
 *
 *   byte  24 version major, minor      94 header size (2)        96 where the points begin (4)
 *        104 point format             105 bytes of a point (2)  107 number of points (4; 1.4: 8 at byte 247)
 *        131 scale x y z (3 doubles)  155 offset x y z (3 doubles) */
#include "io/readers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** Where a point format has its fields; 0: it lacks them. */
typedef struct las_format {
    size_t size; /* 0: not supported */
    size_t classification, colour;
    uint8_t classification_mask, withheld_mask; /* the flags stand in byte 15 */
} las_format;

static const las_format formats[] = {
    [0] = {20, 15, 0, 0x1f, 0x80},  [1] = {28, 15, 0, 0x1f, 0x80}, [2] = {26, 15, 20, 0x1f, 0x80},
    [3] = {34, 15, 28, 0x1f, 0x80}, [6] = {30, 16, 0, 0, 0x04},    [7] = {36, 16, 30, 0, 0x04},
    [8] = {38, 16, 30, 0, 0x04},
};

enum { SMALLEST_HEADER = 227, HEADER_1_4 = 375, INTENSITY = 12, FLAGS = 15 };

/* A little-endian number of the header. */
static uint64_t whole(const unsigned char *at, size_t size)
{
    uint64_t value = 0;
    for (size_t i = size; i-- > 0;) value = value << 8 | at[i];
    return value;
}

static double real(const unsigned char *at)
{
    const uint64_t bits = whole(at, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

typedef struct las_header {
    int minor;
    unsigned format;
    size_t begin, record;
    uint64_t points;
    double scale[3], shift[3];
} las_header;

static plm_status read_header(const plm_bytes *bytes, las_header *header, plm_error *error)
{
    const unsigned char *data = bytes->data;
    if (bytes->size < SMALLEST_HEADER)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: the file ends within the LAS header of %d bytes",
                        bytes->name, bytes->size, SMALLEST_HEADER);
    if (data[24] != 1 || data[25] > 4)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte 24: LAS version %d.%d, 1.0 to 1.4 was expected", bytes->name,
                        data[24], data[25]);
    *header = (las_header){.minor = data[25], .format = data[104], .begin = whole(data + 96, 4)};
    header->record = whole(data + 105, 2);
    header->points = whole(data + 107, 4);
    if (header->minor == 4 && bytes->size >= HEADER_1_4) header->points = whole(data + 247, 8);
    for (int axis = 0; axis < 3; axis++) {
        header->scale[axis] = real(data + 131 + 8 * axis);
        header->shift[axis] = real(data + 155 + 8 * axis);
    }
    return PLM_OK;
}

static plm_status check_header(const plm_bytes *bytes, const las_header *header, plm_error *error)
{
    if (header->format & 0xc0)
        return plm_fail(error, PLM_E_FORMAT,
                        "%s: byte 104: the points are compressed (LAZ), which is not read; convert the "
                        "file with `laszip` or `pdal translate` to LAS",
                        bytes->name);
    if (header->format >= sizeof formats / sizeof *formats || formats[header->format].size == 0)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte 104: point format %u, 0 to 3 or 6 to 8 was expected",
                        bytes->name, header->format);
    if (header->record < formats[header->format].size)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte 105: points of %zu bytes, at least %zu were expected",
                        bytes->name, header->record, formats[header->format].size);
    for (int axis = 0; axis < 3; axis++)
        if (!(fabs(header->scale[axis]) > 0 && isfinite(header->scale[axis]) && isfinite(header->shift[axis])))
            return plm_fail(error, PLM_E_FORMAT,
                            "%s: byte %d: scale %g and offset %g along %c, finite numbers and a scale "
                            "that is not 0 were expected",
                            bytes->name, 131 + 8 * axis, header->scale[axis], header->shift[axis], "xyz"[axis]);
    if (header->begin < SMALLEST_HEADER || header->begin > bytes->size)
        return plm_fail(error, PLM_E_FORMAT,
                        "%s: byte 96: points begin at byte %zu, between %d and the file's %zu bytes was "
                        "expected",
                        bytes->name, header->begin, SMALLEST_HEADER, bytes->size);
    if (header->points > (bytes->size - header->begin) / header->record)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: %llu points of %zu bytes were expected, %zu bytes are left",
                        bytes->name, header->begin, (unsigned long long)header->points, header->record,
                        bytes->size - header->begin);
    return PLM_OK;
}

static plm_status add_column(plm_columns *columns, const plm_bytes *bytes, const las_header *header, const char *name,
                             plm_scalar type, size_t offset, plm_error *error)
{
    plm_column *column = plm_columns_add(columns, name, strlen(name), type, error);
    if (!column) return PLM_E_MEMORY;
    column->data = bytes->data + header->begin + offset;
    column->stride = header->record;
    column->is_swapped = !plm_host_is_little();
    return PLM_OK;
}

static plm_status add_columns(plm_columns *columns, const plm_bytes *bytes, const las_header *header, plm_error *error)
{
    static const char *const xyz[] = {"x", "y", "z"}, *const rgb[] = {"red", "green", "blue"};
    const las_format *format = &formats[header->format];
    plm_status status = PLM_OK;
    for (size_t k = 0; k < 3 && status == PLM_OK; k++) {
        status = add_column(columns, bytes, header, xyz[k], PLM_INT32, 4 * k, error);
        if (status != PLM_OK) return status;
        columns->column[k].scale = header->scale[k];
        columns->column[k].shift = header->shift[k];
    }
    status = add_column(columns, bytes, header, "intensity", PLM_UINT16, INTENSITY, error);
    if (status == PLM_OK) {
        status = add_column(columns, bytes, header, "classification", PLM_UINT8, format->classification, error);
        if (status == PLM_OK) columns->column[columns->count - 1].mask = format->classification_mask;
    }
    if (status == PLM_OK) {
        status = add_column(columns, bytes, header, "withheld", PLM_UINT8, FLAGS, error);
        if (status == PLM_OK) columns->column[columns->count - 1].mask = format->withheld_mask;
    }
    for (size_t k = 0; k < 3 && status == PLM_OK && format->colour; k++)
        status = add_column(columns, bytes, header, rgb[k], PLM_UINT16, format->colour + 2 * k, error);
    columns->rows = (size_t)header->points;
    return status;
}

plm_status plm_las_read(const plm_bytes *bytes, const plm_read_options *options, plm_cloud *cloud,
                        plm_read_report *report, plm_error *error)
{
    las_header header = {0};
    plm_columns columns = {0};
    plm_roles roles;
    plm_status status = read_header(bytes, &header, error);
    if (status == PLM_OK) status = check_header(bytes, &header, error);
    if (status == PLM_OK) status = add_columns(&columns, bytes, &header, error);
    if (status == PLM_OK) status = plm_roles_find(&columns, bytes, options, &roles, report, error);
    if (status == PLM_OK) {
        snprintf(report->description, sizeof report->description, "LAS 1.%d, point format %u", header.minor,
                 header.format);
        status = plm_columns_to_cloud(&columns, &roles, bytes, options, cloud, report, error);
    }
    plm_columns_free(&columns);
    return status;
}
