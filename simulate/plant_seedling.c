/* simulate/plant_seedling.c: dicot seedlings: a stem, two cotyledons, a few true leaves. One table row a kind. */
#include "cloud/linear.h"
#include "simulate/models.h"

typedef struct range {
    double low, high;
} range;

static double draw(plm_random *random, range from)
{
    return plm_between(random, from.low, from.high);
}

/** Lengths in m, angles in degrees; slim: width over length. */
typedef struct seedling {
    range height, stem_diameter, hypocotyl; /* share of the stem below the cotyledons */
    range cotyledon_length, cotyledon_slim, cotyledon_petiole;
    double cotyledon_rise, cotyledon_fall;
    int leaves_low, leaves_high;
    range leaf_length, leaf_slim, petiole; /* petiole's length over the blade's */
    bool is_palmate;
    range rise, fall; /* margins */
    int lobes_low, lobes_high;
    range lobe_depth, lobe_power, sinus, tooth_depth;
    int teeth;
    double turn; /* from leaf to leaf, degrees */
} seedling;

static const seedling eggplant = {.height = {0.075, 0.16},
                                  .stem_diameter = {0.0026, 0.0042},
                                  .hypocotyl = {0.3, 0.5},
                                  .cotyledon_length = {0.022, 0.036},
                                  .cotyledon_slim = {0.26, 0.4},
                                  .cotyledon_petiole = {0.006, 0.014},
                                  .cotyledon_rise = 0.55,
                                  .cotyledon_fall = 0.6,
                                  .leaves_low = 2,
                                  .leaves_high = 5,
                                  .leaf_length = {0.045, 0.085},
                                  .leaf_slim = {0.6, 0.85},
                                  .petiole = {0.35, 0.7},
                                  .rise = {0.4, 0.6},
                                  .fall = {0.55, 0.9},
                                  .lobes_low = 0,
                                  .lobes_high = 4,
                                  .lobe_depth = {0.02, 0.16},
                                  .turn = 137.5};
static const seedling pepper = {.height = {0.09, 0.19},
                                .stem_diameter = {0.0019, 0.0034},
                                .hypocotyl = {0.25, 0.4},
                                .cotyledon_length = {0.02, 0.033},
                                .cotyledon_slim = {0.26, 0.4},
                                .cotyledon_petiole = {0.005, 0.01},
                                .cotyledon_rise = 0.7,
                                .cotyledon_fall = 0.8,
                                .leaves_low = 3,
                                .leaves_high = 8,
                                .leaf_length = {0.035, 0.075},
                                .leaf_slim = {0.4, 0.58},
                                .petiole = {0.35, 0.8},
                                .rise = {0.6, 0.9},
                                .fall = {0.8, 1.2},
                                .turn = 137.5};
static const seedling okra = {.height = {0.1, 0.2},
                              .stem_diameter = {0.0022, 0.0036},
                              .hypocotyl = {0.35, 0.5},
                              .cotyledon_length = {0.026, 0.038},
                              .cotyledon_slim = {0.78, 0.98},
                              .cotyledon_petiole = {0.01, 0.022},
                              .cotyledon_rise = 0.5,
                              .cotyledon_fall = 0.45,
                              .leaves_low = 2,
                              .leaves_high = 5,
                              .leaf_length = {0.04, 0.075},
                              .leaf_slim = {0.95, 1.2},
                              .petiole = {0.5, 1.1},
                              .is_palmate = true,
                              .lobes_low = 5,
                              .lobes_high = 5,
                              .lobe_depth = {0.08, 0.38},
                              .lobe_power = {0.7, 1.5},
                              .sinus = {0.05, 0.22},
                              .tooth_depth = {0, 0.05},
                              .teeth = 30,
                              .turn = 144};
static const seedling cucumber = {.height = {0.08, 0.19},
                                  .stem_diameter = {0.0025, 0.0042},
                                  .hypocotyl = {0.32, 0.5},
                                  .cotyledon_length = {0.038, 0.056},
                                  .cotyledon_slim = {0.54, 0.68},
                                  .cotyledon_petiole = {0.006, 0.013},
                                  .cotyledon_rise = 0.5,
                                  .cotyledon_fall = 0.5,
                                  .leaves_low = 2,
                                  .leaves_high = 6,
                                  .leaf_length = {0.036, 0.07},
                                  .leaf_slim = {1.0, 1.3},
                                  .petiole = {0.45, 1.1},
                                  .is_palmate = true,
                                  .lobes_low = 5,
                                  .lobes_high = 5,
                                  .lobe_depth = {0.03, 0.22},
                                  .lobe_power = {0.6, 1.4},
                                  .sinus = {0.12, 0.28},
                                  .tooth_depth = {0, 0.04},
                                  .teeth = 36,
                                  .turn = 144};

static const range arched_sinus = {0.15, 0.35};
static const double narrow_sinus = 0.3; /* deeper ones */

static void grow_cotyledons(plm_builder *builder, const seedling *kind, const plm_disposition *habit, double node,
                            double stem_radius, double azimuth)
{
    plm_random *random = &builder->random;
    const double length = draw(random, kind->cotyledon_length) * (0.85 + 0.15 * habit->vigour);
    const double slim = draw(random, kind->cotyledon_slim);
    for (int k = 0; k < 2; k++) {
        plm_leaf_spec leaf = {.role = PLM_LEAF_COTYLEDON};
        leaf.azimuth = azimuth + k * PLM_PI + plm_draw_angle(random, -14, 14);
        leaf.zenith = plm_draw_angle(random, 52, 82);
        leaf.petiole_length = draw(random, kind->cotyledon_petiole);
        leaf.petiole_radius = stem_radius * plm_between(random, 0.45, 0.58);
        leaf.petiole_tip_radius = leaf.petiole_radius * plm_between(random, 0.8, 1);
        leaf.petiole_bend.pitch = plm_draw_angle(random, -10, 22);
        leaf.blade = (plm_blade_spec){.length = length * plm_between(random, 0.93, 1.07),
                                      .rise = kind->cotyledon_rise,
                                      .fall = kind->cotyledon_fall};
        leaf.blade.width = leaf.blade.length * slim * plm_between(random, 0.95, 1.05);
        leaf.blade.base_width = 1.2 * leaf.petiole_tip_radius;
        plm_draw_blade_form(random, habit, &leaf.blade);
        plm_aim_blade(&leaf, plm_draw_angle(random, 62, 100));
        plm_build_leaf(builder, 0, node, &leaf);
    }
}

/* Blade of true leaf number k of count: the middle ones are largest, the last ones still unfold. */
static void draw_true_blade(plm_random *random, bool is_arched, const seedling *kind, const plm_disposition *habit,
                            double length, double slim, int lobes, double lobe_depth, plm_blade_spec *blade)
{
    *blade = (plm_blade_spec){.length = length, .is_palmate = kind->is_palmate};
    blade->width = length * slim * plm_between(random, 0.92, 1.08);
    blade->lobe_count = lobes;
    blade->lobe_depth = lobes ? lobe_depth * plm_between(random, 0.8, 1.2) : 0;
    if (kind->is_palmate) {
        blade->lobe_power = draw(random, kind->lobe_power);
        blade->sinus = draw(random, kind->sinus);
        if (is_arched) {
            blade->sinus = draw(random, arched_sinus);
            blade->sinus_width = blade->sinus > narrow_sinus ? 0.2 : 0;
        }
        blade->tooth_count = kind->teeth;
        blade->tooth_depth = draw(random, kind->tooth_depth);
    } else {
        blade->rise = draw(random, kind->rise);
        blade->fall = draw(random, kind->fall);
    }
    plm_draw_blade_form(random, habit, blade);
}

/* Angles from zenith and bends like those of the development clouds' seedlings. */
static void arch_petiole(plm_random *random, double youth, plm_leaf_spec *leaf)
{
    leaf->zenith = plm_draw_angle(random, 42, 56);
    leaf->zenith -= youth * plm_draw_angle(random, 15, 28);
    leaf->petiole_bend.pitch = plm_draw_angle(random, 12, 50);
    leaf->petiole_bend.pitch_power = plm_between(random, 0.7, 1.6); /* most near the stem, or near the blade */
    leaf->petiole_bend.yaw = plm_draw_angle(random, -6, 6);
}

static void grow_true_leaves(plm_builder *builder, const seedling *kind, const plm_disposition *habit, int count,
                             const double *node, double stem_radius, double azimuth)
{
    plm_random *random = &builder->random;
    const double largest = draw(random, kind->leaf_length) * habit->vigour, slim = draw(random, kind->leaf_slim);
    const double lobe_depth = draw(random, kind->lobe_depth), stalk = draw(random, kind->petiole);
    const int lobes = kind->lobes_low + plm_draw_index(random, kind->lobes_high - kind->lobes_low + 1);
    for (int k = 0; k < count; k++) {
        const double youth = count > 1 ? (double)k / (count - 1) : 0.4; /* 0 oldest, 1 youngest */
        const double size = (k == 0 ? plm_between(random, 0.6, 1) : 1) * (1 - 0.65 * pow(youth, 2.2));
        plm_leaf_spec leaf = {.role = PLM_LEAF_TRUE};
        leaf.azimuth = azimuth + habit->handed * k * plm_radians(kind->turn) + plm_draw_angle(random, -18, 18);
        leaf.zenith = plm_draw_angle(random, 52, 72) - youth * plm_draw_angle(random, 22, 38) + habit->spread;
        leaf.petiole_length = largest * size * stalk * plm_between(random, 0.75, 1.25);
        leaf.petiole_radius = stem_radius * plm_between(random, 0.42, 0.55) * (1 - 0.2 * youth);
        leaf.petiole_tip_radius = leaf.petiole_radius * plm_between(random, 0.7, 0.95);
        leaf.petiole_flare = plm_between(random, 0, 0.3);
        leaf.petiole_bend.pitch = (1 - youth) * plm_draw_angle(random, -8, 30) * (0.4 + habit->droop);
        leaf.petiole_bend.yaw = plm_draw_angle(random, -12, 12);
        draw_true_blade(random, builder->is_arched, kind, habit, largest * size * plm_between(random, 0.9, 1.1), slim,
                        lobes, lobe_depth, &leaf.blade);
        leaf.blade.base_width = 1.2 * leaf.petiole_tip_radius;
        if (builder->is_arched) arch_petiole(random, youth, &leaf);
        plm_aim_blade(&leaf, plm_draw_angle(random, 58, 88) - youth * plm_draw_angle(random, 5, 35));
        if (builder->is_arched)
            leaf.pitch = plm_draw_angle(random, 0, 22); /* the blade goes on where the petiole leads */
        leaf.roll = plm_draw_angle(random, -14, 14);
        plm_build_leaf(builder, 0, node[k], &leaf);
    }
}

static void grow(plm_builder *builder, const seedling *kind)
{
    plm_random *random = &builder->random;
    builder->plant->is_arched = builder->is_arched;
    const plm_disposition habit = plm_draw_disposition(random);
    double node[PLM_TRUE_NODES_MAXIMUM];
    plm_curve axis;
    const double height = draw(random, kind->height) * (0.7 + 0.3 * habit.compact);
    const double radius = 0.5 * draw(random, kind->stem_diameter) * (0.9 + 0.1 * habit.vigour);
    const int count = kind->leaves_low + plm_draw_index(random, kind->leaves_high - kind->leaves_low + 1);
    const double first = draw(random, kind->hypocotyl) * height;
    plm_draw_stem(random, height, 14, &axis);
    plm_draw_nodes(random, first, 0.97 * height, plm_between(random, 0.7, 0.95), count + 1, node);
    plm_taper taper = {.base = radius,
                       .tip = radius * plm_between(random, 0.6, 0.85),
                       .power = plm_between(random, 0.8, 1.6),
                       .swell = plm_between(random, 0, 0.12),
                       .swell_length = 1.5 * radius,
                       .node_count = count + 1};
    for (int k = 0; k <= count; k++) taper.node[k] = node[k];
    plm_build_stem(builder, -1, &axis, &taper, false);
    const double azimuth = plm_between(random, 0, 2 * PLM_PI);
    grow_cotyledons(builder, kind, &habit, node[0], radius, azimuth);
    grow_true_leaves(builder, kind, &habit, count, node + 1, radius, azimuth + 0.5 * PLM_PI);
}

void plm_grow_eggplant(plm_builder *builder)
{
    grow(builder, &eggplant);
}

void plm_grow_pepper(plm_builder *builder)
{
    grow(builder, &pepper);
}

void plm_grow_okra(plm_builder *builder)
{
    grow(builder, &okra);
}

void plm_grow_cucumber(plm_builder *builder)
{
    grow(builder, &cucumber);
}
