/* io/read_mesh_ply.c: meshes as PLY, ascii and binary of both byte orders: the elements vertex (x, y, z) and face (a list of
 * vertex numbers; label and organ where they are written). Other elements and properties are passed over. */
#include "io/number.h"
#include "io/ply_header.h"
#include "io/read_mesh.h"

#include <stdio.h>
#include <string.h>

/** The body, number by number. */
typedef struct ply_body {
    const plm_ply_header *header;
    size_t at;
    double *list; /* the last list that was read */
    size_t list_count, list_room;
} ply_body;

static plm_status ended(const ply_body *body, plm_error *error)
{
    return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: the file ends within the numbers that its header tells of",
                    body->header->bytes->name, body->at);
}

static bool is_space(unsigned char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* Moves to the next number of an ascii body. */
static void skip_space(ply_body *body)
{
    const plm_bytes *bytes = body->header->bytes;
    while (body->header->is_ascii && body->at < bytes->size && is_space(bytes->data[body->at])) body->at++;
}

/* The next number of the body. */
static plm_status next_number(ply_body *body, plm_scalar type, double *value, plm_error *error)
{
    const plm_bytes *bytes = body->header->bytes;
    if (!body->header->is_ascii) {
        const size_t size = plm_scalar_size(type);
        if (size > bytes->size - body->at) return ended(body, error);
        const plm_column one = {.type = type,
                                .is_swapped = body->header->is_little != plm_host_is_little(),
                                .data = bytes->data + body->at};
        plm_column_load(&one, 0, 1, value);
        body->at += size;
        return PLM_OK;
    }
    skip_space(body);
    if (body->at == bytes->size) return ended(body, error);
    const char *begin = (const char *)bytes->data + body->at, *end = (const char *)bytes->data + bytes->size,
               *stop = begin;
    while (stop < end && !is_space((unsigned char)*stop)) stop++;
    char shown[PLM_SHOWN_LENGTH];
    if (plm_number_scan(begin, stop, '.', value) != stop)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: found \"%s\", a number was expected", bytes->name, body->at,
                        plm_show(begin, (size_t)(stop - begin), shown));
    body->at += (size_t)(stop - begin);
    return PLM_OK;
}

static plm_status next_list(ply_body *body, const plm_ply_property *property, plm_error *error)
{
    skip_space(body);
    const size_t begin = body->at;
    const size_t least = body->header->is_ascii ? 2 : plm_scalar_size(property->type); /* bytes of an entry */
    double count;
    plm_status status = next_number(body, property->count_type, &count, error);
    if (status != PLM_OK) return status;
    if (!(count >= 0 && count <= (double)((body->header->bytes->size - body->at) / least + 1)) ||
        count != (double)(size_t)count)
        return plm_fail(error, PLM_E_FORMAT, "%s: byte %zu: a list of %.17g entries; %zu bytes are left",
                        body->header->bytes->name, begin, count, body->header->bytes->size - body->at);
    body->list_count = (size_t)count;
    if (body->list_count > body->list_room) {
        double *larger = plm_realloc(body->list, body->list_count, sizeof *larger, error);
        if (!larger) return PLM_E_MEMORY;
        body->list = larger;
        body->list_room = body->list_count;
    }
    for (size_t k = 0; k < body->list_count && status == PLM_OK; k++)
        status = next_number(body, property->type, &body->list[k], error);
    return status;
}

/** What the properties of an element are to a mesh; the places of them in the element, or -1. */
typedef struct mesh_roles {
    long xyz[3], corners, label, organ;
} mesh_roles;

static mesh_roles find_roles(const plm_ply_header *header, const plm_ply_element *element)
{
    mesh_roles roles = {{-1, -1, -1}, -1, -1, -1};
    for (size_t k = 0; k < element->property_count; k++) {
        const plm_ply_property *property = &header->properties[element->first_property + k];
        if (property->is_list && element->is_face &&
            (plm_ply_is_named(property, "vertex_indices") || plm_ply_is_named(property, "vertex_index")))
            roles.corners = (long)k;
        if (property->is_list) continue;
        static const char *const axis[] = {"x", "y", "z"};
        for (int i = 0; i < 3; i++)
            if (plm_ply_is_named(property, axis[i])) roles.xyz[i] = (long)k;
        if (plm_ply_is_named(property, "label")) roles.label = (long)k;
        if (plm_ply_is_named(property, "organ")) roles.organ = (long)k;
    }
    return roles;
}

static plm_status check_roles(const plm_ply_header *header, const plm_ply_element *element, const mesh_roles *roles,
                              plm_error *error)
{
    const char *name = header->bytes->name;
    if (element->is_vertex && (roles->xyz[0] < 0 || roles->xyz[1] < 0 || roles->xyz[2] < 0))
        return plm_fail(error, PLM_E_FORMAT, "%s: the element vertex has no property %s", name,
                        roles->xyz[0] < 0   ? "x"
                        : roles->xyz[1] < 0 ? "y"
                                            : "z");
    if (element->is_face && roles->corners < 0)
        return plm_fail(error, PLM_E_FORMAT, "%s: the element face has no list vertex_indices", name);
    return PLM_OK;
}

static uint8_t label_of(double value)
{
    return value > 0 && value < PLM_LABEL_COUNT ? (uint8_t)value : (uint8_t)PLM_LABEL_OTHER;
}

static int32_t organ_of(double value)
{
    return value > -1 && value < 2147483647 ? (int32_t)value : -1;
}

/* One row of an element. */
static plm_status read_row(ply_body *body, const plm_ply_element *element, const mesh_roles *roles,
                           plm_mesh_draft *draft, plm_error *error)
{
    const plm_ply_header *header = body->header;
    double xyz[3] = {0}, label = 0, organ = -1;
    double *corner = NULL;
    size_t corners = 0;
    char place[40];
    skip_space(body);
    snprintf(place, sizeof place, "byte %zu", body->at);
    plm_status status = PLM_OK;
    for (size_t k = 0; k < element->property_count && status == PLM_OK; k++) {
        const plm_ply_property *property = &header->properties[element->first_property + k];
        double value = 0;
        status =
            property->is_list ? next_list(body, property, error) : next_number(body, property->type, &value, error);
        if ((long)k == roles->corners && status == PLM_OK) { /* kept: a later list of the row would take its place */
            corner = body->list;
            corners = body->list_count;
            body->list = NULL;
            body->list_room = 0;
        }
        for (int i = 0; i < 3; i++)
            if ((long)k == roles->xyz[i]) xyz[i] = value;
        if ((long)k == roles->label) label = value;
        if ((long)k == roles->organ) organ = value;
    }
    if (status == PLM_OK && element->is_vertex) status = plm_mesh_draft_vertex(draft, xyz, place, error);
    if (status == PLM_OK && element->is_face)
        status = plm_mesh_draft_polygon(draft, corner, corners, (size_t)header->elements[header->vertex].rows,
                                        label_of(label), organ_of(organ), place, error);
    if (corner && !body->list) { /* used again for the next row */
        body->list = corner;
        body->list_room = corners;
    } else {
        plm_free(corner);
    }
    return status;
}

static plm_status read_element(ply_body *body, const plm_ply_element *element, plm_mesh_draft *draft, plm_error *error)
{
    const mesh_roles roles = find_roles(body->header, element);
    bool has_list;
    size_t least = plm_ply_smallest_row(body->header, element, &has_list);
    if (body->header->is_ascii) least = element->property_count; /* a digit each; the last needs nothing behind it */
    plm_status status = check_roles(body->header, element, &roles, error);
    if (status == PLM_OK) status = plm_ply_check_rows(body->header, element, body->at, least, error);
    if (status == PLM_OK && !element->property_count) return PLM_OK;
    draft->has_label |= element->is_face && roles.label >= 0;
    draft->has_organ |= element->is_face && roles.organ >= 0;
    for (uint64_t row = 0; row < element->rows && status == PLM_OK; row++)
        status = read_row(body, element, &roles, draft, error);
    return status;
}

plm_status plm_mesh_read_ply(const plm_bytes *bytes, plm_mesh_draft *draft, plm_error *error)
{
    plm_ply_header header;
    plm_status status = plm_ply_header_read(bytes, &header, error);
    bool has_faces = false;
    for (size_t k = 0; status == PLM_OK && k < header.element_count; k++) has_faces |= header.elements[k].is_face;
    if (status == PLM_OK && !has_faces)
        status = plm_fail(error, PLM_E_FORMAT, "%s: has points but no element face; a mesh was expected", bytes->name);
    ply_body body = {.header = &header, .at = header.body};
    for (size_t k = 0; status == PLM_OK && k < header.element_count; k++)
        status = read_element(&body, &header.elements[k], draft, error);
    plm_free(body.list);
    plm_ply_header_free(&header);
    return status;
}
