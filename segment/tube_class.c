/* segment/tube_class.c: a blade is flat at every scale, its rim and tip included; a tube is round up to a few radii and
 * long beyond. One logistic formula over the shapes of balls of six sizes, in units of R, with the noise taken off; trees over
 * the same where so few points are around that these shapes scatter. */
#include "segment/tube_class.h"

#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/sparse_tube_forest.h"
#include "segment/tube_weights.h"

static const double BALL_RADIUS[PLM_TUBE_SCALES] = {0.35, 0.5, 0.71, 1, 1.41, 2};
static const double BALL_CELLS = 6;
static const double VALUE_FLOOR = 0.02; /* of the ball's radius: below, an eigenvalue is taken for none */
enum {
    SCALE_OF_R = 3,
    FEW = 12 /* points in a ball: fewer do not tell its shape */
};

static void shape_features(const plm_ball_shape *shape, double radius, double noise, float feature[PLM_TUBE_FEATURES])
{
    double l[3];
    const double least = (VALUE_FLOOR * radius) * (VALUE_FLOOR * radius);
    for (int i = 0; i < 3; i++) l[i] = fmax((double)shape->value[i] - noise * noise, least);
    feature[0] = (float)(1 - sqrt(l[1] / l[0]));
    feature[1] = (float)sqrt(l[2] / l[1]);
    for (int i = 0; i < 3; i++) feature[2 + i] = (float)(sqrt(l[i]) / radius);
    feature[5] = (float)(shape->offset / radius);
}

/* Each working point takes over from the copy's voxel that holds the base point nearest to it. */
static plm_status nearest_base(const float (*base)[3], size_t base_count, const plm_thinned *working, uint32_t *nearest,
                               plm_error *error)
{
    float *best = plm_alloc(working->count, sizeof *best, error);
    if (!best) return PLM_E_MEMORY;
    for (size_t i = 0; i < working->count; i++) best[i] = INFINITY;
    for (size_t i = 0; i < base_count; i++) {
        const uint32_t w = working->voxels.owner[i];
        const float x = base[i][0] - working->xyz[w][0], y = base[i][1] - working->xyz[w][1],
                    z = base[i][2] - working->xyz[w][2];
        const float d = x * x + y * y + z * z;
        if (d < best[w]) {
            best[w] = d;
            nearest[w] = (uint32_t)i;
        }
    }
    plm_free(best);
    return PLM_OK;
}

static void take_over(const plm_ball_shape *shape, const plm_thinned *copy, const uint32_t *nearest, size_t count,
                      int scale_number, const plm_scale *scale, plm_tube_point *point)
{
    const double radius = BALL_RADIUS[scale_number] * scale->radius, noise = scale->noise;
    for (size_t i = 0; i < count; i++) {
        const plm_ball_shape *s = &shape[copy->voxels.owner[nearest[i]]];
        shape_features(s, radius, noise, point[i].feature[scale_number]);
        if (scale_number != SCALE_OF_R) continue;
        point[i].count = s->count;
        point[i].radius = (float)sqrt(fmax((double)s->value[1] + s->value[2] - 2 * noise * noise, 0));
        for (int axis = 0; axis < 3; axis++) {
            point[i].axis[axis] = s->axis[axis];
            point[i].normal[axis] = s->normal[axis];
        }
    }
}

/* Where too few points are in a ball, its shape by links as far as sparse parts want; the graph keeps these. The formula was fitted without
 * such in balls smaller than R; points that it tells and that have some (dense plants with sparse parts) fare no worse by them. */
static plm_status widen_few(plm_graph *graph, double radius, plm_ball_shape *shape, plm_error *error)
{
    size_t few = 0;
    for (size_t i = 0; i < graph->count; i++) few += shape[i].count < FEW;
    if (!few) return PLM_OK;
    const uint32_t edges = graph->first[graph->count];
    plm_status status = plm_graph_widen(graph, error);
    if (status != PLM_OK || graph->first[graph->count] == edges) return status;
    plm_ball_shape *wide = plm_alloc(graph->count, sizeof *wide, error);
    status = wide ? plm_ball_shapes(graph, radius, wide, error) : PLM_E_MEMORY;
    for (size_t i = 0; status == PLM_OK && i < graph->count; i++)
        if (shape[i].count < FEW) shape[i] = wide[i];
    plm_free(wide);
    return status;
}

plm_status plm_tube_points(const float (*base)[3], size_t base_count, const plm_thinned *working,
                           const plm_scale *scale, plm_tube_point *point, plm_error *error)
{
    uint32_t *nearest = plm_alloc_zero(working->count, sizeof *nearest, error);
    plm_status status = nearest ? nearest_base(base, base_count, working, nearest, error) : PLM_E_MEMORY;
    for (int k = 0; k < PLM_TUBE_SCALES && status == PLM_OK; k++) {
        plm_thinned copy = {0};
        plm_graph graph = {0};
        plm_ball_shape *shape = NULL;
        const double radius = BALL_RADIUS[k] * scale->radius, cell = fmax(radius / BALL_CELLS, scale->spacing);
        status = plm_thin(base, base_count, cell, &copy, error);
        if (status == PLM_OK && !(shape = plm_alloc(copy.count, sizeof *shape, error))) status = PLM_E_MEMORY;
        if (status == PLM_OK) status = plm_ball_graph((const float(*)[3])copy.xyz, copy.count, cell, &graph, error);
        if (status == PLM_OK) status = plm_ball_shapes(&graph, radius, shape, error);
        if (status == PLM_OK) status = widen_few(&graph, radius, shape, error);
        if (status == PLM_OK) take_over(shape, &copy, nearest, working->count, k, scale, point);
        plm_free(shape);
        plm_graph_free(&graph);
        plm_thinned_free(&copy);
    }
    plm_free(nearest);
    return status;
}

float plm_tube_probability(const plm_tube_point *point)
{
    if (point->count < PLM_TUBE_SPARSE)
        return (float)plm_forest_probability(SPARSE_TUBE_BIAS, SPARSE_TUBE_TREE,
                                             sizeof SPARSE_TUBE_TREE / sizeof *SPARSE_TUBE_TREE, &point->feature[0][0]);
    double sum = TUBE_BIAS;
    for (int k = 0; k < PLM_TUBE_SCALES; k++)
        for (int f = 0; f < PLM_TUBE_FEATURES; f++) sum += TUBE_WEIGHT[k][f] * point->feature[k][f];
    return (float)(1 / (1 + exp(-sum)));
}
