/* mesh/hull.c: convex hull of many points. Nearly all points lie inside: the extreme points along spread directions span
 * a first hull, and only points outside of it can be corners (Akl and Toussaint 1978, in space). The facets of that hull
 * are the directions of the next round. What is left goes to CGAL's exact hull. A point is only dropped when it is inside
 * beyond all rounding, so that the hull is that of all points; points are sorted before and triangles after, so that the
 * order of the rows leaves no trace. */
#include "cloud/linear.h"
#include "mesh/hull_cgal.h"
#include "mesh/mesh.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum {
    BLOCK = 256,              /* points taken at once, so that loops over them are vectors */
    MAXIMUM_DIRECTIONS = 448, /* three rounds: 26 corners, then 48 more, then 144 more, span at most 432 facets */
    MAXIMUM_ROUNDS = 3,
    FEW_POINTS = 1000 /* not worth a round */
};

typedef struct float3 {
    float x, y, z;
} float3;

typedef double triple[3];

/** The point that lies farthest along a direction; of several, the smallest by x, y, z. */
typedef struct extreme {
    float reach;
    float3 point;
} extreme;

/** A half space: outside where normal . (p - centre) > limit. */
typedef struct facet {
    double normal[3], limit;
} facet;

/** What the rounds know: extreme points found so far, and their hull. */
typedef struct rounds {
    float3 *left; /* points that may be corners; NULL: all */
    size_t left_count;
    triple *corner;
    size_t corner_count;
    float3 *direction;
    facet *facet;
    size_t direction_count, facet_count;
    double centre[3], radius;
    bool solid; /* the corners span a volume */
} rounds;

static bool point_before(float3 a, float3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

static void take_extreme(extreme *best, extreme other)
{
    if (other.reach > best->reach || (other.reach == best->reach && point_before(other.point, best->point)))
        *best = other;
}

/** Faces, edges and corners of the points' box: 26 spread directions, so that a tall plant is met as well as a round one. */
static size_t box_directions(const double side[3], float3 *direction)
{
    float scale[3];
    size_t count = 0;
    for (int axis = 0; axis < 3; axis++) scale[axis] = side[axis] > 0 ? (float)(1 / side[axis]) : 0;
    for (int i = 0; i < 27; i++) {
        const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
        if (x || y || z) direction[count++] = (float3){(float)x * scale[0], (float)y * scale[1], (float)z * scale[2]};
    }
    return count;
}

/** Updates best[d] with points begin to end. The reach is rounded, but the same for the same point. */
static void extremes_of_block(const float3 *point, size_t count, const rounds *state, extreme *best)
{
    float x[BLOCK], y[BLOCK], z[BLOCK], reach[BLOCK];
    const float cx = (float)state->centre[0], cy = (float)state->centre[1], cz = (float)state->centre[2];
    for (size_t i = 0; i < count; i++) x[i] = point[i].x - cx, y[i] = point[i].y - cy, z[i] = point[i].z - cz;
    for (size_t d = 0; d < state->direction_count; d++) {
        const float3 u = state->direction[d];
        float most = -INFINITY;
#pragma omp simd reduction(max : most)
        for (size_t i = 0; i < count; i++) {
            reach[i] = u.x * x[i] + u.y * y[i] + u.z * z[i];
            most = reach[i] > most ? reach[i] : most;
        }
        if (!(most >= best[d].reach)) continue;
        for (size_t i = 0; i < count; i++)
            if (reach[i] == most) take_extreme(&best[d], (extreme){most, point[i]});
    }
}

static void find_extremes(const float3 *point, size_t count, const rounds *state, extreme *best)
{
    const size_t directions = state->direction_count;
    for (size_t d = 0; d < directions; d++) best[d] = (extreme){-INFINITY, point[0]};
    const int64_t blocks = (int64_t)((count + BLOCK - 1) / BLOCK);
#pragma omp parallel
    {
        extreme own[MAXIMUM_DIRECTIONS];
        memcpy(own, best, directions * sizeof *own);
#pragma omp for schedule(static)
        for (int64_t b = 0; b < blocks; b++) {
            const size_t begin = (size_t)b * BLOCK;
            extremes_of_block(point + begin, count - begin < BLOCK ? count - begin : BLOCK, state, own);
        }
#pragma omp critical
        for (size_t d = 0; d < directions; d++) take_extreme(&best[d], own[d]);
    }
}

/** Facets of the hull of the corners, and their normals as the next directions. */
static void facets_from(const plm_mesh *hull, rounds *state)
{
    state->facet_count = state->direction_count = 0;
    for (size_t t = 0; t < hull->triangle_count; t++) {
        double corner[3][3], a[3], b[3];
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                corner[i][axis] = hull->vertex[hull->triangle[t][i]][axis] - state->centre[axis];
        for (int axis = 0; axis < 3; axis++)
            a[axis] = corner[1][axis] - corner[0][axis], b[axis] = corner[2][axis] - corner[0][axis];
        facet *f = &state->facet[state->facet_count++];
        plm_cross(a, b, f->normal);
        /* The normal is known to a few roundings of |a||b|, and so is normal . p to as many of |a||b| radius: 64 of them
         * are more than can occur. */
        f->limit = plm_dot(f->normal, corner[0]) - 64 * DBL_EPSILON * plm_norm(a) * plm_norm(b) * state->radius;
        double unit[3] = {f->normal[0], f->normal[1], f->normal[2]};
        plm_normalise(unit);
        state->direction[state->direction_count++] = (float3){(float)unit[0], (float)unit[1], (float)unit[2]};
    }
}

/** keep[i] = 1 where point i is on or outside the hull of the corners. Gives how many are. */
static size_t mark_outside(const float3 *point, size_t count, const rounds *state, uint8_t *keep)
{
    const int64_t blocks = (int64_t)((count + BLOCK - 1) / BLOCK);
    size_t kept = 0;
#pragma omp parallel for schedule(static) reduction(+ : kept)
    for (int64_t b = 0; b < blocks; b++) {
        const size_t begin = (size_t)b * BLOCK, size = count - begin < BLOCK ? count - begin : BLOCK;
        double x[BLOCK], y[BLOCK], z[BLOCK], above[BLOCK];
        for (size_t i = 0; i < size; i++) {
            x[i] = point[begin + i].x - state->centre[0];
            y[i] = point[begin + i].y - state->centre[1];
            z[i] = point[begin + i].z - state->centre[2];
            above[i] = -INFINITY;
        }
        for (size_t f = 0; f < state->facet_count; f++) {
            const facet side = state->facet[f];
            for (size_t i = 0; i < size; i++) {
                const double s = side.normal[0] * x[i] + side.normal[1] * y[i] + side.normal[2] * z[i] - side.limit;
                above[i] = s > above[i] ? s : above[i];
            }
        }
        for (size_t i = 0; i < size; i++) kept += keep[begin + i] = above[i] >= 0;
    }
    return kept;
}

/** Keeps the points on or outside of the corners' hull: state->left becomes a new block, the old one is freed. */
static plm_status keep_outside(const float3 *point, size_t count, rounds *state, plm_error *error)
{
    plm_status status = PLM_E_MEMORY;
    float3 *left = NULL;
    uint8_t *keep = plm_alloc(count, 1, error);
    if (!keep) goto out;
    const size_t kept = mark_outside(point, count, state, keep);
    left = plm_alloc(kept, sizeof *left, error);
    if (!left) goto out;
    for (size_t i = 0, next = 0; i < count; i++)
        if (keep[i]) left[next++] = point[i];
    plm_free(state->left);
    state->left = left;
    state->left_count = kept;
    status = PLM_OK;
out:
    plm_free(keep);
    return status;
}

/** Sides of the points' box; centre and radius that all points lie within. */
static void measure_box(const float3 *point, size_t count, rounds *state, double side[3])
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        const float p[3] = {point[i].x, point[i].y, point[i].z};
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
            high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        side[axis] = (double)high[axis] - low[axis];
        state->centre[axis] = (float)(low[axis] + 0.5 * side[axis]); /* a float, so that p - centre hardly rounds */
    }
    state->radius = plm_norm(side);
}

/** One round: extremes along the directions join the corners, and points inside of the corners' hull go. */
static plm_status run_round(const float3 *point, size_t count, rounds *state, plm_error *error)
{
    extreme best[MAXIMUM_DIRECTIONS];
    plm_mesh hull = {0};
    int dimension = -1;
    find_extremes(point, count, state, best);
    for (size_t d = 0; d < state->direction_count; d++) {
        const double p[3] = {best[d].point.x, best[d].point.y, best[d].point.z};
        memcpy(state->corner[state->corner_count++], p, sizeof p);
    }
    plm_status status = plm_hull_cgal((const triple *)state->corner, state->corner_count, &hull, &dimension, error);
    state->solid = status == PLM_OK && dimension == 3;
    if (state->solid) {
        facets_from(&hull, state);
        status = keep_outside(point, count, state, error);
    }
    plm_mesh_free(&hull);
    return status;
}

/** Rounds as long as they pay: on return state->left has the points that may be corners of the hull. */
static plm_status drop_inside(const float3 *point, size_t count, rounds *state, plm_error *error)
{
    state->corner = plm_alloc(MAXIMUM_DIRECTIONS, sizeof *state->corner, error);
    state->direction = plm_alloc(MAXIMUM_DIRECTIONS, sizeof *state->direction, error);
    state->facet = plm_alloc(MAXIMUM_DIRECTIONS, sizeof *state->facet, error);
    if (!state->corner || !state->direction || !state->facet) return PLM_E_MEMORY;
    if (count <= FEW_POINTS) return PLM_OK;
    double side[3];
    measure_box(point, count, state, side);
    state->direction_count = box_directions(side, state->direction);
    for (int round = 0; round < MAXIMUM_ROUNDS && count > FEW_POINTS; round++) {
        const size_t before = count;
        const plm_status status = run_round(point, count, state, error);
        if (status != PLM_OK) return status;
        if (!state->solid) break; /* too thin for directions: the exact hull sees all points */
        point = state->left;
        count = state->left_count;
        if (count > before / 2) break;
    }
    return PLM_OK;
}

static int compare_points(const void *a, const void *b)
{
    const double *p = a, *q = b;
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] != q[axis]) return p[axis] < q[axis] ? -1 : 1;
    return 0;
}

/** The points in order of x, y, z, each place once. NULL without memory. */
static triple *sorted_places(const float3 *point, size_t count, size_t *place_count, plm_error *error)
{
    triple *place = plm_alloc(count, sizeof *place, error);
    if (!place) return NULL;
    for (size_t i = 0; i < count; i++) {
        const double p[3] = {point[i].x + 0.0, point[i].y + 0.0, point[i].z + 0.0}; /* + 0: -0 becomes 0 */
        memcpy(place[i], p, sizeof p);
    }
    qsort(place, count, sizeof *place, compare_points);
    size_t unique = 0;
    for (size_t i = 0; i < count; i++)
        if (unique == 0 || compare_points(place[unique - 1], place[i]) != 0)
            memmove(place[unique++], place[i], sizeof *place);
    *place_count = unique;
    return place;
}

typedef struct numbered_vertex {
    triple place;
    uint32_t number;
} numbered_vertex;

static int compare_triangles(const void *a, const void *b)
{
    const uint32_t *s = a, *t = b;
    for (int i = 0; i < 3; i++)
        if (s[i] != t[i]) return s[i] < t[i] ? -1 : 1;
    return 0;
}

/** Vertices in order of x, y, z, triangles from their smallest vertex, in order: a hull looks the same however it was
 * found. */
static plm_status put_in_order(plm_mesh *hull, plm_error *error)
{
    plm_status status = PLM_E_MEMORY;
    numbered_vertex *vertex = plm_alloc(hull->vertex_count, sizeof *vertex, error);
    uint32_t *place = plm_alloc(hull->vertex_count, sizeof *place, error);
    if (!vertex || !place) goto out;
    for (uint32_t v = 0; v < hull->vertex_count; v++) {
        memcpy(vertex[v].place, hull->vertex[v], sizeof vertex[v].place);
        vertex[v].number = v;
    }
    qsort(vertex, hull->vertex_count, sizeof *vertex, compare_points); /* place comes first in numbered_vertex */
    for (uint32_t v = 0; v < hull->vertex_count; v++) {
        memcpy(hull->vertex[v], vertex[v].place, sizeof vertex[v].place);
        place[vertex[v].number] = v;
    }
    for (size_t t = 0; t < hull->triangle_count; t++) {
        uint32_t corner[3];
        for (int i = 0; i < 3; i++) corner[i] = place[hull->triangle[t][i]];
        int first = corner[1] < corner[0] ? 1 : 0;
        if (corner[2] < corner[first]) first = 2;
        for (int i = 0; i < 3; i++) hull->triangle[t][i] = corner[(first + i) % 3];
    }
    qsort(hull->triangle, hull->triangle_count, sizeof *hull->triangle, compare_triangles);
    status = PLM_OK;
out:
    plm_free(vertex);
    plm_free(place);
    return status;
}

/** Sum of the tetrahedra between the triangles and the mean vertex, none of which is negative. */
static double volume_of(const plm_mesh *hull)
{
    double centre[3] = {0, 0, 0}, sum = 0;
    for (size_t v = 0; v < hull->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++)
            centre[axis] += (hull->vertex[v][axis] - hull->vertex[0][axis]) / (double)hull->vertex_count;
    for (int axis = 0; axis < 3; axis++) centre[axis] += hull->vertex[0][axis];
    for (size_t t = 0; t < hull->triangle_count; t++) {
        double corner[3][3], across[3];
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                corner[i][axis] = hull->vertex[hull->triangle[t][i]][axis] - centre[axis];
        plm_cross(corner[1], corner[2], across);
        sum += plm_dot(corner[0], across) / 6;
    }
    return sum;
}

plm_status plm_convex_hull(const float (*xyz)[3], size_t count, double *volume, double *area, plm_mesh *hull,
                           plm_error *error)
{
    rounds state = {0};
    plm_mesh draft = {0};
    triple *place = NULL;
    size_t place_count = 0;
    int dimension = -1;
    double draft_area = 0;
    const float3 *point = (const float3 *)xyz;
    plm_status status = drop_inside(point, count, &state, error);
    if (status == PLM_OK) {
        place = state.left ? sorted_places(state.left, state.left_count, &place_count, error)
                           : sorted_places(point, count, &place_count, error);
        if (!place) status = PLM_E_MEMORY;
    }
    if (status == PLM_OK) status = plm_hull_cgal((const triple *)place, place_count, &draft, &dimension, error);
    if (status == PLM_OK && dimension < 2)
        status = plm_fail(error, PLM_E_DEGENERATE, "%zu points at %zu places %s have no convex hull", count,
                          place_count, dimension == 1 ? "on one line" : "in all");
    if (status == PLM_OK) status = put_in_order(&draft, error);
    if (status == PLM_OK) status = plm_mesh_area(&draft, &draft_area, error);
    if (status == PLM_OK) {
        *volume = dimension == 3 ? volume_of(&draft) : 0;
        *area = draft_area;
        if (hull) {
            *hull = draft;
            draft = (plm_mesh){0};
        }
    }
    plm_mesh_free(&draft);
    plm_free(place);
    plm_free(state.left);
    plm_free(state.corner);
    plm_free(state.direction);
    plm_free(state.facet);
    return status;
}
