/* segment/strap_legs.h: legs of strap leaves: the tree that grows from their feet. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_LEGS_H
#define PLANTIMETER_SEGMENT_STRAP_LEGS_H

#include "segment/scratch.h"
#include "segment/sketch.h"

/** Legs of leaves: each goes from a foot up to where it meets another one of the same leaf. Arrays are of the scratch. */
typedef struct plm_strap_legs {
    const plm_sketch *sketch;
    float *upside; /**< of each point, how far it is below the farthest; INFINITY: of no leaf, or what wraps the stem */
    int32_t *leg;  /**< of each point, -1: none */
    size_t legs;
    uint32_t *low; /**< of each leg, the point nearest to the base */
    float *length; /**< of each leg, from there on */
    float *width;  /**< of each leg, its points over its length */
    uint32_t *tip; /**< of each leaf, its farthest point; UINT32_MAX: it has none */
    uint32_t *end; /**< of each leaf, the point nearest to the base; likewise */
    double usual;  /**< median of points over lengths of the leaves with one leg; 0: there are none */
} plm_strap_legs;

/** Finds the legs of sketch->leaf, from 0 to leaves. from_base: distance of each point along the graph. PLM_E_MEMORY. */
plm_status plm_strap_find_legs(const plm_sketch *sketch, const float *from_base, size_t leaves, plm_scratch *scratch,
                               plm_strap_legs *legs);

/** Whether a leg is as wide as one of a leaf, not of a part of its blade. */
bool plm_strap_is_wide(const plm_strap_legs *legs, size_t leg);

/** Whether two legs of a leaf, both wide, are of two leaves. */
bool plm_strap_are_apart(const plm_strap_legs *legs, size_t a, size_t b);

/** Whether a leaf ends off the stem, at a touch. */
bool plm_strap_has_no_foot(const plm_strap_legs *legs, size_t leaf);

#endif
