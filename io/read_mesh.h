/* io/read_mesh.h: what the readers of meshes share: a mesh that grows, vertex by vertex and polygon by polygon. Internal to io/. */
#ifndef PLANTIMETER_IO_READ_MESH_H
#define PLANTIMETER_IO_READ_MESH_H

#include "io/bytes.h"
#include "io/io.h"

/** A mesh under way. Organs and labels are those of the triangles; they count only where has_organ or has_label is set. */
typedef struct plm_mesh_draft {
    const plm_bytes *bytes;
    double (*vertex)[3];
    uint32_t (*triangle)[3];
    int32_t *organ;
    uint8_t *label;
    size_t vertex_count, vertex_room, triangle_count, triangle_room;
    bool has_organ, has_label;
} plm_mesh_draft;

/** Adds a vertex; place ("line 7", "byte 312") is for the message. PLM_E_FORMAT for numbers that are no coordinates. */
plm_status plm_mesh_draft_vertex(plm_mesh_draft *draft, const double xyz[3], const char *place, plm_error *error);

/** Adds a polygon as a fan of triangles about its first corner. corner: numbers of vertices from 0 on, as doubles so that
 * whatever stands in a file can be told; each must be below vertices. PLM_E_FORMAT below three corners or for a vertex
 * that is not there. */
plm_status plm_mesh_draft_polygon(plm_mesh_draft *draft, const double *corner, size_t count, size_t vertices,
                                  uint8_t label, int32_t organ, const char *place, plm_error *error);

/** The readers: all bytes of the file in, a draft out (the caller frees it, also on failure). */
plm_status plm_mesh_read_ply(const plm_bytes *bytes, plm_mesh_draft *draft, plm_error *error);
plm_status plm_mesh_read_obj(const plm_bytes *bytes, plm_mesh_draft *draft, plm_error *error);

#endif
