/* io/text_columns.c: what the columns of a text file are. */
#include "io/number.h"
#include "io/text_layout.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLED_ROWS = 1024, SAMPLED_PLACES = 64, SAMPLED_COLUMNS = 16, MOST_LABELS = 64 };

/** Rows spread over the file; a missing number is NaN. */
typedef struct sample {
    double (*value)[SAMPLED_COLUMNS];
    size_t rows;
} sample;

void plm_column_name(const char *begin, const char *stop, char name[64])
{
    const char *end = stop;
    for (const char *at = begin + 1; at < end; at++)
        if (*at == '[' || *at == '(') end = at;
    while (end > begin && end[-1] == ' ') end--;
    const size_t length = end - begin < 63 ? (size_t)(end - begin) : 63;
    memcpy(name, begin, length);
    name[length] = 0;
}

/* "-" and nothing leave a column without a name: it goes by its number. */
static plm_status add_name(plm_columns *columns, const char *begin, const char *stop, plm_error *error)
{
    char name[64];
    plm_column_name(begin, stop, name);
    if (!name[0] || !strcmp(name, "-")) snprintf(name, sizeof name, "column%zu", columns->count + 1);
    return plm_columns_add(columns, name, strlen(name), PLM_FLOAT64, error) ? PLM_OK : PLM_E_MEMORY;
}

/* The names in a line, as many as there are columns; the rest go by their numbers. */
static plm_status add_names(const plm_line *line, char separator, size_t wanted, plm_columns *columns, plm_error *error)
{
    const char *at = line->begin, *begin = "", *stop = begin;
    plm_status status = PLM_OK;
    while (status == PLM_OK && columns->count < wanted) {
        if (!plm_item_next(&at, line->end, separator, &begin, &stop)) begin = stop = "";
        status = add_name(columns, begin, stop, error);
    }
    return status;
}

static plm_status names_of_options(const plm_bytes *bytes, const char *names, size_t wanted, plm_columns *columns,
                                   plm_error *error)
{
    const plm_line line = {.begin = names, .end = names + strlen(names)};
    const char *at = line.begin, *begin, *stop;
    size_t given = 0;
    while (plm_item_next(&at, line.end, ',', &begin, &stop)) given++;
    if (given > wanted)
        return plm_fail(error, PLM_E_ARGUMENT, "%s: %zu columns are named, but its rows have only %zu", bytes->name,
                        given, wanted);
    return add_names(&line, ',', wanted, columns, error);
}

/* ---- Guessing ------------------------------------------------------------------------------------------------- */

static void sample_row(const plm_text_layout *layout, const plm_line *line, double value[SAMPLED_COLUMNS])
{
    const char *at = line->begin, *begin, *stop;
    for (size_t i = 0; i < SAMPLED_COLUMNS; i++) {
        value[i] = NAN;
        if (!plm_item_next(&at, line->end, layout->separator, &begin, &stop)) continue;
        if (plm_number_scan(begin, stop, layout->decimal, &value[i]) != stop) value[i] = NAN;
    }
}

/* Files are often sorted by organ: rows from many places tell more than the first ones. */
static plm_status take_sample(const plm_bytes *bytes, const plm_text_layout *layout, sample *rows, plm_error *error)
{
    const char *start = (const char *)bytes->data + layout->begin, *end = (const char *)bytes->data + bytes->size;
    rows->value = plm_alloc(SAMPLED_ROWS, sizeof *rows->value, error);
    if (!rows->value) return PLM_E_MEMORY;
    const char *at = start;
    for (size_t place = 0; place < SAMPLED_PLACES; place++) {
        const char *from = start + (size_t)(end - start) / SAMPLED_PLACES * place;
        if (from > at) at = plm_line_at(from, end).next;
        for (size_t i = 0; i < SAMPLED_ROWS / SAMPLED_PLACES && at < end; i++) {
            const plm_line line = plm_line_at(at, end);
            at = line.next;
            if (!plm_line_is_empty(&line, true)) sample_row(layout, &line, rows->value[rows->rows++]);
        }
    }
    return PLM_OK;
}

static bool are_unit_vectors(const sample *rows, size_t column)
{
    bool has_fraction = false;
    for (size_t i = 0; i < rows->rows; i++) {
        const double *v = &rows->value[i][column];
        const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (fabs(length - 1) > 0.01 && length != 0) return false; /* 0: no normal was found there. NaN passes */
        has_fraction |= v[0] != floor(v[0]);
    }
    return has_fraction;
}

/* True of shares within 0 to 1 and of whole numbers within 0 to 255. */
static bool are_colours(const sample *rows, size_t column)
{
    bool are_shares = true, are_bytes = true;
    for (size_t i = 0; i < rows->rows; i++)
        for (size_t k = column; k < column + 3; k++) {
            const double v = rows->value[i][k];
            are_shares &= !(v < 0 || v > 1);
            are_bytes &= !(v < 0 || v > 255 || v != floor(v));
        }
    return are_shares || are_bytes;
}

static bool are_labels(const sample *rows, size_t column)
{
    double seen[MOST_LABELS];
    size_t count = 0;
    for (size_t i = 0; i < rows->rows; i++) {
        const double v = rows->value[i][column];
        size_t at = 0;
        if (isnan(v)) continue;
        if (v != floor(v) || fabs(v) > 1e6) return false;
        while (at < count && seen[at] != v) at++;
        if (at < count) continue;
        if (count == MOST_LABELS) return false;
        seen[count++] = v;
    }
    return count > 0;
}

static plm_status guess_names(const sample *rows, const plm_text_layout *layout, plm_columns *columns, plm_error *error)
{
    const size_t known = layout->item_count < SAMPLED_COLUMNS ? layout->item_count : SAMPLED_COLUMNS;
    bool has_normal = false, has_colour = false, has_label = false;
    char names[SAMPLED_COLUMNS * 16] = "x,y,z";
    for (size_t column = 3; column < known;) {
        const bool is_triple = column + 3 <= known;
        const char *next = "-";
        size_t taken = 1;
        if (is_triple && !has_normal && are_unit_vectors(rows, column)) {
            has_normal = true;
            next = "nx,ny,nz";
            taken = 3;
        } else if (is_triple && !has_colour && are_colours(rows, column)) {
            has_colour = true;
            next = "red,green,blue";
            taken = 3;
        } else if (!has_label && are_labels(rows, column)) {
            has_label = true;
            next = "label";
        }
        const size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, ",%s", next);
        column += taken;
    }
    const plm_line line = {.begin = names, .end = names + strlen(names)};
    return add_names(&line, ',', layout->item_count, columns, error);
}

plm_status plm_text_columns(const plm_bytes *bytes, const plm_read_options *options, const plm_text_layout *layout,
                            plm_columns *columns, plm_error *error)
{
    static const char pts[] = "x,y,z,intensity,red,green,blue";
    const plm_line pts_line = {.begin = pts, .end = pts + sizeof pts - 1};
    if (options->columns) return names_of_options(bytes, options->columns, layout->item_count, columns, error);
    if (layout->header.begin)
        return add_names(&layout->header, layout->header_separator, layout->item_count, columns, error);
    if (layout->has_count_line && (layout->item_count == 4 || layout->item_count == 7))
        return add_names(&pts_line, ',', layout->item_count, columns, error);
    sample rows = {0};
    plm_status status = take_sample(bytes, layout, &rows, error);
    if (status == PLM_OK) status = guess_names(&rows, layout, columns, error);
    plm_free(rows.value);
    return status;
}
