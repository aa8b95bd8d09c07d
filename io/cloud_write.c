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

plm_out_layout plm_out_layout_of(const plm_cloud *cloud)
{
    static const char *const xyz[] = {"x", "y", "z"}, *const rgb[] = {"red", "green", "blue"};
    static const char *const normal[] = {"nx", "ny", "nz"};
    const plm_scalar place = needs_double(cloud) ? PLM_FLOAT64 : PLM_FLOAT32;
    plm_out_layout layout = {0};
    for (int k = 0; k < 3; k++) add(&layout, xyz[k], place);
    for (int k = 0; k < 3 && cloud->rgb; k++) add(&layout, rgb[k], PLM_UINT8);
    for (int k = 0; k < 3 && cloud->normal; k++) add(&layout, normal[k], PLM_FLOAT32);
    if (cloud->extent) add(&layout, "extent_0", PLM_FLOAT32);
    if (cloud->extent) add(&layout, "extent_1", PLM_FLOAT32);
    if (cloud->opacity) add(&layout, "opacity", PLM_FLOAT32);
    if (cloud->label) add(&layout, "label", PLM_UINT8);
    if (cloud->organ) add(&layout, "organ", PLM_INT32);
    return layout;
}

void plm_out_pack(const plm_out_layout *layout, const plm_cloud *cloud, size_t i, unsigned char row[PLM_OUT_ROW])
{
    unsigned char *at = row;
    for (int axis = 0; axis < 3; axis++) {
        const double place = cloud->origin[axis] + (double)cloud->xyz[i][axis];
        const float single = (float)place;
        const bool is_double = layout->field[axis].type == PLM_FLOAT64;
        memcpy(at, is_double ? (const void *)&place : (const void *)&single, is_double ? sizeof place : sizeof single);
        at += is_double ? sizeof place : sizeof single;
    }
    const struct {
        const void *from;
        size_t size;
    } parts[] = {{cloud->rgb ? cloud->rgb[i] : NULL, sizeof *cloud->rgb},
                 {cloud->normal ? cloud->normal[i] : NULL, sizeof *cloud->normal},
                 {cloud->extent ? cloud->extent[i] : NULL, sizeof *cloud->extent},
                 {cloud->opacity ? &cloud->opacity[i] : NULL, sizeof *cloud->opacity},
                 {cloud->label ? &cloud->label[i] : NULL, sizeof *cloud->label},
                 {cloud->organ ? &cloud->organ[i] : NULL, sizeof *cloud->organ}};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        if (!parts[k].from) continue;
        memcpy(at, parts[k].from, parts[k].size);
        at += parts[k].size;
    }
}

static const struct {
    const char *ending;
    plm_cloud_writer *write;
} writers[] = {
    {".ply", plm_ply_write},
};

plm_status plm_cloud_write(const char *path, const plm_cloud *cloud, plm_error *error)
{
    const char *ending = strrchr(path, '.');
    plm_cloud_writer *write = NULL;
    for (size_t i = 0; ending && i < sizeof writers / sizeof *writers; i++)
        if (strcasecmp(ending, writers[i].ending) == 0) write = writers[i].write;
    if (!write) return plm_fail(error, PLM_E_ARGUMENT, "%s: a name that ends in .ply was expected", path);
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = write(cloud, output, error);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status != PLM_OK ? status : closed;
}
