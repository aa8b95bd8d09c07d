/* io/ascii.c: rows of numbers in text.
 *
 * The text is cut into chunks at line ends. One pass counts the rows of each chunk, so that a second can parse all
 * chunks at once, each into its place; only the columns that the cloud needs are kept. */
#include "io/ascii.h"

#include "io/number.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 1 << 20, SKIPPED = -1 };

/** Where item i of a line goes. */
typedef struct item_target {
    ptrdiff_t offset; /* in the packed row, or SKIPPED */
    bool is_double;
} item_target;

typedef enum fault_kind { FAULT_NONE, FAULT_NOT_A_NUMBER, FAULT_TOO_FEW, FAULT_TOO_MANY } fault_kind;

typedef struct row_fault {
    fault_kind kind;
    size_t line, item; /* line within the chunk, from 0 on */
    const char *text;
    size_t size;
} row_fault;

typedef struct chunk {
    const char *begin, *end;
    uint64_t rows, lines;
    uint64_t first_row, first_line; /* of the file */
    row_fault fault;
} chunk;

typedef struct ascii_work {
    const plm_ascii *ascii;
    const plm_columns *columns;
    item_target *targets;
    size_t row_size;
    unsigned char *block;
    uint64_t begin, end; /* rows wanted */
    chunk *chunks;
    size_t chunk_count;
} ascii_work;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

plm_line plm_line_at(const char *text, const char *end)
{
    const char *feed = memchr(text, '\n', (size_t)(end - text));
    plm_line line = {text, feed ? feed : end, feed ? feed + 1 : end};
    if (line.end > text && line.end[-1] == '\r') line.end--;
    return line;
}

bool plm_line_is_empty(const plm_line *line, bool has_comments)
{
    const char *at = line->begin;
    while (at < line->end && is_blank(*at)) at++;
    if (at == line->end) return true;
    return has_comments && (*at == '#' || (*at == '/' && at + 1 < line->end && at[1] == '/'));
}

bool plm_item_next(const char **at, const char *end, char separator, const char **begin, const char **stop)
{
    const char *from = *at;
    while (from < end && is_blank(*from) && *from != separator) from++;
    if (separator == ' ')
        while (from < end && is_blank(*from)) from++;
    if (from == end && (separator == ' ' || *at == end)) return false;
    const char *to = from;
    if (from < end && *from == '"') {
        const char *quote = memchr(from + 1, '"', (size_t)(end - from - 1));
        if (quote) to = quote + 1;
    }
    while (to < end && *to != separator && !(separator == ' ' && is_blank(*to))) to++;
    *at = to < end ? to + 1 : end;
    while (to > from && is_blank(to[-1])) to--;
    const bool is_quoted = to - from >= 2 && *from == '"' && to[-1] == '"';
    *begin = from + is_quoted;
    *stop = to - is_quoted;
    return true;
}

/* ---- One row ------------------------------------------------------------------------------------------------- */

static void keep(const item_target *target, unsigned char *row, double value)
{
    const float single = (float)value;
    if (target->is_double)
        memcpy(row + target->offset, &value, sizeof value);
    else
        memcpy(row + target->offset, &single, sizeof single);
}

static row_fault fault_at(fault_kind kind, size_t item, const char *text, const char *end)
{
    const char *stop = text;
    while (stop < end && !is_blank(*stop) && *stop != ',' && *stop != ';') stop++;
    return (row_fault){.kind = kind, .item = item, .text = text, .size = (size_t)(stop - text)};
}

/* Rows whose items are parted by blanks: no quotation marks and no empty items. Lists are passed over. */
static row_fault parse_blank_row(const ascii_work *work, const char *at, const char *end, unsigned char *row)
{
    for (size_t item = 0; item < work->ascii->item_count; item++) {
        const item_target *target = &work->targets[item];
        while (at < end && is_blank(*at)) at++;
        if (at == end) return (row_fault){.kind = FAULT_TOO_FEW, .item = item};
        const char *begin = at;
        const bool is_list = work->ascii->is_list && work->ascii->is_list[item];
        double value = 0;
        if (target->offset != SKIPPED || is_list) {
            at = plm_number_scan(begin, end, work->ascii->decimal, &value);
            if (!at || (at < end && !is_blank(*at))) return fault_at(FAULT_NOT_A_NUMBER, item, begin, end);
            if (!is_list) keep(target, row, value);
        } else {
            while (at < end && !is_blank(*at)) at++;
        }
        for (; is_list && value >= 1; value--) {
            while (at < end && is_blank(*at)) at++;
            if (at == end) return (row_fault){.kind = FAULT_TOO_FEW, .item = item};
            while (at < end && !is_blank(*at)) at++;
        }
    }
    while (at < end && is_blank(*at)) at++;
    if (at == end) return (row_fault){0};
    return fault_at(FAULT_TOO_MANY, work->ascii->item_count, at, end);
}

/* Rows with a separator: items may be empty (then NaN) and stand in quotation marks; one may end the line. */
static row_fault parse_separated_row(const ascii_work *work, const char *at, const char *end, unsigned char *row)
{
    const char separator = work->ascii->separator;
    for (size_t item = 0; item < work->ascii->item_count; item++) {
        const item_target *target = &work->targets[item];
        const char *begin, *stop;
        const bool is_last_and_empty = at == end && item > 0 && end[-1] == separator;
        if (is_last_and_empty)
            begin = stop = end;
        else if (!plm_item_next(&at, end, separator, &begin, &stop))
            return (row_fault){.kind = FAULT_TOO_FEW, .item = item};
        if (is_last_and_empty && item + 1 < work->ascii->item_count)
            return (row_fault){.kind = FAULT_TOO_FEW, .item = item};
        if (target->offset == SKIPPED) continue;
        double value = NAN;
        if (begin < stop && plm_number_scan(begin, stop, work->ascii->decimal, &value) != stop)
            return fault_at(FAULT_NOT_A_NUMBER, item, begin, stop);
        keep(target, row, value);
    }
    while (at < end && is_blank(*at)) at++;
    if (at == end) return (row_fault){0};
    return fault_at(FAULT_TOO_MANY, work->ascii->item_count, at, end);
}

/* ---- Chunks -------------------------------------------------------------------------------------------------- */

static void count_chunk(const plm_ascii *ascii, chunk *piece)
{
    for (const char *at = piece->begin; at < piece->end;) {
        const plm_line line = plm_line_at(at, piece->end);
        piece->rows += !plm_line_is_empty(&line, ascii->has_comments);
        piece->lines++;
        at = line.next;
    }
}

static void parse_chunk(const ascii_work *work, chunk *piece)
{
    uint64_t row = piece->first_row;
    size_t line_number = 0;
    for (const char *at = piece->begin; at < piece->end && row < work->end; line_number++) {
        const plm_line line = plm_line_at(at, piece->end);
        at = line.next;
        if (plm_line_is_empty(&line, work->ascii->has_comments) || row++ < work->begin) continue;
        unsigned char *to = work->block + (row - 1 - work->begin) * work->row_size;
        const row_fault fault = work->ascii->separator == ' ' ? parse_blank_row(work, line.begin, line.end, to)
                                                              : parse_separated_row(work, line.begin, line.end, to);
        if (fault.kind == FAULT_NONE) continue;
        piece->fault = fault;
        piece->fault.line = line_number;
        return;
    }
}

static plm_status cut_chunks(const plm_bytes *bytes, size_t begin, ascii_work *work, plm_error *error)
{
    const size_t most = (bytes->size - begin) / CHUNK + 1;
    work->chunks = plm_alloc_zero(most, sizeof *work->chunks, error);
    if (!work->chunks) return PLM_E_MEMORY;
    const char *at = (const char *)bytes->data + begin, *end = (const char *)bytes->data + bytes->size;
    while (at < end) {
        const char *stop = (size_t)(end - at) <= CHUNK ? end : plm_line_at(at + CHUNK, end).next;
        work->chunks[work->chunk_count++] = (chunk){.begin = at, .end = stop};
        at = stop;
    }
    return PLM_OK;
}

/* Counts the rows of all chunks; gives how many there are, and the number of the line behind the last. */
static uint64_t count_rows(ascii_work *work, size_t first_line, uint64_t *last_line)
{
#pragma omp parallel for schedule(dynamic) if (work->chunk_count > 1)
    for (size_t i = 0; i < work->chunk_count; i++) {
        chunk *piece = &work->chunks[i];
        count_chunk(work->ascii, piece);
    }
    uint64_t rows = 0, line = first_line;
    for (size_t i = 0; i < work->chunk_count; i++) {
        work->chunks[i].first_row = rows;
        work->chunks[i].first_line = line;
        rows += work->chunks[i].rows;
        line += work->chunks[i].lines;
    }
    *last_line = line;
    return rows;
}

static plm_status report_fault(const ascii_work *work, const plm_bytes *bytes, const chunk *piece, plm_error *error)
{
    const row_fault *fault = &piece->fault;
    const unsigned long long line = piece->first_line + fault->line;
    char shown[PLM_SHOWN_LENGTH];
    switch (fault->kind) {
        case FAULT_TOO_FEW:
            return plm_fail(error, PLM_E_FORMAT, "%s: line %llu: has only %zu complete values, %zu were expected",
                            bytes->name, line, fault->item, work->ascii->item_count);
        case FAULT_TOO_MANY:
            return plm_fail(error, PLM_E_FORMAT, "%s: line %llu: \"%s\" follows the %zu values that were expected",
                            bytes->name, line, plm_show(fault->text, fault->size, shown), work->ascii->item_count);
        default:
            return plm_fail(error, PLM_E_FORMAT, "%s: line %llu: value %zu (%s) is \"%s\", a number was expected",
                            bytes->name, line, fault->item + 1, work->columns->column[fault->item].name,
                            plm_show(fault->text, fault->size, shown));
    }
}

/* Lays the packed row out: coordinates, labels and packed colours as double, all else as float. */
static plm_status lay_out(ascii_work *work, const plm_roles *roles, plm_error *error)
{
    work->targets = plm_alloc(work->ascii->item_count, sizeof *work->targets, error);
    if (!work->targets) return PLM_E_MEMORY;
    for (size_t i = 0; i < work->ascii->item_count; i++) {
        work->targets[i] = (item_target){.offset = SKIPPED};
        for (plm_role role = 0; role < PLM_ROLE_COUNT; role++) {
            if (roles->column[role] != &work->columns->column[i]) continue;
            if (work->ascii->is_list && work->ascii->is_list[i]) continue;
            work->targets[i].offset = 0;
            if (role <= PLM_ROLE_Z || role >= PLM_ROLE_LABEL || role == PLM_ROLE_PACKED_COLOUR)
                work->targets[i].is_double = true;
        }
    }
    for (size_t i = 0; i < work->ascii->item_count; i++) {
        if (work->targets[i].offset == SKIPPED) continue;
        work->targets[i].offset = (ptrdiff_t)work->row_size;
        work->row_size += work->targets[i].is_double ? sizeof(double) : sizeof(float);
    }
    return PLM_OK;
}

static plm_status parse_rows(ascii_work *work, const plm_bytes *bytes, plm_error *error)
{
    const size_t rows = (size_t)(work->end - work->begin);
    work->block = plm_alloc(rows, work->row_size, error);
    if (!work->block) return PLM_E_MEMORY;
#pragma omp parallel for schedule(dynamic) if (work->chunk_count > 1)
    for (size_t i = 0; i < work->chunk_count; i++) {
        chunk *piece = &work->chunks[i];
        parse_chunk(work, piece);
        if (piece->fault.kind == FAULT_NONE) /* else the message shows what stands there */
            plm_bytes_drop(bytes, (const unsigned char *)piece->begin, (size_t)(piece->end - piece->begin));
    }
    for (size_t i = 0; i < work->chunk_count; i++)
        if (work->chunks[i].fault.kind != FAULT_NONE) return report_fault(work, bytes, &work->chunks[i], error);
    return PLM_OK;
}

static void point_columns(const ascii_work *work, plm_columns *columns)
{
    for (size_t i = 0; i < work->ascii->item_count; i++) {
        if (work->targets[i].offset == SKIPPED) continue;
        plm_column *column = &columns->column[i];
        column->type = work->targets[i].is_double ? PLM_FLOAT64 : PLM_FLOAT32;
        column->data = work->block + work->targets[i].offset;
        column->stride = work->row_size;
    }
    columns->rows = (size_t)(work->end - work->begin);
}

plm_status plm_ascii_read(const plm_bytes *bytes, const plm_ascii *ascii, const plm_ascii_place *place,
                          const plm_roles *roles, plm_columns *columns, void **block, plm_error *error)
{
    ascii_work work = {.ascii = ascii, .columns = columns};
    *block = NULL;
    plm_status status = lay_out(&work, roles, error);
    if (status == PLM_OK) status = cut_chunks(bytes, place->begin, &work, error);
    if (status == PLM_OK) {
        uint64_t line;
        const uint64_t found = count_rows(&work, place->line, &line);
        const uint64_t rows = found > place->skip ? found - place->skip : 0;
        work.begin = place->skip;
        work.end = work.begin + (place->rows < rows ? place->rows : rows);
        if (place->rows != UINT64_MAX && rows < place->rows)
            status = plm_fail(error, PLM_E_FORMAT, "%s: line %llu: the file ends after %llu points, %llu were expected",
                              bytes->name, (unsigned long long)line, (unsigned long long)rows,
                              (unsigned long long)place->rows);
    }
    if (status == PLM_OK) status = parse_rows(&work, bytes, error);
    if (status == PLM_OK) point_columns(&work, columns);
    *block = work.block;
    plm_free(work.chunks);
    plm_free(work.targets);
    return status;
}
