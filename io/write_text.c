/* io/write_text.c: clouds as text, blank-separated or CSV, with as few digits as bring back the same numbers. */
#include "io/number.h"
#include "io/writers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A float or double with the fewest digits that read back as the same. The "C" locale must be in force. */
static int print_real(char *to, size_t room, double value, bool is_double)
{
    const int last = is_double ? 17 : 9;
    for (int digits = last - 3;; digits++) {
        const int length = snprintf(to, room, "%.*g", digits, value);
        if (digits == last || (is_double ? strtod(to, NULL) == value : strtof(to, NULL) == (float)value)) return length;
    }
}

static int print_field(char *to, size_t room, plm_scalar type, const unsigned char *from)
{
    float single;
    double value;
    int32_t whole;
    switch (type) {
        case PLM_FLOAT32:
            memcpy(&single, from, sizeof single);
            return print_real(to, room, (double)single, false);
        case PLM_FLOAT64:
            memcpy(&value, from, sizeof value);
            return print_real(to, room, value, true);
        case PLM_INT32:
            memcpy(&whole, from, sizeof whole);
            return snprintf(to, room, "%d", whole);
        default:
            return snprintf(to, room, "%u", *from);
    }
}

static plm_status write_rows(const plm_cloud *cloud, const char *before, char separator, plm_output *output,
                             plm_error *error)
{
    const plm_out_layout layout = plm_out_layout_of(cloud, false);
    char line[PLM_OUT_FIELDS * 32];
    plm_status status = plm_output_print(output, error, "%s", before);
    for (size_t i = 0; status == PLM_OK && i < layout.count; i++)
        status = plm_output_print(output, error, "%s%c", layout.field[i].name, i + 1 < layout.count ? separator : '\n');
    for (size_t i = 0; status == PLM_OK && i < cloud->count; i++) {
        unsigned char row[PLM_OUT_ROW];
        const unsigned char *at = row;
        size_t used = 0;
        plm_out_pack(&layout, cloud, i, row);
        for (size_t k = 0; k < layout.count; k++) {
            used += (size_t)print_field(line + used, sizeof line - used, layout.field[k].type, at);
            line[used++] = k + 1 < layout.count ? separator : '\n';
            at += plm_scalar_size(layout.field[k].type);
        }
        status = plm_output_write(output, line, used, error);
    }
    return status;
}

plm_status plm_text_write(const plm_cloud *cloud, plm_output *output, plm_error *error)
{
    plm_locale locale = plm_locale_enter();
    const plm_status status = write_rows(cloud, "# ", ' ', output, error);
    plm_locale_leave(&locale);
    return status;
}

plm_status plm_csv_write(const plm_cloud *cloud, plm_output *output, plm_error *error)
{
    plm_locale locale = plm_locale_enter();
    const plm_status status = write_rows(cloud, "", ',', output, error);
    plm_locale_leave(&locale);
    return status;
}
