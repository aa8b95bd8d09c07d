/* traits/near_hull.c: points near a hull, by halving boxes of them: faces that are far from a box are far from its points. */
#include "traits/near_hull.h"

#include <math.h>
#include <omp.h>
#include <string.h>

enum {
    PARTS_LEVELS = 6,
    PARTS = 1 << PARTS_LEVELS, /* boxes that threads share */
    FEW_POINTS = 32,
    FEW_PLANES = 4,
    MOST_LEVELS = 60
};

/* Boxes are held for this much (relatively) nearer than they are: rounding must not drop a face. */
static const double slack = 1e-9;

typedef struct search {
    const float (*xyz)[3];
    const double (*plane)[4];
    double depth;
    bool *near;
    uint32_t *id; /* of planes: those that come near the box at hand are first */
} search;

/** Rows whose points lie in a box. */
typedef struct part {
    uint32_t *row;
    size_t count;
    double low[3], high[3];
} part;

static double plane_depth(const double plane[4], const float p[3])
{
    return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3];
}

/* Outward planes of a closed hull: normal and offset of each triangle. */
static size_t hull_planes(const plm_mesh *hull, double (*plane)[4])
{
    size_t used = 0;
    for (size_t t = 0; t < hull->triangle_count; t++) {
        const double *a = hull->vertex[hull->triangle[t][0]], *b = hull->vertex[hull->triangle[t][1]];
        const double *c = hull->vertex[hull->triangle[t][2]];
        const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!(length > 0)) continue;
        double offset = 0;
        for (int k = 0; k < 3; k++) {
            plane[used][k] = n[k] / length;
            offset += plane[used][k] * (a[k] + hull->origin[k]);
        }
        plane[used++][3] = offset;
    }
    return used;
}

/* Brings the planes that come near the box to the front of the first `planes` ids; gives how many. */
static size_t keep_planes(search *s, const part *box, size_t planes)
{
    double centre[3], half[3], size = s->depth;
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * (box->low[k] + box->high[k]);
        half[k] = 0.5 * (box->high[k] - box->low[k]);
        size += fabs(centre[k]) + half[k];
    }
    size_t kept = 0;
    for (size_t j = 0; j < planes; j++) {
        const uint32_t id = s->id[j];
        const double *n = s->plane[id];
        const double reach = fabs(n[0]) * half[0] + fabs(n[1]) * half[1] + fabs(n[2]) * half[2];
        const double at = n[0] * centre[0] + n[1] * centre[1] + n[2] * centre[2] - n[3];
        if (at + reach + slack * (size + fabs(n[3])) <= -s->depth) continue;
        s->id[j] = s->id[kept];
        s->id[kept++] = id;
    }
    return kept;
}

/* Splits a part in the middle of its longest side. */
static void halve(const search *s, const part *whole, part *left, part *right)
{
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (whole->high[k] - whole->low[k] > whole->high[axis] - whole->low[axis]) axis = k;
    const double middle = 0.5 * (whole->low[axis] + whole->high[axis]);
    size_t lower = 0;
    for (size_t i = 0; i < whole->count; i++) {
        const uint32_t row = whole->row[i];
        if ((double)s->xyz[row][axis] >= middle) continue;
        whole->row[i] = whole->row[lower];
        whole->row[lower++] = row;
    }
    const part all = *whole; /* which left may be */
    *left = all, *right = all;
    left->count = lower;
    left->high[axis] = middle;
    right->row = all.row + lower;
    right->count = all.count - lower;
    right->low[axis] = middle;
}

static void mark(search *s, const part *box, size_t planes, int level)
{
    if (box->count == 0) return;
    const size_t kept = keep_planes(s, box, planes);
    if (kept == 0) return;
    if (box->count > FEW_POINTS && kept > FEW_PLANES && level < MOST_LEVELS) {
        part left, right;
        halve(s, box, &left, &right);
        mark(s, &left, kept, level + 1);
        mark(s, &right, kept, level + 1);
        return;
    }
    for (size_t i = 0; i < box->count; i++) {
        bool *near = &s->near[box->row[i]];
        const float *p = s->xyz[box->row[i]];
        for (size_t j = 0; j < kept && !*near; j++) *near = plane_depth(s->plane[s->id[j]], p) > -s->depth;
    }
}

static part part_of_used(const float (*xyz)[3], const bool *use, size_t count, uint32_t *row)
{
    part all = {row, 0, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < count; i++) {
        if (!use[i]) continue;
        row[all.count++] = (uint32_t)i;
        for (int k = 0; k < 3; k++) {
            all.low[k] = fmin(all.low[k], xyz[i][k]);
            all.high[k] = fmax(all.high[k], xyz[i][k]);
        }
    }
    return all;
}

/* ids: a list of all planes for each thread. */
static void mark_parts(const search *whole, part *parts, size_t planes, uint32_t *ids)
{
    for (int level = 0, made = 1; level < PARTS_LEVELS; level++, made *= 2)
        for (int i = 0; i < made; i++) halve(whole, &parts[i], &parts[i], &parts[made + i]);
#pragma omp parallel for schedule(dynamic, 1)
    for (int i = 0; i < PARTS; i++) {
        search own = *whole;
        own.id = ids + (size_t)omp_get_thread_num() * planes;
        mark(&own, &parts[i], planes, PARTS_LEVELS);
    }
}

plm_status plm_near_hull(const plm_mesh *hull, const float (*xyz)[3], const bool *use, size_t count, double depth,
                         bool *near, size_t *near_count, plm_error *error)
{
    const size_t threads = (size_t)omp_get_max_threads();
    double(*plane)[4] = plm_alloc(hull->triangle_count, sizeof *plane, error);
    const size_t planes = plane ? hull_planes(hull, plane) : 0;
    uint32_t *ids = plm_alloc(threads * planes, sizeof *ids, error);
    uint32_t *row = plm_alloc(count, sizeof *row, error);
    const plm_status status = plane && ids && row ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t i = 0; i < threads * planes; i++) ids[i] = (uint32_t)(i % planes);
        memset(near, 0, count * sizeof *near);
        part parts[PARTS] = {part_of_used(xyz, use, count, row)};
        const search whole = {xyz, (const double(*)[4])plane, depth, near, NULL};
        mark_parts(&whole, parts, planes, ids);
        *near_count = 0;
        for (size_t i = 0; i < count; i++) *near_count += near[i];
    }
    plm_free(plane);
    plm_free(ids);
    plm_free(row);
    return status;
}
