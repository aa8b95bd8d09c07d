/* io/writers.h: what the writers of clouds have in common. Internal to io/. */
#ifndef PLANTIMETER_IO_WRITERS_H
#define PLANTIMETER_IO_WRITERS_H

#include "io/columns.h"

/** A field of a file that is written: name, type, and where its numbers stand in a packed row. */
typedef struct plm_out_field {
    const char *name;
    plm_scalar type;
} plm_out_field;

enum { PLM_OUT_FIELDS = 16, PLM_OUT_ROW = 128 };

/** The fields of a cloud, in the order in which they are written. */
typedef struct plm_out_layout {
    plm_out_field field[PLM_OUT_FIELDS];
    size_t count, row_size;
    bool is_pcd;
} plm_out_layout;

/** One attribute after the other: x y z, colour, normals, extents and opacity, label, organ, leaflet. is_pcd: by PCL's
 * names, with the colour packed into one number. */
plm_out_layout plm_out_layout_of(const plm_cloud *cloud, bool is_pcd);

/** Packs point i into row, in this machine's byte order. */
void plm_out_pack(const plm_out_layout *layout, const plm_cloud *cloud, size_t i, unsigned char row[PLM_OUT_ROW]);

/** Writes all points packed. */
plm_status plm_out_rows(const plm_out_layout *layout, const plm_cloud *cloud, plm_output *output, plm_error *error);

typedef plm_status plm_cloud_writer(const plm_cloud *cloud, plm_output *output, plm_error *error);

plm_cloud_writer plm_ply_write;
plm_cloud_writer plm_pcd_write;
plm_cloud_writer plm_text_write;
plm_cloud_writer plm_csv_write;

#endif
