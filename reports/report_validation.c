/* reports/report_validation.c: agreement with manual measurements on the page: the main statistics and the plots. */
#include "reports/report.h"

#include "io/bytes.h"
#include "reports/csv_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_ROOM = 4096 };

/** What the table shows, by the names of agreement.csv. */
static const struct shown_statistic {
    const char *name, *heading;
} shown[] = {
    {"n", "n"},         {"r2", "R2"},     {"r2_pearson", "r2 Pearson"}, {"rmse", "RMSE"},         {"rrmse", "rRMSE %"},
    {"mape", "MAPE %"}, {"bias", "bias"}, {"loa_low", "LoA low"},       {"loa_high", "LoA high"}, {"ccc", "CCC"}};
enum { SHOWN = sizeof shown / sizeof *shown };

/** Columns of agreement.csv. */
typedef struct agreement_columns {
    size_t trait, group, statistic, value, low, high, unit, reason;
} agreement_columns;

static void put_statistic(plm_html *page, const plm_table *table, size_t row, const agreement_columns *c)
{
    double value, low, high;
    if (!plm_table_number(plm_table_cell(table, row, c->value), &value)) {
        plm_html_print(page, "<td class=\"none\" title=\"");
        plm_html_text(page, plm_table_cell(table, row, c->reason));
        plm_html_print(page, "\">-</td>");
        return;
    }
    plm_html_print(page, "<td");
    if (plm_table_number(plm_table_cell(table, row, c->low), &low) &&
        plm_table_number(plm_table_cell(table, row, c->high), &high))
        plm_html_print(page, " title=\"95 %% interval %.4g to %.4g\"", low, high);
    plm_html_print(page, ">%.4g</td>", value);
}

/* Rows [first, last) are of one trait and group. */
static void put_group(plm_html *page, const plm_table *table, size_t first, size_t last, const agreement_columns *c)
{
    const char *unit = "";
    for (size_t row = first; row < last; row++)
        if (!strcmp(plm_table_cell(table, row, c->statistic), "rmse")) unit = plm_table_cell(table, row, c->unit);
    plm_html_print(page, "<tr><th scope=\"row\">");
    plm_html_text(page, plm_table_cell(table, first, c->trait));
    plm_html_print(page, "</th><td>");
    plm_html_text(page, plm_table_cell(table, first, c->group));
    plm_html_print(page, "</td><td>");
    plm_html_text(page, unit);
    plm_html_print(page, "</td>");
    for (int k = 0; k < SHOWN; k++) {
        size_t row = first;
        while (row < last && strcmp(plm_table_cell(table, row, c->statistic), shown[k].name)) row++;
        if (row < last)
            put_statistic(page, table, row, c);
        else
            plm_html_print(page, "<td class=\"none\">-</td>");
    }
    plm_html_print(page, "</tr>\n");
}

static size_t group_end(const plm_table *table, size_t first, const agreement_columns *c)
{
    size_t last = first + 1;
    while (last < table->rows &&
           !strcmp(plm_table_cell(table, last, c->trait), plm_table_cell(table, first, c->trait)) &&
           !strcmp(plm_table_cell(table, last, c->group), plm_table_cell(table, first, c->group)))
        last++;
    return last;
}

void plm_report_plot(plm_report *report, const char *folder, const char *name, const char *label)
{
    plm_html *page = &report->page;
    char path[PATH_ROOM];
    plm_bytes file;
    if (page->status != PLM_OK || strchr(name, '/') ||
        snprintf(path, sizeof path, "%s/plots/%s.svg", folder, name) >= PATH_ROOM)
        return;
    const plm_status status = plm_bytes_open(path, &file, NULL);
    if (status == PLM_E_MEMORY) page->status = plm_fail(page->error, PLM_E_MEMORY, "out of memory for %s", path);
    if (status != PLM_OK) return;
    plm_html_print(page, "<object class=\"plot%s\" type=\"image/svg+xml\" aria-label=\"",
                   strcmp(name, "overview") ? "" : " overview");
    plm_html_text(page, label);
    plm_html_print(page, "\" data=\"");
    plm_html_data_uri(page, "image/svg+xml", file.data, file.size);
    plm_html_print(page, "\"></object>\n");
    plm_bytes_close(&file);
}

void plm_report_validation(plm_report *report, const char *folder)
{
    plm_html *page = &report->page;
    char path[PATH_ROOM];
    plm_table table;
    if (page->status != PLM_OK || !plm_report_has(folder, "agreement.csv")) return;
    snprintf(path, sizeof path, "%s/agreement.csv", folder);
    page->status = plm_table_read(path, &table, page->error);
    if (page->status != PLM_OK) return;
    const agreement_columns c = {plm_table_column(&table, "trait"),     plm_table_column(&table, "group"),
                                 plm_table_column(&table, "statistic"), plm_table_column(&table, "value"),
                                 plm_table_column(&table, "ci_low"),    plm_table_column(&table, "ci_high"),
                                 plm_table_column(&table, "unit"),      plm_table_column(&table, "reason")};
    plm_html_print(page,
                   "<section>\n<h2>Agreement with manual measurements</h2>\n<div class=\"wide\"><table>\n<thead><tr>"
                   "<th>trait</th><th>group</th><th>unit</th>");
    for (int k = 0; k < SHOWN; k++) plm_html_print(page, "<th>%s</th>", shown[k].heading);
    plm_html_print(page, "</tr></thead>\n<tbody>\n");
    for (size_t first = 0, last; first < table.rows; first = last) {
        last = group_end(&table, first, &c);
        put_group(page, &table, first, last, &c);
    }
    plm_html_print(page,
                   "</tbody></table></div>\n<p class=\"note\">Differences are estimate minus manual. 95 %% intervals: "
                   "the pointer over a value; all statistics: agreement.csv.</p>\n");
    for (size_t first = 0; first < table.rows; first = group_end(&table, first, &c))
        if (!strcmp(plm_table_cell(&table, first, c.group), "all"))
            plm_report_plot(report, folder, plm_table_cell(&table, first, c.trait),
                            "estimate against manual, Bland-Altman, differences");
    plm_html_print(page, "</section>\n");
    plm_table_free(&table);
}
