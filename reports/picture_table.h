/* reports/picture_table.h: the table of traits beside the views of a picture. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_PICTURE_TABLE_H
#define PLANTIMETER_REPORTS_PICTURE_TABLE_H

#include "reports/canvas.h"
#include "traits/traits.h"

/** Draws the traits of a plant and of its organs from (x, y) down, width wide, at most to bottom. What finds no room is
 * counted in a last line. */
void plm_picture_table(plm_canvas *canvas, const plm_measurement *measurement, int x, int y, int width, int bottom);

/** The value of a trait of an organ (-1: of the plant), or NULL. */
const plm_trait_value *plm_measurement_find(const plm_measurement *measurement, const char *trait, int32_t organ);

#endif
