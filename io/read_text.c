/* io/read_text.c: points as rows of text: xyz, txt, csv, tsv, pts. */
#include "io/readers.h"
#include "io/text_layout.h"

#include <stdio.h>

static const char *separator_name(char separator)
{
    switch (separator) {
        case ',':
            return "commas";
        case ';':
            return "semicolons";
        case '\t':
            return "tabs";
        default:
            return "blanks";
    }
}

plm_status plm_text_read(const plm_bytes *bytes, const plm_read_options *options, plm_cloud *cloud,
                         plm_read_report *report, plm_error *error)
{
    plm_text_layout layout;
    plm_columns columns = {0};
    plm_roles roles;
    void *block = NULL;
    plm_status status = plm_text_layout_find(bytes, options, &layout, error);
    if (status == PLM_OK) status = plm_text_columns(bytes, options, &layout, &columns, error);
    if (status == PLM_OK) status = plm_roles_find(&columns, bytes, options, &roles, report, error);
    if (status == PLM_OK) {
        const plm_ascii ascii = {.separator = layout.separator,
                                 .decimal = layout.decimal,
                                 .has_comments = true,
                                 .item_count = layout.item_count};
        const plm_ascii_place place = {.begin = layout.begin, .line = layout.line, .rows = UINT64_MAX};
        status = plm_ascii_read(bytes, &ascii, &place, &roles, &columns, &block, error);
    }
    if (status == PLM_OK) {
        snprintf(report->description, sizeof report->description, "text, %zu columns parted by %s", layout.item_count,
                 separator_name(layout.separator));
        status = plm_columns_to_cloud(&columns, &roles, bytes, options, cloud, report, error);
    }
    plm_free(block);
    plm_columns_free(&columns);
    return status;
}
