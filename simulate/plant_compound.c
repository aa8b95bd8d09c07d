/* simulate/plant_compound.c: plants with compound leaves: tomato (pinnate), soybean (trifoliate). */
#include "cloud/linear.h"
#include "simulate/models.h"

/* ---- Tomato ----------------------------------------------------------------------------------------------------- */

typedef struct tomato {
    double height, stem_radius; /* m */
    int leaves;
    double rachis;             /* length of petiole and rachis of a full leaf, m */
    int pairs_low, pairs_high; /* of leaflets */
    int truss[2];              /* ranks that carry one; -1: none */
    double slim[2];            /* range of the largest leaflet's length over that of the rachis */
} tomato;

static void draw_leaflet(plm_random *random, const plm_disposition *habit, double length, bool is_last,
                         plm_leaflet_spec *leaflet)
{
    plm_blade_spec *blade = &leaflet->blade;
    *blade = (plm_blade_spec){
        .length = length, .rise = plm_between(random, 0.5, 0.75), .fall = plm_between(random, 0.8, 1.1)};
    blade->width = length * plm_between(random, 0.5, 0.72) * (is_last ? 1.1 : 1);
    blade->lobe_count = 2 + plm_draw_index(random, 3);
    blade->lobe_depth = plm_between(random, 0.05, 0.4);
    plm_draw_blade_form(random, habit, blade);
    blade->base_width = 0.04 * length;
    blade->detail = 0.45;
    leaflet->petiolule_length = length * (is_last ? plm_between(random, 0.05, 0.15) : plm_between(random, 0.08, 0.28));
    leaflet->pitch = plm_draw_angle(random, -10, 25);
    leaflet->roll = plm_draw_angle(random, -20, 20);
}

/* Pairs of leaflets that grow towards the tip, not quite opposite, and the last one at the end. */
static void draw_pinnate(plm_random *random, const plm_disposition *habit, int pairs, double largest, double first,
                         plm_leaf_spec *leaf)
{
    leaf->leaflet_count = 2 * pairs + 1;
    for (int k = 0; k < pairs; k++) {
        const double along = pairs > 1 ? (double)k / (pairs - 1) : 1;
        const double place = first + (0.86 - first) * along;
        for (int side = 0; side < 2; side++) {
            plm_leaflet_spec *leaflet = &leaf->leaflet[2 * k + side];
            const double size = largest * (0.55 + 0.35 * along) * plm_between(random, 0.75, 1.15);
            draw_leaflet(random, habit, size, false, leaflet);
            leaflet->share = fmin(place + 0.02 * side + plm_between(random, 0, 0.02), 0.95);
            leaflet->turn = (side ? -1 : 1) * plm_draw_angle(random, 50, 85);
            if (2 * k + side && leaflet->share < leaflet[-1].share) leaflet->share = leaflet[-1].share;
        }
    }
    plm_leaflet_spec *last = &leaf->leaflet[leaf->leaflet_count - 1];
    draw_leaflet(random, habit, largest * plm_between(random, 0.95, 1.3), true, last);
    last->share = 1;
}

static void tomato_leaf(plm_builder *builder, const tomato *kind, const plm_disposition *habit, int rank,
                        const double *node, double azimuth, double slim)
{
    plm_random *random = &builder->random;
    const double youth = (double)rank / (kind->leaves - 1);
    const double size = (0.8 + 0.2 * fmin(1, 3 * youth)) * (1 - 0.6 * pow(youth, 3)) * plm_between(random, 0.85, 1.15);
    plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE};
    leaf.azimuth = azimuth + habit->handed * rank * plm_radians(137.5) + plm_draw_angle(random, -20, 20);
    leaf.zenith = plm_draw_angle(random, 48, 68) - youth * plm_draw_angle(random, 15, 35) + habit->spread;
    leaf.petiole_length = kind->rachis * size;
    leaf.petiole_radius = kind->stem_radius * plm_between(random, 0.4, 0.52) * (1 - 0.4 * youth);
    leaf.petiole_tip_radius = leaf.petiole_radius * plm_between(random, 0.35, 0.55);
    leaf.petiole_flare = plm_between(random, 0, 0.35);
    leaf.petiole_bend = (plm_bend){.pitch = (1 - 0.7 * youth) * plm_draw_angle(random, 5, 35) * (0.6 + habit->droop),
                                   .pitch_power = plm_between(random, 1, 1.8),
                                   .yaw = plm_draw_angle(random, -18, 18),
                                   .roll = plm_draw_angle(random, -25, 25),
                                   .wander = {plm_draw_angle(random, 0, 3), plm_draw_angle(random, 0, 3)},
                                   .wander_count = plm_between(random, 1, 2)};
    const int pairs = kind->pairs_low + plm_draw_index(random, kind->pairs_high - kind->pairs_low + 1);
    draw_pinnate(random, habit, pairs, kind->rachis * size * slim, plm_between(random, 0.3, 0.45), &leaf);
    plm_build_leaf(builder, 0, node[rank], &leaf);
}

/* A truss: a hanging axis with fruits on both sides. Neither stem, petiole nor leaf: other. */
static void tomato_truss(plm_builder *builder, double node, double azimuth)
{
    plm_random *random = &builder->random;
    double start[3];
    plm_curve axis;
    const int fruits = 5 + plm_draw_index(random, 4);
    const plm_frame_at frame = plm_frame_of_direction(plm_draw_angle(random, 55, 80), azimuth);
    const plm_bend bend = {.pitch = plm_draw_angle(random, 60, 95), .yaw = plm_draw_angle(random, -20, 20)};
    const plm_taper taper = {.base = 0.0028, .tip = 0.0018};
    plm_curve_at(&builder->stem[0].axis, node, start, NULL);
    plm_curve_grow(start, &frame, plm_between(random, 0.14, 0.2), &bend, &axis);
    builder->label = PLM_LABEL_OTHER;
    builder->organ = builder->leaflet = -1;
    plm_build_tube(builder, &axis, &taper, 0, axis.length);
    for (int k = 0; k < fruits; k++) {
        const double radius = plm_between(random, 0.014, 0.027) * (1 - 0.4 * k / fruits);
        double point[3];
        plm_frame_at at;
        plm_curve_at(&axis, axis.length * (0.35 + 0.65 * k / (fruits - 1)), point, &at);
        for (int i = 0; i < 3; i++) point[i] += (k % 2 ? -1 : 1) * 1.05 * radius * at.side[i];
        point[2] -= 0.5 * radius;
        plm_build_spheroid(builder, point, radius, plm_between(random, 0.85, 1.05));
    }
}

static void grow_tomato(plm_builder *builder, const tomato *kind)
{
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    const double slim = plm_between(random, kind->slim[0], kind->slim[1]);
    double node[PLM_TRUE_NODES_MAXIMUM];
    plm_curve axis;
    plm_draw_stem(random, kind->height, 8, &axis);
    plm_draw_nodes(random, kind->height * plm_between(random, 0.08, 0.16), 0.97 * kind->height,
                   plm_between(random, 0.9, 1), kind->leaves, node);
    const plm_taper taper = {.base = kind->stem_radius,
                             .tip = kind->stem_radius * plm_between(random, 0.45, 0.65),
                             .power = plm_between(random, 0.9, 1.5)};
    plm_build_stem(builder, -1, &axis, &taper, false);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI);
    for (int rank = 0; rank < kind->leaves; rank++) {
        tomato_leaf(builder, kind, &habit, rank, node, azimuth, slim);
        for (int k = 0; k < 2; k++)
            if (kind->truss[k] == rank + 1)
                tomato_truss(builder, node[rank] + 0.02, azimuth + habit.handed * (rank + 0.5) * plm_radians(137.5));
    }
}

void plm_grow_tomato(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const double height = plm_between(random, 0.28, 0.62);
    const tomato young = {.height = height,
                          .stem_radius = 0.0075 * height * plm_between(random, 0.75, 1.25) + 0.0004,
                          .leaves = 6 + plm_draw_index(random, 5),
                          .rachis = plm_between(random, 0.11, 0.2) * (0.5 + height),
                          .pairs_low = 2,
                          .pairs_high = 3,
                          .truss = {-1, -1},
                          .slim = {0.27, 0.42}};
    grow_tomato(builder, &young);
}

void plm_grow_tomato_large(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const tomato grown = {.height = 1.62,
                          .stem_radius = plm_between(random, 0.0055, 0.007),
                          .leaves = 21,
                          .rachis = plm_between(random, 0.25, 0.28),
                          .pairs_low = 6,
                          .pairs_high = 6,
                          .truss = {4, 6},
                          .slim = {0.42, 0.48}};
    grow_tomato(builder, &grown);
}

/* ---- Soybean ---------------------------------------------------------------------------------------------------- */

static void soybean_blade(plm_random *random, const plm_disposition *habit, double length, double slim,
                          plm_blade_spec *blade)
{
    *blade = (plm_blade_spec){
        .length = length, .rise = plm_between(random, 0.45, 0.65), .fall = plm_between(random, 0.6, 0.9)};
    blade->width = length * slim * plm_between(random, 0.93, 1.07);
    plm_draw_blade_form(random, habit, blade);
    blade->base_width = 0.04 * length;
    blade->detail = 0.7;
}

static void soybean_unifoliate(plm_builder *builder, const plm_disposition *habit, double node, double radius,
                               double azimuth, double length)
{
    plm_random *random = &builder->random;
    for (int k = 0; k < 2; k++) {
        plm_leaf_spec leaf = {.role = PLM_LEAF_UNIFOLIATE};
        leaf.azimuth = azimuth + k * PLM_PI + plm_draw_angle(random, -12, 12);
        leaf.zenith = plm_draw_angle(random, 50, 75);
        leaf.petiole_length = plm_between(random, 0.02, 0.045);
        leaf.petiole_radius = leaf.petiole_tip_radius = radius * plm_between(random, 0.4, 0.5);
        leaf.petiole_bend.pitch = plm_draw_angle(random, -5, 20);
        soybean_blade(random, habit, length * plm_between(random, 0.9, 1.1), plm_between(random, 0.55, 0.75),
                      &leaf.blade);
        plm_aim_blade(&leaf, plm_draw_angle(random, 70, 100));
        plm_build_leaf(builder, 0, node, &leaf);
    }
}

static void soybean_trifoliate(plm_builder *builder, const plm_disposition *habit, double node, double radius,
                               double azimuth, double youth, double length, double slim)
{
    plm_random *random = &builder->random;
    plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE, .azimuth = azimuth, .leaflet_count = 3};
    leaf.zenith = plm_draw_angle(random, 48, 66) - youth * plm_draw_angle(random, 20, 35) + habit->spread;
    leaf.petiole_length = length * plm_between(random, 1.4, 2.6);
    leaf.petiole_radius = radius * plm_between(random, 0.42, 0.52) * (1 - 0.15 * youth);
    leaf.petiole_tip_radius = leaf.petiole_radius * plm_between(random, 0.7, 0.95);
    leaf.petiole_flare = plm_between(random, 0, 0.4);
    leaf.petiole_bend = (plm_bend){.pitch = plm_draw_angle(random, -8, 22), .yaw = plm_draw_angle(random, -12, 12)};
    const double end = leaf.zenith + leaf.petiole_bend.pitch, level = plm_draw_angle(random, 65, 100) - 0.4 * youth;
    for (int k = 0; k < 3; k++) {
        plm_leaflet_spec *leaflet = &leaf.leaflet[k];
        soybean_blade(random, habit, length * (k == 2 ? 1.1 : 1) * plm_between(random, 0.92, 1.08), slim,
                      &leaflet->blade);
        leaflet->share = k == 2 ? 1 : plm_between(random, 0.84, 0.86) + 0.005 * k;
        leaflet->turn = k == 2 ? 0 : (k ? -1 : 1) * plm_draw_angle(random, 70, 95);
        leaflet->petiolule_length = plm_between(random, 0.002, 0.006);
        leaflet->pitch = k == 2 ? level - end : plm_draw_angle(random, -5, 25);
        /* side leaflets lie in the terminal one's plane, not in the petiole's */
        leaflet->roll = (k == 2 ? 0 : (k ? -1 : 1) * (level - end) * 0.9) + plm_draw_angle(random, -15, 15);
    }
    plm_build_leaf(builder, 0, node, &leaf);
}

void plm_grow_soybean(plm_builder *builder)
{
    plm_random *random = &builder->random;
    const plm_disposition habit = plm_draw_disposition(random);
    const double height = plm_between(random, 0.18, 0.42) * (0.7 + 0.3 * habit.compact);
    const double radius = plm_between(random, 0.0013, 0.0024),
                 length = plm_between(random, 0.035, 0.062) * habit.vigour;
    const double slim = plm_between(random, 0.5, 0.78);
    const int count = 3 + plm_draw_index(random, 5);
    double node[PLM_TRUE_NODES_MAXIMUM];
    plm_curve axis;
    plm_draw_stem(random, height, 9, &axis);
    plm_draw_nodes(random, height * plm_between(random, 0.22, 0.34), 0.97 * height, plm_between(random, 0.88, 1),
                   count + 1, node);
    const plm_taper taper = {.base = radius, .tip = radius * plm_between(random, 0.55, 0.8)};
    plm_build_stem(builder, -1, &axis, &taper, false);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI);
    soybean_unifoliate(builder, &habit, node[0], radius, azimuth, length * plm_between(random, 0.8, 1.1));
    for (int k = 0; k < count; k++) {
        const double youth = (double)k / (count - 1), turned = azimuth + 0.5 * PLM_PI + k * PLM_PI * 0.97;
        soybean_trifoliate(builder, &habit, node[k + 1], radius, turned + plm_draw_angle(random, -35, 35), youth,
                           length * (1 - 0.5 * pow(youth, 3)), slim);
    }
}
