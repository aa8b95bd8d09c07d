/* reports/canvas.c: drawing with smooth edges: the share of a pixel that a stroke covers is taken from the distance of its
 * centre to the stroke. */
#include "reports/canvas.h"

#include "io/io.h"

#include "reports/letters.h"

#include <math.h>
#include <string.h>

static const double usual_weight = 0.12;
static const double units_per_capital = 70;
static const double tracking = 4; /* units between letters beside what they bring */
static const plm_rgb halo_colour = {255, 255, 255};

plm_status plm_canvas_create(int width, int height, plm_rgb background, plm_canvas *canvas, plm_error *error)
{
    plm_rgb *pixel = plm_alloc((size_t)width * (size_t)height, sizeof *pixel, error);
    if (!pixel) return PLM_E_MEMORY;
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) pixel[i] = background;
    *canvas = (plm_canvas){width, height, pixel};
    return PLM_OK;
}

void plm_canvas_free(plm_canvas *canvas)
{
    plm_free(canvas->pixel);
    *canvas = (plm_canvas){0};
}

static uint8_t mix(uint8_t from, uint8_t to, double share)
{
    return (uint8_t)(from + (to - from) * share + 0.5);
}

void plm_canvas_blend(plm_canvas *canvas, int x, int y, plm_rgb colour, double share)
{
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height || share <= 0) return;
    plm_rgb *pixel = &canvas->pixel[(size_t)y * (size_t)canvas->width + (size_t)x];
    const double part = share > 1 ? 1 : share;
    *pixel = (plm_rgb){mix(pixel->r, colour.r, part), mix(pixel->g, colour.g, part), mix(pixel->b, colour.b, part)};
}

void plm_canvas_box(plm_canvas *canvas, int x, int y, int width, int height, plm_rgb colour)
{
    for (int row = y; row < y + height; row++)
        for (int column = x; column < x + width; column++) plm_canvas_blend(canvas, column, row, colour, 1);
}

/** Pixels off the canvas that still fit an int. */
static const double farthest = 1e9;

/* Distance of a point to a line's piece. */
static double distance_to(double x, double y, const double line[4])
{
    const double dx = line[2] - line[0], dy = line[3] - line[1], squared = dx * dx + dy * dy;
    double t = squared > 0 ? ((x - line[0]) * dx + (y - line[1]) * dy) / squared : 0;
    t = fmin(fmax(t, 0), 1);
    return hypot(x - line[0] - t * dx, y - line[1] - t * dy);
}

void plm_canvas_line(plm_canvas *canvas, double x0, double y0, double x1, double y1, double width, plm_rgb colour)
{
    if (!(fabs(x0) < farthest && fabs(y0) < farthest && fabs(x1) < farthest && fabs(y1) < farthest)) return;
    const double line[4] = {x0, y0, x1, y1}, reach = width / 2 + 1;
    const int left = (int)floor(fmin(x0, x1) - reach), right = (int)ceil(fmax(x0, x1) + reach);
    const int top = (int)floor(fmin(y0, y1) - reach), bottom = (int)ceil(fmax(y0, y1) + reach);
    for (int y = top > 0 ? top : 0; y <= bottom && y < canvas->height; y++)
        for (int x = left > 0 ? left : 0; x <= right && x < canvas->width; x++)
            plm_canvas_blend(canvas, x, y, colour, width / 2 + 0.5 - distance_to(x + 0.5, y + 0.5, line));
}

/* ---- Letters ---------------------------------------------------------------------------------------------------- */

enum { CELL = 96 };

/* Share of each pixel of a cell that the letter covers: the nearest stroke counts, so that joints are not darker. The
 * letter's origin lies at (x, y) of the cell. */
static void cover_cell(const plm_letter *letter, double x, double y, double scale, double width, float cell[CELL][CELL])
{
    memset(cell, 0, sizeof(float[CELL][CELL]));
    const char *at = letter->path;
    plm_stroke_state state = {0};
    double units[4];
    while (plm_stroke_next(&at, &state, units)) {
        const double line[4] = {x + units[0] * scale, y - units[1] * scale, x + units[2] * scale, y - units[3] * scale};
        const double reach = width / 2 + 1;
        const int left = (int)fmax(0, floor(fmin(line[0], line[2]) - reach));
        const int top = (int)fmax(0, floor(fmin(line[1], line[3]) - reach));
        const int right = (int)fmin(CELL - 1, ceil(fmax(line[0], line[2]) + reach));
        const int bottom = (int)fmin(CELL - 1, ceil(fmax(line[1], line[3]) + reach));
        for (int row = top; row <= bottom; row++)
            for (int column = left; column <= right; column++) {
                const double share = width / 2 + 0.5 - distance_to(column + 0.5, row + 0.5, line);
                if (share > cell[row][column]) cell[row][column] = (float)fmin(share, 1);
            }
    }
}

static void draw_letter(plm_canvas *canvas, const plm_letter *letter, double x, double y, double size, double width,
                        plm_rgb colour)
{
    if (!(fabs(x) < farthest && fabs(y) < farthest)) return; /* nowhere near, or not a number */
    float cell[CELL][CELL];
    const double margin = CELL / 4.0;
    const int left = (int)floor(x - margin), top = (int)floor(y - CELL * 0.7);
    cover_cell(letter, x - left, y - top, size / units_per_capital, width, cell);
    for (int row = 0; row < CELL; row++)
        for (int column = 0; column < CELL; column++)
            if (cell[row][column] > 0) plm_canvas_blend(canvas, left + column, top + row, colour, cell[row][column]);
}

static double draw_text(plm_canvas *canvas, double x, double y, const char *text, double size, double width,
                        plm_rgb colour)
{
    while (*text) {
        const plm_letter *letter = plm_letter_find(plm_letter_next(&text));
        draw_letter(canvas, letter, x, y, size, width, colour);
        x += (letter->advance + tracking) * size / units_per_capital;
    }
    return x;
}

double plm_canvas_text(plm_canvas *canvas, double x, double y, const char *text, const plm_lettering *lettering)
{
    const double width = (lettering->weight > 0 ? lettering->weight : usual_weight) * lettering->size;
    if (lettering->has_halo) draw_text(canvas, x, y, text, lettering->size, width + 4, halo_colour);
    return draw_text(canvas, x, y, text, lettering->size, width, lettering->colour);
}

double plm_text_width(const char *text, double size)
{
    double units = 0;
    while (*text) units += plm_letter_find(plm_letter_next(&text))->advance + tracking;
    return units * size / units_per_capital;
}

plm_status plm_canvas_write_png(const plm_canvas *canvas, const char *path, plm_error *error)
{
    const plm_image image = {canvas->width, canvas->height, 3, 8, canvas->pixel};
    return plm_image_write_png(path, &image, error);
}
