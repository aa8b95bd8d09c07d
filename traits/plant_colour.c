/* traits/plant_colour.c: colour indices over the points of the plant. */
#include "traits/families.h"
#include "traits/scene.h"

#include <math.h>

/** Green leaf index, mean of (2 G - R - B) / (2 G + R + B) over points (Louhaichi, Borman and Johnson 2001); black points have
 * none and are left out. Condition: of order 1. */
plm_status plm_trait_gli(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    double sum = 0, squares = 0;
    size_t count = 0;
    for (size_t i = 0; i < scene->plant_count; i++) {
        const uint8_t *c = scene->cloud->rgb[scene->plant_row[i]];
        const double light = 2.0 * c[1] + c[0] + c[2];
        if (light == 0) continue;
        const double index = (2.0 * c[1] - c[0] - c[2]) / light;
        sum += index;
        squares += index * index;
        count++;
    }
    if (count == 0) return plm_not_applicable(out, "all points are black");
    const double n = (double)count;
    out->value = sum / n;
    out->std_error = sqrt(fmax(0, squares / n - out->value * out->value) / n);
    out->point_count = count;
    out->method = "mean over points";
    return PLM_OK;
}

/* Hue of a colour in radians, and its chroma; grey has no hue. */
static double hue_of(const uint8_t c[3], double *chroma)
{
    const double a = c[0] - 0.5 * (c[1] + c[2]), b = 0.866025403784439 * (c[1] - (double)c[2]);
    *chroma = hypot(a, b);
    return atan2(b, a);
}

/** Circular mean of the hue (0 red, 120 green, 240 blue), weighted by chroma: grey points say nothing of hue. The standard
 * error is that of a mean direction (Fisher 1993, section 4.4). */
plm_status plm_trait_hue_mean(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    double x = 0, y = 0, weights = 0, squares = 0;
    for (size_t i = 0; i < scene->plant_count; i++) {
        double chroma;
        const double hue = hue_of(scene->cloud->rgb[scene->plant_row[i]], &chroma);
        x += chroma * cos(hue);
        y += chroma * sin(hue);
        weights += chroma;
        squares += chroma * chroma;
    }
    const double length = hypot(x, y);
    if (!(length > 1e-6 * (1 + weights))) return plm_not_applicable(out, "the colours have no mean hue (grey)");
    const double angle = atan2(y, x), concentration = length / weights, n = weights * weights / squares;
    out->value = angle < 0 ? angle + 2 * 3.14159265358979323846 : angle;
    out->std_error = sqrt(fmax(0, 1 - concentration * concentration) / (2 * n * concentration * concentration));
    out->method = "circular mean, by chroma";
    return PLM_OK;
}
