/* segment/ball_shape.c: covariances of graph-connected balls. */
#include "segment/ball_shape.h"

#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/threads.h"

#include <string.h>

static const double EDGE_CELLS = 2.3;
enum { NEIGHBOURS = 10 };

/* A point of the graph and the last ball that met it, which are asked for together. */
typedef struct node {
    float xyz[3];
    uint32_t seen;
} node;

/* Moments about the centre; the walk goes breadth first, queue doubles as the list of members. */
static void ball(const plm_graph *graph, uint32_t centre, float limit, node *at, uint32_t *queue, plm_ball_shape *shape)
{
    const float *middle = graph->xyz[centre];
    double sum[3] = {0}, moment[6] = {0};
    size_t count = 0;
    queue[count++] = centre;
    at[centre].seen = centre + 1; /* stamps: no clearing between balls */
    for (size_t head = 0; head < count; head++) {
        const uint32_t here = queue[head];
        const float *p = at[here].xyz;
        const double x = (double)p[0] - middle[0], y = (double)p[1] - middle[1], z = (double)p[2] - middle[2];
        sum[0] += x, sum[1] += y, sum[2] += z;
        moment[0] += x * x, moment[1] += x * y, moment[2] += x * z;
        moment[3] += y * y, moment[4] += y * z, moment[5] += z * z;
        for (uint32_t e = graph->first[here]; e < graph->first[here + 1]; e++) {
            node *next = &at[graph->edge[e]];
            if (next->seen == centre + 1) continue;
            next->seen = centre + 1; /* also what is too far: it is that from every member */
            const float dx = next->xyz[0] - middle[0], dy = next->xyz[1] - middle[1], dz = next->xyz[2] - middle[2];
            if (dx * dx + dy * dy + dz * dz <= limit) queue[count++] = graph->edge[e];
        }
    }
    const double scale = 1.0 / (double)count;
    const double m[3] = {sum[0] * scale, sum[1] * scale, sum[2] * scale};
    const double covariance[6] = {moment[0] * scale - m[0] * m[0], moment[1] * scale - m[0] * m[1],
                                  moment[2] * scale - m[0] * m[2], moment[3] * scale - m[1] * m[1],
                                  moment[4] * scale - m[1] * m[2], moment[5] * scale - m[2] * m[2]};
    double value[3], vector[3][3];
    plm_eigen3(covariance, value, vector);
    for (int i = 0; i < 3; i++) {
        shape->value[i] = (float)(value[i] > 0 ? value[i] : 0);
        shape->axis[i] = (float)vector[0][i];
        shape->normal[i] = (float)vector[2][i];
    }
    shape->offset = (float)plm_norm(m);
    shape->count = (uint32_t)count;
}

plm_status plm_ball_graph(const float (*xyz)[3], size_t count, double cell, plm_graph *graph, plm_error *error)
{
    return plm_graph_build(xyz, count, NEIGHBOURS, EDGE_CELLS * cell, graph, error);
}

plm_status plm_ball_shapes(const plm_graph *graph, double radius, plm_ball_shape *shape, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    const size_t threads = plm_thread_count();
    node *at = plm_scratch_take(&scratch, threads * graph->count, sizeof *at);
    uint32_t *queue = plm_scratch_take(&scratch, threads * graph->count, sizeof *queue);
    if (!scratch.failed) {
        const float limit = (float)(radius * radius);
        const int64_t count = (int64_t)graph->count;
#pragma omp parallel
        {
            node *own = at + plm_thread_number() * graph->count;
            uint32_t *own_queue = queue + plm_thread_number() * graph->count;
            for (size_t i = 0; i < graph->count; i++) memcpy(own[i].xyz, graph->xyz[i], sizeof own->xyz);
#pragma omp for schedule(dynamic, 256)
            for (int64_t i = 0; i < count; i++) ball(graph, (uint32_t)i, limit, own, own_queue, &shape[i]);
        }
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}
