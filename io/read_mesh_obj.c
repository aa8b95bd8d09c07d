/* io/read_mesh_obj.c: Wavefront OBJ: lines v and f; each line o or g begins an organ. What else stands there is passed over. */
#include "io/ascii.h"
#include "io/number.h"
#include "io/read_mesh.h"

#include <stdio.h>
#include <string.h>

/** The file being read. */
typedef struct obj_reader {
    plm_mesh_draft *draft;
    size_t line;
    int32_t organ;        /* the last o or g; -1 before */
    bool has_faces_since; /* a g behind an o names the same organ where no face came between */
    double *corner;
    size_t corner_room;
} obj_reader;

static plm_status fault(const obj_reader *reader, const char *begin, const char *stop, const char *expected,
                        plm_error *error)
{
    char shown[PLM_SHOWN_LENGTH];
    return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: found \"%s\", %s was expected", reader->draft->bytes->name,
                    reader->line, plm_show(begin, (size_t)(stop - begin), shown), expected);
}

static plm_status read_vertex(obj_reader *reader, const plm_line *line, const char *at, plm_error *error)
{
    char place[40];
    double xyz[3];
    const char *begin, *stop;
    for (int axis = 0; axis < 3; axis++) {
        if (!plm_item_next(&at, line->end, ' ', &begin, &stop))
            return fault(reader, line->begin, line->end, "v and three coordinates", error);
        if (plm_number_scan(begin, stop, '.', &xyz[axis]) != stop)
            return fault(reader, begin, stop, "a coordinate", error);
    }
    snprintf(place, sizeof place, "line %zu", reader->line);
    return plm_mesh_draft_vertex(reader->draft, xyz, place, error);
}

static plm_status add_corner(obj_reader *reader, size_t at, double value, plm_error *error)
{
    if (at == reader->corner_room) {
        const size_t room = reader->corner_room ? 2 * reader->corner_room : 16;
        double *larger = plm_realloc(reader->corner, room, sizeof *larger, error);
        if (!larger) return PLM_E_MEMORY;
        reader->corner = larger;
        reader->corner_room = room;
    }
    reader->corner[at] = value;
    return PLM_OK;
}

/* Corners are VERTEX, VERTEX/TEXTURE or VERTEX/TEXTURE/NORMAL, from 1 on, or counted back from the last with a minus. */
static plm_status read_face(obj_reader *reader, const plm_line *line, const char *at, plm_error *error)
{
    char place[40];
    size_t count = 0;
    const char *begin, *stop;
    const size_t vertices = reader->draft->vertex_count;
    while (plm_item_next(&at, line->end, ' ', &begin, &stop)) {
        const char *slash = memchr(begin, '/', (size_t)(stop - begin)), *end = slash ? slash : stop;
        double number;
        if (plm_number_scan(begin, end, '.', &number) != end || number == 0)
            return fault(reader, begin, stop, "the number of a vertex", error);
        const plm_status status =
            add_corner(reader, count++, number > 0 ? number - 1 : (double)vertices + number, error);
        if (status != PLM_OK) return status;
    }
    snprintf(place, sizeof place, "line %zu", reader->line);
    reader->has_faces_since = true;
    return plm_mesh_draft_polygon(reader->draft, reader->corner, count, vertices, PLM_LABEL_OTHER, reader->organ, place,
                                  error);
}

static plm_status read_line(obj_reader *reader, const plm_line *line, plm_error *error)
{
    const char *at = line->begin, *begin, *stop;
    if (plm_line_is_empty(line, true) || !plm_item_next(&at, line->end, ' ', &begin, &stop) || stop != begin + 1)
        return PLM_OK;
    switch (*begin) {
        case 'v':
            return read_vertex(reader, line, at, error);
        case 'f':
            return read_face(reader, line, at, error);
        case 'o':
        case 'g':
            if (reader->organ < 0 || reader->has_faces_since) reader->organ++;
            reader->has_faces_since = false;
            reader->draft->has_organ = true;
            return PLM_OK;
        default:
            return PLM_OK;
    }
}

plm_status plm_mesh_read_obj(const plm_bytes *bytes, plm_mesh_draft *draft, plm_error *error)
{
    obj_reader reader = {.draft = draft, .organ = -1};
    const char *end = (const char *)bytes->data + bytes->size;
    plm_status status = PLM_OK;
    for (const char *at = (const char *)bytes->data; at < end && status == PLM_OK;) {
        const plm_line line = plm_line_at(at, end);
        reader.line++;
        status = read_line(&reader, &line, error);
        at = line.next;
    }
    plm_free(reader.corner);
    return status;
}
