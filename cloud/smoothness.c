/* cloud/smoothness.c: smoothness factor, mean distance, normal and curvature from one search for neighbours. */
#include "cloud/smoothness.h"

#include "cloud/all_nearest.h"
#include "cloud/linear.h"

enum { NEWTON_STEPS = 30 };

/** Offsets of the neighbours from the point. */
typedef struct offsets {
    float x[PLM_MOST_NEIGHBOURS], y[PLM_MOST_NEIGHBOURS], z[PLM_MOST_NEIGHBOURS];
} offsets;

static void gather_offsets(const plm_neighbourhood *found, offsets *restrict to)
{
    const plm_neighbourhood from = *found;
    for (size_t i = 0; i < from.count; i++) {
        const uint32_t j = from.place[i];
        to->x[i] = from.x[j] - from.point[0];
        to->y[i] = from.y[j] - from.point[1];
        to->z[i] = from.z[j] - from.point[2];
    }
}

/** Unit vectors and distances in float (they are no better known), sums in double, so that their order does not show. */
static void measure_smoothness(const plm_neighbourhood *found, const offsets *to, const plm_neighbour_measures *out)
{
    const size_t count = found->count;
    const float *restrict squared = found->squared;
    double x = 0, y = 0, z = 0, distances = 0;
    int32_t apart = 0;
#pragma omp simd reduction(+ : x, y, z, distances, apart)
    for (size_t i = 0; i < count; i++) {
        const float distance = sqrtf(squared[i]);
        const float scale = squared[i] > 0 ? 1 / distance : 0;
        x += (double)(to->x[i] * scale);
        y += (double)(to->y[i] * scale);
        z += (double)(to->z[i] * scale);
        distances += (double)distance;
        apart += squared[i] > 0;
    }
    if (out->smoothness) out->smoothness[found->point_row] = apart ? (float)(sqrt(x * x + y * y + z * z) / apart) : 0;
    if (out->mean_distance) out->mean_distance[found->point_row] = count ? (float)(distances / (double)count) : 0;
}

/** Second moments of the point and its neighbours about their mean, as xx, xy, xz, yy, yz, zz. */
static void second_moments(size_t count, const offsets *to, double moment[6])
{
    double x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
#pragma omp simd reduction(+ : x, y, z, xx, xy, xz, yy, yz, zz)
    for (size_t i = 0; i < count; i++) {
        const double dx = to->x[i], dy = to->y[i], dz = to->z[i];
        x += dx, y += dy, z += dz;
        xx += dx * dx, xy += dx * dy, xz += dx * dz;
        yy += dy * dy, yz += dy * dz, zz += dz * dz;
    }
    const double n = (double)count + 1; /* the point itself has offset 0 */
    moment[0] = (xx - x * x / n) / n;
    moment[1] = (xy - x * y / n) / n;
    moment[2] = (xz - x * z / n) / n;
    moment[3] = (yy - y * y / n) / n;
    moment[4] = (yz - y * z / n) / n;
    moment[5] = (zz - z * z / n) / n;
}

/** Smallest root of the characteristic polynomial of moments with trace 1: Newton's method from 0 climbs to it and never
 * passes it, because the polynomial is convex there. */
static double smallest_root(const double m[6])
{
    const double minors = m[0] * m[3] - m[1] * m[1] + m[0] * m[5] - m[2] * m[2] + m[3] * m[5] - m[4] * m[4];
    const double determinant =
        m[0] * (m[3] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[2]) + m[2] * (m[1] * m[4] - m[3] * m[2]);
    double root = 0;
    for (int step = 0; step < NEWTON_STEPS; step++) {
        const double value = determinant - root * (minors - root * (1 - root));
        const double slope = minors - root * (2 - 3 * root);
        if (!(value > 0) || !(slope > 0)) break;
        const double next = root + value / slope;
        if (!(next > root)) break;
        root = next;
    }
    return root;
}

/** Direction of least spread: the largest cross product of two rows of the matrix less its smallest root. Gives false
 * where these are too small to tell (the other two roots are not both apart from it): Jacobi's rotations can. */
static bool least_direction(const double m[6], double root, double direction[3])
{
    const double row[3][3] = {{m[0] - root, m[1], m[2]}, {m[1], m[3] - root, m[4]}, {m[2], m[4], m[5] - root}};
    double best = 0;
    for (int i = 0; i < 3; i++) {
        double across[3];
        plm_cross(row[i], row[(i + 1) % 3], across);
        const double squared = plm_dot(across, across);
        if (squared <= best) continue;
        best = squared;
        for (int axis = 0; axis < 3; axis++) direction[axis] = across[axis];
    }
    plm_normalise(direction);
    return best > 1e-8; /* product of both gaps above 1e-4 of the trace: the direction has 8 digits */
}

static void measure_plane(const plm_neighbourhood *found, const offsets *to, const plm_neighbour_measures *out)
{
    double moment[6], normal[3] = {0, 0, 1}, variation = 0;
    second_moments(found->count, to, moment);
    const double trace = moment[0] + moment[3] + moment[5];
    if (trace > 0) {
        for (int i = 0; i < 6; i++) moment[i] /= trace;
        variation = smallest_root(moment);
        if (!least_direction(moment, variation, normal)) {
            double value[3], vector[3][3];
            plm_eigen3(moment, value, vector);
            variation = value[2] > 0 ? value[2] : 0;
            for (int axis = 0; axis < 3; axis++) normal[axis] = vector[2][axis];
        }
    }
    const double sign = normal[2] != 0 ? normal[2] : normal[1] != 0 ? normal[1] : normal[0];
    if (out->normal)
        for (int axis = 0; axis < 3; axis++)
            out->normal[found->point_row][axis] = (float)(sign < 0 ? -normal[axis] : normal[axis]);
    if (out->curvature) out->curvature[found->point_row] = (float)variation;
}

static void visit_point(void *user, const plm_neighbourhood *found)
{
    const plm_neighbour_measures *out = user;
    offsets to;
    gather_offsets(found, &to);
    if (out->smoothness || out->mean_distance) measure_smoothness(found, &to, out);
    if (out->normal || out->curvature) measure_plane(found, &to, out);
}

plm_status plm_neighbour_pass(const float (*xyz)[3], size_t count, size_t k, const plm_neighbour_measures *out,
                              plm_error *error)
{
    plm_neighbour_measures to = *out;
    return plm_all_nearest(xyz, count, k, visit_point, &to, error);
}
