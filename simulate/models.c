/* simulate/models.c: what the plant models share. Ranges are wide on purpose: a method that holds on these plants
 * should not hang on one habit. They were set beside photographs' proportions and the sizes in the seedling paper (8-20
 * cm, stems 2-4 mm). */
#include "simulate/models.h"

#include "cloud/linear.h"

double plm_draw_angle(plm_random *random, double low_degrees, double high_degrees)
{
    return plm_radians(plm_between(random, low_degrees, high_degrees));
}

plm_disposition plm_draw_disposition(plm_random *random)
{
    return (plm_disposition){.vigour = plm_between(random, 0.7, 1.35),
                             .compact = plm_between(random, 0.6, 1.25),
                             .droop = plm_draw(random),
                             .fold = plm_draw(random),
                             .ruffle = plm_draw(random),
                             .spread = plm_draw_angle(random, -12, 12),
                             .handed = plm_draw(random) < 0.5 ? -1 : 1};
}

void plm_draw_stem(plm_random *random, double length, double lean_degrees, plm_curve *axis)
{
    const double lean = plm_draw_angle(random, 0, lean_degrees), azimuth = plm_between(random, 0, 2 * PLM_PI);
    const plm_frame_at frame = plm_frame_of_direction(lean, azimuth);
    const plm_bend bend = {
        .pitch = plm_draw_angle(random, -lean_degrees, 0.8 * lean_degrees),
        .yaw = plm_draw_angle(random, -0.5 * lean_degrees, 0.5 * lean_degrees),
        .wander = {plm_draw_angle(random, 0, 0.35 * lean_degrees), plm_draw_angle(random, 0, 0.35 * lean_degrees)},
        .wander_count = plm_between(random, 1, 2.5),
        .wander_phase = {plm_between(random, 0, 2 * PLM_PI), plm_between(random, 0, 2 * PLM_PI)}};
    plm_curve_grow((double[3]){0, 0, 0}, &frame, length, &bend, axis);
}

void plm_aim_blade(plm_leaf_spec *leaf, double zenith)
{
    leaf->pitch = zenith - (leaf->zenith + leaf->petiole_bend.pitch);
}

void plm_draw_blade_form(plm_random *random, const plm_disposition *disposition, plm_blade_spec *blade)
{
    blade->bend.pitch = plm_draw_angle(random, 5, 25) + disposition->droop * plm_draw_angle(random, 5, 50);
    blade->bend.pitch_power = plm_between(random, 1, 1.8);
    blade->bend.yaw = plm_draw_angle(random, -10, 10);
    blade->bend.roll = plm_draw_angle(random, -12, 12);
    blade->fold = plm_draw_angle(random, 0, 8) + disposition->fold * plm_draw_angle(random, 0, 22);
    blade->fold_end = blade->fold * plm_between(random, 0.2, 1);
    blade->cup = plm_draw_angle(random, -18, 14);
    blade->wave = blade->width * disposition->ruffle * plm_between(random, 0.005, 0.05);
    blade->wave_count = plm_between(random, 1.5, 4.5);
    blade->wave_phase[0] = plm_between(random, 0, 2 * PLM_PI);
    blade->wave_phase[1] = plm_between(random, 0, 2 * PLM_PI);
    blade->dimple = blade->width * disposition->ruffle * plm_between(random, 0, 0.008);
    blade->dimple_count = plm_between(random, 3, 6);
    blade->dimple_phase = plm_between(random, 0, 2 * PLM_PI);
    blade->asymmetry = plm_between(random, -0.08, 0.08);
}

void plm_draw_nodes(plm_random *random, double first, double last, double ratio, int count, double *node)
{
    double step = 1, total = 0;
    node[0] = 0;
    for (int k = 1; k < count; k++) {
        total += step * plm_between(random, 0.85, 1.15);
        node[k] = total;
        step *= ratio;
    }
    for (int k = 0; k < count; k++) node[k] = first + (total > 0 ? (last - first) * node[k] / total : 0);
}
