/* tests/support/made_sketch.c: growing from the sources along the graph. */
#include "support/made_sketch.h"
#include "support/test.h"

void made_sketch_grow(plm_sketch *sketch, const bool *is_source, const int32_t *organ, float *distance)
{
    plm_error error = {0};
    const size_t count = sketch->working.count;
    uint32_t *source = plm_alloc(count, sizeof *source, &error);
    int32_t *origin = plm_alloc(count, sizeof *origin, &error);
    assert_true(source && origin);
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++)
        if (is_source[i]) source[sources++] = i;
    const plm_walk walk = {.source = source, .source_count = sources, .distance = distance, .origin = origin};
    assert_ok(plm_graph_walk(&sketch->graph, &walk, &error));
    for (size_t i = 0; i < count; i++) sketch->group[i] = origin[i] < 0 ? -1 : organ[source[origin[i]]];
    plm_free(source);
    plm_free(origin);
}
