/* io/read_mesh.c: meshes from files: finding out the format by the content, and the mesh that the readers fill. */
#include "io/read_mesh.h"
#include "io/ascii.h"

#include <math.h>
#include <string.h>

/* Coordinates beyond this are none, as for clouds. */
static const double farthest = 1e18;

plm_status plm_mesh_draft_vertex(plm_mesh_draft *draft, const double xyz[3], const char *place, plm_error *error)
{
    for (int axis = 0; axis < 3; axis++)
        if (!(fabs(xyz[axis]) <= farthest))
            return plm_fail(error, PLM_E_FORMAT, "%s: %s: vertex %zu has the coordinate %g", draft->bytes->name, place,
                            draft->vertex_count, xyz[axis]);
    if (draft->vertex_count == draft->vertex_room) {
        const size_t room = draft->vertex_room ? 2 * draft->vertex_room : 256;
        void *larger = plm_realloc(draft->vertex, room, sizeof *draft->vertex, error);
        if (!larger) return PLM_E_MEMORY;
        draft->vertex = larger;
        draft->vertex_room = room;
    }
    memcpy(draft->vertex[draft->vertex_count++], xyz, 3 * sizeof *xyz);
    return PLM_OK;
}

static plm_status make_room(plm_mesh_draft *draft, size_t triangles, plm_error *error)
{
    size_t room = draft->triangle_room ? draft->triangle_room : 256;
    if (draft->triangle_count + triangles <= draft->triangle_room) return PLM_OK;
    while (room < draft->triangle_count + triangles) room *= 2;
    void *triangle = plm_realloc(draft->triangle, room, sizeof *draft->triangle, error);
    if (!triangle) return PLM_E_MEMORY;
    draft->triangle = triangle;
    void *organ = plm_realloc(draft->organ, room, sizeof *draft->organ, error);
    if (!organ) return PLM_E_MEMORY;
    draft->organ = organ;
    void *label = plm_realloc(draft->label, room, sizeof *draft->label, error);
    if (!label) return PLM_E_MEMORY;
    draft->label = label;
    draft->triangle_room = room;
    return PLM_OK;
}

plm_status plm_mesh_draft_polygon(plm_mesh_draft *draft, const double *corner, size_t count, size_t vertices,
                                  uint8_t label, int32_t organ, const char *place, plm_error *error)
{
    if (count < 3)
        return plm_fail(error, PLM_E_FORMAT, "%s: %s: a face of %zu corners; at least 3 were expected",
                        draft->bytes->name, place, count);
    for (size_t k = 0; k < count; k++)
        if (!(corner[k] >= 0 && corner[k] < (double)vertices && corner[k] == floor(corner[k])))
            return plm_fail(error, PLM_E_FORMAT, "%s: %s: a face names vertex %.17g (from 0 on) of %zu",
                            draft->bytes->name, place, corner[k], vertices);
    const plm_status status = make_room(draft, count - 2, error);
    if (status != PLM_OK) return status;
    for (size_t k = 1; k + 1 < count; k++) {
        const size_t at = draft->triangle_count++;
        const double fan[3] = {corner[0], corner[k], corner[k + 1]};
        for (int i = 0; i < 3; i++) draft->triangle[at][i] = (uint32_t)fan[i];
        draft->label[at] = label;
        draft->organ[at] = organ;
    }
    return PLM_OK;
}

/* The middle of the vertices becomes the origin, so that offsets are small. */
static void centre(plm_mesh *mesh)
{
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < mesh->vertex_count; i++) {
            low = fmin(low, mesh->vertex[i][axis]);
            high = fmax(high, mesh->vertex[i][axis]);
        }
        mesh->origin[axis] = 0.5 * low + 0.5 * high;
        for (size_t i = 0; i < mesh->vertex_count; i++) mesh->vertex[i][axis] -= mesh->origin[axis];
    }
}

static bool is_ply(const plm_bytes *bytes)
{
    return bytes->size >= 4 && memcmp(bytes->data, "ply", 3) == 0 && (bytes->data[3] == '\n' || bytes->data[3] == '\r');
}

/* The first line that is not blank and no comment begins with a word of OBJ. */
static bool is_obj(const plm_bytes *bytes)
{
    static const char *const words[] = {"v", "vn", "vt", "vp", "f", "o", "g", "s", "l", "mtllib", "usemtl"};
    const char *end = (const char *)bytes->data + bytes->size;
    for (const char *at = (const char *)bytes->data; at < end;) {
        const plm_line line = plm_line_at(at, end);
        const char *begin, *stop, *from = line.begin;
        at = line.next;
        if (plm_line_is_empty(&line, true) || !plm_item_next(&from, line.end, ' ', &begin, &stop)) continue;
        for (size_t k = 0; k < sizeof words / sizeof *words; k++)
            if ((size_t)(stop - begin) == strlen(words[k]) && !memcmp(begin, words[k], strlen(words[k]))) return true;
        return false;
    }
    return false;
}

static plm_status finish(plm_mesh_draft *draft, plm_mesh *mesh, uint8_t **face_label, plm_error *error)
{
    if (!draft->triangle_count)
        return plm_fail(error, PLM_E_FORMAT, "%s: has no faces, a mesh was expected", draft->bytes->name);
    *mesh = (plm_mesh){.vertex_count = draft->vertex_count,
                       .triangle_count = draft->triangle_count,
                       .vertex = draft->vertex,
                       .triangle = draft->triangle,
                       .face_organ = draft->has_organ ? draft->organ : NULL};
    centre(mesh);
    if (face_label) *face_label = draft->has_label ? draft->label : NULL;
    if (!face_label || !draft->has_label) plm_free(draft->label);
    if (!draft->has_organ) plm_free(draft->organ);
    *draft = (plm_mesh_draft){0};
    return PLM_OK;
}

static plm_status read_bytes(const plm_bytes *bytes, plm_mesh *mesh, uint8_t **face_label, plm_error *error)
{
    plm_mesh_draft draft = {.bytes = bytes};
    char shown[PLM_SHOWN_LENGTH];
    plm_status status;
    if (bytes->size == 0)
        status = plm_fail(error, PLM_E_FORMAT, "%s: is empty, a mesh was expected", bytes->name);
    else if (is_ply(bytes))
        status = plm_mesh_read_ply(bytes, &draft, error);
    else if (is_obj(bytes))
        status = plm_mesh_read_obj(bytes, &draft, error);
    else
        status = plm_fail(error, PLM_E_FORMAT, "%s: byte 0: begins with \"%s\"; a mesh as PLY or OBJ was expected",
                          bytes->name, plm_show(bytes->data, bytes->size < 8 ? bytes->size : 8, shown));
    if (status == PLM_OK) status = finish(&draft, mesh, face_label, error);
    plm_free(draft.vertex);
    plm_free(draft.triangle);
    plm_free(draft.organ);
    plm_free(draft.label);
    return status;
}

plm_status plm_mesh_read(const char *path, plm_mesh *mesh, uint8_t **face_label, plm_error *error)
{
    plm_bytes bytes;
    plm_status status = plm_bytes_open(path, &bytes, error);
    if (status != PLM_OK) return status;
    status = read_bytes(&bytes, mesh, face_label, error);
    plm_bytes_close(&bytes);
    return status;
}

plm_status plm_mesh_parse(const void *data, size_t size, const char *name, plm_mesh *mesh, uint8_t **face_label,
                          plm_error *error)
{
    const plm_bytes bytes = plm_bytes_wrap(data, size, name);
    return read_bytes(&bytes, mesh, face_label, error);
}
