/* segment/point_heap.h: points in the order of a value that may still fall. Internal. */
#ifndef PLANTIMETER_SEGMENT_POINT_HEAP_H
#define PLANTIMETER_SEGMENT_POINT_HEAP_H

#include "segment/scratch.h"

/** A binary heap of points, least value first; of equal values the earlier point. */
typedef struct plm_point_heap {
    size_t count;
    uint32_t *point;
    uint32_t *place;    /* of a point in the heap, UINT32_MAX outside */
    const float *value; /* of each point; the caller's */
} plm_point_heap;

/** An empty heap with room for all of count points, in the scratch. false: no memory. */
bool plm_heap_start(plm_point_heap *heap, const float *value, size_t count, plm_scratch *scratch);

/** Adds a point, or moves it up where it is in the heap and its value has fallen. */
void plm_heap_add(plm_point_heap *heap, uint32_t point);

/** Takes the first out of a heap that is not empty. */
uint32_t plm_heap_pop(plm_point_heap *heap);

#endif
