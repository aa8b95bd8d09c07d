/* simulate/manual_readings.c: readings such as a person takes by hand, in the layout of manual-measurement tables. Reading errors: ruler
 * 0.5 mm, leaf area meter 1.5 %, protractor 1 degree (read to half a degree), calliper 0.02 mm. Settled by taste, after
 * what such instruments state. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/simulate.h"

/* The growing table; remembers that memory ran out. */
typedef struct readings {
    char *text;
    size_t used, room;
    bool has_failed;
    plm_error *error;
    const char *plant_id;
    plm_random random;
} readings;

static void add_row(readings *table, const char *organ, int id, const char *trait, int digits, double value,
                    const char *unit)
{
    char row[320], number[16] = "";
    if (id >= 0) snprintf(number, sizeof number, "%d", id);
    const int size = snprintf(row, sizeof row, "%.120s,%s,%s,%s,%.*f,%s\n", table->plant_id, organ, number, trait,
                              digits, value, unit);
    if (table->has_failed || size < 0) return;
    if (table->used + (size_t)size + 1 > table->room) {
        const size_t room = 2 * table->room + 4096;
        char *larger = plm_realloc(table->text, room, 1, table->error);
        table->has_failed = !larger;
        if (!larger) return;
        table->text = larger;
        table->room = room;
    }
    memcpy(table->text + table->used, row, (size_t)size + 1);
    table->used += (size_t)size;
}

static void ruler(readings *table, const char *organ, int id, const char *trait, double metres)
{
    add_row(table, organ, id, trait, 0, 1000 * metres + 0.5 * plm_draw_normal(&table->random), "mm");
}

static void protractor(readings *table, const char *organ, int id, const char *trait, double radians, double most)
{
    const double read = plm_degrees(radians) + plm_draw_normal(&table->random);
    add_row(table, organ, id, trait, 1, fmin(fmax(0.5 * round(2 * read), 0), most), "deg");
}

plm_status plm_manual_readings(const char *plant_id, const plm_virtual_plant *plant, uint64_t seed, char **text,
                               plm_error *error)
{
    readings table = {.text = *text, .used = *text ? strlen(*text) : 0, .error = error, .plant_id = plant_id};
    table.room = *text ? table.used + 1 : 0;
    table.random.key = plm_key(seed, 60);
    ruler(&table, "plant", -1, "plant_height", plant->whole.height);
    add_row(&table, "plant", -1, "leaf_count", 0, (double)plant->leaf_count, "1");
    for (size_t k = 0; k < plant->stem_count; k++)
        add_row(&table, "stem", (int)k, "stem_diameter", 2,
                1000 * plant->stem[k].diameter + 0.02 * plm_draw_normal(&table.random), "mm");
    for (size_t k = 0; k < plant->petiole_count; k++) {
        protractor(&table, "petiole", (int)k, "petiole_inclination", plant->petiole[k].inclination, 180);
        ruler(&table, "petiole", (int)k, "petiole_length", plant->petiole[k].length);
    }
    for (size_t k = 0; k < plant->leaf_count; k++) {
        const plm_true_leaf *leaf = &plant->leaf[k];
        add_row(&table, "leaf", (int)k, "leaf_area", 2, 1e4 * leaf->area * (1 + 0.015 * plm_draw_normal(&table.random)),
                "cm2");
        protractor(&table, "leaf", (int)k, "leaf_inclination", leaf->inclination, 90);
        ruler(&table, "leaf", (int)k, "leaf_length", leaf->length);
        ruler(&table, "leaf", (int)k, "leaf_width", leaf->width);
    }
    *text = table.text;
    return table.has_failed ? PLM_E_MEMORY : PLM_OK;
}
