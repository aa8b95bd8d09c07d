/* io/ascii.h: rows of numbers in text, for PLY, PCD and plain text files. Internal to io/. */
#ifndef PLANTIMETER_IO_ASCII_H
#define PLANTIMETER_IO_ASCII_H

#include "io/columns.h"

/** How the rows of a file are written. The lines of one file are alike: item i of each line belongs to column i. */
typedef struct plm_ascii {
    char separator;      /* ' ': runs of blanks and tabs; else that character, with blanks around it */
    char decimal;        /* ',' where that may stand in place of a decimal point, else '.' */
    bool has_comments;   /* lines that begin with # or // are no rows */
    const bool *is_list; /* PLY: item i is a count and that many numbers; NULL: none is */
    size_t item_count;   /* items of a line, the same as columns */
} plm_ascii;

/** Where the rows are. */
typedef struct plm_ascii_place {
    size_t begin;  /* byte of the first line */
    size_t line;   /* its number, from 1 on */
    uint64_t skip; /* rows to pass over before the first that counts */
    uint64_t rows; /* rows that the file claims to have, UINT64_MAX: all to the end */
} plm_ascii_place;

/** Reads the columns that roles name and points them to block, which the caller frees with plm_free (also on failure;
 * it is then NULL or valid). Sets columns->rows. PLM_E_FORMAT with line, item and text. */
plm_status plm_ascii_read(const plm_bytes *bytes, const plm_ascii *ascii, const plm_ascii_place *place,
                          const plm_roles *roles, plm_columns *columns, void **block, plm_error *error);

/** A line of text without its end; next is the line after it, or end. */
typedef struct plm_line {
    const char *begin, *end, *next;
} plm_line;

/** The line at text (text < end). A line ends in LF, CR LF or, in old files, CR alone never. */
plm_line plm_line_at(const char *text, const char *end);

/** True of a line that is blank, or a comment where comments exist. */
bool plm_line_is_empty(const plm_line *line, bool has_comments);

/** Cuts the next item off a line: text from *at on, which moves behind the item and its separator. False at the end of
 * the line. Blanks around the item and quotation marks are not part of it. */
bool plm_item_next(const char **at, const char *end, char separator, const char **begin, const char **stop);

#endif
