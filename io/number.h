/* io/number.h: decimal numbers of text files, whatever the process' locale. Internal to io/. */
#ifndef PLANTIMETER_IO_NUMBER_H
#define PLANTIMETER_IO_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

/** Reads the number that begins at text and gives the address behind it, or NULL where none begins. Correctly rounded.
 * "nan", "inf" and their Windows spellings ("-nan(ind)", "1.#QNAN") are numbers. decimal is '.' or ','. */
const char *plm_number_scan(const char *text, const char *end, char decimal, double *value);

/** Reads a whole number 0 to 2^63 - 1 that fills text[0..size). */
bool plm_number_whole(const char *text, size_t size, unsigned long long *value);

#endif
