/* io/number.c: fast and correctly rounded decimal numbers.
 *
 * A decimal of at most 2^53 times a power of ten of at most 22 is one exact product or quotient of two doubles (W. D.
 * Clinger, How to read floating point numbers accurately, 1990, section 3): nearly all coordinates are that. The others
 * go to strtod under the "C" locale. */
#include "io/number.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { LONGEST = 512 }; /* characters of a number; a longer one is no number of a point cloud */

static const double power_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

plm_locale plm_locale_enter(void)
{
    plm_locale locale = {.plain = newlocale(LC_ALL_MASK, "C", (locale_t)0)};
    if (locale.plain) locale.before = uselocale(locale.plain);
    return locale;
}

void plm_locale_leave(plm_locale *locale)
{
    if (!locale->plain) return;
    uselocale(locale->before);
    freelocale(locale->plain);
}

/* The slow way: a copy that ends in a zero byte, read in the "C" locale. */
static bool slow(const char *text, const char *end, char decimal, double *value)
{
    char copy[LONGEST];
    const size_t size = (size_t)(end - text);
    if (size >= sizeof copy) return false;
    memcpy(copy, text, size);
    copy[size] = 0;
    char *point = decimal == '.' ? NULL : strchr(copy, decimal);
    if (point) *point = '.';
    plm_locale locale = plm_locale_enter();
    char *stop;
    *value = strtod(copy, &stop);
    plm_locale_leave(&locale);
    return *stop == 0;
}

/* What programs print for "not a number" and for infinity. Longest first where one begins another. */
static const char *special(const char *text, const char *end, bool is_negative, double *value)
{
    static const struct {
        const char *word;
        double value;
    } words[] = {{"nan(snan)", NAN}, {"nan(ind)", NAN}, {"nan", NAN},         {"infinity", INFINITY},
                 {"inf", INFINITY},  {"1.#qnan", NAN},  {"1.#inf", INFINITY}, {"1.#ind", NAN},
                 {"1.#snan", NAN},   {"null", NAN},     {"na", NAN}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const size_t length = strlen(words[i].word);
        if ((size_t)(end - text) < length || strncasecmp(text, words[i].word, length) != 0) continue;
        *value = is_negative ? -words[i].value : words[i].value;
        return text + length;
    }
    return NULL;
}

/* The exponent behind 'e', or text itself where there is none. */
static const char *scan_exponent(const char *text, const char *end, int *exponent)
{
    const char *at = text;
    if (at == end || (*at != 'e' && *at != 'E')) return text;
    at++;
    const bool is_negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) at++;
    if (at == end || !is_digit(*at)) return text;
    int found = 0;
    for (; at < end && is_digit(*at); at++)
        if (found < 100000) found = found * 10 + (*at - '0');
    *exponent += is_negative ? -found : found;
    return at;
}

const char *plm_number_scan(const char *text, const char *end, char decimal, double *value)
{
    const char *at = text;
    const bool is_negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) at++;
    const char *first = at;
    uint64_t mantissa = 0;
    int digits = 0, exponent = 0; /* digits: significant ones in mantissa */
    for (; at < end && is_digit(*at); at++) {
        if (digits < 19) {
            mantissa = mantissa * 10 + (uint64_t)(*at - '0');
            digits += mantissa != 0;
        } else {
            digits = 20; /* more than mantissa holds: the slow way */
        }
    }
    ptrdiff_t seen = at - first;
    if (at < end && (*at == '.' || *at == decimal)) {
        const char *fraction = ++at;
        for (; at < end && is_digit(*at); at++) {
            if (digits < 19) {
                mantissa = mantissa * 10 + (uint64_t)(*at - '0');
                digits += mantissa != 0;
                exponent--;
            } else {
                digits = 20;
            }
        }
        seen += at - fraction;
    }
    if (seen == 0) return special(first, end, is_negative, value);
    if (at < end && *at == '#') return special(first, end, is_negative, value);
    at = scan_exponent(at, end, &exponent);
    if (digits <= 19 && mantissa <= (UINT64_C(1) << 53) && exponent >= -22 && exponent <= 22) {
        const double exact = (double)mantissa;
        const double size = exponent < 0 ? exact / power_of_ten[-exponent] : exact * power_of_ten[exponent];
        *value = is_negative ? -size : size;
        return at;
    }
    return slow(text, at, decimal, value) ? at : NULL;
}

bool plm_number_whole(const char *text, size_t size, unsigned long long *value)
{
    unsigned long long found = 0;
    if (size == 0 || size > 19) return false;
    for (size_t i = 0; i < size; i++) {
        if (!is_digit(text[i])) return false;
        found = found * 10 + (unsigned long long)(text[i] - '0');
    }
    if (found > INT64_MAX) return false;
    *value = found;
    return true;
}
