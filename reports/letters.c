/* reports/letters.c: a plain stroke alphabet of our own, so that pictures need no font files and are the same everywhere.
 * Sorted by code. */
#include "reports/letters.h"

#include <math.h>
#include <stdlib.h>

static const plm_letter letters[] = {
    {' ', 26, ""},
    {'!', 16, "M6 70L6 20M6 0L6 2"},
    {'"', 28, "M6 70L6 52M20 70L20 52"},
    {'#', 54, "M16 0L24 70M34 0L42 70M4 46L50 46M2 24L48 24"},
    {'$', 48, "A22 49 15 13 35 270a22 21 17 15 90 -145M22 74L22 -6"},
    {'%', 64, "A14 54 11 15 0 360A46 16 11 15 0 360M46 70L14 0"},
    {'&', 58, "M52 0L14 48a23 56 11 14 215 -45L12 28a20 16 17 16 130 340L46 30"},
    {'\'', 14, "M6 70L6 52"},
    {'(', 26, "A34 28 26 50 130 230"},
    {')', 26, "A-10 28 26 50 50 -50"},
    {'*', 36, "M17 70L17 40M4 63L30 47M30 63L4 47"},
    {'+', 52, "M24 8L24 52M2 30L46 30"},
    {',', 18, "M9 3L4 -11"},
    {'-', 34, "M5 27L27 27"},
    {'.', 16, "M6 0L6 2"},
    {'/', 34, "M3 -10L29 74"},
    {'0', 50, "A23 35 18 35 0 360"},
    {'1', 50, "M10 57L26 70L26 0"},
    {'2', 50, "A23 51 17 19 168 -32L5 0L42 0"},
    {'3', 50, "A22 53 16 17 150 -90a22 18 18 18 90 -152"},
    {'4', 50, "M33 0L33 70L4 21L44 21"},
    {'5', 50, "M39 70L11 70L8 40a22 23 18 23 125 -145"},
    {'6', 50, "A38 22 33 48 97 180A23 22 18 22 180 540"},
    {'7', 50, "M5 70L41 70L17 0"},
    {'8', 50, "A23 53 15 17 0 360A23 18 18 18 0 360"},
    {'9', 50, "A23 48 18 22 0 360A8 48 33 48 0 -83"},
    {':', 18, "M7 0L7 2M7 44L7 46"},
    {';', 18, "M9 3L4 -11M8 44L8 46"},
    {'<', 50, "M42 54L6 30L42 6"},
    {'=', 52, "M4 40L46 40M4 20L46 20"},
    {'>', 50, "M6 54L42 30L6 6"},
    {'?', 44, "A20 53 15 17 165 -45L20 30L20 20M20 0L20 2"},
    {'@', 78, "A38 30 13 17 0 360M51 46L51 26a58 26 7 10 180 360a38 30 33 38 8 300"},
    {'A', 56, "M3 0L28 70L53 0M12 24L44 24"},
    {'B', 52, "M7 0L7 70L25 70a25 53 16 17 90 -90L7 36M25 36a25 18 19 18 90 -90L7 0"},
    {'C', 58, "A33 35 29 35 45 315"},
    {'D', 58, "M7 0L7 70L20 70a20 35 31 35 90 -90L7 0"},
    {'E', 48, "M41 70L7 70L7 0L42 0M7 37L36 37"},
    {'F', 44, "M41 70L7 70L7 0M7 37L36 37"},
    {'G', 64, "A34 35 30 35 45 318L56 32L38 32"},
    {'H', 58, "M7 0L7 70M50 0L50 70M7 37L50 37"},
    {'I', 20, "M9 0L9 70"},
    {'J', 40, "M30 70L30 17a17 17 13 17 0 -160"},
    {'K', 52, "M7 0L7 70M47 70L7 27M21 42L49 0"},
    {'L', 44, "M7 70L7 0L40 0"},
    {'M', 70, "M7 0L7 70L34 20L61 70L61 0"},
    {'N', 60, "M7 0L7 70L51 0L51 70"},
    {'O', 68, "A34 35 29 35 0 360"},
    {'P', 48, "M7 0L7 70L25 70a25 51 18 19 90 -90L7 32"},
    {'Q', 68, "A34 35 29 35 0 360M42 17L60 -5"},
    {'R', 52, "M7 0L7 70L25 70a25 51 18 19 90 -90L7 32M26 32L46 0"},
    {'S', 50, "A24 52 17 18 35 270a24 17 19 17 90 -145"},
    {'T', 50, "M3 70L47 70M25 70L25 0"},
    {'U', 58, "M7 70L7 22a29 22 22 22 180 360L51 70"},
    {'V', 54, "M3 70L27 0L51 70"},
    {'W', 76, "M3 70L21 0L38 66L55 0L73 70"},
    {'X', 50, "M4 70L46 0M46 70L4 0"},
    {'Y', 50, "M2 70L25 34L48 70M25 34L25 0"},
    {'Z', 50, "M5 70L45 70L4 0L46 0"},
    {'[', 24, "M20 76L8 76L8 -14L20 -14"},
    {'\\', 34, "M5 74L31 -10"},
    {']', 24, "M4 76L16 76L16 -14L4 -14"},
    {'^', 44, "M6 44L22 70L38 44"},
    {'_', 44, "M1 -12L43 -12"},
    {'`', 22, "M5 72L15 60"},
    {'a', 46, "A21 25 16 25 0 360M38 50L38 0"},
    {'b', 46, "M7 70L7 0A24 25 16 25 0 360"},
    {'c', 42, "A23 25 17 25 45 315"},
    {'d', 46, "A21 25 16 25 0 360M38 70L38 0"},
    {'e', 45, "M6 26L39 26a22 25 17 25 3 312"},
    {'f', 30, "A24 57 11 13 70 180L13 0M3 48L26 48"},
    {'g', 46, "A21 25 16 25 0 360M38 50L38 -3a22 -3 16 17 0 -150"},
    {'h', 45, "M7 70L7 0M7 31a22 31 15 19 180 0L37 0"},
    {'i', 18, "M8 50L8 0M8 66L8 68"},
    {'j', 20, "M12 50L12 -7a3 -7 9 13 0 -100M12 66L12 68"},
    {'k', 42, "M7 70L7 0M36 50L7 19M17 30L38 0"},
    {'l', 18, "M8 70L8 0"},
    {'m', 68, "M7 50L7 0M7 33a20 33 13 17 180 0L33 0M33 33a46 33 13 17 180 0L59 0"},
    {'n', 45, "M7 50L7 0M7 31a22 31 15 19 180 0L37 0"},
    {'o', 45, "A22 25 17 25 0 360"},
    {'p', 46, "M7 50L7 -20A24 25 16 25 0 360"},
    {'q', 46, "A21 25 16 25 0 360M38 50L38 -20"},
    {'r', 30, "M7 50L7 0M7 30a21 30 14 20 180 62"},
    {'s', 38, "A19 37 12 13 38 270a19 12 13 12 90 -142"},
    {'t', 30, "M13 66L13 12a23 12 10 12 180 295M3 50L26 50"},
    {'u', 45, "M7 50L7 19a22 19 15 19 180 360M37 50L37 0"},
    {'v', 40, "M4 50L20 0L36 50"},
    {'w', 60, "M4 50L17 0L30 46L43 0L56 50"},
    {'x', 38, "M4 50L34 0M34 50L4 0"},
    {'y', 40, "M4 50L20 1M36 50L13 -20"},
    {'z', 38, "M5 50L33 50L4 0L34 0"},
    {'{', 28, "M24 76L18 76L14 70L14 38L6 31L14 24L14 -8L18 -14L24 -14"},
    {'|', 18, "M8 78L8 -16"},
    {'}', 28, "M4 76L10 76L14 70L14 38L22 31L14 24L14 -8L10 -14L4 -14"},
    {'~', 52, "A14 28 10 9 180 20a34 32 10 9 200 360"},
    {0xb0, 28, "A13 58 10 11 0 360"},
    {0xb1, 52, "M24 18L24 62M2 40L46 40M2 4L46 4"},
    {0xb2, 26, "A12 61 9 9 168 -32L3 34L22 34"},
    {0xb3, 26, "A12 62 8 8 150 -90a12 44 9 10 90 -152"},
    {0xb7, 18, "M8 28L8 30"},
    {0xd7, 48, "M8 14L40 46M40 14L8 46"},
    {0x2013, 50, "M5 27L45 27"},
    {0x2026, 50, "M8 0L8 2M25 0L25 2M42 0L42 2"},
};

static const plm_letter unknown = {0, 40, "M6 0L6 60L34 60L34 0L6 0"};

/** Lines that an ellipse is drawn as, a full turn. */
enum { TURN_STEPS = 36 };

static int compare_code(const void *code, const void *letter)
{
    const uint32_t wanted = *(const uint32_t *)code, found = ((const plm_letter *)letter)->code;
    return (wanted > found) - (wanted < found);
}

const plm_letter *plm_letter_find(uint32_t code)
{
    const plm_letter *found = bsearch(&code, letters, sizeof letters / sizeof *letters, sizeof *letters, compare_code);
    return found ? found : &unknown;
}

uint32_t plm_letter_next(const char **text)
{
    const unsigned char *at = (const unsigned char *)*text;
    const int more = at[0] < 0x80                    ? 0
                     : at[0] >= 0xc2 && at[0] < 0xe0 ? 1
                     : (at[0] & 0xf0) == 0xe0        ? 2
                     : (at[0] & 0xf8) == 0xf0        ? 3
                                                     : -1;
    uint32_t code = more <= 0 ? at[0] : at[0] & (0x3fu >> more);
    int read = 1;
    for (; read <= more && (at[read] & 0xc0) == 0x80; read++) code = code << 6 | (at[read] & 0x3fu);
    if (more < 0 || read <= more) {
        ++*text;
        return UINT32_MAX;
    }
    *text += read;
    return code;
}

/* A whole number of the path. */
static double read_number(const char **at)
{
    while (**at == ' ') ++*at;
    char *end;
    const long number = strtol(*at, &end, 10);
    *at = end;
    return (double)number;
}

static void ellipse_point(const plm_stroke_state *s, double angle, double *x, double *y)
{
    const double radians = angle * (3.14159265358979323846 / 180);
    *x = s->cx + s->rx * cos(radians);
    *y = s->cy + s->ry * sin(radians);
}

static int ellipse_line(plm_stroke_state *s, double line[4])
{
    line[0] = s->x;
    line[1] = s->y;
    s->angle += (s->last - s->angle) / s->steps--;
    ellipse_point(s, s->angle, &s->x, &s->y);
    line[2] = s->x;
    line[3] = s->y;
    return 1;
}

static void begin_ellipse(const char **at, plm_stroke_state *s)
{
    s->cx = read_number(at);
    s->cy = read_number(at);
    s->rx = read_number(at);
    s->ry = read_number(at);
    s->angle = read_number(at);
    s->last = read_number(at);
    s->steps = (int)(fabs(s->last - s->angle) / 360 * TURN_STEPS) + 1;
}

int plm_stroke_next(const char **at, plm_stroke_state *s, double line[4])
{
    if (s->steps) return ellipse_line(s, line);
    while (**at) {
        const char command = *(*at)++;
        const double x = s->x, y = s->y;
        if (command == 'A' || command == 'a') {
            begin_ellipse(at, s);
            ellipse_point(s, s->angle, &s->x, &s->y);
            if (command == 'A') return ellipse_line(s, line);
        } else {
            s->x = read_number(at);
            s->y = read_number(at);
            if (command == 'M') continue;
        }
        line[0] = x;
        line[1] = y;
        line[2] = s->x;
        line[3] = s->y;
        return 1;
    }
    return 0;
}
