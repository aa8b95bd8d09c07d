/* reports/csv_write.c: cells of CSV files: quoting by RFC 4180, numbers as short as they can be. */
#include "reports/csv_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *plm_format_number(double value, char text[PLM_NUMBER_LENGTH])
{
    text[0] = 0;
    if (!isfinite(value)) return text;
    if (value == 0) value = 0; /* no "-0" */
    snprintf(text, PLM_NUMBER_LENGTH, "%.9g", value);
    /* A locale may put a comma there. */
    for (char *c = text; *c; c++)
        if (!strchr("+-0123456789eE", *c)) *c = '.';
    return text;
}

plm_status plm_csv_text(plm_output *output, const char *text, char behind, plm_error *error)
{
    plm_status status = PLM_OK;
    if (!strpbrk(text, ",;\"\r\n\t")) {
        status = plm_output_write(output, text, strlen(text), error);
    } else {
        status = plm_output_write(output, "\"", 1, error);
        for (const char *at = text; status == PLM_OK && *at;) {
            const size_t length = strcspn(at, "\"");
            status = plm_output_write(output, at, length, error);
            at += length;
            if (status == PLM_OK && *at) status = plm_output_write(output, "\"\"", 2, error), at++;
        }
        if (status == PLM_OK) status = plm_output_write(output, "\"", 1, error);
    }
    return status == PLM_OK ? plm_output_write(output, &behind, 1, error) : status;
}

plm_status plm_csv_number(plm_output *output, double value, char behind, plm_error *error)
{
    char text[PLM_NUMBER_LENGTH];
    return plm_csv_text(output, plm_format_number(value, text), behind, error);
}
