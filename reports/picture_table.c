/* reports/picture_table.c: the table of traits beside the views of a picture: the plant's in full, of organs those that
 * are asked for most. */
#include "reports/picture_table.h"

#include "reports/picture_view.h"
#include "reports/value_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 4, LINE = 19, MOST_PLANT_LINES = 16 };

static const plm_rgb ink = {40, 44, 48}, faint = {120, 126, 132}, rule = {214, 218, 222};
static const double letter_size = 9;

/** The table under way. */
typedef struct sheet {
    plm_canvas *canvas;
    const plm_measurement *measurement;
    int x, y, width, bottom;
} sheet;

/** What is shown of an organ, in this order. */
static const char *const organ_traits[PLM_LEVEL_COUNT][COLUMNS] = {
    [PLM_STEM] = {"stem_diameter", "stem_length", "stem_inclination", NULL},
    [PLM_PETIOLE] = {"petiole_inclination", "petiole_length", "petiole_diameter", NULL},
    [PLM_LEAF] = {"leaf_area", "leaf_inclination", "leaf_length", "leaf_width"},
};

const plm_trait_value *plm_measurement_find(const plm_measurement *measurement, const char *trait, int32_t organ)
{
    for (size_t i = 0; i < measurement->value_count; i++) {
        const plm_trait_value *value = &measurement->value[i];
        if (value->organ_id == organ && !strcmp(value->trait->name, trait)) return value;
    }
    return NULL;
}

static void put_text(const sheet *s, double x, const char *text, plm_rgb colour, double weight)
{
    const plm_lettering lettering = {.size = letter_size, .weight = weight, .colour = colour};
    plm_canvas_text(s->canvas, x, s->y + LINE - 6, text, &lettering);
}

static void put_right(const sheet *s, double right, const char *text, plm_rgb colour)
{
    put_text(s, right - plm_text_width(text, letter_size), text, colour, 0);
}

static void put_heading(sheet *s, const char *text)
{
    s->y += 8;
    put_text(s, s->x, text, ink, 0.17);
    s->y += LINE + 2;
    plm_canvas_box(s->canvas, s->x, s->y - 3, s->width, 1, rule);
}

static void estimate_text(const plm_trait_value *value, bool with_unit, char out[PLM_VALUE_ROOM])
{
    const double factor = plm_unit_factor(value->trait->unit);
    plm_value_text(value->estimate.value * factor, value->estimate.std_error * factor,
                   with_unit ? plm_unit_name(value->trait->unit) : "", out);
}

/* ---- The plant --------------------------------------------------------------------------------------------------- */

static void put_plant(sheet *s)
{
    const plm_measurement *measurement = s->measurement;
    size_t left_out = 0;
    int lines = 0;
    put_heading(s, "plant");
    for (size_t i = 0; i < measurement->value_count; i++) {
        const plm_trait_value *value = &measurement->value[i];
        if (value->trait->level != PLM_PLANT || value->estimate.state != PLM_STATE_OK) continue;
        if (lines == MOST_PLANT_LINES || s->y + LINE > s->bottom) {
            left_out++;
            continue;
        }
        char name[80], text[PLM_VALUE_ROOM];
        plm_readable_name(value->trait->name, name, sizeof name);
        estimate_text(value, true, text);
        put_text(s, s->x, name, ink, 0);
        put_right(s, s->x + s->width, text, ink);
        s->y += LINE;
        lines++;
    }
    if (left_out == 0) return;
    char text[64];
    snprintf(text, sizeof text, "and %zu more in traits.csv", left_out);
    put_text(s, s->x, text, faint, 0);
    s->y += LINE;
}

/* ---- Organs ------------------------------------------------------------------------------------------------------ */

/* The traits of a level that were measured of any organ. */
static int find_columns(const plm_measurement *measurement, plm_level level, const plm_trait *column[COLUMNS])
{
    int count = 0;
    for (int k = 0; k < COLUMNS && organ_traits[level][k]; k++)
        for (size_t i = 0; i < measurement->value_count; i++) {
            const plm_trait_value *value = &measurement->value[i];
            if (value->estimate.state != PLM_STATE_OK || strcmp(value->trait->name, organ_traits[level][k])) continue;
            column[count++] = value->trait;
            break;
        }
    return count;
}

/* The organ behind the one of number `after` (-1: the first), or -1. Organs of a level are sorted. */
static int32_t next_organ(const plm_measurement *measurement, plm_level level, int32_t after)
{
    for (size_t i = 0; i < measurement->value_count; i++)
        if (measurement->value[i].trait->level == level && measurement->value[i].organ_id > after)
            return measurement->value[i].organ_id;
    return -1;
}

static void put_column_names(sheet *s, plm_level level, const plm_trait *const *column, int count)
{
    const size_t prefix = strlen(plm_level_name(level)) + 1;
    put_text(s, s->x, plm_level_name(level), faint, 0);
    for (int k = 0; k < count; k++) {
        char name[80], text[96];
        plm_readable_name(column[k]->name + prefix, name, sizeof name);
        snprintf(text, sizeof text, "%s, %s", name, plm_unit_name(column[k]->unit));
        put_right(s, s->x + s->width - (count - 1 - k) * (s->width - 40) / COLUMNS, text, faint);
    }
    s->y += LINE;
}

static void put_organ(sheet *s, plm_level level, int32_t organ, const plm_trait *const *column, int count)
{
    static const plm_label labels[PLM_LEVEL_COUNT] = {PLM_LABEL_OTHER, PLM_LABEL_STEM, PLM_LABEL_PETIOLE,
                                                      PLM_LABEL_LEAF};
    char text[PLM_VALUE_ROOM];
    plm_canvas_box(s->canvas, s->x, s->y + LINE - 15, 10, 10, plm_organ_colour(labels[level], organ));
    snprintf(text, sizeof text, "%d", organ);
    put_text(s, s->x + 17, text, ink, 0);
    for (int k = 0; k < count; k++) {
        const plm_trait_value *value = plm_measurement_find(s->measurement, column[k]->name, organ);
        const bool is_ok = value && value->estimate.state == PLM_STATE_OK;
        if (is_ok) estimate_text(value, false, text);
        put_right(s, s->x + s->width - (count - 1 - k) * (s->width - 40) / COLUMNS, is_ok ? text : "-",
                  is_ok ? ink : faint);
    }
    s->y += LINE;
}

static void put_organs(sheet *s, plm_level level, const char *heading, int most)
{
    const plm_trait *column[COLUMNS];
    const int count = find_columns(s->measurement, level, column);
    if (count == 0 || s->y + 4 * LINE > s->bottom) return;
    put_heading(s, heading);
    put_column_names(s, level, column, count);
    int left_out = 0, lines = 0;
    for (int32_t organ = next_organ(s->measurement, level, -1); organ >= 0;
         organ = next_organ(s->measurement, level, organ)) {
        if (lines == most || s->y + 2 * LINE > s->bottom) {
            left_out++;
            continue;
        }
        put_organ(s, level, organ, column, count);
        lines++;
    }
    if (left_out == 0) return;
    char text[64];
    snprintf(text, sizeof text, "and %d more in traits.csv", left_out);
    put_text(s, s->x, text, faint, 0);
    s->y += LINE;
}

void plm_picture_table(plm_canvas *canvas, const plm_measurement *measurement, int x, int y, int width, int bottom)
{
    sheet s = {canvas, measurement, x, y, width, bottom};
    put_plant(&s);
    put_organs(&s, PLM_STEM, "stems", 3);
    put_organs(&s, PLM_LEAF, "leaves", 12);
    put_organs(&s, PLM_PETIOLE, "petioles", 10);
}
