/* io/ply_header.c: the header of a PLY file (G. Turk, The PLY polygon file format, 1994): elements, their properties, and where
 * the first row begins. */
#include "io/ply_header.h"
#include "io/ascii.h"
#include "io/number.h"

#include <string.h>

/** A word of a header line. */
typedef struct ply_word {
    const char *text;
    size_t size;
} ply_word;

static bool word_is(const ply_word *word, const char *text)
{
    return word->size == strlen(text) && memcmp(word->text, text, word->size) == 0;
}

static plm_status header_fault(const plm_ply_header *header, const ply_word *found, const char *expected,
                               plm_error *error)
{
    char shown[PLM_SHOWN_LENGTH];
    return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: found \"%s\", %s was expected", header->bytes->name,
                    header->line, plm_show(found->text, found->size, shown), expected);
}

static plm_status read_format(plm_ply_header *header, const ply_word *words, plm_error *error)
{
    if (word_is(&words[1], "ascii"))
        header->is_ascii = true;
    else if (word_is(&words[1], "binary_little_endian"))
        header->is_little = true;
    else if (!word_is(&words[1], "binary_big_endian"))
        return header_fault(header, &words[1], "ascii, binary_little_endian or binary_big_endian", error);
    return word_is(&words[2], "1.0") ? PLM_OK : header_fault(header, &words[2], "version 1.0", error);
}

static plm_status read_element(plm_ply_header *header, const ply_word *words, plm_error *error)
{
    unsigned long long rows;
    if (!plm_number_whole(words[2].text, words[2].size, &rows))
        return header_fault(header, &words[2], "a number of elements", error);
    if (header->element_count == PLM_PLY_ELEMENTS)
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: more than %d elements", header->bytes->name, header->line,
                        PLM_PLY_ELEMENTS);
    const bool is_vertex = word_is(&words[1], "vertex");
    if (is_vertex && header->vertex != PLM_PLY_ELEMENTS)
        return header_fault(header, &words[1], "only one element vertex", error);
    if (is_vertex) header->vertex = header->element_count;
    header->elements[header->element_count++] = (plm_ply_element){.is_vertex = is_vertex,
                                                                  .is_face = word_is(&words[1], "face"),
                                                                  .rows = rows,
                                                                  .first_property = header->property_count};
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

static plm_status add_property(plm_ply_header *header, const plm_ply_property *property, const ply_word *name,
                               plm_error *error)
{
    if (header->property_count == PLM_PLY_PROPERTIES)
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: more than %d properties", header->bytes->name, header->line,
                        PLM_PLY_PROPERTIES);
    if (header->property_count == header->property_room) {
        const size_t room = header->property_room ? 2 * header->property_room : 32;
        plm_ply_property *larger = plm_realloc(header->properties, room, sizeof *larger, error);
        if (!larger) return PLM_E_MEMORY;
        header->properties = larger;
        header->property_room = room;
    }
    plm_ply_element *element = &header->elements[header->element_count - 1];
    header->properties[header->property_count++] = *property;
    element->property_count++;
    if (!element->is_vertex) return PLM_OK;
    /* A list stands among the columns so that they match the properties; its name is no field. */
    plm_column *column = plm_columns_add(&header->columns, property->is_list ? "" : name->text,
                                         property->is_list ? 0 : name->size, property->type, error);
    if (!column) return PLM_E_MEMORY;
    column->is_list = property->is_list;
    return PLM_OK;
}

static plm_status read_property(plm_ply_header *header, const ply_word *words, size_t count, plm_error *error)
{
    plm_ply_property property = {.is_list = word_is(&words[1], "list")};
    const ply_word *type = property.is_list ? &words[3] : &words[1];
    if (header->element_count == 0) return header_fault(header, &words[0], "an element before its properties", error);
    if (count < (property.is_list ? 5u : 3u))
        return header_fault(header, &words[0], "a property's type and name", error);
    if (property.is_list && (!read_type(&words[2], &property.count_type) || property.count_type >= PLM_FLOAT32))
        return header_fault(header, &words[2], "the whole-number type of a list's length", error);
    if (!read_type(type, &property.type)) return header_fault(header, type, "a type such as float or uchar", error);
    const ply_word *name = &words[property.is_list ? 4 : 2];
    property.name = name->text;
    property.name_size = name->size;
    return add_property(header, &property, name, error);
}

/* One line of the header; sets is_end at end_header. */
static plm_status read_header_line(plm_ply_header *header, const plm_line *line, bool *is_end, bool *has_format,
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

plm_status plm_ply_header_read(const plm_bytes *bytes, plm_ply_header *header, plm_error *error)
{
    *header = (plm_ply_header){.bytes = bytes, .vertex = PLM_PLY_ELEMENTS};
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
    if (header->vertex == PLM_PLY_ELEMENTS)
        return plm_fail(error, PLM_E_FORMAT, "%s: has no element vertex, points were expected", header->bytes->name);
    return PLM_OK;
}

void plm_ply_header_free(plm_ply_header *header)
{
    plm_free(header->properties);
    plm_columns_free(&header->columns);
    header->properties = NULL;
}

bool plm_ply_is_named(const plm_ply_property *property, const char *name)
{
    return property->name_size == strlen(name) && memcmp(property->name, name, property->name_size) == 0;
}

size_t plm_ply_smallest_row(const plm_ply_header *header, const plm_ply_element *element, bool *has_list)
{
    size_t size = 0;
    *has_list = false;
    for (size_t i = 0; i < element->property_count; i++) {
        const plm_ply_property *property = &header->properties[element->first_property + i];
        *has_list |= property->is_list;
        size += plm_scalar_size(property->is_list ? property->count_type : property->type);
    }
    return size;
}

plm_status plm_ply_check_rows(const plm_ply_header *header, const plm_ply_element *element, size_t at, size_t row_size,
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
