/* reports/csv_table.c: a CSV file as a table of text. One pass unquotes the cells in place; a second one counts. */
#include "reports/csv_table.h"

#include <ctype.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct parser {
    char *at, *end;
    char separator;
    size_t line;
    const char *name;
} parser;

static char find_separator(const char *text)
{
    size_t comma = 0, semicolon = 0, tab = 0;
    for (bool quoted = false; *text && (quoted || *text != '\n'); text++) {
        if (*text == '"') quoted = !quoted;
        if (quoted) continue;
        comma += *text == ',';
        semicolon += *text == ';';
        tab += *text == '\t';
    }
    return tab > comma && tab > semicolon ? '\t' : semicolon > comma ? ';' : ',';
}

/* Takes one cell off the text, unquoted and ended with a zero in place. last: it ends its row. */
static plm_status take_cell(parser *p, char **cell, bool *last, plm_error *error)
{
    const size_t start = p->line;
    char *to = p->at;
    *cell = to;
    if (p->at < p->end && *p->at == '"') {
        for (p->at++;; p->at++) {
            if (p->at >= p->end)
                return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: a quote is never closed", p->name, start);
            if (*p->at == '"') {
                if (p->at + 1 >= p->end || p->at[1] != '"') break;
                p->at++;
            }
            p->line += *p->at == '\n';
            *to++ = *p->at;
        }
        p->at++;
    }
    while (p->at < p->end && *p->at != p->separator && *p->at != '\n') {
        if (*p->at != '\r') *to++ = *p->at;
        p->at++;
    }
    *last = p->at >= p->end || *p->at == '\n';
    p->line += p->at < p->end && *p->at == '\n';
    p->at += p->at < p->end;
    *to = 0;
    return PLM_OK;
}

/* Counts rows and cells at most, so that one allocation holds them: separators and line ends outnumber the cells. */
static void count_cells(const char *text, char separator, size_t *cells, size_t *rows)
{
    *cells = *rows = 1;
    for (; *text; text++) {
        *cells += *text == separator || *text == '\n';
        *rows += *text == '\n';
    }
}

static plm_status fill_rows(parser *p, plm_table *table, plm_error *error)
{
    size_t used = 0, row = 0;
    while (p->at < p->end) {
        const size_t line = p->line, begin = used;
        for (bool last = false; !last;) {
            char *cell;
            plm_status status = take_cell(p, &cell, &last, error);
            if (status != PLM_OK) return status;
            if (row > 0 && used - begin == table->columns) {
                if (*cell)
                    return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: more cells than the header's %zu", p->name,
                                    line, table->columns);
                continue; /* separators at a row's end */
            }
            table->cell[used++] = cell;
        }
        if (used - begin == 1 && !table->cell[begin][0]) { /* an empty line */
            used = begin;
            continue;
        }
        if (row == 0) table->columns = used;
        while (used - begin < table->columns) table->cell[used++] = p->end; /* the zero behind the text */
        table->line[row++] = line;
    }
    if (row == 0)
        return plm_fail(error, PLM_E_FORMAT, "%s: line 1: the file is empty; a header line was expected", p->name);
    table->rows = row - 1;
    return PLM_OK;
}

plm_status plm_table_parse(const char *data, size_t size, const char *name, plm_table *out, plm_error *error)
{
    if (memchr(data, 0, size))
        return plm_fail(error, PLM_E_FORMAT, "%s: holds zero bytes; a text table was expected", name);
    plm_table table = {0};
    table.text = plm_alloc(size + 1, 1, error);
    if (!table.text) return PLM_E_MEMORY;
    memcpy(table.text, data, size);
    table.text[size] = 0;
    const size_t mark = size >= 3 && !memcmp(data, "\xef\xbb\xbf", 3) ? 3 : 0;
    parser p = {table.text + mark, table.text + size, find_separator(table.text + mark), 1, name};
    size_t cells, rows;
    count_cells(p.at, p.separator, &cells, &rows);
    /* Short rows are filled up to the header's width. */
    size_t columns = 1;
    for (const char *c = p.at; *c && *c != '\n'; c++) columns += *c == p.separator;
    plm_status status = PLM_E_MEMORY;
    if (rows > SIZE_MAX / (columns + 1) / sizeof *table.cell)
        status = plm_fail(error, PLM_E_FORMAT, "%s: too many cells", name);
    else {
        table.cell = plm_alloc(cells + rows * columns, sizeof *table.cell, error);
        table.line = table.cell ? plm_alloc(rows, sizeof *table.line, error) : NULL;
        if (table.line) status = fill_rows(&p, &table, error);
    }
    if (status == PLM_OK)
        *out = table;
    else
        plm_table_free(&table);
    return status;
}

plm_status plm_table_read(const char *path, plm_table *table, plm_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file) return plm_fail(error, PLM_E_READ, "%s: %s", path, strerror(errno));
    char *data = NULL;
    size_t size = 0, room = 0;
    plm_status status = PLM_OK;
    for (size_t got = 1; got && status == PLM_OK;) {
        if (size == room) {
            room = room ? 2 * room : 65536;
            char *grown = plm_realloc(data, room, 1, error);
            if (!grown) {
                status = PLM_E_MEMORY;
                break;
            }
            data = grown;
        }
        got = fread(data + size, 1, room - size, file);
        size += got;
    }
    if (status == PLM_OK && ferror(file)) status = plm_fail(error, PLM_E_READ, "%s: %s", path, strerror(errno));
    if (status == PLM_OK) status = plm_table_parse(data, size, path, table, error);
    plm_free(data);
    fclose(file);
    return status;
}

void plm_table_free(plm_table *table)
{
    plm_free(table->cell);
    plm_free(table->line);
    plm_free(table->text);
    *table = (plm_table){0};
}

size_t plm_table_column(const plm_table *table, const char *name)
{
    for (size_t i = 0; i < table->columns; i++)
        if (!strcasecmp(table->cell[i], name)) return i;
    return SIZE_MAX;
}

const char *plm_table_cell(const plm_table *table, size_t row, size_t column)
{
    return column == SIZE_MAX ? "" : table->cell[(row + 1) * table->columns + column];
}

bool plm_table_number(const char *cell, double *value)
{
    while (isspace((unsigned char)*cell)) cell++;
    const char first = *cell == '-' || *cell == '+' ? cell[1] : *cell;
    if (!isdigit((unsigned char)first) && first != '.') return false; /* "nan", "inf", "0x" are no readings */
    const locale_t point = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!point) return false;
    const locale_t before = uselocale(point);
    char *end;
    *value = strtod(cell, &end);
    uselocale(before);
    freelocale(point);
    while (isspace((unsigned char)*end)) end++;
    return end != cell && !*end && isfinite(*value);
}
