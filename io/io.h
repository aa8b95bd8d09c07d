/* io/io.h: readers and writers of clouds and meshes, and georeferencing.
 *
 * Knows cloud/ only. Readers find the format out from the content, not from the file's name. A file is never trusted:
 * sizes are checked against the file's length before anything is allocated, and an error names the file and the line or
 * byte, what was found and what was expected. Writers write beside the target and rename: no partial file is left. */
#ifndef PLANTIMETER_IO_IO_H
#define PLANTIMETER_IO_IO_H

#include "../cloud/cloud.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum plm_format {
    PLM_FORMAT_UNKNOWN = 0,
    PLM_FORMAT_PLY,
    PLM_FORMAT_SPLAT, /**< a PLY of 3D gaussians: opacity is a logit, scales are logarithms, rotation is w x y z */
    PLM_FORMAT_PCD,
    PLM_FORMAT_TEXT,
    PLM_FORMAT_LAS,
} plm_format;

/** How the labels of a file are numbered. */
typedef enum plm_label_scheme {
    PLM_LABELS_CLASSES = 0, /**< plm_label in the label field, organ number within its class in the field `organ` */
    PLM_LABELS_INSTANCES /**< one number an organ: stem_label is the stem, every other number from 0 on a leaf (numbered
                              in ascending order), other negative numbers no organ (PLM_LABEL_OTHER) */
} plm_label_scheme;

/** What the caller knows of a file. All zero is a good default. Strings are the caller's. */
typedef struct plm_read_options {
    const char *label_field; /**< read labels from this field (its name, or its number from 1 on); NULL: labels are left
                                  unread. CloudCompare's prefix "scalar_" may be there or not */
    const char *organ_field; /**< NULL: "organ" where there is one */
    plm_label_scheme label_scheme;
    int32_t stem_label;     /**< the stem's number under PLM_LABELS_INSTANCES */
    const char *columns;    /**< text files: names of the columns, comma-separated ("x,y,z,red,green,blue,label"; "-"
                                leaves one out); NULL: header line, else found out from the number of columns */
    char separator;         /**< text files: comma, semicolon, tab or blank; 0: found out */
    double minimum_opacity; /**< gaussians below are dropped; 0: 0.005 */
    int splat_points;       /**< surface points made of one gaussian: 1 (its centre; 0 means 1) or 5 (its centre and the
                                ends of its two long axes at one standard deviation) */
} plm_read_options;

/** What a reader met. Fixed size: nothing to free. */
typedef struct plm_read_report {
    plm_format format;
    uint64_t rows;                /**< points that the file holds */
    uint64_t dropped_not_finite;  /**< rows left out for coordinates that are NaN, Inf or beyond 1e18, and gaussians
                                       whose scales or rotation are no numbers */
    uint64_t dropped_transparent; /**< gaussians left out for their opacity */
    uint64_t dropped_withheld;    /**< LAS points that are marked as deleted */
    char fields[512];             /**< names of the fields, comma-separated, cut where they do not fit */
    char label_field[64];         /**< a field that looks like labels ("label", "class", ...), "" for none */
    char description[64];         /**< "PLY, binary little-endian", "LAS 1.4, point format 6", ... */
} plm_read_report;

/** Reads a cloud of any supported format: PLY (ascii, binary of both byte orders), 3DGS PLY, PCD (ascii, binary,
 * binary_compressed), text (xyz, csv, tsv, txt), LAS 1.2 to 1.4 (point formats 0-3 and 6-8).
 * path     "-" is standard input.
 * options  NULL: all defaults.
 * cloud    out, the caller's (plm_cloud_free); coordinates in the file's unit and axes; origin near the points, so
 *          that float offsets keep 1e-7 of the cloud's size. Written only when PLM_OK comes back.
 * report   out, may be NULL.
 * PLM_E_READ, PLM_E_FORMAT (message: file, line or byte, found, expected), PLM_E_ARGUMENT (a field that options
 * name is not in the file), PLM_E_MEMORY. */
PLM_API plm_status plm_cloud_read(const char *path, const plm_read_options *options, plm_cloud *cloud,
                                  plm_read_report *report, plm_error *error);

/** The same from a buffer in memory; name stands for the file in messages. */
PLM_API plm_status plm_cloud_parse(const void *data, size_t size, const char *name, const plm_read_options *options,
                                   plm_cloud *cloud, plm_read_report *report, plm_error *error);

/** Writes a cloud with all its attributes; the format follows from the path's ending: .ply (binary little-endian),
 * .pcd (binary), .xyz .txt (blank-separated, header line behind `#`), .csv. Labels, organs and leaflets become the
 * fields `label`, `organ` and `leaflet`, and a PLY comment says what they mean; leaflets are not read again. Coordinates
 * are origin + offset: float where that loses nothing beyond 1e-7 of the cloud's size, double else. plm_cloud.source is not written: it numbers another file's rows.
 * PLM_E_WRITE, PLM_E_ARGUMENT (unknown ending). */
PLM_API plm_status plm_cloud_write(const char *path, const plm_cloud *cloud, plm_error *error);

/** Writes a mesh as .ply (binary), .obj or .stl (binary) through OpenMesh. face_organ becomes the face property `organ` and
 * face colours in PLY. These files hold float coordinates: origin + vertex, but the vertices relative to mesh->origin
 * where that sum would lose more than 1e-7 of the mesh's size. PLM_E_WRITE, PLM_E_ARGUMENT (unknown ending, or a triangle
 * that names a vertex which the mesh lacks), PLM_E_LIBRARY. */
PLM_API plm_status plm_mesh_write(const char *path, const plm_mesh *mesh, plm_error *error);

/** Reads a mesh: PLY (ascii, binary of both byte orders; element face with vertex_indices) or OBJ. Polygons become fans of
 * triangles about their first corner.
 * path        "-" is standard input.
 * mesh        out, the caller's (plm_mesh_free); in the file's unit and axes, origin in its middle. face_organ from the face
 *             property `organ` of PLY or the number of the line o or g in OBJ, from 0 on; NULL where there are none.
 * face_label  out, the caller's (plm_free), may be NULL: plm_label of every triangle; NULL where the file has no face property
 *             `label`.
 * PLM_E_READ, PLM_E_FORMAT (line or byte, found, expected; faces that name vertices which are not there), PLM_E_MEMORY. Outputs
 * are written only when PLM_OK comes back. */
PLM_API plm_status plm_mesh_read(const char *path, plm_mesh *mesh, uint8_t **face_label, plm_error *error);

/** The same from a buffer in memory; name stands for the file in messages. */
PLM_API plm_status plm_mesh_parse(const void *data, size_t size, const char *name, plm_mesh *mesh, uint8_t **face_label,
                                  plm_error *error);

/** A picture: rows from the top, pixels of 1 (grey) or 3 (red, green, blue) channels of 8 or 16 bits in this machine's byte order.
 * The pixels are the caller's. */
typedef struct plm_image {
    int width, height, channels, bits;
    const void *pixels;
} plm_image;

/** Writes a picture as PNG. PLM_E_WRITE, PLM_E_LIBRARY, PLM_E_MEMORY. */
PLM_API plm_status plm_image_write_png(const char *path, const plm_image *image, plm_error *error);

/** Opens path + ".part" for writing; plm_output_close renames it to path when all went well (ok true and no write
 * error), and removes it else. The seam through which every file of the project is written. */
typedef struct plm_output plm_output;
PLM_API plm_status plm_output_open(const char *path, plm_output **output, plm_error *error);
PLM_API plm_status plm_output_write(plm_output *output, const void *data, size_t size, plm_error *error);
PLM_API plm_status plm_output_print(plm_output *output, plm_error *error, const char *format, ...) PLM_PRINTF(3, 4);
PLM_API plm_status plm_output_close(plm_output *output, bool ok, plm_error *error);

/** Makes a folder and those above it; one that is there already is no error. PLM_E_WRITE. */
PLM_API plm_status plm_folder_make(const char *folder, plm_error *error);

/** SHA-256 of a file's bytes as 64 lower-case hexadecimal digits and a zero. */
PLM_API plm_status plm_file_sha256(const char *path, char digest[65], plm_error *error);

/** A coordinate reference system: "geodetic" (x longitude, y latitude in degrees, z height in metres, WGS 84) or
 * "utm:ZONE[N|S]" (x easting, y northing, z height; N where left out). */
typedef struct plm_crs {
    bool is_geodetic;
    int utm_zone; /**< 1 to 60 */
    bool is_south;
} plm_crs;

/** Parses the text of --crs. PLM_E_ARGUMENT names what is wrong. */
PLM_API plm_status plm_crs_parse(const char *text, plm_crs *crs, plm_error *error);

/** A local east-north-up frame on the WGS 84 ellipsoid. */
typedef struct plm_georeference {
    plm_crs crs;
    double longitude, latitude, height; /**< of the local frame's origin: degrees, degrees, metres */
} plm_georeference;

/** Turns a cloud in crs into metres in a local east-north-up frame at its own middle, in place, by GeographicLib: true
 * metres, which those of UTM are not (they are 0.9996 to 1.001 of them, and turned by the meridian convergence). Normals
 * turn with the points. cloud->origin becomes 0.
 * PLM_E_ARGUMENT when a point's numbers are not of crs, or when longitudes lie on both sides of the date line (they may
 * go on beyond 180); PLM_E_DEGENERATE for an empty cloud, PLM_E_MEMORY, PLM_E_LIBRARY. The cloud is then unchanged. */
PLM_API plm_status plm_cloud_georeference(plm_cloud *cloud, const plm_crs *crs, plm_georeference *reference,
                                          plm_error *error);

/** Longitude and latitude (degrees) and height (m) of a point of the local frame. */
PLM_API plm_status plm_georeference_locate(const plm_georeference *reference, const double local[3], double *longitude,
                                           double *latitude, double *height, plm_error *error);

/** Local east-north-up coordinates to the coordinates of reference->crs (what the file had). */
PLM_API plm_status plm_georeference_restore(const plm_georeference *reference, const double local[3],
                                            double file_coordinates[3], plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
