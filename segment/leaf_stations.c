/* segment/leaf_stations.c: stations of the way through a leaf: where their points are, how wide they lie, how many of them are
 * tube, and how far apart they are. */
#include "segment/junction.h"

#include "cloud/linear.h"

#include <math.h>

void plm_station_measure(const plm_sketch *sketch, const uint32_t *row, size_t count, plm_station *station)
{
    double moment[6] = {0}, value[3], vector[3][3], sum[3] = {0}, tubes = 0;
    *station = (plm_station){.count = (uint32_t)count};
    if (!count) return;
    for (size_t k = 0; k < count; k++) {
        for (int a = 0; a < 3; a++) sum[a] += sketch->working.xyz[row[k]][a];
        tubes += sketch->is_tube[row[k]];
    }
    for (int a = 0; a < 3; a++) station->middle[a] = sum[a] / (double)count;
    station->tube = tubes / (double)count;
    for (size_t k = 0; k < count; k++) {
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = sketch->working.xyz[row[k]][a] - station->middle[a];
        for (int a = 0, m = 0; a < 3; a++)
            for (int c = a; c < 3; c++) moment[m++] += d[a] * d[c] / (double)count;
    }
    plm_eigen3(moment, value, vector);
    station->width = sqrt(fmax(value[0], 0));
}

double plm_leaf_typical_link(const plm_leaf_way *way, const bool *among, float *value)
{
    const plm_graph *graph = &way->sketch->graph;
    size_t count = 0;
    for (size_t k = 0; k < way->count; k++) { /* of each point one, in turn */
        const uint32_t i = way->order[k], links = graph->first[i + 1] - graph->first[i];
        if (!among[i] || !links) continue;
        const uint32_t j = graph->edge[graph->first[i] + (uint32_t)k % links];
        if (among[j]) value[count++] = (float)plm_graph_length(graph, i, j);
    }
    return count ? plm_quantile(value, count, 0.5) : 0;
}

const plm_station *plm_leaf_station(const plm_leaf_way *way, double distance)
{
    size_t k = (size_t)(distance / way->step + 0.5);
    if (k >= way->station_count) k = way->station_count - 1;
    while (k > 0 && !way->station[k].count) k--;
    return &way->station[k];
}
