/* reports/report_provenance.c: where the values of a report come from: version, options, inputs, what was run. */
#include "reports/report.h"

#include <stdio.h>
#include <string.h>

static void put_json_value(plm_html *page, const json_t *value)
{
    char number[64];
    if (json_is_string(value)) {
        plm_html_text(page, json_string_value(value));
    } else if (json_is_number(value)) {
        snprintf(number, sizeof number, "%.9g", json_number_value(value));
        plm_html_text(page, number);
    } else {
        plm_html_print(page, json_is_null(value) ? "-" : json_is_true(value) ? "yes" : "no");
    }
}

static void put_member(plm_html *page, const json_t *object, const char *key, const char *element)
{
    plm_html_print(page, "<td>");
    if (element) plm_html_print(page, "<%s>", element);
    put_json_value(page, json_object_get(object, key));
    if (element) plm_html_print(page, "</%s>", element);
    plm_html_print(page, "</td>");
}

/* "read 0.02 s, frame 2.2 s, ..." */
static void put_stages(plm_html *page, const json_t *plan)
{
    bool is_first = true;
    plm_html_print(page, "<td>");
    for (size_t i = 0; i < json_array_size(plan); i++) {
        const json_t *stage = json_array_get(plan, i);
        const char *name = json_string_value(json_object_get(stage, "stage"));
        if (!name || !json_is_true(json_object_get(stage, "runs"))) continue;
        if (!is_first) plm_html_print(page, ", ");
        plm_html_text(page, name);
        plm_html_print(page, " %.2g s", json_number_value(json_object_get(stage, "seconds")));
        is_first = false;
    }
    plm_html_print(page, "</td>");
}

static void put_inputs(plm_report *report)
{
    plm_html *page = &report->page;
    plm_html_print(
        page, "<div class=\"wide\"><table class=\"inputs\">\n<thead><tr><th>plant</th><th>input</th><th>SHA-256</th>"
              "<th>format</th><th>points</th><th>unit</th><th>zenith</th><th>ran</th></tr></thead>\n<tbody>\n");
    for (size_t i = 0; i < report->results->count; i++) {
        const plm_result *plant = &report->results->plant[i];
        plm_html_print(page, "<tr><th scope=\"row\">");
        plm_html_text(page, plant->plant_id);
        plm_html_print(page, "</th>");
        put_member(page, plant->record, "input", NULL);
        put_member(page, plant->record, "sha256", "code");
        put_member(page, plant->record, "format", NULL);
        put_member(page, plant->record, "points", NULL);
        put_member(page, json_object_get(plant->record, "unit"), "evidence", NULL);
        put_member(page, json_object_get(plant->record, "frame"), "evidence", NULL);
        put_stages(page, json_object_get(plant->record, "plan"));
        plm_html_print(page, "</tr>\n");
    }
    plm_html_print(page, "</tbody></table></div>\n");
}

void plm_report_provenance(plm_report *report)
{
    plm_html *page = &report->page;
    json_t *options = json_object_get(report->root, "options");
    plm_html_print(page, "<section>\n<h2>Where this comes from</h2>\n<p>Plantimeter ");
    put_json_value(page, json_object_get(report->root, "version"));
    plm_html_print(page, ". Options:</p>\n<dl class=\"options\">\n");
    for (void *at = json_object_iter(options); at; at = json_object_iter_next(options, at)) {
        plm_html_print(page, "<div><dt>");
        plm_html_text(page, json_object_iter_key(at));
        plm_html_print(page, "</dt><dd>");
        put_json_value(page, json_object_iter_value(at));
        plm_html_print(page, "</dd></div>\n");
    }
    plm_html_print(page, "</dl>\n");
    put_inputs(report);
    plm_html_print(page, "</section>\n");
}
