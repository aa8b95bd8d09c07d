/* tool/talk.c: progress on a terminal, and the short table of results. */
#include "tool/talk.h"

#include "reports/value_text.h"
#include "traits/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

progress_line progress_begin(bool quiet)
{
    return (progress_line){.is_shown = !quiet && isatty(STDERR_FILENO)};
}

void progress_stage(const char *stage, void *user)
{
    const progress_line *line = user;
    if (!line->is_shown) return;
    fprintf(stderr, "\r\033[K[%zu/%zu] %s: %s ", line->number, line->total, line->plant_id, stage);
    fflush(stderr);
}

void progress_end(const progress_line *line)
{
    if (line->is_shown) fputs("\r\033[K", stderr);
}

/* ---- The short table --------------------------------------------------------------------------------------------- */

enum { COLUMNS = 4, CELL = PLM_VALUE_ROOM };

/* Which traits the table shows: the first of those asked for, or what a plant is known by. */
static plm_status choose_columns(const char *list, const plm_trait *column[COLUMNS], size_t *count, plm_error *error)
{
    static const char *const usual[] = {"plant_height", "total_leaf_area", "leaf_count", "stem_diameter"};
    *count = 0;
    if (!list) {
        for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
            if (plm_trait_find(usual[i])) column[(*count)++] = plm_trait_find(usual[i]);
        return PLM_OK;
    }
    size_t trait_count;
    const plm_trait *traits = plm_traits(&trait_count);
    bool *chosen = plm_alloc(trait_count, sizeof *chosen, error);
    if (!chosen) return PLM_E_MEMORY;
    const plm_status status = plm_trait_choose(list, chosen, error);
    for (size_t i = 0; i < trait_count && *count < COLUMNS && status == PLM_OK; i++)
        if (chosen[i]) column[(*count)++] = &traits[i];
    plm_free(chosen);
    return status;
}

/* A plant's value, or that of its only organ, or the mean of its organs. */
static void cell_text(const plm_result *plant, const plm_trait *trait, char text[CELL])
{
    double sum = 0, std_error = NAN;
    size_t count = 0;
    for (size_t i = 0; i < plant->row_count; i++) {
        const plm_result_row *row = &plant->row[i];
        if (row->trait != trait || !plm_result_row_is_ok(row)) continue;
        sum += row->value;
        std_error = count++ ? NAN : row->std_error;
    }
    if (count == 0) {
        snprintf(text, CELL, "-");
        return;
    }
    plm_value_text(sum / (double)count, std_error, plm_unit_name(trait->unit), text);
    const size_t length = strlen(text);
    if (count > 1) snprintf(text + length, CELL - length, " (mean of %zu)", count);
}

/* Columns of a terminal that a text fills: its characters, not its bytes. */
static int width_of(const char *text)
{
    int width = 0;
    for (; *text; text++) width += (*text & 0xc0) != 0x80;
    return width;
}

static void print_cell(const char *text, int width)
{
    printf("%s%*s", text, width > width_of(text) ? width - width_of(text) : 0, "");
}

static void print_rows(const plm_results *results, const plm_trait *const *column, size_t column_count)
{
    int width[COLUMNS + 1] = {5};
    char text[CELL];
    for (size_t i = 0; i < results->count; i++) {
        const int id_width = width_of(results->plant[i].plant_id);
        if (id_width > width[0]) width[0] = id_width;
    }
    for (size_t c = 0; c < column_count; c++) {
        width[c + 1] = width_of(column[c]->name);
        for (size_t i = 0; i < results->count; i++) {
            cell_text(&results->plant[i], column[c], text);
            if (width_of(text) > width[c + 1]) width[c + 1] = width_of(text);
        }
    }
    print_cell("plant", column_count ? width[0] + 2 : 0);
    for (size_t c = 0; c < column_count; c++) print_cell(column[c]->name, c + 1 < column_count ? width[c + 1] + 2 : 0);
    putchar('\n');
    for (size_t i = 0; i < results->count; i++) {
        const plm_result *plant = &results->plant[i];
        print_cell(plant->plant_id, width[0] + 2);
        for (size_t c = 0; c < column_count && !plant->failure; c++) {
            cell_text(plant, column[c], text);
            print_cell(text, c + 1 < column_count ? width[c + 1] + 2 : 0);
        }
        printf("%s%s\n", plant->failure ? "failed: " : "", plant->failure ? plant->failure : "");
    }
}

plm_status print_short_table(const plm_results *results, const char *traits, plm_error *error)
{
    const plm_trait *column[COLUMNS];
    size_t count;
    const plm_status status = choose_columns(traits, column, &count, error);
    if (status == PLM_OK) print_rows(results, column, count);
    return status;
}
