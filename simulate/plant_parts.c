/* simulate/plant_parts.c: a leaf alone, a stem alone, and the tall cucumber of the laser-scanning paper. */
#include "cloud/linear.h"
#include "simulate/models.h"

void plm_grow_single_leaf(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    const plm_frame_at up = plm_frame_of_direction(0, 0);
    const plm_taper none = {.base = 1e-6, .tip = 1e-6};
    plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE};
    plm_blade_spec *blade = &leaf.blade;
    plm_curve axis;
    builder->plant->has_petioles = false;
    plm_curve_grow((double[3]){0, 0, 0}, &up, 1e-5, &(plm_bend){0}, &axis);
    plm_build_stem(builder, -1, &axis, &none, true);
    leaf.azimuth = plm_between(random, 0, 2 * PLM_PI);
    leaf.zenith = plm_draw_angle(random, 15, 100);
    blade->length = plm_between(random, 0.04, 0.16);
    blade->is_palmate = plm_draw(random) < 0.3;
    if (blade->is_palmate) {
        blade->width = blade->length * plm_between(random, 0.9, 1.25);
        blade->lobe_count = 5;
        blade->lobe_depth = plm_between(random, 0, 0.3);
        blade->lobe_power = plm_between(random, 0.7, 1.3);
        blade->sinus = plm_between(random, 0.05, 0.25);
    } else {
        blade->width = blade->length * plm_between(random, 0.3, 0.85);
        blade->rise = plm_between(random, 0.4, 0.9);
        blade->fall = plm_between(random, 0.45, 1.1);
        blade->lobe_count = plm_draw_index(random, 4);
        blade->lobe_depth = plm_between(random, 0, 0.15);
    }
    plm_draw_blade_form(random, &habit, blade);
    plm_build_leaf(builder, 0, 0, &leaf);
}

void plm_grow_bare_stem(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const double height = plm_between(random, 0.12, 0.5), radius = height * plm_between(random, 0.006, 0.014);
    const int branches = plm_draw_index(random, 5);
    const plm_taper taper = {.base = radius, .tip = radius * plm_between(random, 0.4, 0.8), .power = 1};
    plm_curve axis;
    builder->plant->has_petioles = false;
    plm_draw_stem(random, height, 12, &axis);
    plm_build_stem(builder, -1, &axis, &taper, false);
    for (int k = 0; k < branches; k++) {
        const double node = height * (0.25 + 0.6 * (k + plm_draw(random)) / branches),
                     angle = plm_draw_angle(random, 28, 65);
        const plm_frame_at frame = plm_frame_of_direction(angle, k * plm_radians(137.5) + plm_draw(random));
        const double thick = plm_taper_at(&taper, node, height), share = plm_between(random, 0.4, 0.75);
        const plm_taper thin = {.base = share * thick, .tip = 0.6 * share * thick, .power = 1};
        const plm_bend bend = {.pitch = plm_draw_angle(random, -45, 10), .yaw = plm_draw_angle(random, -15, 15)};
        double start[3];
        plm_frame_at at;
        plm_curve branch;
        plm_curve_at(&axis, node, start, &at);
        const double cosine = plm_dot(frame.tangent, at.tangent);
        for (int i = 0; i < 3; i++) start[i] += frame.tangent[i] * thick / sqrt(1 - cosine * cosine);
        plm_curve_grow(start, &frame, height * plm_between(random, 0.15, 0.4), &bend, &branch);
        plm_build_stem(builder, 0, &branch, &thin, false);
    }
}

void plm_grow_cucumber_large(plm_builder *builder)
{
    enum { LEAVES = 17 };
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    const double height = 1.98, radius = plm_between(random, 0.0045, 0.006), length = plm_between(random, 0.17, 0.2);
    const double depth = plm_between(random, 0.05, 0.2);
    const plm_taper taper = {.base = radius, .tip = 0.6 * radius, .power = 1.2};
    double node[PLM_TRUE_NODES_MAXIMUM];
    plm_curve axis;
    plm_draw_stem(random, height, 4, &axis);
    plm_draw_nodes(random, 0.12, 0.97 * height, 0.98, LEAVES, node);
    plm_build_stem(builder, -1, &axis, &taper, false);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI);
    for (int k = 0; k < LEAVES; k++) {
        const double youth = (double)k / (LEAVES - 1),
                     size = (0.8 + 0.2 * fmin(1, 4 * youth)) * (1 - 0.6 * pow(youth, 4));
        plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE};
        plm_blade_spec *blade = &leaf.blade;
        leaf.azimuth = azimuth + habit.handed * k * plm_radians(144) + plm_draw_angle(random, -15, 15);
        leaf.zenith = plm_draw_angle(random, 50, 66) - youth * plm_draw_angle(random, 10, 25);
        leaf.petiole_length = 1.55 * length * size * plm_between(random, 0.85, 1.15);
        leaf.petiole_radius = 0.5 * radius;
        leaf.petiole_tip_radius = 0.4 * radius;
        leaf.petiole_bend.pitch = plm_draw_angle(random, 0, 20);
        *blade = (plm_blade_spec){.length = length * size, .is_palmate = true, .lobe_count = 5, .lobe_depth = depth};
        blade->width = 1.18 * blade->length * plm_between(random, 0.93, 1.07);
        blade->lobe_power = plm_between(random, 0.7, 1.2);
        blade->sinus = plm_between(random, 0.15, 0.25);
        plm_draw_blade_form(random, &habit, blade);
        plm_aim_blade(&leaf, plm_draw_angle(random, 85, 112) - 0.5 * youth);
        plm_build_leaf(builder, 0, node[k], &leaf);
    }
}
