/* io/columns.h: what all readers have in common: a file's points as columns of numbers, lying where the file has them.
 * Internal to io/.
 *
 * A reader parses its format's header into plm_columns (names, types, addresses) and hands them to
 * plm_columns_to_cloud, which finds out what each column means and converts. Text readers fill in the addresses between
 * the two, by plm_ascii_read. */
#ifndef PLANTIMETER_IO_COLUMNS_H
#define PLANTIMETER_IO_COLUMNS_H

#include "io/bytes.h"
#include "io/io.h"

typedef enum plm_scalar {
    PLM_INT8,
    PLM_UINT8,
    PLM_INT16,
    PLM_UINT16,
    PLM_INT32,
    PLM_UINT32,
    PLM_INT64,
    PLM_UINT64,
    PLM_FLOAT32,
    PLM_FLOAT64,
    PLM_SCALAR_COUNT
} plm_scalar;

/** Bytes of a scalar. */
size_t plm_scalar_size(plm_scalar type);

/** One number a row, stride bytes apart. */
typedef struct plm_column {
    char name[64];
    plm_scalar type;
    bool is_list;              /* stands for a list: has no numbers, and no field means it */
    bool is_whole;             /* the file says that the numbers are whole */
    bool is_swapped;           /* byte order is not this machine's */
    uint8_t mask;              /* of PLM_UINT8: the bits that count; 0: all */
    double scale, shift;       /* the value is stored * scale + shift; scale 0: the value as stored */
    const unsigned char *data; /* of row 0 */
    size_t stride;
} plm_column;

/** Columns of equally many rows. Free with plm_columns_free (the numbers belong to others). */
typedef struct plm_columns {
    plm_column *column;
    size_t count, room;
    size_t rows;
} plm_columns;

/** Adds a column; its name is cut where it is too long. The address holds until the next call. NULL: no memory. */
plm_column *plm_columns_add(plm_columns *columns, const char *name, size_t name_length, plm_scalar type,
                            plm_error *error);
void plm_columns_free(plm_columns *columns);

/** count numbers from row first on, as doubles. */
void plm_column_load(const plm_column *column, size_t first, size_t count, double *values);

/** What a column can mean. */
typedef enum plm_role {
    PLM_ROLE_X,
    PLM_ROLE_Y,
    PLM_ROLE_Z,
    PLM_ROLE_RED,
    PLM_ROLE_GREEN,
    PLM_ROLE_BLUE,
    PLM_ROLE_PACKED_COLOUR, /* 0x00RRGGBB in 32 bits (PCD) */
    PLM_ROLE_NX,
    PLM_ROLE_NY,
    PLM_ROLE_NZ,
    PLM_ROLE_EXTENT_0, /* plm_cloud.extent, as written by this project */
    PLM_ROLE_EXTENT_1,
    PLM_ROLE_OPACITY,
    PLM_ROLE_DC_0, /* 3DGS: constant term of the spherical harmonics */
    PLM_ROLE_DC_1,
    PLM_ROLE_DC_2,
    PLM_ROLE_SCALE_0,
    PLM_ROLE_SCALE_1,
    PLM_ROLE_SCALE_2,
    PLM_ROLE_ROTATION_0,
    PLM_ROLE_ROTATION_1,
    PLM_ROLE_ROTATION_2,
    PLM_ROLE_ROTATION_3,
    PLM_ROLE_WITHHELD, /* not 0: the row is marked as deleted (LAS) */
    PLM_ROLE_LABEL,
    PLM_ROLE_ORGAN,
    PLM_ROLE_COUNT
} plm_role;

/** Which column has which role; NULL where none has it, or where nothing needs it. */
typedef struct plm_roles {
    const plm_column *column[PLM_ROLE_COUNT];
    bool is_splat;
} plm_roles;

/** The role that a column's name tells ("x", "Red", "scalar_nx", ...); PLM_ROLE_COUNT for none. */
plm_role plm_role_of_name(const char *name);

/** Finds the roles out and fills in the fields, label_field and (for gaussians) format of the report.
 * PLM_E_FORMAT when x, y or z is missing; PLM_E_ARGUMENT when a field that options name is. */
plm_status plm_roles_find(const plm_columns *columns, const plm_bytes *bytes, const plm_read_options *options,
                          plm_roles *roles, plm_read_report *report, plm_error *error);

/** Converts columns (with their numbers in place) to a cloud and adds the counts of rows to the report. */
plm_status plm_columns_to_cloud(const plm_columns *columns, const plm_roles *roles, const plm_bytes *bytes,
                                const plm_read_options *options, plm_cloud *cloud, plm_read_report *report,
                                plm_error *error);

/** Is this machine little-endian? */
bool plm_host_is_little(void);

#endif
