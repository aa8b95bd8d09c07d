/* reports/picture.c: the picture of a measured plant: side view and top view at one scale, and the traits beside them. */
#include "reports/picture_table.h"
#include "reports/picture_view.h"
#include "reports/reports.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1600, HEIGHT = 1000, MARGIN = 28, TITLE = 64, TABLE = 512, GAP = 56, CAPTION = 26, SAMPLE = 40000 };

static const plm_rgb paper = {255, 255, 255}, ink = {40, 44, 48}, faint = {120, 126, 132}, panel = {246, 247, 248};
static const double air = 1.1;          /* the box over the plant */
static const double ground_shown = 0.1; /* of the plant's height, below it */

/** What is drawn, along the side view's axes: right, away from the viewer, up. */
typedef struct extent {
    double right[3]; /* unit, horizontal */
    double away[3];
    double low[3], high[3];
} extent;

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* ---- What to show ------------------------------------------------------------------------------------------------ */

static bool is_shown(const plm_cloud *cloud, size_t i)
{
    return !cloud->label || (cloud->label[i] >= PLM_LABEL_STEM && cloud->label[i] <= PLM_LABEL_LEAF);
}

/* The horizontal direction in which the plant is widest: seen from across it, leaves hide each other least. */
static void widest_direction(const plm_cloud *cloud, double right[3])
{
    double mean[2] = {0}, moment[3] = {0}, count = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        if (!is_shown(cloud, i)) continue;
        mean[0] += cloud->xyz[i][0];
        mean[1] += cloud->xyz[i][1];
        count++;
    }
    for (size_t i = 0; i < cloud->count; i++) {
        if (!is_shown(cloud, i)) continue;
        const double x = cloud->xyz[i][0] - mean[0] / count, y = cloud->xyz[i][1] - mean[1] / count;
        moment[0] += x * x;
        moment[1] += x * y;
        moment[2] += y * y;
    }
    const double turn = 0.5 * atan2(2 * moment[1], moment[0] - moment[2]);
    right[0] = cos(turn);
    right[1] = sin(turn);
    right[2] = 0;
}

/* Smallest and largest coordinate along an axis; without labels but for the outer 0.2 %, which may be floaters. */
static plm_status find_range(const plm_cloud *cloud, const double axis[3], double *low, double *high, plm_error *error)
{
    const size_t step = cloud->label ? 1 : cloud->count / SAMPLE + 1;
    double *value = plm_alloc(cloud->count / step + 1, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; i < cloud->count; i += step)
        if (is_shown(cloud, i))
            value[count++] = cloud->xyz[i][0] * axis[0] + cloud->xyz[i][1] * axis[1] + cloud->xyz[i][2] * axis[2];
    qsort(value, count, sizeof *value, compare_doubles);
    const size_t outer = cloud->label ? 0 : count / 500;
    *low = count ? value[outer] : 0;
    *high = count ? value[count - 1 - outer] : 0;
    plm_free(value);
    return PLM_OK;
}

static bool has_ground(const plm_cloud *cloud)
{
    for (size_t i = 0; cloud->label && i < cloud->count; i++)
        if (cloud->label[i] == PLM_LABEL_GROUND) return true;
    return false;
}

static plm_status find_extent(const plm_cloud *cloud, extent *shown, plm_error *error)
{
    const double up[3] = {0, 0, 1};
    widest_direction(cloud, shown->right);
    shown->away[0] = -shown->right[1];
    shown->away[1] = shown->right[0];
    shown->away[2] = 0;
    plm_status status = find_range(cloud, shown->right, &shown->low[0], &shown->high[0], error);
    if (status == PLM_OK) status = find_range(cloud, shown->away, &shown->low[1], &shown->high[1], error);
    if (status == PLM_OK) status = find_range(cloud, up, &shown->low[2], &shown->high[2], error);
    if (has_ground(cloud)) shown->low[2] -= ground_shown * (shown->high[2] - shown->low[2]);
    return status;
}

/* ---- Where to show it -------------------------------------------------------------------------------------------- */

/* Places the two boxes at one scale: beside each other or one above the other, whichever shows the plant larger. */
static void place_views(const extent *shown, plm_view *side, plm_view *top)
{
    double size[3];
    for (int i = 0; i < 3; i++) size[i] = fmax(air * (shown->high[i] - shown->low[i]), 1e-9);
    const double width = WIDTH - 3 * MARGIN - TABLE, height = HEIGHT - TITLE - MARGIN - GAP;
    const double stacked = fmin(width / size[0], (height - GAP) / (size[2] + size[1]));
    const double abreast = fmin((width - GAP) / (2 * size[0]), height / fmax(size[2], size[1]));
    const double scale = fmax(stacked, abreast);
    const bool is_stacked = stacked >= abreast;
    const double up[3] = {0, 0, 1};
    double middle[3];
    for (int i = 0; i < 3; i++) middle[i] = (shown->low[i] + shown->high[i]) / 2;
    for (int i = 0; i < 3; i++)
        side->centre[i] = top->centre[i] = middle[0] * shown->right[i] + middle[1] * shown->away[i] + middle[2] * up[i];
    memcpy(side->right, shown->right, sizeof side->right);
    memcpy(side->up, up, sizeof side->up);
    memcpy(top->right, shown->right, sizeof top->right);
    memcpy(top->up, shown->away, sizeof top->up);
    side->scale = top->scale = scale;
    side->x = top->x = MARGIN;
    side->y = top->y = TITLE + CAPTION;
    side->width = top->width = (int)(is_stacked ? width : (width - GAP) / 2);
    side->height = top->height = (int)height;
    if (is_stacked) {
        side->height = (int)((height - GAP) * size[2] / (size[2] + size[1]));
        top->height = (int)(height - GAP) - side->height;
        top->y = side->y + side->height + GAP;
    } else {
        top->x = side->x + side->width + GAP;
    }
}

/* ---- Words and measures ------------------------------------------------------------------------------------------ */

static void put_text(plm_canvas *canvas, double x, double y, const char *text, double size, plm_rgb colour)
{
    const plm_lettering lettering = {.size = size, .colour = colour};
    plm_canvas_text(canvas, x, y, text, &lettering);
}

/* 1, 2 or 5 times a power of ten, about as long as wanted. */
static double round_length(double metres)
{
    const double power = pow(10, floor(log10(metres))), share = metres / power;
    return (share >= 5 ? 5 : share >= 2 ? 2 : 1) * power;
}

static void put_scale_bar(plm_canvas *canvas, const plm_view *view)
{
    const double length = round_length(160 / view->scale), pixels = length * view->scale;
    const double x = view->x + 4, y = HEIGHT - 24;
    plm_canvas_line(canvas, x, y, x + pixels, y, 3, ink);
    plm_canvas_line(canvas, x, y - 6, x, y + 6, 2, ink);
    plm_canvas_line(canvas, x + pixels, y - 6, x + pixels, y + 6, 2, ink);
    char text[48];
    const bool in_metres = length >= 1;
    snprintf(text, sizeof text, "%.4g %s", in_metres ? length : length * 1e3, in_metres ? "m" : "mm");
    put_text(canvas, x + pixels + 12, y + 5, text, 10, ink);
}

/** Boxes of words that are there already: later ones keep clear of them. */
enum { MOST_WORDS = 256 };
typedef struct words {
    int count;
    double box[MOST_WORDS][4];
} words;

static bool is_free(words *taken, double x, double y, double width, double height)
{
    for (int i = 0; i < taken->count; i++) {
        const double *box = taken->box[i];
        if (x < box[2] && box[0] < x + width && y < box[3] && box[1] < y + height) return false;
    }
    if (taken->count == MOST_WORDS) return false;
    const double box[4] = {x, y, x + width, y + height};
    memcpy(taken->box[taken->count++], box, sizeof box);
    return true;
}

/** The name of an organ and where it belongs. */
typedef struct organ_name {
    char text[32];
    double x, y, nearness; /* to the viewer */
} organ_name;

/* Nearest to the viewer first; names break ties. */
static int compare_names(const void *a, const void *b)
{
    const organ_name *p = a, *q = b;
    if (p->nearness != q->nearness) return p->nearness > q->nearness ? -1 : 1;
    return strcmp(p->text, q->text);
}

static int collect_names(const plm_view *view, const plm_measurement *measurement, organ_name name[MOST_WORDS])
{
    static const char *const names[PLM_LEVEL_COUNT] = {"", "stem ", "", "leaf "};
    const plm_trait_value *before = NULL;
    int count = 0;
    for (size_t i = 0; i < measurement->value_count && count < MOST_WORDS; i++) {
        const plm_trait_value *value = &measurement->value[i];
        const plm_level level = value->trait->level;
        if (value->organ_id < 0 || !names[level][0]) continue;
        if (before && before->trait->level == level && before->organ_id == value->organ_id) continue;
        before = value;
        double point[3];
        for (int axis = 0; axis < 3; axis++) { /* from the input's axes to the plant's */
            point[axis] = -measurement->cloud.origin[axis];
            for (int k = 0; k < 3; k++) point[axis] += measurement->frame.rotation[axis][k] * value->centroid[k];
        }
        organ_name *here = &name[count++];
        plm_view_project(view, point, &here->x, &here->y);
        here->nearness = plm_view_nearness(view, point);
        snprintf(here->text, sizeof here->text, "%s%d", names[level], value->organ_id);
    }
    qsort(name, (size_t)count, sizeof *name, compare_names);
    return count;
}

/* The numbers of the organs, at their middles. Of two in one place the organ before the other, which hides it, has its
 * name there. */
static void put_organ_names(plm_canvas *canvas, const plm_view *view, const plm_measurement *measurement, words *taken)
{
    organ_name name[MOST_WORDS];
    const int count = collect_names(view, measurement, name);
    for (int i = 0; i < count; i++) {
        const double width = plm_text_width(name[i].text, 9);
        if (!is_free(taken, name[i].x - width / 2 - 3, name[i].y - 9, width + 6, 18)) continue;
        const plm_lettering lettering = {.size = 9, .weight = 0.15, .colour = ink, .has_halo = true};
        plm_canvas_text(canvas, name[i].x - width / 2, name[i].y + 4, name[i].text, &lettering);
    }
}

/* The height of the plant, drawn as on a plan. */
static void put_height(plm_canvas *canvas, const plm_view *side, const extent *shown,
                       const plm_measurement *measurement)
{
    const plm_trait_value *height = plm_measurement_find(measurement, "plant_height", -1);
    if (!height || height->estimate.state != PLM_STATE_OK) return;
    const double top_point[3] = {side->centre[0], side->centre[1], shown->high[2]};
    double x, top;
    plm_view_project(side, top_point, &x, &top);
    const double bottom = top + height->estimate.value * side->scale;
    x -= side->scale * (shown->high[0] - shown->low[0]) / 2 + 14;
    if (x < side->x + 4) x = side->x + 4;
    plm_canvas_line(canvas, x, top, x, bottom, 1.2, faint);
    plm_canvas_line(canvas, x - 4, top, x + 8, top, 1.2, faint);
    plm_canvas_line(canvas, x - 4, bottom, x + 8, bottom, 1.2, faint);
    char text[64];
    const double factor = plm_unit_factor(height->trait->unit);
    snprintf(text, sizeof text, "%.1f %s", height->estimate.value * factor, plm_unit_name(height->trait->unit));
    const plm_lettering lettering = {.size = 8.5, .colour = faint, .has_halo = true};
    plm_canvas_text(canvas, x + 5, (top + bottom) / 2, text, &lettering);
}

/* ---- The picture ------------------------------------------------------------------------------------------------- */

static plm_status put_view(plm_canvas *canvas, const plm_view *view, const char *caption,
                           const plm_measurement *measurement, plm_error *error)
{
    plm_canvas_box(canvas, view->x, view->y, view->width, view->height, panel);
    put_text(canvas, view->x, view->y - 9, caption, 9, faint);
    const plm_status status = plm_view_draw(canvas, view, measurement, error);
    if (status != PLM_OK) return status;
    words taken = {0};
    put_organ_names(canvas, view, measurement, &taken);
    return PLM_OK;
}

static plm_status draw(plm_canvas *canvas, const plm_plant_report *plant, plm_error *error)
{
    const plm_measurement *measurement = plant->measurement;
    extent shown;
    plm_view side, top;
    plm_status status = find_extent(&measurement->cloud, &shown, error);
    if (status != PLM_OK) return status;
    place_views(&shown, &side, &top);
    status = put_view(canvas, &side, "side view", measurement, error);
    if (status == PLM_OK) status = put_view(canvas, &top, "top view", measurement, error);
    if (status != PLM_OK) return status;
    put_height(canvas, &side, &shown, measurement);
    put_scale_bar(canvas, &side);
    put_text(canvas, MARGIN, 44, plant->plant_id, 17, ink);
    const int x = WIDTH - MARGIN - TABLE;
    plm_picture_table(canvas, measurement, x, TITLE - 12, TABLE, HEIGHT - 44);
    put_text(canvas, x, HEIGHT - 20, "Plantimeter " PLM_VERSION, 8, faint);
    return PLM_OK;
}

plm_status plm_write_picture(const char *path, const plm_plant_report *plant, plm_error *error)
{
    if (!plant->measurement)
        return plm_fail(error, PLM_E_ARGUMENT, "%s: the plant was not measured; there is nothing to draw", path);
    plm_canvas canvas;
    plm_status status = plm_canvas_create(WIDTH, HEIGHT, paper, &canvas, error);
    if (status != PLM_OK) return status;
    status = draw(&canvas, plant, error);
    if (status == PLM_OK) status = plm_canvas_write_png(&canvas, path, error);
    plm_canvas_free(&canvas);
    return status;
}
