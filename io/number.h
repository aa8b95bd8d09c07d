/* io/number.h: decimal numbers of text files, whatever the process' locale. Internal to io/. */
#ifndef PLANTIMETER_IO_NUMBER_H
#define PLANTIMETER_IO_NUMBER_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>

/** Reads the number that begins at text and gives the address behind it, or NULL where none begins. Correctly rounded.
 * "nan", "inf" and their Windows spellings ("-nan(ind)", "1.#QNAN") are numbers. decimal is the sign that may stand in place of a point: ',' or '.'. */
const char *plm_number_scan(const char *text, const char *end, char decimal, double *value);

/** Reads a whole number 0 to 2^63 - 1 that fills text[0..size). */
bool plm_number_whole(const char *text, size_t size, unsigned long long *value);

/** Puts this thread into the "C" locale, so that printf and strtod use a point; plm_locale_leave brings back what was. */
typedef struct plm_locale {
    locale_t plain, before;
} plm_locale;

plm_locale plm_locale_enter(void);
void plm_locale_leave(plm_locale *locale);

#endif
