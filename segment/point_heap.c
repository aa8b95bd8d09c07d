/* segment/point_heap.c: each point knows its place, so that a lesser value moves it up. */
#include "segment/point_heap.h"

bool plm_heap_start(plm_point_heap *heap, const float *value, size_t count, plm_scratch *scratch)
{
    *heap = (plm_point_heap){.point = plm_scratch_take(scratch, count, sizeof *heap->point),
                             .place = plm_scratch_take(scratch, count, sizeof *heap->place),
                             .value = value};
    for (size_t i = 0; !scratch->failed && i < count; i++) heap->place[i] = UINT32_MAX;
    return !scratch->failed;
}

static bool comes_first(const plm_point_heap *heap, uint32_t a, uint32_t b)
{
    return heap->value[a] < heap->value[b] || (heap->value[a] == heap->value[b] && a < b);
}

static void put(plm_point_heap *heap, uint32_t point, size_t place)
{
    heap->point[place] = point;
    heap->place[point] = (uint32_t)place;
}

void plm_heap_add(plm_point_heap *heap, uint32_t point)
{
    if (heap->place[point] == UINT32_MAX) put(heap, point, heap->count++);
    size_t i = heap->place[point];
    for (; i > 0 && comes_first(heap, point, heap->point[(i - 1) / 2]); i = (i - 1) / 2)
        put(heap, heap->point[(i - 1) / 2], i);
    put(heap, point, i);
}

uint32_t plm_heap_pop(plm_point_heap *heap)
{
    const uint32_t first = heap->point[0], last = heap->point[--heap->count];
    heap->place[first] = UINT32_MAX;
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < heap->count; i = child) {
        if (child + 1 < heap->count && comes_first(heap, heap->point[child + 1], heap->point[child])) child++;
        if (!comes_first(heap, heap->point[child], last)) break;
        put(heap, heap->point[child], i);
    }
    if (heap->count) put(heap, last, i);
    return first;
}
