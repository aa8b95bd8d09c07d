/* simulate/truth.c: the truth that is taken from the faces: sums over triangles with their exact moments, so that it
 * converges with the square of the edge length. Definitions: shared design, section 5, and the `definitions` of the
 * truth files. */
#include "simulate/truth.h"

#include <stdlib.h>
#include <string.h>

#include "cloud/linear.h"
#include "simulate/crossings.h"

/* ---- Moments ---------------------------------------------------------------------------------------------------- */

static double normal_of(const double a[3], const double b[3], const double c[3], double normal[3])
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    plm_cross(u, v, normal);
    return 0.5 * plm_normalise(normal);
}

void plm_moments_add(plm_moments *moments, const double a[3], const double b[3], const double c[3])
{
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    double normal[3], sum[3];
    const double area = normal_of(a, b, c, normal);
    moments->area += area;
    for (int i = 0; i < 3; i++) {
        sum[i] = a[i] + b[i] + c[i];
        moments->first[i] += area * sum[i] / 3;
    }
    for (int k = 0; k < 6; k++) {
        const int i = row[k], j = column[k];
        moments->second[k] += area / 12 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
    }
}

void plm_moments_axes(const plm_moments *moments, double centroid[3], double variance[3], double axis[3][3])
{
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    double matrix[6];
    for (int i = 0; i < 3; i++) centroid[i] = moments->area > 0 ? moments->first[i] / moments->area : 0;
    for (int k = 0; k < 6; k++)
        matrix[k] = moments->area > 0 ? moments->second[k] / moments->area - centroid[row[k]] * centroid[column[k]] : 0;
    plm_eigen3(matrix, variance, axis);
}

static void corners(const plm_virtual_plant *plant, size_t face, const double *corner[3])
{
    for (int k = 0; k < 3; k++) corner[k] = plant->mesh.vertex[plant->mesh.triangle[face][k]];
}

/* ---- Leaves ----------------------------------------------------------------------------------------------------- */

static bool belongs(const plm_virtual_plant *plant, size_t face, int32_t leaf, int32_t leaflet)
{
    return plant->face_label[face] == PLM_LABEL_LEAF && plant->mesh.face_organ[face] == leaf &&
           (leaflet == 0 || plant->face_leaflet[face] == leaflet);
}

/* Mean and SD, over the area, of the facets' inclination. */
static void facets(const plm_virtual_plant *plant, int32_t leaf, int32_t leaflet, plm_true_leaf *truth)
{
    double area = 0, sum = 0, squares = 0;
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        if (!belongs(plant, f, leaf, leaflet)) continue;
        const double *corner[3];
        double normal[3];
        corners(plant, f, corner);
        const double part = normal_of(corner[0], corner[1], corner[2], normal);
        const double tilt = atan2(hypot(normal[0], normal[1]), fabs(normal[2]));
        area += part;
        sum += part * tilt;
        squares += part * tilt * tilt;
    }
    truth->facet_inclination_mean = area > 0 ? sum / area : 0;
    truth->facet_inclination_sd =
        area > 0 ? sqrt(fmax(squares / area - truth->facet_inclination_mean * truth->facet_inclination_mean, 0)) : 0;
}

static void leaf_from_faces(const plm_virtual_plant *plant, int32_t leaf, int32_t leaflet, plm_true_leaf *truth)
{
    plm_moments moments = {0};
    double variance[3], axis[3][3];
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        if (!belongs(plant, f, leaf, leaflet)) continue;
        const double *corner[3];
        corners(plant, f, corner);
        plm_moments_add(&moments, corner[0], corner[1], corner[2]);
    }
    plm_moments_axes(&moments, truth->centroid, variance, axis);
    truth->area = moments.area;
    truth->flatness = variance[1] > 0 ? fmax(variance[2], 0) / variance[1] : 0;
    for (int i = 0; i < 3; i++) truth->normal[i] = axis[2][2] < 0 ? -axis[2][i] : axis[2][i];
    truth->inclination = atan2(hypot(truth->normal[0], truth->normal[1]), fabs(truth->normal[2]));
    facets(plant, leaf, leaflet, truth);
    truth->azimuth_from_stem = atan2(truth->centroid[1], truth->centroid[0]);
}

/* Extent of a compound leaf across the direction junction -> tip, in its plane. */
static double width_in_plane(const plm_virtual_plant *plant, int32_t leaf, const plm_true_leaf *truth)
{
    double along[3], across[3], low = INFINITY, high = -INFINITY;
    const double *from = plant->leaflet[truth->first_leaflet].base;
    for (int i = 0; i < 3; i++) along[i] = truth->tip[i] - from[i];
    plm_cross(truth->normal, along, across);
    plm_normalise(across);
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        if (!belongs(plant, f, leaf, 0)) continue;
        const double *corner[3];
        corners(plant, f, corner);
        for (int k = 0; k < 3; k++) {
            const double at = plm_dot(across, corner[k]);
            low = fmin(low, at);
            high = fmax(high, at);
        }
    }
    return high > low ? high - low : 0;
}

/* ---- Stems and petioles ----------------------------------------------------------------------------------------- */

static void tube_moments(const plm_virtual_plant *plant, plm_label label, int32_t organ, const double *beyond,
                         double radius, plm_moments *moments)
{
    *moments = (plm_moments){0};
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        if (plant->face_label[f] != label || plant->mesh.face_organ[f] != organ) continue;
        const double *corner[3];
        corners(plant, f, corner);
        if (beyond) { /* leave out the foot inside the stem: what lies on the stem's side of the petiole's base */
            double away = 0;
            for (int i = 0; i < 3; i++) {
                const double middle = (corner[0][i] + corner[1][i] + corner[2][i]) / 3;
                away += (middle - beyond[i]) * (beyond[3 + i]);
            }
            if (away < -radius) continue;
        }
        plm_moments_add(moments, corner[0], corner[1], corner[2]);
    }
}

static void tubes_from_faces(plm_virtual_plant *plant)
{
    plm_moments moments;
    double variance[3], axis[3][3];
    for (size_t k = 0; k < plant->stem_count; k++) {
        tube_moments(plant, PLM_LABEL_STEM, (int32_t)k, NULL, 0, &moments);
        plm_moments_axes(&moments, plant->stem[k].centroid, variance, axis);
    }
    for (size_t k = 0; k < plant->petiole_count; k++) {
        plm_true_petiole *petiole = &plant->petiole[k];
        double beyond[6]; /* base, and the direction of the chord */
        for (int i = 0; i < 3; i++) {
            beyond[i] = petiole->base[i];
            beyond[3 + i] = petiole->junction[i] - petiole->base[i];
        }
        plm_normalise(beyond + 3);
        tube_moments(plant, PLM_LABEL_PETIOLE, (int32_t)k, beyond, 0.25 * petiole->diameter, &moments);
        plm_moments_axes(&moments, petiole->centroid, variance, axis);
        const double sign = plm_dot(axis[0], beyond + 3) < 0 ? -1 : 1;
        petiole->inclination_pca = atan2(hypot(axis[0][0], axis[0][1]), sign * axis[0][2]);
    }
}

/* ---- The whole plant -------------------------------------------------------------------------------------------- */

static int by_x_then_y(const void *a, const void *b)
{
    const double *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

static double turn_of(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Convex hull of sorted points in the plane (Andrew's monotone chain); gives the number of its corners. */
static size_t flat_hull(const double (*point)[2], size_t count, double (*hull)[2])
{
    size_t size = 0;
    for (int pass = 0; pass < 2; pass++) {
        const size_t start = size;
        for (size_t k = 0; k < count; k++) {
            const double *p = point[pass ? count - 1 - k : k];
            while (size >= start + 2 && turn_of(hull[size - 2], hull[size - 1], p) <= 0) size--;
            memcpy(hull[size++], p, sizeof *hull);
        }
        size--; /* the last of a chain is the first of the next */
    }
    return size;
}

static plm_status horizontal_width(const plm_virtual_plant *plant, double *width, plm_error *error)
{
    const size_t count = plant->mesh.vertex_count;
    double(*point)[2] = plm_alloc(count, sizeof *point, error);
    double(*hull)[2] = plm_alloc(2 * count + 2, sizeof *hull, error);
    const plm_status status = point && hull ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t k = 0; k < count; k++) memcpy(point[k], plant->mesh.vertex[k], sizeof *point);
        qsort(point, count, sizeof *point, by_x_then_y);
        const size_t size = flat_hull((const double(*)[2])point, count, hull);
        *width = 0;
        for (size_t i = 0; i < size; i++)
            for (size_t j = 0; j < i; j++)
                *width = fmax(*width, hypot(hull[i][0] - hull[j][0], hull[i][1] - hull[j][1]));
    }
    plm_free(hull);
    plm_free(point);
    return status;
}

/* Principal axes of the ground projection, and the extents along them. */
static void ground_axes(const plm_virtual_plant *plant, plm_true_plant *whole)
{
    plm_moments moments = {0};
    double centroid[3], variance[3], axis[3][3], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        const double *corner[3];
        double flat[3][3], solid[3], level[3];
        corners(plant, f, corner);
        for (int k = 0; k < 3; k++) memcpy(flat[k], (double[3]){corner[k][0], corner[k][1], 0}, sizeof flat[k]);
        /* weighted by the area of the face itself, not of its projection */
        const double area = normal_of(corner[0], corner[1], corner[2], solid);
        const double shadow = normal_of(flat[0], flat[1], flat[2], level);
        plm_moments part = {0};
        plm_moments_add(&part, flat[0], flat[1], flat[2]);
        if (!(shadow > 1e-9 * area)) continue;
        moments.area += area;
        for (int i = 0; i < 3; i++) moments.first[i] += part.first[i] * area / shadow;
        for (int i = 0; i < 6; i++) moments.second[i] += part.second[i] * area / shadow;
    }
    plm_moments_axes(&moments, centroid, variance, axis);
    for (size_t k = 0; k < plant->mesh.vertex_count; k++)
        for (int i = 0; i < 2; i++) {
            const double at = plm_dot(plant->mesh.vertex[k], (double[3]){axis[i][0], axis[i][1], 0});
            low[i] = fmin(low[i], at);
            high[i] = fmax(high[i], at);
        }
    whole->pca1 = high[0] - low[0];
    whole->pca2 = high[1] - low[1];
    whole->pca_variance_ratio = variance[0] > 0 ? variance[1] / variance[0] : 0;
    whole->pca_axis1[0] = axis[0][0];
    whole->pca_axis1[1] = axis[0][1];
}

plm_status plm_truth_from_faces(plm_virtual_plant *plant, plm_error *error)
{
    plm_true_plant *whole = &plant->whole;
    *whole = (plm_true_plant){.lowest = INFINITY, .highest = -INFINITY, .hull_volume = NAN, .hull_area = NAN};
    for (size_t k = 0; k < plant->mesh.vertex_count; k++) {
        whole->lowest = fmin(whole->lowest, plant->mesh.vertex[k][2]);
        whole->highest = fmax(whole->highest, plant->mesh.vertex[k][2]);
    }
    whole->height = whole->highest - whole->lowest;
    for (size_t k = 0; k < plant->leaf_count; k++) {
        plm_true_leaf *leaf = &plant->leaf[k];
        leaf_from_faces(plant, (int32_t)k, 0, leaf);
        whole->leaf_area += leaf->area;
        if (!leaf->is_compound) continue;
        leaf->width = width_in_plane(plant, (int32_t)k, leaf);
        for (size_t j = 0; j < leaf->leaflet_count; j++)
            leaf_from_faces(plant, (int32_t)k, (int32_t)(j + 1), &plant->leaflet[leaf->first_leaflet + j]);
    }
    tubes_from_faces(plant);
    ground_axes(plant, whole);
    plm_status status = horizontal_width(plant, &whole->width, error);
    for (int axis = 0; status == PLM_OK && axis < 3; axis++) {
        double area;
        const int along = (axis + 2) % 3; /* z, x, y */
        status = plm_silhouette(plant, along, &area, &whole->leaf_overlap[axis], error);
        if (status == PLM_OK && along == 2) whole->projected_area = area;
    }
    if (status == PLM_OK) status = plm_leaf_pairs_crossing(plant, &whole->leaf_pairs_crossing, error);
    return status;
}
