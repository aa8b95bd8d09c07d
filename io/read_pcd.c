/* io/read_pcd.c: PCD 0.6 and 0.7 of the Point Cloud Library: ascii, binary, and binary_compressed (LZF, column after
 * column). */
#include "io/ascii.h"
#include "io/lzf.h"
#include "io/number.h"
#include "io/readers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_FIELDS = 256, MOST_ITEMS = 8192 };

typedef struct pcd_field {
    const char *name;
    size_t name_size;
    unsigned long long size, count;
    char type; /* I, U or F */
} pcd_field;

typedef enum pcd_body { PCD_ASCII, PCD_BINARY, PCD_COMPRESSED } pcd_body;

typedef struct pcd_header {
    const plm_bytes *bytes;
    size_t line;
    pcd_field fields[MOST_FIELDS];
    size_t field_count;
    bool has_points;
    unsigned long long points, width, height;
    pcd_body body;
    size_t begin, row_size; /* of the body */
    plm_columns columns;    /* one a number of a row */
} pcd_header;

static plm_status fault(const pcd_header *header, const char *begin, const char *stop, const char *expected,
                        plm_error *error)
{
    char shown[PLM_SHOWN_LENGTH];
    return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: found \"%s\", %s was expected", header->bytes->name,
                    header->line, plm_show(begin, (size_t)(stop - begin), shown), expected);
}

static bool is_word(const char *begin, const char *stop, const char *word)
{
    return (size_t)(stop - begin) == strlen(word) && memcmp(begin, word, strlen(word)) == 0;
}

static plm_status read_fields(pcd_header *header, const char *at, const char *end, plm_error *error)
{
    const char *begin, *stop;
    while (plm_item_next(&at, end, ' ', &begin, &stop)) {
        if (header->field_count == MOST_FIELDS) return fault(header, begin, stop, "at most 256 fields", error);
        header->fields[header->field_count++] =
            (pcd_field){.name = begin, .name_size = (size_t)(stop - begin), .size = 4, .count = 1, .type = 'F'};
    }
    return PLM_OK;
}

/* A line of SIZE, TYPE or COUNT: one item a field. */
static plm_status read_of_fields(pcd_header *header, char which, const char *at, const char *end, plm_error *error)
{
    const char *begin, *stop;
    for (size_t i = 0; i < header->field_count; i++) {
        pcd_field *field = &header->fields[i];
        if (!plm_item_next(&at, end, ' ', &begin, &stop)) return fault(header, end, end, "one value a field", error);
        if (which == 'T') {
            if (stop - begin != 1 || !memchr("IUF", *begin, 3)) return fault(header, begin, stop, "I, U or F", error);
            field->type = *begin;
        } else if (which == 'S') {
            if (!plm_number_whole(begin, (size_t)(stop - begin), &field->size) ||
                (field->size != 1 && field->size != 2 && field->size != 4 && field->size != 8))
                return fault(header, begin, stop, "a size of 1, 2, 4 or 8 bytes", error);
        } else if (!plm_number_whole(begin, (size_t)(stop - begin), &field->count) || field->count > MOST_ITEMS) {
            return fault(header, begin, stop, "a count of at most 8192", error);
        }
    }
    return plm_item_next(&at, end, ' ', &begin, &stop) ? fault(header, begin, stop, "one value a field", error)
                                                       : PLM_OK;
}

static plm_status read_whole(pcd_header *header, const char *at, const char *end, unsigned long long *number,
                             plm_error *error)
{
    const char *begin = end, *stop = end;
    if (plm_item_next(&at, end, ' ', &begin, &stop) && plm_number_whole(begin, (size_t)(stop - begin), number))
        return PLM_OK;
    return fault(header, begin, stop, "a whole number", error);
}

static plm_status read_data(pcd_header *header, const char *at, const char *end, plm_error *error)
{
    const char *begin = end, *stop = end;
    plm_item_next(&at, end, ' ', &begin, &stop);
    if (is_word(begin, stop, "ascii"))
        header->body = PCD_ASCII;
    else if (is_word(begin, stop, "binary"))
        header->body = PCD_BINARY;
    else if (is_word(begin, stop, "binary_compressed"))
        header->body = PCD_COMPRESSED;
    else
        return fault(header, begin, stop, "ascii, binary or binary_compressed", error);
    return PLM_OK;
}

static plm_status read_header_line(pcd_header *header, const plm_line *line, bool *is_end, plm_error *error)
{
    const char *at = line->begin, *begin, *stop;
    if (plm_line_is_empty(line, true) || !plm_item_next(&at, line->end, ' ', &begin, &stop)) return PLM_OK;
    if (is_word(begin, stop, "VERSION") || is_word(begin, stop, "VIEWPOINT")) return PLM_OK;
    if (is_word(begin, stop, "FIELDS") || is_word(begin, stop, "COLUMNS"))
        return read_fields(header, at, line->end, error);
    if (is_word(begin, stop, "SIZE") || is_word(begin, stop, "TYPE") || is_word(begin, stop, "COUNT"))
        return read_of_fields(header, *begin, at, line->end, error);
    if (is_word(begin, stop, "WIDTH")) return read_whole(header, at, line->end, &header->width, error);
    if (is_word(begin, stop, "HEIGHT")) return read_whole(header, at, line->end, &header->height, error);
    if (is_word(begin, stop, "POINTS")) {
        header->has_points = true;
        return read_whole(header, at, line->end, &header->points, error);
    }
    if (!is_word(begin, stop, "DATA"))
        return fault(header, begin, stop, "FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA", error);
    *is_end = true;
    return read_data(header, at, line->end, error);
}

static bool scalar_of(const pcd_field *field, plm_scalar *type)
{
    const bool is_packed = (field->name_size == 3 && memcmp(field->name, "rgb", 3) == 0) ||
                           (field->name_size == 4 && memcmp(field->name, "rgba", 4) == 0);
    if (is_packed && field->size == 4) {
        *type = PLM_UINT32; /* whatever TYPE says: PCL declares the colour's bits as a float */
        return true;
    }
    if (field->type == 'F') {
        *type = field->size == 8 ? PLM_FLOAT64 : PLM_FLOAT32;
        return field->size >= 4;
    }
    const int order = field->size == 1 ? 0 : field->size == 2 ? 1 : field->size == 4 ? 2 : 3;
    static const plm_scalar whole[2][4] = {{PLM_INT8, PLM_INT16, PLM_INT32, PLM_INT64},
                                           {PLM_UINT8, PLM_UINT16, PLM_UINT32, PLM_UINT64}};
    *type = whole[field->type == 'U'][order];
    return true;
}

/* One column a number; of a field with several, the others go without a name. */
static plm_status add_columns(pcd_header *header, plm_error *error)
{
    for (size_t i = 0; i < header->field_count; i++) {
        const pcd_field *field = &header->fields[i];
        plm_scalar type;
        if (!scalar_of(field, &type))
            return plm_fail(error, PLM_E_FORMAT, "%s: field %zu is a float of %llu bytes, 4 or 8 were expected",
                            header->bytes->name, i + 1, field->size);
        for (size_t k = 0; k < field->count; k++) {
            if (header->columns.count == MOST_ITEMS)
                return plm_fail(error, PLM_E_FORMAT, "%s: more than %d numbers a point", header->bytes->name,
                                MOST_ITEMS);
            if (!plm_columns_add(&header->columns, field->name, k ? 0 : field->name_size, type, error))
                return PLM_E_MEMORY;
        }
        header->row_size += field->size * field->count;
    }
    return PLM_OK;
}

static plm_status read_header(pcd_header *header, plm_error *error)
{
    const char *start = (const char *)header->bytes->data, *end = start + header->bytes->size;
    plm_line line = {.next = start};
    bool is_end = false;
    header->height = 1;
    for (header->line = 1; !is_end; header->line++) {
        if (line.next == end)
            return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: the file ends within the header, DATA was expected",
                            header->bytes->name, header->line);
        line = plm_line_at(line.next, end);
        const plm_status status = read_header_line(header, &line, &is_end, error);
        if (status != PLM_OK) return status;
    }
    header->begin = (size_t)(line.next - start);
    if (!header->has_points) {
        if (header->height && header->width > header->bytes->size / header->height)
            return plm_fail(error, PLM_E_FORMAT, "%s: %llu x %llu points do not fit into a file of %zu bytes",
                            header->bytes->name, header->width, header->height, header->bytes->size);
        header->points = header->width * header->height;
    }
    return add_columns(header, error);
}

/* Fields one after the other, each with all its points, or points one after the other, each with all its fields. */
static void point_columns(pcd_header *header, const unsigned char *data)
{
    const bool by_field = header->body == PCD_COMPRESSED;
    plm_column *column = header->columns.column;
    for (size_t i = 0; i < header->field_count; i++) {
        const pcd_field *field = &header->fields[i];
        for (size_t k = 0; k < field->count; k++, column++) {
            column->data = data + k * field->size;
            column->stride = by_field ? field->size * field->count : header->row_size;
            column->is_swapped = !plm_host_is_little();
        }
        data += field->size * field->count * (by_field ? header->points : 1);
    }
    header->columns.rows = (size_t)header->points;
}

static plm_status read_binary(pcd_header *header, plm_error *error)
{
    const size_t left = header->bytes->size - header->begin;
    if (header->row_size && header->points > left / header->row_size)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: %llu points of %zu bytes were expected, %zu bytes are left",
                        header->bytes->name, header->begin, header->points, header->row_size, left);
    point_columns(header, header->bytes->data + header->begin);
    return PLM_OK;
}

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static plm_status read_compressed(pcd_header *header, void **block, plm_error *error)
{
    const plm_bytes *bytes = header->bytes;
    const size_t left = bytes->size - header->begin;
    const unsigned char *at = bytes->data + header->begin;
    if (left < 8)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: two sizes of 4 bytes were expected, %zu bytes are left",
                        bytes->name, header->begin, left);
    const size_t packed = read_u32(at), unpacked = read_u32(at + 4);
    if (packed > left - 8)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: %zu compressed bytes were expected, %zu bytes are left",
                        bytes->name, header->begin, packed, left - 8);
    const bool fits = header->points == 0 || header->row_size <= unpacked / header->points;
    if (!fits || header->row_size * header->points != unpacked || unpacked / PLM_LZF_MOST > packed)
        return plm_fail(error, PLM_E_FORMAT,
                        "%s: byte %zu: %zu bytes in %zu compressed ones, %llu points of %zu bytes were "
                        "expected",
                        bytes->name, header->begin + 4, unpacked, packed, header->points, header->row_size);
    unsigned char *numbers = *block = plm_alloc(unpacked, 1, error);
    if (!numbers) return PLM_E_MEMORY;
    size_t stop;
    if (!plm_lzf_decompress(at + 8, packed, numbers, unpacked, &stop))
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: the compressed points are damaged", bytes->name,
                        header->begin + 8 + stop);
    point_columns(header, numbers);
    return PLM_OK;
}

/* In text a colour is the whole number 0xRRGGBB or, by PCL's habit, the float that has these bits. */
static void unpack_text_colours(const plm_column *column, unsigned char *numbers, size_t rows)
{
    for (size_t i = 0; i < rows; i++, numbers += column->stride) {
        double value;
        memcpy(&value, numbers, sizeof value);
        if (value >= 1 && value <= UINT32_MAX) continue;
        const float single = (float)value;
        uint32_t bits;
        memcpy(&bits, &single, sizeof bits);
        value = bits;
        memcpy(numbers, &value, sizeof value);
    }
}

static plm_status read_ascii(pcd_header *header, const plm_roles *roles, void **block, plm_error *error)
{
    const plm_ascii ascii = {.separator = ' ', .decimal = '.', .item_count = header->columns.count};
    const plm_ascii_place place = {.begin = header->begin, .line = header->line, .rows = header->points};
    const plm_status status = plm_ascii_read(header->bytes, &ascii, &place, roles, &header->columns, block, error);
    const plm_column *packed = roles->column[PLM_ROLE_PACKED_COLOUR];
    if (status == PLM_OK && packed)
        unpack_text_colours(packed, (unsigned char *)*block + (packed->data - (const unsigned char *)*block),
                            header->columns.rows);
    return status;
}

plm_status plm_pcd_read(const plm_bytes *bytes, const plm_read_options *options, plm_cloud *cloud,
                        plm_read_report *report, plm_error *error)
{
    static const char *const bodies[] = {"ascii", "binary", "binary_compressed"};
    pcd_header header = {.bytes = bytes};
    plm_roles roles;
    void *block = NULL;
    plm_status status = read_header(&header, error);
    if (status == PLM_OK) status = plm_roles_find(&header.columns, bytes, options, &roles, report, error);
    if (status == PLM_OK)
        status = header.body == PCD_ASCII    ? read_ascii(&header, &roles, &block, error)
                 : header.body == PCD_BINARY ? read_binary(&header, error)
                                             : read_compressed(&header, &block, error);
    if (status == PLM_OK) {
        snprintf(report->description, sizeof report->description, "PCD, %s", bodies[header.body]);
        status = plm_columns_to_cloud(&header.columns, &roles, bytes, options, cloud, report, error);
    }
    plm_free(block);
    plm_columns_free(&header.columns);
    return status;
}
