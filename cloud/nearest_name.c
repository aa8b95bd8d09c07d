/* cloud/nearest_name.c: optimal string alignment distance (F. J. Damerau, 1964, without edits inside swapped pairs). */
#include "cloud/nearest_name.h"

#include <string.h>

enum { LONGEST = 63 };

/* ASCII only: names are, and tolower would ask the locale. */
static char fold(char letter)
{
    if (letter >= 'A' && letter <= 'Z') return (char)(letter - 'A' + 'a');
    return letter == '-' ? '_' : letter;
}

static size_t least(size_t a, size_t b, size_t c)
{
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

size_t plm_name_distance(const char *a, const char *b)
{
    size_t table[3][LONGEST + 1];
    const size_t length_a = strnlen(a, LONGEST), length_b = strnlen(b, LONGEST);
    size_t *previous = table[0], *line = table[1], *before_previous = table[2];
    for (size_t j = 0; j <= length_b; j++) line[j] = j;
    for (size_t i = 1; i <= length_a; i++) {
        size_t *oldest = before_previous;
        before_previous = previous;
        previous = line;
        line = oldest;
        line[0] = i;
        for (size_t j = 1; j <= length_b; j++) {
            const size_t change = fold(a[i - 1]) != fold(b[j - 1]);
            line[j] = least(previous[j] + 1, line[j - 1] + 1, previous[j - 1] + change);
            const int swapped = i > 1 && j > 1 && fold(a[i - 1]) == fold(b[j - 2]) && fold(a[i - 2]) == fold(b[j - 1]);
            if (swapped && before_previous[j - 2] + 1 < line[j]) line[j] = before_previous[j - 2] + 1;
        }
    }
    return line[length_b];
}

static int begins(const char *word, const char *with)
{
    size_t i = 0;
    while (with[i] && fold(word[i]) == fold(with[i])) i++;
    return with[i] == 0;
}

const char *plm_nearest_name(const char *word, const char *(*name)(const void *table, size_t i), const void *table,
                             size_t count)
{
    const char *nearest = NULL;
    size_t smallest = (size_t)-1;
    if (!*word) return NULL;
    for (size_t i = 0; i < count; i++) {
        const char *candidate = name(table, i);
        const size_t length_word = strnlen(word, LONGEST), length = strnlen(candidate, LONGEST);
        const size_t longer = length > length_word ? length : length_word;
        const size_t shorter = length + length_word - longer;
        size_t distance = plm_name_distance(word, candidate);
        const int is_beginning = shorter >= 3 && (begins(candidate, word) || begins(word, candidate));
        if (distance * 3 > longer && !is_beginning) continue;
        if (is_beginning && distance > 1) distance = 1;
        if (distance >= smallest) continue;
        smallest = distance;
        nearest = candidate;
    }
    return nearest;
}
