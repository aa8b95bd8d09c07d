/* cloud/nearest_name.h: the known name that a mistyped one probably means. Internal. */
#ifndef PLANTIMETER_CLOUD_NEAREST_NAME_H
#define PLANTIMETER_CLOUD_NEAREST_NAME_H

#include <stddef.h>

/** Edits between two words: letters inserted, dropped, changed or swapped with their neighbour (optimal string
 * alignment). Case does not count, `-` and `_` are the same. Words are looked at up to 63 letters. */
size_t plm_name_distance(const char *a, const char *b);

/** The nearest of count names (name(table, i)) to word, the first of equally near ones; NULL when all are too far to be
 * meant: more than a third of the longer word's letters would change. A name that word begins or is begun by counts as
 * near. */
const char *plm_nearest_name(const char *word, const char *(*name)(const void *table, size_t i), const void *table,
                             size_t count);

#endif
