/* io/write_ply.c: clouds as binary PLY. */
#include "io/writers.h"

static const char *type_name(plm_scalar type)
{
    static const char *const names[PLM_SCALAR_COUNT] = {[PLM_INT8] = "char",
                                                        [PLM_UINT8] = "uchar",
                                                        [PLM_INT32] = "int",
                                                        [PLM_FLOAT32] = "float",
                                                        [PLM_FLOAT64] = "double"};
    return names[type];
}

plm_status plm_ply_write(const plm_cloud *cloud, plm_output *output, plm_error *error)
{
    const plm_out_layout layout = plm_out_layout_of(cloud, false);
    plm_status status =
        plm_output_print(output, error, "ply\nformat binary_%s_endian 1.0\n", plm_host_is_little() ? "little" : "big");
    if (status == PLM_OK && cloud->label)
        status = plm_output_print(output, error, "comment label 0 other, 1 stem, 2 petiole, 3 leaf, 4 ground\n");
    if (status == PLM_OK && cloud->organ)
        status =
            plm_output_print(output, error, "comment organ is the number of the organ within its class, -1 for none\n");
    if (status == PLM_OK && cloud->leaflet)
        status = plm_output_print(
            output, error, "comment leaflet is the number of the leaflet within its compound leaf, -1 for none\n");
    if (status == PLM_OK) status = plm_output_print(output, error, "element vertex %zu\n", cloud->count);
    for (size_t i = 0; status == PLM_OK && i < layout.count; i++)
        status =
            plm_output_print(output, error, "property %s %s\n", type_name(layout.field[i].type), layout.field[i].name);
    if (status == PLM_OK) status = plm_output_print(output, error, "end_header\n");
    return status == PLM_OK ? plm_out_rows(&layout, cloud, output, error) : status;
}
