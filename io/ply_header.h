/* io/ply_header.h: the header of a PLY file, for clouds (read_ply.c) and meshes (read_mesh_ply.c). Internal to io/. */
#ifndef PLANTIMETER_IO_PLY_HEADER_H
#define PLANTIMETER_IO_PLY_HEADER_H

#include "io/columns.h"

enum { PLM_PLY_ELEMENTS = 64, PLM_PLY_PROPERTIES = 8192 };

typedef struct plm_ply_property {
    plm_scalar type;
    plm_scalar count_type; /* of a list */
    bool is_list;
    const char *name; /* in the file's bytes */
    size_t name_size;
} plm_ply_property;

typedef struct plm_ply_element {
    bool is_vertex, is_face;
    uint64_t rows;
    size_t first_property, property_count;
} plm_ply_element;

typedef struct plm_ply_header {
    const plm_bytes *bytes;
    size_t line; /* number of the line being read */
    bool is_ascii, is_little;
    plm_ply_element elements[PLM_PLY_ELEMENTS];
    size_t element_count, vertex; /* vertex: number of the element, or PLM_PLY_ELEMENTS */
    plm_ply_property *properties;
    size_t property_count, property_room;
    plm_columns columns; /* one a property of the vertices */
    size_t body;         /* byte of the first element's first row */
} plm_ply_header;

/** Reads the header. Free with plm_ply_header_free, also on failure. PLM_E_FORMAT (line, found, expected), PLM_E_MEMORY. */
plm_status plm_ply_header_read(const plm_bytes *bytes, plm_ply_header *header, plm_error *error);
void plm_ply_header_free(plm_ply_header *header);

/** True of a property of that name. */
bool plm_ply_is_named(const plm_ply_property *property, const char *name);

/** The least that a row of an element takes in a binary body: its scalars, and the lengths of its lists. */
size_t plm_ply_smallest_row(const plm_ply_header *header, const plm_ply_element *element, bool *has_list);

/** The rows that an element claims must fit into what is left of the file from byte `at` on, before anything is allocated for
 * them. PLM_E_FORMAT. */
plm_status plm_ply_check_rows(const plm_ply_header *header, const plm_ply_element *element, size_t at, size_t row_size,
                              plm_error *error);

#endif
