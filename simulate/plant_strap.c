/* simulate/plant_strap.c: maize: a stem with strap leaves whose feet clasp it. */
#include "cloud/linear.h"
#include "simulate/models.h"

typedef struct maize {
    double height, stem_radius; /* of the stem, m */
    int leaves;
    double leaf_length, leaf_width; /* of the largest, m */
    double spread;                  /* radians added to the leaves' angle */
    double limpness;                /* of the leaves' bend; 1 in young plants */
    double lean;                    /* of the stem, degrees */
    double shrink;                  /* of the uppermost leaves: the last ones below a tassel are short */
    bool has_tassel;
} maize;

static void maize_leaf(plm_builder *builder, const maize *kind, const plm_disposition *habit, int rank, double node,
                       double azimuth)
{
    plm_random *random = &builder->random;
    const double rise = (rank + 0.5) / kind->leaves; /* 0 lowest, 1 top */
    const double size = (1 - 1.15 * (rise - 0.58) * (rise - 0.58) * 1.8) * (1 - kind->shrink * pow(rise, 4));
    plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE, .azimuth = azimuth};
    plm_blade_spec *blade = &leaf.blade;
    const double radius = plm_taper_at(&builder->stem[0].taper, node, builder->stem[0].axis.length);
    leaf.zenith =
        plm_draw_angle(random, 14, 34) - rise * plm_draw_angle(random, 2, 12) + 0.5 * habit->spread + kind->spread;
    blade->length = kind->leaf_length * size * plm_between(random, 0.92, 1.08);
    blade->width = kind->leaf_width * (0.55 + 0.45 * size) * plm_between(random, 0.92, 1.08);
    blade->rise = plm_between(random, 0.25, 0.4);
    blade->fall = plm_between(random, 0.6, 0.9);
    blade->base_width = fmin(2.6 * radius, 0.95 * blade->width);
    blade->clasp_radius = 1.05 * radius;
    blade->clasp_length = plm_between(random, 1.5, 3) * radius;
    blade->bend = (plm_bend){.pitch = plm_draw_angle(random, 25, 65) + habit->droop * plm_draw_angle(random, 20, 85),
                             .pitch_power = plm_between(random, 1.3, 2.6),
                             .yaw = plm_draw_angle(random, -12, 12),
                             .roll = plm_draw_angle(random, -45, 45)};
    blade->bend.pitch *= kind->limpness * (1.1 - 0.6 * rise); /* young leaves at the top stand up */
    blade->fold = plm_draw_angle(random, 4, 12) + habit->fold * plm_draw_angle(random, 0, 25);
    blade->fold_end = blade->fold * plm_between(random, 0, 0.5);
    blade->cup = plm_draw_angle(random, 0, 18);
    blade->wave = blade->width * (0.01 + 0.09 * habit->ruffle) * plm_between(random, 0.5, 1);
    blade->wave_count = blade->length / (blade->width * plm_between(random, 1.1, 2));
    blade->wave_phase[0] = plm_between(random, 0, 2 * PLM_PI);
    blade->wave_phase[1] = plm_between(random, 0, 2 * PLM_PI);
    plm_build_leaf(builder, 0, node, &leaf);
}

static void maize_tassel(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const plm_curve *stem = &builder->stem[0].axis;
    builder->label = PLM_LABEL_OTHER;
    builder->organ = builder->leaflet = -1;
    for (int k = 0; k < 9; k++) {
        const plm_taper taper = {.base = 0.0025, .tip = 0.0018};
        const double zenith = k ? plm_draw_angle(random, 12, 40) : 0.02;
        const plm_frame_at frame = plm_frame_of_direction(zenith, plm_between(random, 0, 2 * PLM_PI));
        const plm_bend bend = {.pitch =
                                   k ? plm_draw_angle(random, 0, 50) : 0}; /* the spike in the middle stands upright */
        plm_curve axis;
        double start[3];
        plm_curve_at(stem, stem->length + 0.02 * k, start, NULL);
        plm_curve_grow(start, &frame, (k ? 0.16 : 0.3) * plm_between(random, 0.8, 1.2), &bend, &axis);
        plm_build_tube(builder, &axis, &taper, 0, axis.length);
    }
    const plm_taper stalk = {.base = 0.003, .tip = 0.0025};
    plm_curve axis;
    plm_curve_grow(stem->point[PLM_CURVE_STEPS], &stem->frame[PLM_CURVE_STEPS], 0.18, &(plm_bend){0}, &axis);
    plm_build_tube(builder, &axis, &stalk, -0.01, axis.length);
}

static void grow_maize(plm_builder *builder, const maize *kind)
{
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    double node[PLM_TRUE_NODES_MAXIMUM];
    plm_curve axis;
    builder->plant->has_petioles = false;
    plm_draw_stem(random, kind->height, kind->lean, &axis);
    plm_draw_nodes(random, kind->height * plm_between(random, 0.08, 0.14), 0.98 * kind->height,
                   plm_between(random, 0.98, 1.08), kind->leaves, node);
    plm_taper taper = {.base = kind->stem_radius,
                       .tip = kind->stem_radius * plm_between(random, 0.45, 0.65),
                       .power = plm_between(random, 1, 1.6),
                       .swell = plm_between(random, 0, 0.08),
                       .swell_length = kind->stem_radius,
                       .node_count = kind->leaves};
    for (int k = 0; k < kind->leaves; k++) taper.node[k] = node[k];
    plm_build_stem(builder, -1, &axis, &taper, false);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI), scatter = plm_between(random, 5, 20);
    for (int rank = 0; rank < kind->leaves; rank++)
        maize_leaf(builder, kind, &habit, rank, node[rank],
                   azimuth + rank * PLM_PI + plm_draw_angle(random, -scatter, scatter));
    if (kind->has_tassel) maize_tassel(builder);
}

void plm_grow_maize(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const double height = plm_between(random, 0.25, 0.8);
    const maize young = {.height = height,
                         .stem_radius = 0.004 + height * plm_between(random, 0.004, 0.008),
                         .leaves = 5 + plm_draw_index(random, 6),
                         .leaf_length = (0.15 + 0.6 * height) * plm_between(random, 0.8, 1.15),
                         .leaf_width = (0.02 + 0.05 * height) * plm_between(random, 0.8, 1.25),
                         .limpness = 1,
                         .lean = 4};
    grow_maize(builder, &young);
}

void plm_grow_maize_large(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const maize grown = {.height = 2.17,
                         .stem_radius = plm_between(random, 0.011, 0.014),
                         .leaves = 14,
                         .leaf_length = plm_between(random, 1.15, 1.25),
                         .leaf_width = plm_between(random, 0.1, 0.12),
                         .spread = 0.4,
                         .limpness = 0.6,
                         .lean = 1,
                         .shrink = 0.55,
                         .has_tassel = true};
    grow_maize(builder, &grown);
}
