/* mesh/leaf_charts.c: a leaf cut into pieces that a plane sees without folds, from the normals at some hundred probes. */
#include "mesh/leaf_charts.h"

#include "cloud/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PROBES = 500,
    PROBE_NEIGHBOURS = 24,
    PROBE_MAXIMUM = 250, /* neighbours asked for where noise is large ... */
    PROBE_USED = 60,     /* ... of which so many strided ones are used */
    SMALLEST_CHART = 150 /* points */
};

static const double widest_tilt = 40.0;  /* degrees between a normal and its chart's axis ... */
static const double tilted_share = 0.10; /* ... that so many normals may exceed */
/* Fine charts help the area of sparse arched leaves by 1-2 % and spoil their plane: seams count twice or not at all. */
static const double smallest_share = 1.0 / 12;
static const double ball_per_noise = 5.0; /* as for local quadrics: a smaller ball has any plane */

typedef plm_leaf_probe probe;

static void add_moment(double moment[6], const double d[3])
{
    moment[0] += d[0] * d[0];
    moment[1] += d[0] * d[1];
    moment[2] += d[0] * d[2];
    moment[3] += d[1] * d[1];
    moment[4] += d[1] * d[2];
    moment[5] += d[2] * d[2];
}

/* Normal of the plane through the neighbours of row that are of its own part. */
static void probe_at(const plm_leaf_points *points, uint32_t row, size_t wanted, probe *out)
{
    uint32_t near[PROBE_MAXIMUM];
    const size_t found = plm_index_nearest(points->index, points->xyz[row], wanted, near, NULL);
    const size_t step = (found + PROBE_USED - 1) / PROBE_USED;
    double sum[3] = {0, 0, 0}, moment[6] = {0}, value[3], axis[3][3];
    size_t used = 0;
    for (size_t j = 0; j < found; j += step)
        if (points->component[near[j]] == points->component[row]) near[used++] = near[j];
    for (size_t j = 0; j < used; j++)
        for (int i = 0; i < 3; i++) sum[i] += (double)points->xyz[near[j]][i] / (double)used;
    for (size_t j = 0; j < used; j++) {
        double d[3];
        for (int i = 0; i < 3; i++) d[i] = (double)points->xyz[near[j]][i] - sum[i];
        add_moment(moment, d);
    }
    plm_eigen3(moment, value, axis);
    for (int i = 0; i < 3; i++) out->place[i] = points->xyz[row][i];
    memcpy(out->normal, axis[2], sizeof out->normal);
}

static void turn(double vector[3])
{
    for (int i = 0; i < 3; i++) vector[i] = -vector[i];
}

/* Makes the normals of all probes face the same side of the sheet: each takes its side from the one through which it is
 * first reached when the nearest probe, of much the same normal, always comes next (H. Hoppe et al. 1992, with Prim's
 * minimum spanning tree). Then turns all of them so that most look up. */
static plm_status face_one_side(probe *probes, size_t count, plm_error *error)
{
    double *cost = plm_alloc(count, sizeof *cost, error);
    size_t *from = plm_alloc(count, sizeof *from, error);
    const bool good = cost && from;
    double up = 0;
    for (size_t j = 0; good && j < count; j++) cost[j] = INFINITY, from[j] = 0;
    for (size_t round = 0, at = 0; good && round < count; round++) {
        if (plm_dot(probes[at].normal, probes[from[at]].normal) < 0) turn(probes[at].normal);
        up += probes[at].normal[2];
        cost[at] = -1; /* done */
        size_t next = at;
        for (size_t j = 0; j < count; j++) {
            if (cost[j] < 0) continue;
            double d[3];
            for (int i = 0; i < 3; i++) d[i] = probes[j].place[i] - probes[at].place[i];
            const double here = plm_norm(d) * (1.05 - fabs(plm_dot(probes[j].normal, probes[at].normal)));
            if (here < cost[j]) cost[j] = here, from[j] = at;
            if (next == at || cost[j] < cost[next]) next = j;
        }
        at = next;
    }
    for (size_t j = 0; good && up < 0 && j < count; j++) turn(probes[j].normal);
    plm_free(cost);
    plm_free(from);
    return good ? PLM_OK : PLM_E_MEMORY;
}

static void mean_axis(const probe *probes, size_t count, double axis[3])
{
    for (int i = 0; i < 3; i++) {
        axis[i] = 0;
        for (size_t j = 0; j < count; j++) axis[i] += probes[j].normal[i];
    }
    if (plm_normalise(axis) > 0) return;
    memcpy(axis, probes[0].normal, sizeof probes[0].normal); /* a closed tube: no side is the mean */
}

static double share_beyond(const probe *probes, size_t count, const double axis[3], double degrees)
{
    const double limit = cos(plm_radians(degrees));
    size_t beyond = 0;
    for (size_t j = 0; j < count; j++) beyond += plm_dot(probes[j].normal, axis) < limit;
    return (double)beyond / (double)count;
}

static void middle_of(const probe *probes, size_t count, double middle[3])
{
    for (int i = 0; i < 3; i++) {
        middle[i] = 0;
        for (size_t j = 0; j < count; j++) middle[i] += probes[j].place[i] / (double)count;
    }
}

static int compare_probes(const void *a, const void *b)
{
    const probe *x = a, *y = b;
    if (x->along != y->along) return x->along < y->along ? -1 : 1;
    return memcmp(x->place, y->place, sizeof x->place); /* any fixed order will do */
}

/* How far the normals spread: sum of squared chords to their mean axis. */
static double spread_of(const probe *probes, size_t count)
{
    double axis[3], sum = 0;
    mean_axis(probes, count, axis);
    for (size_t j = 0; j < count; j++) sum += 2 - 2 * plm_dot(probes[j].normal, axis);
    return sum;
}

static void sort_along(probe *probes, size_t count, const double axis[3])
{
    for (size_t j = 0; j < count; j++) probes[j].along = plm_dot(axis, probes[j].place);
    qsort(probes, count, sizeof *probes, compare_probes);
}

/* Sorts the probes along the one of their three axes whose halves have the least spread of normals, and gives the plane
 * between the halves. A leaf folded along its midrib wants another cut than an arched one. */
static plm_leaf_cut cut_in_half(probe *probes, size_t count)
{
    double middle[3], moment[6] = {0}, value[3], axis[3][3], least = INFINITY;
    middle_of(probes, count, middle);
    for (size_t j = 0; j < count; j++) {
        double d[3];
        for (int i = 0; i < 3; i++) d[i] = probes[j].place[i] - middle[i];
        add_moment(moment, d);
    }
    plm_eigen3(moment, value, axis);
    int best = 0;
    for (int i = 0; i < 3; i++) {
        sort_along(probes, count, axis[i]);
        const double spread = spread_of(probes, count / 2) + spread_of(probes + count / 2, count - count / 2);
        if (spread < least) least = spread, best = i;
    }
    sort_along(probes, count, axis[best]);
    plm_leaf_cut cut = {0};
    memcpy(cut.normal, axis[best], sizeof cut.normal);
    cut.offset = 0.5 * (probes[count / 2 - 1].along + probes[count / 2].along);
    return cut;
}

static void add_chart(plm_leaf_charts *charts, const probe *probes, size_t count, const double axis[3], int parent)
{
    plm_leaf_chart *chart = &charts->chart[charts->count++];
    chart->parent = parent;
    middle_of(probes, count, chart->origin);
    memcpy(chart->normal, axis, sizeof chart->normal);
    plm_frame_of_axis(chart->normal, chart->u, chart->v);
}

/* Makes the charts of count probes; gives the number by which a cut refers to them. smallest: probes of a chart. */
static int divide(plm_leaf_charts *charts, probe *probes, size_t count, size_t smallest, int parent)
{
    double axis[3];
    mean_axis(probes, count, axis);
    const bool small = count / 2 < smallest || charts->cut_count + 1 >= PLM_LEAF_CHARTS_MAXIMUM;
    if (small || share_beyond(probes, count, axis, widest_tilt) <= tilted_share) {
        add_chart(charts, probes, count, axis, parent);
        return (int)charts->count - 1;
    }
    const size_t self = charts->cut_count++;
    charts->cut[self] = cut_in_half(probes, count);
    charts->cut[self].parent = parent;
    const int below = divide(charts, probes, count / 2, smallest, (int)self);
    const int above = divide(charts, probes + count / 2, count - count / 2, smallest, (int)self);
    charts->cut[self].below = below;
    charts->cut[self].above = above;
    return -1 - (int)self;
}

plm_status plm_leaf_charts_make(const plm_leaf_points *points, const uint32_t *row, size_t count, double noise,
                                plm_leaf_charts *charts, plm_error *error)
{
    const size_t probe_count = count < PROBES ? count : PROBES;
    probe *probes = plm_alloc(probe_count, sizeof *probes, error);
    if (!probes) return PLM_E_MEMORY;
    for (size_t j = 0; j < probe_count; j++) { /* the rows are in Morton order: strides are spread over the leaf */
        const uint32_t at = row[j * count / probe_count];
        const double radius = points->reach[at] * sqrt((double)PROBE_NEIGHBOURS / 8); /* of that many neighbours */
        const double ratio = fmax(1, ball_per_noise * noise / fmax(radius, 1e-30));
        const double wanted = fmin(PROBE_MAXIMUM, PROBE_NEIGHBOURS * ratio * ratio);
        probe_at(points, at, (size_t)wanted, &probes[j]);
    }
    plm_leaf_charts made = {.probe_count = probe_count, .probe = probes};
    const double smallest =
        fmax(smallest_share * (double)probe_count, (double)SMALLEST_CHART * (double)probe_count / (double)count);
    const plm_status status = face_one_side(probes, probe_count, error);
    if (status == PLM_OK) {
        divide(&made, probes, probe_count, (size_t)ceil(smallest), -1);
        *charts = made;
    } else {
        plm_leaf_charts_free(&made);
    }
    return status;
}

void plm_leaf_charts_free(plm_leaf_charts *charts)
{
    if (!charts) return;
    plm_free(charts->probe);
    *charts = (plm_leaf_charts){0};
}

void plm_leaf_chart_normal(const plm_leaf_charts *charts, const double point[3], double normal[3])
{
    double least = INFINITY;
    for (size_t j = 0; j < charts->probe_count; j++) {
        double d[3];
        for (int i = 0; i < 3; i++) d[i] = point[i] - charts->probe[j].place[i];
        const double squared = plm_dot(d, d);
        if (squared >= least) continue;
        least = squared;
        memcpy(normal, charts->probe[j].normal, sizeof charts->probe[j].normal);
    }
}

size_t plm_leaf_chart_of(const plm_leaf_charts *charts, const double point[3])
{
    int at = charts->cut_count ? -1 : 0; /* the first cut is the root */
    while (at < 0) {
        const plm_leaf_cut *cut = &charts->cut[-1 - at];
        at = plm_dot(cut->normal, point) < cut->offset ? cut->below : cut->above;
    }
    return (size_t)at;
}

double plm_leaf_chart_distance(const plm_leaf_charts *charts, size_t chart, const double point[3])
{
    double furthest = -INFINITY;
    int from = (int)chart;
    for (int at = charts->chart[chart].parent; at >= 0; from = -1 - at, at = charts->cut[at].parent) {
        const plm_leaf_cut *cut = &charts->cut[at];
        const double above = plm_dot(cut->normal, point) - cut->offset;
        furthest = fmax(furthest, cut->below == from ? above : -above);
    }
    return furthest;
}

void plm_leaf_chart_project(const plm_leaf_chart *chart, const double point[3], double uvz[3])
{
    const double d[3] = {point[0] - chart->origin[0], point[1] - chart->origin[1], point[2] - chart->origin[2]};
    uvz[0] = plm_dot(d, chart->u);
    uvz[1] = plm_dot(d, chart->v);
    uvz[2] = plm_dot(d, chart->normal);
}

void plm_leaf_chart_lift(const plm_leaf_chart *chart, const double uvz[3], double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] = chart->origin[i] + uvz[0] * chart->u[i] + uvz[1] * chart->v[i] + uvz[2] * chart->normal[i];
}
