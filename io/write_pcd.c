/* io/write_pcd.c: clouds as binary PCD, with PCL's names and its packed colour. */
#include "io/writers.h"

#include <string.h>

/* A line of the header: a keyword and one item a field. */
static plm_status print_line(const plm_out_layout *layout, const char *keyword, plm_output *output, plm_error *error)
{
    plm_status status = plm_output_print(output, error, "%s", keyword);
    for (size_t i = 0; status == PLM_OK && i < layout->count; i++) {
        const plm_out_field *field = &layout->field[i];
        const bool is_real =
            field->type >= PLM_FLOAT32 || !strcmp(field->name, "rgb"); /* PCL reads its bits as a float */
        switch (*keyword) {
            case 'F':
                status = plm_output_print(output, error, " %s", field->name);
                break;
            case 'S':
                status = plm_output_print(output, error, " %zu", plm_scalar_size(field->type));
                break;
            case 'T':
                status = plm_output_print(output, error, " %c", is_real ? 'F' : field->type == PLM_INT32 ? 'I' : 'U');
                break;
            default:
                status = plm_output_print(output, error, " 1");
        }
    }
    return status == PLM_OK ? plm_output_print(output, error, "\n") : status;
}

plm_status plm_pcd_write(const plm_cloud *cloud, plm_output *output, plm_error *error)
{
    static const char *const lines[] = {"FIELDS", "SIZE", "TYPE", "COUNT"};
    const plm_out_layout layout = plm_out_layout_of(cloud, true);
    plm_status status = plm_output_print(output, error, "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n");
    for (size_t i = 0; status == PLM_OK && i < sizeof lines / sizeof *lines; i++)
        status = print_line(&layout, lines[i], output, error);
    if (status == PLM_OK)
        status =
            plm_output_print(output, error, "WIDTH %zu\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %zu\nDATA binary\n",
                             cloud->count, cloud->count);
    return status == PLM_OK ? plm_out_rows(&layout, cloud, output, error) : status;
}
