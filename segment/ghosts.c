/* segment/ghosts.c: features of a point's nearest neighbours, and boosted trees over them.
 *
 * A ghost of a mixed pixel lies behind a rim, a little or far, in a fan that few pixels fill: further from its
 * neighbours than they are from theirs, beside their centre, off their plane. A thin petiole is sparse too, but like its
 * neighbours, and its points lie in line. What is far and what is rough differs between scanners, so the trees are also
 * told how even the cloud's spacing is and how thick its surfaces are. */
#include "segment/ghosts.h"

#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "segment/ghost_forest.h"
#include "segment/scale.h"
#include "segment/scratch.h"

#include <math.h>

enum { K = PLM_GHOST_NEIGHBOURS, FEW = 8, SIXTH = 6, HALF = 12, FAR = 5, LOF = 3, SHAPE = 6 };
enum { SHAPE_FEW = FAR + LOF, SHAPE_ALL = SHAPE_FEW + SHAPE, THICK = SHAPE - 1, OF_CLOUD = SHAPE_ALL + SHAPE };

static const size_t far_place[FAR] = {1, 3, SIXTH, HALF, K - 1};
static const double least = 1e-3; /* of the spacing: smaller lengths are taken for this */

typedef struct table {
    const float (*xyz)[3];
    const uint32_t *row;  /* count x K: neighbours, nearest first */
    const float *squared; /* their squared distances */
    double spacing;       /* median distance to the nearest */
    double median[FAR];   /* of the distances to those of far_place */
} table;

static double distance(const table *t, size_t i, size_t place)
{
    return fmax(sqrt((double)t->squared[i * K + place]), least * t->spacing);
}

/* The value of a rank (0: least) among a few; reorders them. */
static double ranked(float *value, size_t count, size_t rank)
{
    for (size_t i = 1; i < count; i++) {
        const float v = value[i];
        size_t k = i;
        for (; k > 0 && value[k - 1] > v; k--) value[k] = value[k - 1];
        value[k] = v;
    }
    return (double)value[rank];
}

/* Distances over the cloud's medians and over the neighbours' own (the idea of the local outlier factor, Breunig et al.
 * 2000), as logarithms. */
static void far_features(const table *t, size_t i, float feature[])
{
    float around[K];
    for (size_t k = 0; k < FAR; k++) feature[k] = (float)log(distance(t, i, far_place[k]) / t->median[k]);
    for (size_t k = 0; k < 2; k++) {
        const size_t place = k ? HALF : SIXTH;
        for (size_t j = 0; j <= place; j++) around[j] = (float)distance(t, t->row[i * K + j], place);
        feature[FAR + k] = (float)log(distance(t, i, place) / ranked(around, place + 1, place / 2));
    }
    for (size_t j = 0; j < HALF; j++) around[j] = (float)distance(t, t->row[i * K + j], SIXTH);
    feature[FAR + 2] = (float)log(distance(t, i, SIXTH) / ranked(around, HALF, 1));
}

/* The shape of the first n neighbours: residual from their plane, in spacings and in their thickness; how far beside
 * their centre the point is; linearity, roundness; thickness. */
static void shape_features(const table *t, size_t i, size_t n, float feature[])
{
    double mean[3] = {0}, moment[6] = {0}, value[3], vector[3][3];
    for (size_t j = 0; j < n; j++) {
        const float *p = t->xyz[t->row[i * K + j]];
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = ((double)p[a] - t->xyz[i][a]) / t->spacing;
        for (int a = 0, m = 0; a < 3; a++) {
            mean[a] += d[a] / (double)n;
            for (int b = a; b < 3; b++) moment[m++] += d[a] * d[b] / (double)n;
        }
    }
    for (int a = 0, m = 0; a < 3; a++)
        for (int b = a; b < 3; b++) moment[m++] -= mean[a] * mean[b];
    plm_eigen3(moment, value, vector);
    double length[3];
    for (int k = 0; k < 3; k++) length[k] = sqrt(fmax(value[k], least * least));
    const double residual = fabs(plm_dot(mean, vector[2]));
    feature[0] = (float)residual;
    feature[1] = (float)(residual / length[2]);
    feature[2] = (float)(plm_norm(mean) * t->spacing / distance(t, i, n - 1));
    feature[3] = (float)(1 - length[1] / length[0]);
    feature[4] = (float)(length[2] / length[1]);
    feature[THICK] = (float)log(length[2]);
}

/* What the cloud is like: how even its spacing is and how thick its surfaces are; and the point's surroundings. */
static void cloud_features(const table *t, size_t count, float *value, float (*feature)[PLM_GHOST_FEATURES])
{
    for (size_t i = 0; i < count; i++) value[i] = (float)distance(t, i, SIXTH);
    const float spread = (float)log(t->median[2] / (double)plm_quantile(value, count, 0.25));
    for (size_t i = 0; i < count; i++) value[i] = feature[i][SHAPE_ALL + THICK];
    const float thin = plm_quantile(value, count, 0.3);
    const int64_t rows = (int64_t)count;
#pragma omp parallel for schedule(static)
    for (int64_t i = 0; i < rows; i++) {
        float around[K];
        for (size_t j = 0; j < K; j++) around[j] = feature[t->row[(size_t)i * K + j]][SHAPE_ALL + THICK];
        feature[i][OF_CLOUD] = (float)ranked(around, K, K / 2) - feature[i][SHAPE_ALL + THICK];
        feature[i][OF_CLOUD + 1] = spread;
        feature[i][OF_CLOUD + 2] = thin;
    }
}

static void all_features(table *t, size_t count, float *value, float (*feature)[PLM_GHOST_FEATURES])
{
    for (size_t i = 0; i < count; i++) value[i] = t->squared[i * K];
    t->spacing = sqrt((double)plm_quantile(value, count, 0.5));
    for (size_t k = 0; k < FAR; k++) {
        for (size_t i = 0; i < count; i++) value[i] = (float)distance(t, i, far_place[k]);
        t->median[k] = (double)plm_quantile(value, count, 0.5);
    }
    const int64_t rows = (int64_t)count;
#pragma omp parallel for schedule(dynamic, 256)
    for (int64_t i = 0; i < rows; i++) {
        far_features(t, (size_t)i, feature[i]);
        shape_features(t, (size_t)i, FEW, feature[i] + SHAPE_FEW);
        shape_features(t, (size_t)i, K, feature[i] + SHAPE_ALL);
    }
    cloud_features(t, count, value, feature);
}

plm_status plm_ghost_features(const float (*xyz)[3], size_t count, float (*feature)[PLM_GHOST_FEATURES],
                              plm_error *error)
{
    _Static_assert(OF_CLOUD + 3 == PLM_GHOST_FEATURES, "every feature is written");
    if (count <= K) return plm_fail(error, PLM_E_DEGENERATE, "%zu points are too few to tell ghosts by", count);
    plm_scratch scratch = {.error = error};
    uint32_t *row = plm_scratch_take(&scratch, count * K, sizeof *row);
    float *squared = plm_scratch_take(&scratch, count * K, sizeof *squared);
    float *value = plm_scratch_take(&scratch, count, sizeof *value);
    plm_status status = scratch.failed ? PLM_E_MEMORY : plm_neighbour_table(xyz, count, K, row, squared, error);
    if (status == PLM_OK) {
        table t = {.xyz = xyz, .row = row, .squared = squared};
        all_features(&t, count, value, feature);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

double plm_ghost_probability(const float feature[PLM_GHOST_FEATURES])
{
    return plm_forest_probability(GHOST_BIAS, GHOST_TREE, sizeof GHOST_TREE / sizeof *GHOST_TREE, feature);
}
