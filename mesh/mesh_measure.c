/* mesh/mesh_measure.c: area and best-fit plane of triangle meshes. Sums run in triangle order and are compensated (A.
 * Neumaier 1974), so that they keep their digits over millions of triangles and over parts of very different size. */
#include "cloud/linear.h"
#include "mesh/mesh.h"

/** A sum with the rounding errors of its additions carried beside it. */
typedef struct compensated {
    double sum, lost;
} compensated;

static void add(compensated *total, double term)
{
    const double sum = total->sum + term;
    total->lost += fabs(total->sum) >= fabs(term) ? (total->sum - sum) + term : (term - sum) + total->sum;
    total->sum = sum;
}

static double value_of(compensated total)
{
    return total.sum + total.lost;
}

/** a * b - c * d to two roundings (W. Kahan; Jeannerod, Louvet and Muller 2013). Plain, it loses all digits where the
 * products nearly cancel, which in needles they do. */
static double difference_of_products(double a, double b, double c, double d)
{
    const double cd = c * d;
    return fma(a, b, -cd) + fma(-c, d, cd);
}

/** Half the cross product of two edges: its length is the area, its direction the side that the triangle faces. The
 * edges start at the corner across from the longest one, whose rounding would weigh most. */
static double area_vector(double corner[3][3], double out[3])
{
    double edge[3][3], squared[3]; /* edge[i] goes from corner i to the next */
    for (int i = 0; i < 3; i++) {
        for (int axis = 0; axis < 3; axis++) edge[i][axis] = corner[(i + 1) % 3][axis] - corner[i][axis];
        squared[i] = plm_dot(edge[i], edge[i]);
    }
    int longest = squared[1] > squared[0] ? 1 : 0;
    if (squared[2] > squared[longest]) longest = 2;
    const double *a = edge[(longest + 1) % 3], *b = edge[(longest + 2) % 3];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = 0.5 * difference_of_products(a[j], b[k], a[k], b[j]);
    }
    return plm_norm(out);
}

static plm_status check_triangles(const plm_mesh *mesh, plm_error *error)
{
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            if (mesh->triangle[t][i] >= mesh->vertex_count)
                return plm_fail(error, PLM_E_ARGUMENT, "triangle %zu names vertex %u; the mesh has %zu vertices", t,
                                (unsigned)mesh->triangle[t][i], mesh->vertex_count);
    return PLM_OK;
}

static void corners_of(const plm_mesh *mesh, size_t t, const double from[3], double corner[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++) corner[i][axis] = mesh->vertex[mesh->triangle[t][i]][axis] - from[axis];
}

plm_status plm_mesh_area(const plm_mesh *mesh, double *area, plm_error *error)
{
    const plm_status status = check_triangles(mesh, error);
    if (status != PLM_OK) return status;
    const double zero[3] = {0, 0, 0};
    compensated total = {0};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double corner[3][3], vector[3];
        corners_of(mesh, t, zero, corner);
        add(&total, area_vector(corner, vector));
    }
    *area = value_of(total);
    return PLM_OK;
}

/** First moments: area, area vector, and centroid as an offset from `from`. Gives the area. */
static double first_moments(const plm_mesh *mesh, const double from[3], double facing[3], double centroid[3])
{
    compensated area = {0}, vector_sum[3] = {{0}}, moment[3] = {{0}};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double corner[3][3], vector[3];
        corners_of(mesh, t, from, corner);
        const double a = area_vector(corner, vector);
        add(&area, a);
        for (int axis = 0; axis < 3; axis++) {
            add(&vector_sum[axis], vector[axis]);
            add(&moment[axis], a * (corner[0][axis] + corner[1][axis] + corner[2][axis]) / 3);
        }
    }
    const double total = value_of(area);
    for (int axis = 0; axis < 3; axis++) {
        facing[axis] = value_of(vector_sum[axis]);
        centroid[axis] = total > 0 ? value_of(moment[axis]) / total : 0;
    }
    return total;
}

/** Second moments about centre per area, as xx, xy, xz, yy, yz, zz. Over a triangle of area A with corners v and
 * s = v1 + v2 + v3, the integral of x x' is A / 12 (v1 v1' + v2 v2' + v3 v3' + s s'). */
static void second_moments(const plm_mesh *mesh, const double centre[3], double area, double moment[6])
{
    compensated sum[6] = {{0}};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double corner[3][3], s[3], vector[3];
        corners_of(mesh, t, centre, corner);
        const double weight = area_vector(corner, vector) / (12 * area);
        for (int axis = 0; axis < 3; axis++) s[axis] = corner[0][axis] + corner[1][axis] + corner[2][axis];
        for (int i = 0, entry = 0; i < 3; i++)
            for (int j = i; j < 3; j++, entry++) {
                double products = s[i] * s[j];
                for (int c = 0; c < 3; c++) products += corner[c][i] * corner[c][j];
                add(&sum[entry], weight * products);
            }
    }
    for (int i = 0; i < 6; i++) moment[i] = value_of(sum[i]);
}

/** An eigenvector's sign is chance. The normal looks to the side that most area faces, and where neither side does (a
 * closed mesh), up. The two axes stay right-handed with it. */
static void orient(const double facing[3], double area, plm_plane *plane)
{
    double side = plm_dot(facing, plane->normal);
    if (fabs(side) <= 1e-9 * area) side = plane->normal[2];
    if (side == 0) side = plane->normal[1];
    if (side == 0) side = plane->normal[0];
    if (side > 0) return;
    for (int axis = 0; axis < 3; axis++) {
        plane->normal[axis] = -plane->normal[axis];
        plane->axis[1][axis] = -plane->axis[1][axis];
    }
}

plm_status plm_mesh_plane(const plm_mesh *mesh, plm_plane *plane, plm_error *error)
{
    const plm_status status = check_triangles(mesh, error);
    if (status != PLM_OK) return status;
    const double zero[3] = {0, 0, 0};
    const double *start = mesh->triangle_count ? mesh->vertex[mesh->triangle[0][0]] : zero;
    double facing[3], offset[3], shift[3];
    const double area = first_moments(mesh, start, facing, offset);
    if (!(area > 0) || !isfinite(area))
        return plm_fail(error, PLM_E_DEGENERATE, "a mesh of %zu triangles and area %g m2 has no best-fit plane",
                        mesh->triangle_count, area);
    plm_plane result;
    for (int axis = 0; axis < 3; axis++) result.centroid[axis] = start[axis] + offset[axis];
    /* once more from the centroid itself, so that the place of the first corner leaves no trace */
    first_moments(mesh, result.centroid, facing, shift);
    for (int axis = 0; axis < 3; axis++) result.centroid[axis] += shift[axis];
    double moment[6], vector[3][3];
    second_moments(mesh, result.centroid, area, moment);
    plm_eigen3(moment, result.eigenvalue, vector);
    for (int i = 0; i < 3; i++) {
        if (result.eigenvalue[i] < 0) result.eigenvalue[i] = 0; /* a flat mesh's smallest one, rounded */
        for (int axis = 0; axis < 3; axis++) {
            result.normal[axis] = vector[2][axis];
            result.axis[0][axis] = vector[0][axis];
            result.axis[1][axis] = vector[1][axis];
        }
    }
    orient(facing, area, &result);
    *plane = result;
    return PLM_OK;
}
