/* reports/canvas.h: a picture in memory: lines, boxes and letters with smooth edges, and PNG out. Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_CANVAS_H
#define PLANTIMETER_REPORTS_CANVAS_H

#include "cloud/cloud.h"

/** A colour, 0 to 255 each. */
typedef struct plm_rgb {
    uint8_t r, g, b;
} plm_rgb;

/** width x height pixels, rows from the top. */
typedef struct plm_canvas {
    int width, height;
    plm_rgb *pixel;
} plm_canvas;

/** A canvas of one colour; freed by plm_canvas_free. */
plm_status plm_canvas_create(int width, int height, plm_rgb background, plm_canvas *canvas, plm_error *error);
void plm_canvas_free(plm_canvas *canvas);

/** Mixes colour into a pixel; share 0 to 1. Pixels outside are passed over. */
void plm_canvas_blend(plm_canvas *canvas, int x, int y, plm_rgb colour, double share);

/** A box with edges on whole pixels. */
void plm_canvas_box(plm_canvas *canvas, int x, int y, int width, int height, plm_rgb colour);

/** A line with round ends; coordinates are pixel centres + 0.5. */
void plm_canvas_line(plm_canvas *canvas, double x0, double y0, double x1, double y1, double width, plm_rgb colour);

/** How letters are drawn. */
typedef struct plm_lettering {
    double size;   /**< height of a capital, pixels */
    double weight; /**< width of the strokes in heights of a capital; 0: 0.12 */
    plm_rgb colour;
    bool has_halo; /**< a light rim, for letters over a drawing */
} plm_lettering;

/** Writes UTF-8 text with its baseline at y, from x to the right. Letters that are not known become a small box. Gives
 * the x behind the last letter. */
double plm_canvas_text(plm_canvas *canvas, double x, double y, const char *text, const plm_lettering *lettering);

/** Width of a text in pixels. */
double plm_text_width(const char *text, double size);

/** Writes the picture as PNG (plm_output: beside, then renamed). PLM_E_WRITE, PLM_E_LIBRARY. */
plm_status plm_canvas_write_png(const plm_canvas *canvas, const char *path, plm_error *error);

#endif
