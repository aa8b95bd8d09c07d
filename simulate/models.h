/* simulate/models.h: the plant models, one function a kind, and what they share. Internal. */
#ifndef PLANTIMETER_SIMULATE_MODELS_H
#define PLANTIMETER_SIMULATE_MODELS_H

#include "simulate/build.h"

/** How a plant of this seed is disposed: drawn once a plant, so that its leaves resemble each other. */
typedef struct plm_disposition {
    double vigour;  /* size of leaves against the kind's mean, 0.7 to 1.35 */
    double compact; /* length of internodes against the kind's mean, 0.6 to 1.25 */
    double droop;   /* 0 stiff to 1 limp */
    double fold;    /* 0 flat to 1 folded */
    double ruffle;  /* 0 smooth to 1 wavy */
    double spread;  /* radians added to the leaves' angle from the stem */
    double handed;  /* +1 or -1: sense of the leaf spiral */
} plm_disposition;

plm_disposition plm_draw_disposition(plm_random *random);

/** Radians from degrees drawn between two bounds. */
double plm_draw_angle(plm_random *random, double low_degrees, double high_degrees);

/** A main stem from the origin: leaning, bending and wandering a little. */
void plm_draw_stem(plm_random *random, double length, double lean_degrees, plm_curve *axis);

/** Turns the blade so that its midrib leaves the junction at this angle from zenith, whatever the petiole does. */
void plm_aim_blade(plm_leaf_spec *leaf, double zenith);

/** Bend, fold, cup, waves and relief of a blade of length and width already set, by disposition. */
void plm_draw_blade_form(plm_random *random, const plm_disposition *disposition, plm_blade_spec *blade);

/** Distances of count nodes along a stem: the first at first, the last at last, each internode `ratio` of the one
 * before, uneven by 15 %. */
void plm_draw_nodes(plm_random *random, double first, double last, double ratio, int count, double *node);

void plm_grow_eggplant(plm_builder *builder);
void plm_grow_pepper(plm_builder *builder);
void plm_grow_okra(plm_builder *builder);
void plm_grow_cucumber(plm_builder *builder);
void plm_grow_cucumber_large(plm_builder *builder);
void plm_grow_tomato(plm_builder *builder);
void plm_grow_tomato_large(plm_builder *builder);
void plm_grow_soybean(plm_builder *builder);
void plm_grow_maize(plm_builder *builder);
void plm_grow_maize_large(plm_builder *builder);
void plm_grow_arabidopsis(plm_builder *builder);
void plm_grow_arabidopsis_large(plm_builder *builder);
void plm_grow_lettuce(plm_builder *builder);
void plm_grow_single_leaf(plm_builder *builder);
void plm_grow_bare_stem(plm_builder *builder);

#endif
