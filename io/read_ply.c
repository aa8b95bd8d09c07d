/* io/read_ply.c: PLY (G. Turk, The PLY polygon file format, 1994), ascii and binary of both byte orders, and PLY files
 * of 3D gaussians, which are told by their properties.
 *
 * Points are the element `vertex`. Binary points without lists are read where they lie; elements before them and lists
 * inside them are passed over. */
#include "io/ascii.h"
#include "io/number.h"
#include "io/readers.h"

#include <stdio.h>
#include <string.h>

enum { MOST_ELEMENTS = 64, MOST_PROPERTIES = 8192 };

typedef struct ply_property {
    plm_scalar type;
    plm_scalar count_type; /* of a list */
    bool is_list;
} ply_property;

typedef struct ply_element {
    bool is_vertex;
    uint64_t rows;
    size_t first_property, property_count;
} ply_element;

typedef struct ply_header {
    const plm_bytes *bytes;
    size_t line; /* number of the line being read */
    bool is_ascii, is_little;
    ply_element elements[MOST_ELEMENTS];
    size_t element_count, vertex; /* vertex: number of the element, or MOST_ELEMENTS */
    ply_property *properties;
    size_t property_count, property_room;
    plm_columns columns; /* one a property of the vertices */
    size_t body;         /* byte of the first element's first row */
} ply_header;

/** A word of a header line. */
typedef struct ply_word {
    const char *text;
    size_t size;
} ply_word;

static bool word_is(const ply_word *word, const char *text)
{
    return word->size == strlen(text) && memcmp(word->text, text, word->size) == 0;
}

static plm_status header_fault(const ply_header *header, const ply_word *found, const char *expected, plm_error *error)
{
    char shown[PLM_SHOWN_LENGTH];
    return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: found \"%s\", %s was expected", header->bytes->name,
                    header->line, plm_show(found->text, found->size, shown), expected);
}

static plm_status read_format(ply_header *header, const ply_word *words, plm_error *error)
{
    if (word_is(&words[1], "ascii"))
        header->is_ascii = true;
    else if (word_is(&words[1], "binary_little_endian"))
        header->is_little = true;
    else if (!word_is(&words[1], "binary_big_endian"))
        return header_fault(header, &words[1], "ascii, binary_little_endian or binary_big_endian", error);
    return word_is(&words[2], "1.0") ? PLM_OK : header_fault(header, &words[2], "version 1.0", error);
}

static plm_status read_element(ply_header *header, const ply_word *words, plm_error *error)
{
    unsigned long long rows;
    if (!plm_number_whole(words[2].text, words[2].size, &rows))
        return header_fault(header, &words[2], "a number of elements", error);
    if (header->element_count == MOST_ELEMENTS)
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: more than %d elements", header->bytes->name, header->line,
                        MOST_ELEMENTS);
    const bool is_vertex = word_is(&words[1], "vertex");
    if (is_vertex && header->vertex != MOST_ELEMENTS)
        return header_fault(header, &words[1], "only one element vertex", error);
    if (is_vertex) header->vertex = header->element_count;
    header->elements[header->element_count++] =
        (ply_element){.is_vertex = is_vertex, .rows = rows, .first_property = header->property_count};
    return PLM_OK;
}

static bool read_type(const ply_word *word, plm_scalar *type)
{
    static const struct {
        const char *name;
        plm_scalar type;
    } types[] = {{"char", PLM_INT8},       {"uchar", PLM_UINT8},    {"short", PLM_INT16},   {"ushort", PLM_UINT16},
                 {"int", PLM_INT32},       {"uint", PLM_UINT32},    {"float", PLM_FLOAT32}, {"double", PLM_FLOAT64},
                 {"int8", PLM_INT8},       {"uint8", PLM_UINT8},    {"int16", PLM_INT16},   {"uint16", PLM_UINT16},
                 {"int32", PLM_INT32},     {"uint32", PLM_UINT32},  {"int64", PLM_INT64},   {"uint64", PLM_UINT64},
                 {"float32", PLM_FLOAT32}, {"float64", PLM_FLOAT64}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (word_is(word, types[i].name)) {
            *type = types[i].type;
            return true;
        }
    return false;
}

static plm_status add_property(ply_header *header, const ply_property *property, const ply_word *name, plm_error *error)
{
    if (header->property_count == MOST_PROPERTIES)
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: more than %d properties", header->bytes->name, header->line,
                        MOST_PROPERTIES);
    if (header->property_count == header->property_room) {
        const size_t room = header->property_room ? 2 * header->property_room : 32;
        ply_property *larger = plm_realloc(header->properties, room, sizeof *larger, error);
        if (!larger) return PLM_E_MEMORY;
        header->properties = larger;
        header->property_room = room;
    }
    ply_element *element = &header->elements[header->element_count - 1];
    header->properties[header->property_count++] = *property;
    element->property_count++;
    if (!element->is_vertex) return PLM_OK;
    /* A list stands among the columns so that they match the properties; its name is no field. */
    return plm_columns_add(&header->columns, property->is_list ? "" : name->text, property->is_list ? 0 : name->size,
                           property->type, error)
               ? PLM_OK
               : PLM_E_MEMORY;
}

static plm_status read_property(ply_header *header, const ply_word *words, size_t count, plm_error *error)
{
    ply_property property = {.is_list = word_is(&words[1], "list")};
    const ply_word *type = property.is_list ? &words[3] : &words[1];
    if (header->element_count == 0) return header_fault(header, &words[0], "an element before its properties", error);
    if (count < (property.is_list ? 5u : 3u))
        return header_fault(header, &words[0], "a property's type and name", error);
    if (property.is_list && (!read_type(&words[2], &property.count_type) || property.count_type >= PLM_FLOAT32))
        return header_fault(header, &words[2], "the whole-number type of a list's length", error);
    if (!read_type(type, &property.type)) return header_fault(header, type, "a type such as float or uchar", error);
    return add_property(header, &property, &words[property.is_list ? 4 : 2], error);
}

/* One line of the header; sets is_end at end_header. */
static plm_status read_header_line(ply_header *header, const plm_line *line, bool *is_end, bool *has_format,
                                   plm_error *error)
{
    enum { MOST_WORDS = 6 };
    ply_word words[MOST_WORDS] = {{"", 0}, {"", 0}, {"", 0}, {"", 0}, {"", 0}, {"", 0}};
    size_t count = 0;
    const char *at = line->begin, *begin, *stop;
    while (count < MOST_WORDS && plm_item_next(&at, line->end, ' ', &begin, &stop))
        words[count++] = (ply_word){begin, (size_t)(stop - begin)};
    if (count == 0 || word_is(&words[0], "comment") || word_is(&words[0], "obj_info")) return PLM_OK;
    if (word_is(&words[0], "end_header")) {
        *is_end = true;
        return *has_format ? PLM_OK : header_fault(header, &words[0], "a line `format`", error);
    }
    if (word_is(&words[0], "format")) {
        *has_format = true;
        return read_format(header, words, error);
    }
    if (word_is(&words[0], "element")) return read_element(header, words, error);
    if (word_is(&words[0], "property")) return read_property(header, words, count, error);
    return header_fault(header, &words[0], "format, comment, element, property or end_header", error);
}

static plm_status read_header(ply_header *header, plm_error *error)
{
    const char *start = (const char *)header->bytes->data, *end = start + header->bytes->size;
    plm_line line = plm_line_at(start, end); /* "ply" */
    bool is_end = false, has_format = false;
    for (header->line = 2; !is_end; header->line++) {
        if (line.next == end)
            return plm_fail(error, PLM_E_FORMAT,
                            "%s: line %zu: the file ends within the header, end_header was expected",
                            header->bytes->name, header->line);
        line = plm_line_at(line.next, end);
        const plm_status status = read_header_line(header, &line, &is_end, &has_format, error);
        if (status != PLM_OK) return status;
    }
    header->body = (size_t)(line.next - start);
    if (header->vertex == MOST_ELEMENTS)
        return plm_fail(error, PLM_E_FORMAT, "%s: has no element vertex, points were expected", header->bytes->name);
    return PLM_OK;
}

/* ---- Binary bodies ------------------------------------------------------------------------------------------- */

/* The least that a row of an element takes: its scalars, and the lengths of its lists. */
static size_t smallest_row(const ply_header *header, const ply_element *element, bool *has_list)
{
    size_t size = 0;
    *has_list = false;
    for (size_t i = 0; i < element->property_count; i++) {
        const ply_property *property = &header->properties[element->first_property + i];
        *has_list |= property->is_list;
        size += plm_scalar_size(property->is_list ? property->count_type : property->type);
    }
    return size;
}

/* The rows that an element claims must fit into what is left of the file, before anything is allocated for them. */
static plm_status check_rows(const ply_header *header, const ply_element *element, size_t at, size_t row_size,
                             plm_error *error)
{
    const size_t left = header->bytes->size - at;
    if (row_size == 0 || element->rows <= left / row_size) return PLM_OK;
    return plm_fail(
        error, PLM_E_FORMAT,
        "%s: byte %zu: the header says %llu rows of at least %zu bytes for element %zu, but only %zu bytes are "
        "left",
        header->bytes->name, at, (unsigned long long)element->rows, row_size, (size_t)(element - header->elements) + 1,
        left);
}

/* The bytes of the property at byte `at`, a list with its length; false where the file ends before. */
static bool property_size(const ply_header *header, const ply_property *property, size_t at, size_t *size)
{
    const size_t left = header->bytes->size - at, one = plm_scalar_size(property->type);
    *size = one;
    if (property->is_list) {
        const size_t head = plm_scalar_size(property->count_type);
        if (left < head) return false;
        const plm_column length = {.type = property->count_type,
                                   .is_swapped = header->is_little != plm_host_is_little(),
                                   .data = header->bytes->data + at};
        double count;
        plm_column_load(&length, 0, 1, &count);
        if (!(count >= 0) || count > (double)((left - head) / one)) return false;
        *size = head + (size_t)count * one;
    }
    return *size <= left;
}

/* Walks the rows of an element from byte *at on. Where packed is given, their scalars are copied there. */
static plm_status walk_rows(const ply_header *header, const ply_element *element, size_t *at, unsigned char *packed,
                            plm_error *error)
{
    for (uint64_t row = 0; row < element->rows; row++)
        for (size_t i = 0; i < element->property_count; i++) {
            const ply_property *property = &header->properties[element->first_property + i];
            size_t size;
            if (!property_size(header, property, *at, &size))
                return plm_fail(error, PLM_E_FORMAT,
                                "%s: byte %zu: row %llu of %llu of element %zu reaches beyond the file",
                                header->bytes->name, *at, (unsigned long long)row + 1,
                                (unsigned long long)element->rows, (size_t)(element - header->elements) + 1);
            if (packed && !property->is_list) {
                memcpy(packed, header->bytes->data + *at, size);
                packed += size;
            }
            *at += size;
        }
    return PLM_OK;
}

/* Moves *at behind an element. */
static plm_status pass_element(const ply_header *header, const ply_element *element, size_t *at, plm_error *error)
{
    bool has_list;
    const size_t row_size = smallest_row(header, element, &has_list);
    const plm_status status = check_rows(header, element, *at, row_size, error);
    if (status != PLM_OK || row_size == 0) return status;
    if (has_list) return walk_rows(header, element, at, NULL, error);
    *at += (size_t)element->rows * row_size;
    return PLM_OK;
}

/* Points the columns to the numbers: in the file, or in a packed copy without the lists. */
static plm_status place_vertices(ply_header *header, size_t at, void **block, plm_error *error)
{
    const ply_element *vertex = &header->elements[header->vertex];
    bool has_list;
    size_t row_size = smallest_row(header, vertex, &has_list);
    plm_status status = check_rows(header, vertex, at, row_size, error);
    if (status != PLM_OK) return status;
    const unsigned char *data = header->bytes->data + at;
    if (has_list) {
        row_size = 0;
        for (size_t i = 0; i < vertex->property_count; i++)
            if (!header->properties[vertex->first_property + i].is_list)
                row_size += plm_scalar_size(header->columns.column[i].type);
        *block = plm_alloc((size_t)vertex->rows, row_size, error);
        if (!*block) return PLM_E_MEMORY;
        data = *block;
        status = walk_rows(header, vertex, &at, *block, error);
        if (status != PLM_OK) return status;
    }
    for (size_t i = 0; i < vertex->property_count; i++) {
        plm_column *column = &header->columns.column[i];
        if (header->properties[vertex->first_property + i].is_list) continue;
        column->data = data;
        column->stride = row_size;
        column->is_swapped = header->is_little != plm_host_is_little();
        data += plm_scalar_size(column->type);
    }
    header->columns.rows = (size_t)vertex->rows;
    return PLM_OK;
}

static plm_status read_binary(ply_header *header, void **block, plm_error *error)
{
    size_t at = header->body;
    plm_status status = PLM_OK;
    for (size_t i = 0; i < header->vertex && status == PLM_OK; i++)
        status = pass_element(header, &header->elements[i], &at, error);
    return status == PLM_OK ? place_vertices(header, at, block, error) : status;
}

/* ---- Text bodies --------------------------------------------------------------------------------------------- */

static plm_status read_ascii(ply_header *header, const plm_roles *roles, void **block, plm_error *error)
{
    const ply_element *vertex = &header->elements[header->vertex];
    plm_ascii_place place = {.begin = header->body, .line = header->line, .rows = vertex->rows};
    for (size_t i = 0; i < header->vertex; i++) {
        const plm_status status = check_rows(header, &header->elements[i], header->body, 1, error);
        if (status != PLM_OK) return status;
        if (header->elements[i].property_count) place.skip += header->elements[i].rows;
    }
    bool *is_list = plm_alloc(vertex->property_count, sizeof *is_list, error);
    if (!is_list) return PLM_E_MEMORY;
    for (size_t i = 0; i < vertex->property_count; i++)
        is_list[i] = header->properties[vertex->first_property + i].is_list;
    const plm_ascii ascii = {
        .separator = ' ', .decimal = '.', .is_list = is_list, .item_count = vertex->property_count};
    const plm_status status = plm_ascii_read(header->bytes, &ascii, &place, roles, &header->columns, block, error);
    plm_free(is_list);
    return status;
}

plm_status plm_ply_read(const plm_bytes *bytes, const plm_read_options *options, plm_cloud *cloud,
                        plm_read_report *report, plm_error *error)
{
    ply_header header = {.bytes = bytes, .vertex = MOST_ELEMENTS};
    plm_roles roles;
    void *block = NULL;
    plm_status status = read_header(&header, error);
    if (status == PLM_OK) status = plm_roles_find(&header.columns, bytes, options, &roles, report, error);
    if (status == PLM_OK)
        status = header.is_ascii ? read_ascii(&header, &roles, &block, error) : read_binary(&header, &block, error);
    if (status == PLM_OK) {
        const char *body = header.is_ascii ? "ascii" : header.is_little ? "binary little-endian" : "binary big-endian";
        snprintf(report->description, sizeof report->description, "PLY%s, %s", roles.is_splat ? " of 3D gaussians" : "",
                 body);
        status = plm_columns_to_cloud(&header.columns, &roles, bytes, options, cloud, report, error);
    }
    plm_free(block);
    plm_free(header.properties);
    plm_columns_free(&header.columns);
    return status;
}
