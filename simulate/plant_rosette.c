/* simulate/plant_rosette.c: leaves from one place near the ground: arabidopsis (with petioles), lettuce (a head). */
#include "cloud/linear.h"
#include "simulate/models.h"

/* ---- Arabidopsis ------------------------------------------------------------------------------------------------ */

static void rosette_leaf(plm_builder *builder, const plm_disposition *habit, double node, double youth, double azimuth,
                         double largest, double slim, double stalk)
{
    plm_random *random = &builder->random;
    const double size = (youth < 0.15 ? plm_between(random, 0.55, 0.8) : plm_between(random, 0.9, 1.1)) *
                        fmax(1 - pow(youth, 2.5) * 0.85, 0.12);
    plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE, .azimuth = azimuth};
    leaf.zenith =
        plm_draw_angle(random, 68, 84) - pow(youth, 1.6) * plm_draw_angle(random, 30, 55) + 0.4 * habit->spread;
    leaf.petiole_length = largest * size * stalk * plm_between(random, 0.85, 1.15);
    leaf.petiole_radius = largest * (0.012 + 0.014 * size) * plm_between(random, 0.85, 1.15);
    leaf.petiole_tip_radius = leaf.petiole_radius * plm_between(random, 0.8, 1);
    leaf.petiole_bend.pitch = plm_draw_angle(random, -12, 8);
    plm_blade_spec *blade = &leaf.blade;
    *blade = (plm_blade_spec){
        .length = largest * size, .rise = plm_between(random, 0.5, 0.8), .fall = plm_between(random, 0.35, 0.55)};
    blade->width = blade->length * slim * plm_between(random, 0.92, 1.1);
    blade->tooth_count = 3 + plm_draw_index(random, 4);
    blade->tooth_depth = plm_between(random, 0, 0.07);
    plm_draw_blade_form(random, habit, blade);
    blade->base_width = 2.2 * leaf.petiole_tip_radius;
    plm_aim_blade(&leaf, leaf.zenith + leaf.petiole_bend.pitch + plm_draw_angle(random, -12, 10));
    leaf.roll = plm_draw_angle(random, -8, 8);
    plm_build_leaf(builder, 0, node, &leaf);
}

static void grow_rosette(plm_builder *builder, int count, double largest)
{
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    const double height = largest * plm_between(random, 0.1, 0.16), slim = plm_between(random, 0.5, 0.75);
    const double stalk = plm_between(random, 0.3, 0.75);
    double node[PLM_TRUE_NODES_MAXIMUM];
    const plm_frame_at up = plm_frame_of_direction(0, 0);
    const plm_taper taper = {.base = 0.045 * largest, .tip = 0.035 * largest};
    plm_curve axis;
    plm_curve_grow((double[3]){0, 0, 0}, &up, height, &(plm_bend){0}, &axis);
    plm_draw_nodes(random, 0.35 * height, height, 1, count, node);
    plm_build_stem(builder, -1, &axis, &taper, true);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI);
    for (int k = 0; k < count; k++)
        rosette_leaf(builder, &habit, node[k], (double)k / (count - 1),
                     azimuth + habit.handed * k * plm_radians(137.5) + plm_draw_angle(random, -10, 10), largest, slim,
                     stalk);
}

void plm_grow_arabidopsis(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const int count = 6 + plm_draw_index(random, 9);
    grow_rosette(builder, count, plm_between(random, 0.014, 0.034));
}

void plm_grow_arabidopsis_large(plm_builder *builder)
{
    grow_rosette(builder, 10, plm_between(&builder->random, 0.036, 0.04));
}

/* ---- Lettuce ---------------------------------------------------------------------------------------------------- */

static void lettuce_leaf(plm_builder *builder, const plm_disposition *habit, double node, double youth, double azimuth,
                         double largest, double radius)
{
    plm_random *random = &builder->random;
    const double size = (1 - 0.6 * pow(youth, 1.5)) * plm_between(random, 0.88, 1.12);
    plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE, .azimuth = azimuth};
    plm_blade_spec *blade = &leaf.blade;
    leaf.zenith = plm_draw_angle(random, 50, 72) - youth * plm_draw_angle(random, 38, 50) + 0.5 * habit->spread;
    *blade = (plm_blade_spec){
        .length = largest * size, .rise = plm_between(random, 0.75, 1.1), .fall = plm_between(random, 0.3, 0.5)};
    blade->width = blade->length * plm_between(random, 0.6, 0.9);
    plm_draw_blade_form(random, habit, blade);
    blade->base_width = radius * plm_between(random, 1, 1.7);
    /* outer leaves fall open, inner ones close over the heart */
    blade->bend.pitch = plm_draw_angle(random, 5, 45) * (1 - 1.9 * youth);
    blade->cup = plm_draw_angle(random, 10, 25) + youth * plm_draw_angle(random, 5, 30);
    blade->wave = blade->width * (0.01 + 0.05 * habit->ruffle) * plm_between(random, 0.6, 1.2);
    blade->wave_count = plm_between(random, 3, 7);
    plm_build_leaf(builder, 0, node, &leaf);
}

void plm_grow_lettuce(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    const double largest = plm_between(random, 0.07, 0.17), radius = 0.003 + largest * plm_between(random, 0.02, 0.045);
    const double height = radius * plm_between(random, 3, 5);
    const int count = 9 + plm_draw_index(random, 12);
    double node[PLM_TRUE_NODES_MAXIMUM];
    plm_curve axis;
    builder->plant->has_petioles = false;
    plm_draw_stem(random, height, 4, &axis);
    plm_draw_nodes(random, 0.35 * height, 0.95 * height, 0.95, count, node);
    const plm_taper taper = {.base = radius, .tip = radius * plm_between(random, 0.5, 0.8)};
    plm_build_stem(builder, -1, &axis, &taper, false);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI);
    for (int k = 0; k < count; k++)
        lettuce_leaf(builder, &habit, node[k], (double)k / (count - 1),
                     azimuth + habit.handed * k * plm_radians(137.5) + plm_draw_angle(random, -12, 12), largest,
                     plm_taper_at(&taper, node[k], height));
}
