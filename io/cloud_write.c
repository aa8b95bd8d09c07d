/* io/cloud_write.c: which writer a path's ending asks for, and the rows that writers share. */
#include "io/writers.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* Would float coordinates lose more than 1e-7 of the cloud's size? */
static bool needs_double(const plm_cloud *cloud)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, loss = 0, size = 0;
    for (size_t i = 0; i < cloud->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double at = cloud->origin[axis] + (double)cloud->xyz[i][axis];
            low[axis] = fmin(low[axis], at);
            high[axis] = fmax(high[axis], at);
            loss = fmax(loss, fabs((double)(float)at - at));
        }
    for (int axis = 0; axis < 3; axis++) size = fmax(size, high[axis] - low[axis]);
    return loss > 1e-7 * size;
}

static void add(plm_out_layout *layout, const char *name, plm_scalar type)
{
    layout->field[layout->count++] = (plm_out_field){name, type};
    layout->row_size += plm_scalar_size(type);
}

plm_out_layout plm_out_layout_of(const plm_cloud *cloud, bool is_pcd)
{
    static const char *const xyz[] = {"x", "y", "z"}, *const rgb[] = {"red", "green", "blue"};
    static const char *const normals[2][3] = {{"nx", "ny", "nz"}, {"normal_x", "normal_y", "normal_z"}};
    const plm_scalar place = needs_double(cloud) ? PLM_FLOAT64 : PLM_FLOAT32;
    plm_out_layout layout = {.is_pcd = is_pcd};
    for (int k = 0; k < 3; k++) add(&layout, xyz[k], place);
    if (cloud->rgb && is_pcd) add(&layout, "rgb", PLM_UINT32);
    for (int k = 0; k < 3 && cloud->rgb && !is_pcd; k++) add(&layout, rgb[k], PLM_UINT8);
    for (int k = 0; k < 3 && cloud->normal; k++) add(&layout, normals[is_pcd][k], PLM_FLOAT32);
    if (cloud->extent) add(&layout, "extent_0", PLM_FLOAT32);
    if (cloud->extent) add(&layout, "extent_1", PLM_FLOAT32);
    if (cloud->opacity) add(&layout, "opacity", PLM_FLOAT32);
    if (cloud->label) add(&layout, "label", PLM_UINT8);
    if (cloud->organ) add(&layout, "organ", PLM_INT32);
    if (cloud->leaflet) add(&layout, "leaflet", PLM_INT32);
    return layout;
}

static unsigned char *append(unsigned char *at, const void *from, size_t size)
{
    memcpy(at, from, size);
    return at + size;
}

void plm_out_pack(const plm_out_layout *layout, const plm_cloud *cloud, size_t i, unsigned char row[PLM_OUT_ROW])
{
    unsigned char *at = row;
    for (int axis = 0; axis < 3; axis++) {
        const double place = cloud->origin[axis] + (double)cloud->xyz[i][axis];
        const float single = (float)place;
        if (layout->field[axis].type == PLM_FLOAT64)
            at = append(at, &place, sizeof place);
        else
            at = append(at, &single, sizeof single);
    }
    if (cloud->rgb && layout->is_pcd) {
        const uint8_t *rgb = cloud->rgb[i];
        const uint32_t packed = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
        at = append(at, &packed, sizeof packed);
    } else if (cloud->rgb) {
        at = append(at, cloud->rgb[i], sizeof cloud->rgb[i]);
    }
    if (cloud->normal) at = append(at, cloud->normal[i], sizeof cloud->normal[i]);
    if (cloud->extent) at = append(at, cloud->extent[i], sizeof cloud->extent[i]);
    if (cloud->opacity) at = append(at, &cloud->opacity[i], sizeof cloud->opacity[i]);
    if (cloud->label) at = append(at, &cloud->label[i], sizeof cloud->label[i]);
    if (cloud->organ) at = append(at, &cloud->organ[i], sizeof cloud->organ[i]);
    if (cloud->leaflet) append(at, &cloud->leaflet[i], sizeof cloud->leaflet[i]);
}

plm_status plm_out_rows(const plm_out_layout *layout, const plm_cloud *cloud, plm_output *output, plm_error *error)
{
    plm_status status = PLM_OK;
    unsigned char row[PLM_OUT_ROW];
    for (size_t i = 0; status == PLM_OK && i < cloud->count; i++) {
        plm_out_pack(layout, cloud, i, row);
        status = plm_output_write(output, row, layout->row_size, error);
    }
    return status;
}

static const struct {
    const char *ending;
    plm_cloud_writer *write;
} writers[] = {
    {".ply", plm_ply_write},  {".pcd", plm_pcd_write}, {".xyz", plm_text_write},
    {".txt", plm_text_write}, {".csv", plm_csv_write},
};

plm_status plm_cloud_write(const char *path, const plm_cloud *cloud, plm_error *error)
{
    const char *ending = strrchr(path, '.');
    plm_cloud_writer *write = NULL;
    for (size_t i = 0; ending && i < sizeof writers / sizeof *writers; i++)
        if (strcasecmp(ending, writers[i].ending) == 0) write = writers[i].write;
    if (!write)
        return plm_fail(error, PLM_E_ARGUMENT, "%s: a name that ends in .ply, .pcd, .xyz, .txt or .csv was expected",
                        path);
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = write(cloud, output, error);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status != PLM_OK ? status : closed;
}
