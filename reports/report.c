/* reports/report.c: the page from top to bottom. */
#include "reports/report.h"

#include "reports/assets.h"
#include "reports/overview_plot.h"
#include "reports/run_json.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { PATH_ROOM = 4096 };

bool plm_report_has(const char *folder, const char *name)
{
    char path[PATH_ROOM];
    return (size_t)snprintf(path, sizeof path, "%s/%s", folder, name) < sizeof path && access(path, R_OK) == 0;
}

/* The policy forbids every address: what the page shows is in it. */
static const char head_top[] = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                               "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
                               "data:; style-src 'unsafe-inline'; "
                               "script-src 'unsafe-inline'; object-src data:; frame-src data:\">\n"
                               "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";

static void put_literal(plm_html *page, const char *text)
{
    plm_html_bytes(page, text, strlen(text));
}

static const char *last_name(const char *folder)
{
    const char *end = folder + strlen(folder), *begin;
    while (end > folder + 1 && end[-1] == '/') end--;
    for (begin = end; begin > folder && begin[-1] != '/';) begin--;
    return begin;
}

static void put_head(plm_report *report)
{
    plm_html *page = &report->page;
    put_literal(page, head_top);
    plm_html_text(page, last_name(report->folder));
    put_literal(page, " - Plantimeter</title>\n<style>\n");
    plm_html_bytes(page, plm_asset_style, plm_asset_style_size);
    put_literal(page, "</style>\n</head>\n<body>\n<header>\n<h1>");
    plm_html_text(page, last_name(report->folder));
    put_literal(page, "</h1>\n<p class=\"facts\">");
    size_t failed = 0, warnings = 0;
    for (size_t i = 0; i < report->results->count; i++) {
        failed += report->results->plant[i].failure != NULL;
        warnings += json_array_size(json_object_get(report->results->plant[i].record, "warnings"));
    }
    if (report->root)
        plm_html_print(page, "%zu plant%s, %zu failed, %zu warning%s. ", report->results->count,
                       report->results->count == 1 ? "" : "s", failed, warnings, warnings == 1 ? "" : "s");
    put_literal(page, "Measured with Plantimeter ");
    const char *version = json_string_value(json_object_get(report->root, "version"));
    plm_html_text(page, version ? version : PLM_VERSION);
    put_literal(page, ". Values are &plusmn; one standard error.</p>\n</header>\n<main>\n");
}

static void put_scripts(plm_report *report)
{
    plm_html *page = &report->page;
    if (plm_asset_three_size) {
        put_literal(page, "<script>\n");
        plm_html_bytes(page, plm_asset_three, plm_asset_three_size);
        put_literal(page, "</script>\n");
    }
    put_literal(page, "<script>\n");
    plm_html_bytes(page, plm_asset_viewer, plm_asset_viewer_size);
    put_literal(page, "</script>\n");
}

static plm_status write_page(plm_report *report, const char *validation)
{
    put_head(report);
    if (report->root) plm_report_summary(report);
    if (validation) plm_report_validation(report, validation);
    if (report->root) {
        plm_report_cards(report);
        plm_report_provenance(report);
    }
    put_literal(&report->page, "</main>\n");
    if (report->root) put_scripts(report);
    put_literal(&report->page, "</body>\n</html>\n");
    return report->page.status;
}

plm_status plm_report_write(const char *folder, const plm_report_options *options, bool *has_view, plm_error *error)
{
    plm_results results = {0};
    json_t *root = NULL;
    *has_view = plm_asset_three_size > 0;
    const char *validation = options->validation;
    if (!validation && plm_report_has(folder, "agreement.csv")) validation = folder;
    plm_status status = PLM_OK;
    if (plm_report_has(folder, "run.json") || !validation)
        status = plm_results_read_folder(&results, folder, &root, error);
    char path[PATH_ROOM];
    bool drawn;
    if (status == PLM_OK && options->plots && root &&
        (size_t)snprintf(path, sizeof path, "%s/plots", folder) < sizeof path)
        status = plm_overview_plot(&results, path, &drawn, error);
    if (status == PLM_OK && (size_t)snprintf(path, sizeof path, "%s/report.html", folder) >= sizeof path)
        status = plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    plm_report report = {.page.error = error, .folder = folder, .options = options, .results = &results, .root = root};
    if (status == PLM_OK) status = plm_output_open(path, &report.page.output, error);
    if (status == PLM_OK) {
        status = write_page(&report, validation);
        const plm_status closed = plm_output_close(report.page.output, status == PLM_OK, error);
        if (status == PLM_OK) status = closed;
    }
    json_decref(root);
    plm_results_free(&results);
    return status;
}
