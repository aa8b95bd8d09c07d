/* reports/sheet.c: a CSV under way. */
#include "reports/sheet.h"

#include <stdio.h>
#include <string.h>

plm_sheet plm_sheet_open(const char *folder, const char *name, plm_error *error)
{
    plm_sheet sheet = {.error = error};
    char path[4096];
    if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, name) >= sizeof path)
        sheet.status = plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    else
        sheet.status = plm_output_open(path, &sheet.output, error);
    return sheet;
}

void plm_sheet_text(plm_sheet *sheet, const char *cell, char behind)
{
    if (sheet->status == PLM_OK) sheet->status = plm_csv_text(sheet->output, cell, behind, sheet->error);
}

void plm_sheet_number(plm_sheet *sheet, double value, char behind)
{
    if (sheet->status == PLM_OK) sheet->status = plm_csv_number(sheet->output, value, behind, sheet->error);
}

static void put_bytes(plm_sheet *sheet, const char *bytes, size_t size)
{
    if (sheet->status == PLM_OK) sheet->status = plm_output_write(sheet->output, bytes, size, sheet->error);
}

void plm_sheet_quoted(plm_sheet *sheet, const char *cell, char behind)
{
    put_bytes(sheet, "\"", 1);
    for (const char *at = cell; *at; at++) put_bytes(sheet, *at == '"' ? "\"\"" : at, *at == '"' ? 2 : 1);
    put_bytes(sheet, (const char[2]){'"', behind}, 2);
}

void plm_sheet_line(plm_sheet *sheet, const char *line)
{
    put_bytes(sheet, line, strlen(line));
    put_bytes(sheet, "\n", 1);
}

plm_status plm_sheet_close(plm_sheet *sheet)
{
    if (!sheet->output) return sheet->status;
    const plm_status closed =
        plm_output_close(sheet->output, sheet->status == PLM_OK, sheet->status == PLM_OK ? sheet->error : NULL);
    sheet->output = NULL;
    return sheet->status == PLM_OK ? closed : sheet->status;
}
