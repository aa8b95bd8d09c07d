/* segment/fruit.h: fruit among the leaves of a plant on a stem. Internal. */
#ifndef PLANTIMETER_SEGMENT_FRUIT_H
#define PLANTIMETER_SEGMENT_FRUIT_H

#include "segment/sketch.h"

/** Fruits that touch are a bunch. */
typedef struct plm_fruit {
    size_t bunches; /**< 0: there is no fruit, and what is below tells nothing */
    int32_t *bunch; /**< of each working point, -1 */
    size_t *size;   /**< of each bunch, points */
    size_t touches;
    plm_link *touch; /**< a: a point of a bunch, b: one that is not and was beside it; no length */
} plm_fruit;

/** Finds the fruit among what passes for leaves. fruit: out, even where it fails; the caller's: plm_fruit_free. */
plm_status plm_fruit_find(const plm_sketch *sketch, plm_fruit *fruit, plm_error *error);

/** Parts the graph about fruit. */
plm_status plm_fruit_part(plm_sketch *sketch, const plm_fruit *fruit, plm_error *error);

/** Takes fruit off the leaves, and leaves that are what is left of a truss. */
plm_status plm_fruit_take_off(plm_sketch *sketch, const plm_fruit *fruit, plm_error *error);

void plm_fruit_free(plm_fruit *fruit);

#endif
