/* selftest/stability_meshes.c: areas and planes of needles, far away, in any unit, upright and lying, square and long.
 * Corners are integers times a power of two, turned by a matrix of integers: binary holds them exactly, so the closed
 * forms are those of the very corners that are measured. */
#include "cloud/linear.h"
#include "mesh/mesh.h"
#include "selftest/checks.h"

#include <float.h>

/* Orthogonal columns of length 3: a turn about no axis of the frame, and three times as large. */
static const double turn[3][3] = {{1, 2, 2}, {2, 1, -2}, {2, -2, 1}};

static void turned(const double at[3], double offset, double unit, double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = unit * (plm_dot(turn[i], at) + offset * (i == 2 ? -1 : 1));
}

/* Relative change of a triangle's area by a relative change of its corners: half the way round it times how far out it
 * lies, over the area. */
static double area_condition(double edges, double farthest, double area)
{
    return 0.5 * edges * farthest / area;
}

static void needle(plm_checker *checker, double aspect, double offset, int power)
{
    const double flat[3][3] = {{0, 0, 0}, {aspect, 0, 0}, {floor(aspect / 3), 1, 0}};
    const double unit = ldexp(1, power);
    double corner[3][3];
    uint32_t triangle[1][3] = {{0, 1, 2}};
    for (int i = 0; i < 3; i++) turned(flat[i], offset, unit, corner[i]);
    const plm_mesh mesh = {.vertex_count = 3, .triangle_count = 1, .vertex = corner, .triangle = triangle};
    plm_error why = {0};
    double area = NAN;
    if (!plm_check_ran(checker, "mesh area", plm_mesh_area(&mesh, &area, &why), &why)) return;
    const double reference = 4.5 * aspect * unit * unit;
    /* Corners may be rounded differences away, edges and products are not: whatever the condition, a few roundings. */
    plm_check_value(checker, "mesh area", area, reference,
                    (plm_bound){.error = 4 * DBL_EPSILON,
                                .condition = area_condition(6 * aspect * unit, (3 * aspect + offset) * unit, reference),
                                .note = "4 roundings"});
}

static void needles(plm_checker *checker)
{
    for (int digits = 0; digits <= 12; digits += 2) {
        plm_check_scene(checker, "needle of aspect 1e%d", digits);
        needle(checker, pow(10, digits), 0, 0);
    }
    for (int digits = 3; digits <= 9; digits += 3) {
        plm_check_scene(checker, "needle of aspect 1e6, 1e%d lengths away", digits);
        needle(checker, 1e6, pow(10, digits), 0);
    }
    for (int power = -20; power <= 20; power += 10) {
        plm_check_scene(checker, "needle of aspect 1e6, unit 2^%d", power);
        needle(checker, 1e6, 1e6, power);
    }
}

/* A parallelogram of two triangles over the edges u and v. */
static plm_status plane_of(const double u[3], const double v[3], double offset, double unit, plm_plane *plane,
                           plm_error *why)
{
    const double flat[4][3] = {
        {0, 0, 0}, {u[0], u[1], u[2]}, {u[0] + v[0], u[1] + v[1], u[2] + v[2]}, {v[0], v[1], v[2]}};
    double corner[4][3];
    uint32_t triangle[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) corner[i][k] = unit * (flat[i][k] + offset);
    const plm_mesh mesh = {.vertex_count = 4, .triangle_count = 2, .vertex = corner, .triangle = triangle};
    return plm_mesh_plane(&mesh, plane, why);
}

/* The normal against the exact one (times 3), as the sine of the angle between them. */
static void check_plane(plm_checker *checker, const double u[3], const double v[3], double offset, double unit,
                        const double normal[3])
{
    plm_error why = {0};
    plm_plane plane;
    if (!plm_check_ran(checker, "plane", plane_of(u, v, offset, unit, &plane, &why), &why)) return;
    double across[3];
    plm_cross(plane.normal, normal, across);
    const double condition = plane.eigenvalue[0] / (plane.eigenvalue[1] - plane.eigenvalue[2]);
    plm_check_value(checker, "normal of the plane, rad", plm_norm(across) / plm_norm(normal), 0,
                    (plm_bound){.error = 4 * DBL_EPSILON * condition,
                                .condition = condition,
                                .scale = 1,
                                .note = "4 roundings times the condition"});
    plm_check_value(checker, "larger moments, square root", sqrt(plane.eigenvalue[0]),
                    unit * plm_norm(plm_norm(u) > plm_norm(v) ? u : v) / sqrt(12),
                    (plm_bound){.error = 8 * DBL_EPSILON, .condition = 1});
}

static void planes(plm_checker *checker)
{
    static const struct {
        const char *name;
        double u[3], v[3], normal[3];
    } sheets[] = {
        {"square, lying", {64, 0, 0}, {0, 64, 0}, {0, 0, 1}},
        {"square, upright", {0, 64, 0}, {0, 0, 64}, {1, 0, 0}},
        {"square, oblique", {64, 128, 128}, {128, 64, -128}, {2, -2, 1}},
        {"nearly square, lying", {1048577, 0, 0}, {0, 1048576, 0}, {0, 0, 1}},
        {"nearly square, oblique", {1048577, 2097154, 2097154}, {2097152, 1048576, -2097152}, {2, -2, 1}},
        {"strip of 1:1000, oblique", {1000, 2000, 2000}, {2, 1, -2}, {2, -2, 1}},
        {"strip of 1:1e6, upright", {0, 0, 1e6}, {0, 1, 0}, {1, 0, 0}},
    };
    for (size_t i = 0; i < sizeof sheets / sizeof *sheets; i++) {
        plm_check_scene(checker, "%s", sheets[i].name);
        check_plane(checker, sheets[i].u, sheets[i].v, 0, 1, sheets[i].normal);
        plm_check_scene(checker, "%s, 1e9 lengths away", sheets[i].name);
        check_plane(checker, sheets[i].u, sheets[i].v, 1e9, 1, sheets[i].normal);
        plm_check_scene(checker, "%s, unit 2^-20", sheets[i].name);
        check_plane(checker, sheets[i].u, sheets[i].v, 0, 0x1p-20, sheets[i].normal);
    }
}

/* Nothing but one line or one place has no plane. */
static void lines(plm_checker *checker)
{
    const double u[3] = {1, 2, 2}, v[3] = {2, 4, 4}, zero[3] = {0, 0, 0};
    plm_error why = {0};
    plm_plane plane;
    plm_check_scene(checker, "triangles without area");
    plm_check_refused(checker, "plane", plane_of(u, v, 0, 1, &plane, &why), &why);
    why = (plm_error){0};
    plm_check_scene(checker, "triangles of one place");
    plm_check_refused(checker, "plane", plane_of(zero, zero, 5, 1, &plane, &why), &why);
}

void plm_stability_meshes(plm_checker *checker)
{
    needles(checker);
    planes(checker);
    lines(checker);
}
