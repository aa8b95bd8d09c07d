/* simulate/write_scan.c: scans and plants as binary PLY with the fields that other clouds do not have: leaflets, gaussians, and
 * organs of faces. */
#include <math.h>
#include <string.h>

#include "io/io.h"
#include "simulate/packed.h"
#include "simulate/simulate.h"

static plm_status start(plm_output *output, bool is_labelled, plm_error *error)
{
    plm_status status = plm_output_print(output, error, "ply\nformat binary_%s_endian 1.0\n", plm_byte_order());
    if (status == PLM_OK && is_labelled)
        status = plm_output_print(output, error,
                                  "comment label 0 other, 1 stem, 2 petiole, 3 leaf, 4 ground\n"
                                  "comment organ is the number of the organ within its class, -1 for none\n");
    return status;
}

/* ---- Scans ------------------------------------------------------------------------------------------------------ */

static plm_status scan_header(plm_output *output, const plm_scan *scan, bool is_labelled, plm_error *error)
{
    plm_status status = start(output, is_labelled, error);
    if (status == PLM_OK)
        status = plm_output_print(output, error,
                                  "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n",
                                  scan->cloud.count);
    if (status == PLM_OK && scan->splat.rotation)
        status = plm_output_print(
            output, error,
            "property float nx\nproperty float ny\nproperty float nz\nproperty float f_dc_0\n"
            "property float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
            "property float scale_0\nproperty float scale_1\nproperty float scale_2\n"
            "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n");
    else if (status == PLM_OK)
        status = plm_output_print(output, error, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
    if (status == PLM_OK && is_labelled)
        status = plm_output_print(output, error, "property uchar label\nproperty int organ\n%s",
                                  scan->leaflet ? "property int leaflet\n" : "");
    if (status == PLM_OK) status = plm_output_print(output, error, "end_header\n");
    return status;
}

static void pack_gaussian(plm_packed *row, const plm_scan *scan, size_t k)
{
    const float none[3] = {0, 0, 0}; /* splat files carry normals, and leave them zero */
    plm_pack(row, none, sizeof none);
    for (int i = 0; i < 3; i++) { /* the constant spherical harmonic is 1 / (2 sqrt(pi)) */
        const float dc = (float)((scan->cloud.rgb[k][i] / 255.0 - 0.5) / 0.28209479177387814);
        plm_pack(row, &dc, sizeof dc);
    }
    plm_pack(row, &scan->splat.logit_opacity[k], sizeof(float));
    plm_pack(row, scan->splat.log_scale[k], sizeof scan->splat.log_scale[k]);
    plm_pack(row, scan->splat.rotation[k], sizeof scan->splat.rotation[k]);
}

static void pack_point(plm_packed *row, const plm_scan *scan, bool is_labelled, size_t k)
{
    plm_pack(row, scan->cloud.xyz[k], sizeof scan->cloud.xyz[k]);
    if (scan->splat.rotation)
        pack_gaussian(row, scan, k);
    else
        plm_pack(row, scan->cloud.rgb[k], sizeof scan->cloud.rgb[k]);
    if (!is_labelled) return;
    plm_pack(row, &scan->cloud.label[k], 1);
    plm_pack(row, &scan->cloud.organ[k], sizeof(int32_t));
    if (scan->leaflet) plm_pack(row, &scan->leaflet[k], sizeof(int32_t));
}

plm_status plm_scan_write(const char *path, const plm_scan *scan, bool is_labelled, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = scan_header(output, scan, is_labelled, error);
    for (size_t k = 0; k < scan->cloud.count && status == PLM_OK; k++) {
        plm_packed row = {.used = 0};
        pack_point(&row, scan, is_labelled, k);
        status = plm_output_write(output, row.bytes, row.used, error);
    }
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* ---- Plants ----------------------------------------------------------------------------------------------------- */

static plm_status write_mesh(plm_output *output, const plm_virtual_plant *plant, plm_error *error)
{
    const plm_mesh *mesh = &plant->mesh;
    plm_status status = start(output, true, error);
    if (status == PLM_OK)
        status = plm_output_print(output, error,
                                  "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
                                  "element face %zu\nproperty list uchar int vertex_indices\nproperty uchar label\n"
                                  "property int organ\nproperty int leaflet\nend_header\n",
                                  mesh->vertex_count, mesh->triangle_count);
    for (size_t k = 0; k < mesh->vertex_count && status == PLM_OK; k++)
        status = plm_output_write(output, mesh->vertex[k], sizeof mesh->vertex[k], error);
    for (size_t k = 0; k < mesh->triangle_count && status == PLM_OK; k++) {
        const uint8_t corners = 3;
        plm_packed row = {.used = 0};
        plm_pack(&row, &corners, 1);
        plm_pack(&row, mesh->triangle[k], sizeof mesh->triangle[k]);
        plm_pack(&row, &plant->face_label[k], 1);
        plm_pack(&row, &mesh->face_organ[k], sizeof(int32_t));
        plm_pack(&row, &plant->face_leaflet[k], sizeof(int32_t));
        status = plm_output_write(output, row.bytes, row.used, error);
    }
    return status;
}

plm_status plm_virtual_plant_write(const char *path, const plm_virtual_plant *plant, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = write_mesh(output, plant, error);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}
