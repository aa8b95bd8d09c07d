/* io/text_layout.c: where the rows of a text file begin, and what parts their items. */
#include "io/text_layout.h"

#include "io/number.h"

#include <string.h>

/** How many items of a line are numbers, and how many items there are. */
typedef struct line_count {
    size_t items, numbers;
} line_count;

static line_count count_items(const plm_line *line, char separator, char decimal)
{
    line_count count = {0};
    const char *at = line->begin, *begin, *stop;
    double value;
    while (plm_item_next(&at, line->end, separator, &begin, &stop)) {
        count.items++;
        count.numbers += begin < stop && plm_number_scan(begin, stop, decimal, &value) == stop;
    }
    return count;
}

/* The separator that makes most of the line's items numbers; the earlier wins a tie. Tabs alone are never guessed: they
 * are blanks then, as they may be mixed; told as the separator, two in a row hold an empty item. */
static line_count find_separator(const plm_line *line, char wanted, plm_text_layout *layout)
{
    static const char candidates[] = {',', ';', ' ', '\t'};
    line_count best = {0};
    for (size_t i = 0; i < sizeof candidates; i++) {
        if (candidates[i] != wanted && (wanted || candidates[i] == '\t')) continue;
        const char decimal = candidates[i] == ',' ? '.' : ',';
        const line_count count = count_items(line, candidates[i], decimal);
        if (best.items && count.numbers <= best.numbers) continue;
        best = count;
        layout->separator = candidates[i];
        layout->decimal = decimal;
    }
    return best;
}

/* A line without the comment sign at its front. */
static plm_line without_sign(plm_line line)
{
    while (line.begin < line.end &&
           (*line.begin == ' ' || *line.begin == '\t' || *line.begin == '#' || *line.begin == '/'))
        line.begin++;
    return line;
}

/* Do the line's first items, parted so, name x, y and z? */
static bool names_coordinates(const plm_line *line, char separator, size_t item_count)
{
    bool has[3] = {false, false, false};
    const char *at = line->begin, *begin, *stop;
    for (size_t i = 0; i < item_count && plm_item_next(&at, line->end, separator, &begin, &stop); i++) {
        char name[64];
        plm_column_name(begin, stop, name);
        const plm_role role = plm_role_of_name(name);
        if (role <= PLM_ROLE_Z) has[role] = true;
    }
    return has[0] && has[1] && has[2];
}

/* The separator under which a line names the coordinates; the rows' own goes first. 0: it does not name them. */
static char header_separator(const plm_line *line, const plm_text_layout *layout)
{
    const char separators[] = {layout->separator, ',', ';', '\t', ' '};
    for (size_t i = 0; i < sizeof separators; i++)
        if (names_coordinates(line, separators[i], layout->item_count)) return separators[i];
    return 0;
}

static plm_status no_rows(const plm_bytes *bytes, const plm_line *line, size_t number, plm_error *error)
{
    char shown[PLM_SHOWN_LENGTH];
    return plm_fail(
        error, PLM_E_FORMAT,
        "%s: line %zu: found \"%s\", a row of at least three numbers (or one header line before the rows) was "
        "expected",
        bytes->name, number, plm_show(line->begin, (size_t)(line->end - line->begin), shown));
}

plm_status plm_text_layout_find(const plm_bytes *bytes, const plm_read_options *options, plm_text_layout *layout,
                                plm_error *error)
{
    const char *start = (const char *)bytes->data, *end = start + bytes->size;
    plm_text_layout found = {0};
    plm_line comment = {0}, line = {0};
    size_t number = 1, others = 0; /* others: lines before the rows that are neither rows nor comments */
    const char *at = bytes->size >= 3 && memcmp(start, "\xef\xbb\xbf", 3) == 0 ? start + 3 : start;
    if (options->separator && !memchr(",;\t ", options->separator, 4))
        return plm_fail(error, PLM_E_ARGUMENT, "the separator is '%c'; a comma, semicolon, tab or blank was expected",
                        options->separator);
    for (; at < end; at = line.next, number++) {
        line = plm_line_at(at, end);
        if (plm_line_is_empty(&line, false)) continue;
        if (plm_line_is_empty(&line, true)) {
            comment = without_sign(line);
            continue;
        }
        const line_count count = find_separator(&line, options->separator, &found);
        if (count.numbers >= 3) break;
        if (others++ == 1 || (count.numbers != 0 && count.items != 1)) return no_rows(bytes, &line, number, error);
        found.has_count_line = count.numbers == 1;
        if (!found.has_count_line) found.header = without_sign(line);
    }
    if (at >= end)
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: the file ends without a row of at least three numbers",
                        bytes->name, number);
    found.item_count = count_items(&line, found.separator, found.decimal).items;
    found.begin = (size_t)(at - start);
    found.line = number;
    if (!found.header.begin && comment.begin && header_separator(&comment, &found)) found.header = comment;
    if (found.header.begin) found.header_separator = header_separator(&found.header, &found);
    if (!found.header_separator) found.header_separator = found.separator; /* the fields will be told to lack x */
    *layout = found;
    return PLM_OK;
}
