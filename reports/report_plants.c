/* reports/report_plants.c: the plants of a report: the table of all, and a card each with picture, 3D view and traits. */
#include "reports/report.h"

#include "io/bytes.h"
#include "reports/assets.h"
#include "reports/thumbnail.h"
#include "reports/value_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_ROOM = 4096, THUMBNAIL_FACTOR = 3 };
static const double views_share = 0.66; /* of a picture's width: the two views without the table beside them */

/* ---- Values ------------------------------------------------------------------------------------------------------ */

/* The row of a trait of an organ (-1: the plant), or NULL. */
static const plm_result_row *find_row(const plm_result *plant, const char *trait, int32_t organ)
{
    for (size_t i = 0; i < plant->row_count; i++)
        if (plant->row[i].organ_id == organ && !strcmp(plant->row[i].trait->name, trait)) return &plant->row[i];
    return NULL;
}

/* A cell with a value, marked where it has flags or is missing: the pointer tells why. */
static void put_cell(plm_html *page, const plm_result_row *row, bool with_unit)
{
    if (!row) {
        plm_html_print(page, "<td class=\"none\">-</td>");
        return;
    }
    char text[PLM_VALUE_ROOM];
    const bool is_ok = plm_result_row_is_ok(row), has_flag = is_ok && row->status[2];
    plm_html_print(page, "<td class=\"%s\"", !is_ok ? "none" : has_flag ? "flag" : "ok");
    if (!is_ok || has_flag) {
        plm_html_print(page, " title=\"");
        plm_html_text(page, row->status);
        if (row->reason[0]) {
            plm_html_print(page, ": ");
            plm_html_text(page, row->reason);
        }
        plm_html_print(page, "\"");
    }
    plm_html_print(page, ">");
    if (is_ok)
        plm_html_text(
            page, plm_value_text(row->value, row->std_error, with_unit ? plm_unit_name(row->trait->unit) : "", text));
    else
        plm_html_print(page, "-");
    plm_html_print(page, "</td>");
}

static void put_trait_heading(plm_html *page, const plm_trait *trait, size_t prefix)
{
    char name[96];
    plm_readable_name(trait->name + prefix, name, sizeof name);
    plm_html_print(page, "<th title=\"");
    plm_html_text(page, trait->definition);
    plm_html_print(page, "\">");
    plm_html_text(page, name);
    if (trait->unit != PLM_NUMBER) plm_html_print(page, " <small>%s</small>", plm_unit_name(trait->unit));
    plm_html_print(page, "</th>");
}

/* ---- All plants -------------------------------------------------------------------------------------------------- */

/** A column of the summary; organ 0 of a level that is not the plant's: the main stem. */
static const struct summary_column {
    const char *trait;
    int32_t organ;
} summary_columns[] = {{"plant_height", -1},    {"plant_width", -1},        {"leaf_count", -1},
                       {"total_leaf_area", -1}, {"convex_hull_volume", -1}, {"stem_diameter", 0}};
enum { SUMMARY_COLUMNS = sizeof summary_columns / sizeof *summary_columns };

static bool is_in_summary(const plm_results *results, int column)
{
    for (size_t i = 0; i < results->count; i++)
        if (find_row(&results->plant[i], summary_columns[column].trait, summary_columns[column].organ)) return true;
    return false;
}

void plm_report_summary(plm_report *report)
{
    plm_html *page = &report->page;
    const plm_results *results = report->results;
    bool shown[SUMMARY_COLUMNS];
    plm_html_print(
        page, "<section>\n<h2>Plants</h2>\n<div class=\"wide\"><table class=\"summary\">\n<thead><tr><th>plant</th>");
    for (int k = 0; k < SUMMARY_COLUMNS; k++) {
        shown[k] = is_in_summary(results, k);
        if (shown[k]) put_trait_heading(page, plm_trait_find(summary_columns[k].trait), 0);
    }
    plm_html_print(page, "<th>warnings</th><th>status</th></tr></thead>\n<tbody>\n");
    for (size_t i = 0; i < results->count; i++) {
        const plm_result *plant = &results->plant[i];
        plm_html_print(page, "<tr><th scope=\"row\"><a href=\"#plant-%zu\">", i);
        plm_html_text(page, plant->plant_id);
        plm_html_print(page, "</a></th>");
        for (int k = 0; k < SUMMARY_COLUMNS; k++)
            if (shown[k]) put_cell(page, find_row(plant, summary_columns[k].trait, summary_columns[k].organ), false);
        plm_html_print(page, "<td>%zu</td><td class=\"%s\">",
                       json_array_size(json_object_get(plant->record, "warnings")), plant->failure ? "bad" : "ok");
        plm_html_text(page, plant->failure ? plant->failure : "ok");
        plm_html_print(page, "</td></tr>\n");
    }
    plm_html_print(page, "</tbody></table></div>\n<p class=\"note\">A dash: the scene does not give the value; a mark "
                         "(&bull;): the value has flags. The pointer over it says why. All values: traits.csv and "
                         "plants.csv.</p>\n");
    plm_report_plot(report, report->folder, "overview", "the main traits of every plant, 95 % bars");
    plm_html_print(page, "</section>\n");
}

/* ---- A card ------------------------------------------------------------------------------------------------------ */

static bool plant_file(const plm_report *report, const plm_result *plant, const char *ending, char path[PATH_ROOM])
{
    char name[PATH_ROOM];
    if (snprintf(name, sizeof name, "%s%s", plant->plant_id, ending) >= (int)sizeof name) return false;
    return snprintf(path, PATH_ROOM, "%s/%s", report->folder, name) < PATH_ROOM && plm_report_has(report->folder, name);
}

static void put_picture(plm_report *report, const plm_result *plant, bool whole)
{
    plm_html *page = &report->page;
    char path[PATH_ROOM];
    if (page->status != PLM_OK || !plant_file(report, plant, ".png", path)) return;
    plm_bytes file = {0};
    unsigned char *small = NULL;
    size_t size = 0;
    plm_status status = whole ? plm_bytes_open(path, &file, NULL)
                              : plm_thumbnail(path, views_share, THUMBNAIL_FACTOR, &small, &size, NULL);
    if (status == PLM_OK) {
        plm_html_print(page, "<img class=\"%s\" alt=\"side and top view of ", whole ? "picture" : "thumbnail");
        plm_html_text(page, plant->plant_id);
        plm_html_print(page, ", organs in colours\" src=\"");
        if (whole)
            plm_html_data_uri(page, "image/png", file.data, file.size);
        else
            plm_html_data_uri(page, "image/jpeg", small, size);
        plm_html_print(page, "\">\n");
    }
    if (status == PLM_E_MEMORY) page->status = plm_fail(page->error, PLM_E_MEMORY, "out of memory for %s", path);
    plm_bytes_close(&file);
    plm_free(small);
}

/* The view's JSON within a script element: a "<" would end it, and is none of JSON's own characters. */
static void put_view(plm_report *report, const plm_result *plant, size_t number)
{
    plm_html *page = &report->page;
    char path[PATH_ROOM];
    plm_bytes file = {0};
    if (page->status != PLM_OK || !plm_asset_three_size || !plant_file(report, plant, ".view.json", path)) return;
    if (plm_bytes_open(path, &file, NULL) != PLM_OK) return;
    plm_html_print(page,
                   "<div class=\"view\" data-view=\"%zu\"><noscript>The 3D view needs JavaScript.</noscript></div>\n",
                   number);
    plm_html_print(page, "<script type=\"application/json\" id=\"view-%zu\">", number);
    const char *at = (const char *)file.data, *end = at + file.size;
    while (at < end) {
        const char *next = memchr(at, '<', (size_t)(end - at));
        plm_html_bytes(page, at, (size_t)((next ? next : end) - at));
        if (next) plm_html_print(page, "\\u003c");
        at = next ? next + 1 : end;
    }
    plm_html_print(page, "</script>\n");
    plm_bytes_close(&file);
}

static void put_plant_traits(plm_html *page, const plm_result *plant)
{
    plm_html_print(page, "<table class=\"traits\">\n<tbody>\n");
    for (size_t i = 0; i < plant->row_count; i++) {
        const plm_result_row *row = &plant->row[i];
        if (row->trait->level != PLM_PLANT) continue;
        char name[96];
        plm_readable_name(row->trait->name, name, sizeof name);
        plm_html_print(page, "<tr><th scope=\"row\" title=\"");
        plm_html_text(page, row->trait->definition);
        plm_html_print(page, "\">");
        plm_html_text(page, name);
        plm_html_print(page, "</th>");
        put_cell(page, row, true);
        plm_html_print(page, "<td class=\"why\">");
        const bool is_ok = plm_result_row_is_ok(row);
        if (!is_ok || row->status[2]) plm_html_text(page, is_ok ? row->status + 3 : row->reason);
        plm_html_print(page, "</td></tr>\n");
    }
    plm_html_print(page, "</tbody></table>\n");
}

/* The organ of a level behind number `after`, or -1; column: which traits any organ of the level has. */
static int32_t next_organ(const plm_result *plant, plm_level level, int32_t after)
{
    int32_t next = -1;
    for (size_t i = 0; i < plant->row_count; i++) {
        const int32_t id = plant->row[i].organ_id;
        if (plant->row[i].trait->level == level && id > after && (next < 0 || id < next)) next = id;
    }
    return next;
}

static void put_organs(plm_html *page, const plm_result *plant, plm_level level)
{
    static const char *const headings[PLM_LEVEL_COUNT] = {"plant", "Stems", "Petioles", "Leaves"};
    const int32_t first = next_organ(plant, level, -1);
    if (first < 0) return;
    size_t count;
    const plm_trait *traits = plm_traits(&count);
    const size_t prefix = strlen(plm_level_name(level)) + 1;
    plm_html_print(
        page, "<details%s><summary>%s</summary>\n<div class=\"wide\"><table class=\"organs\"><thead><tr><th>%s</th>",
        level == PLM_LEAF ? " open" : "", headings[level], plm_level_name(level));
    for (size_t k = 0; k < count; k++)
        if (traits[k].level == level && find_row(plant, traits[k].name, first)) {
            const bool has_prefix = !strncmp(traits[k].name, plm_level_name(level), prefix - 1);
            put_trait_heading(page, &traits[k], has_prefix ? prefix : 0);
        }
    plm_html_print(page, "</tr></thead>\n<tbody>\n");
    for (int32_t organ = first; organ >= 0; organ = next_organ(plant, level, organ)) {
        plm_html_print(page, "<tr data-organ=\"%s:%d\"><th scope=\"row\">%d</th>", plm_level_name(level), organ, organ);
        for (size_t k = 0; k < count; k++)
            if (traits[k].level == level && find_row(plant, traits[k].name, first))
                put_cell(page, find_row(plant, traits[k].name, organ), false);
        plm_html_print(page, "</tr>\n");
    }
    plm_html_print(page, "</tbody></table></div></details>\n");
}

static void put_warnings(plm_html *page, const json_t *record)
{
    const json_t *warnings = json_object_get(record, "warnings");
    if (!json_array_size(warnings)) return;
    plm_html_print(page, "<ul class=\"warnings\">\n");
    for (size_t i = 0; i < json_array_size(warnings); i++) {
        const char *text = json_string_value(json_array_get(warnings, i));
        plm_html_print(page, "<li>");
        plm_html_text(page, text ? text : "");
        plm_html_print(page, "</li>\n");
    }
    plm_html_print(page, "</ul>\n");
}

void plm_report_cards(plm_report *report)
{
    plm_html *page = &report->page;
    const size_t count = report->results->count, views = report->options->views;
    if (!plm_asset_three_size)
        plm_html_print(page,
                       "<p class=\"note\">There are no 3D views: three.js was not installed where this program was "
                       "built.</p>\n");
    else if (count > views)
        plm_html_print(page,
                       "<p class=\"note\">The first %zu of %zu plants have their whole picture and a 3D view; "
                       "<code>plantimeter report --views N</code> takes another number, <code>measure --views N</code> "
                       "keeps the points for as many.</p>\n",
                       views, count);
    for (size_t i = 0; i < count; i++) {
        const plm_result *plant = &report->results->plant[i];
        plm_html_print(page, "<section class=\"card\" id=\"plant-%zu\" data-plant=\"", i);
        plm_html_text(page, plant->plant_id);
        plm_html_print(page, "\">\n<h2>");
        plm_html_text(page, plant->plant_id);
        plm_html_print(page, "</h2>\n");
        if (plant->failure) {
            plm_html_print(page, "<p class=\"bad\">failed: ");
            plm_html_text(page, plant->failure);
            plm_html_print(page, "</p>\n");
        }
        put_warnings(page, plant->record);
        put_picture(report, plant, i < views);
        if (i < views) put_view(report, plant, i);
        if (plant->row_count) {
            plm_html_print(page, "<details%s><summary>Plant</summary>\n", i < views ? " open" : "");
            put_plant_traits(page, plant);
            plm_html_print(page, "</details>\n");
        }
        for (plm_level level = PLM_STEM; level < PLM_LEVEL_COUNT; level++) put_organs(page, plant, level);
        plm_html_print(page, "</section>\n");
    }
}
