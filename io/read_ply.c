/* io/read_ply.c: PLY (G. Turk, The PLY polygon file format, 1994), ascii and binary of both byte orders, and PLY files
 * of 3D gaussians, which are told by their properties.
 *
 * Points are the element `vertex`. Binary points without lists are read where they lie; elements before them and lists
 * inside them are passed over. */
#include "io/ascii.h"
#include "io/ply_header.h"
#include "io/readers.h"

#include <stdio.h>
#include <string.h>

/* ---- Binary bodies ------------------------------------------------------------------------------------------- */

/* The bytes of the property at byte `at`, a list with its length; false where the file ends before. */
static bool property_size(const plm_ply_header *header, const plm_ply_property *property, size_t at, size_t *size)
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
static plm_status walk_rows(const plm_ply_header *header, const plm_ply_element *element, size_t *at,
                            unsigned char *packed, plm_error *error)
{
    for (uint64_t row = 0; row < element->rows; row++)
        for (size_t i = 0; i < element->property_count; i++) {
            const plm_ply_property *property = &header->properties[element->first_property + i];
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
static plm_status pass_element(const plm_ply_header *header, const plm_ply_element *element, size_t *at,
                               plm_error *error)
{
    bool has_list;
    const size_t row_size = plm_ply_smallest_row(header, element, &has_list);
    const plm_status status = plm_ply_check_rows(header, element, *at, row_size, error);
    if (status != PLM_OK || row_size == 0) return status;
    if (has_list) return walk_rows(header, element, at, NULL, error);
    *at += (size_t)element->rows * row_size;
    return PLM_OK;
}

/* Points the columns to the numbers: in the file, or in a packed copy without the lists. */
static plm_status place_vertices(plm_ply_header *header, size_t at, void **block, plm_error *error)
{
    const plm_ply_element *vertex = &header->elements[header->vertex];
    bool has_list;
    size_t row_size = plm_ply_smallest_row(header, vertex, &has_list);
    plm_status status = plm_ply_check_rows(header, vertex, at, row_size, error);
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

static plm_status read_binary(plm_ply_header *header, void **block, plm_error *error)
{
    size_t at = header->body;
    plm_status status = PLM_OK;
    for (size_t i = 0; i < header->vertex && status == PLM_OK; i++)
        status = pass_element(header, &header->elements[i], &at, error);
    return status == PLM_OK ? place_vertices(header, at, block, error) : status;
}

/* ---- Text bodies --------------------------------------------------------------------------------------------- */

static plm_status read_ascii(plm_ply_header *header, const plm_roles *roles, void **block, plm_error *error)
{
    const plm_ply_element *vertex = &header->elements[header->vertex];
    plm_ascii_place place = {.begin = header->body, .line = header->line, .rows = vertex->rows};
    for (size_t i = 0; i < header->vertex; i++) {
        const plm_status status = plm_ply_check_rows(header, &header->elements[i], header->body, 1, error);
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
    plm_ply_header header;
    plm_roles roles;
    void *block = NULL;
    plm_status status = plm_ply_header_read(bytes, &header, error);
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
    plm_ply_header_free(&header);
    return status;
}
