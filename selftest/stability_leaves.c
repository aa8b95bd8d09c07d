/* selftest/stability_leaves.c: flat leaves of known area: exactly upright and lying, on grids (every circle through three
 * points goes through a fourth), in any unit, doubled, and dense beside sparse. */
#include "cloud/linear.h"
#include "selftest/checks.h"

#include <string.h>

enum { SIDE = 50 }; /* points along a side */

static const double edge = 0.05;

typedef struct pose {
    const char *name;
    double u[3], v[3], inclination;
} pose;

static const pose poses[] = {
    {"lying", {1, 0, 0}, {0, 1, 0}, 0},
    {"upright", {0, 1, 0}, {0, 0, 1}, 0.5 * PLM_PI},
    {"upright, across the axes", {0.8, 0.6, 0}, {0, 0, 1}, 0.5 * PLM_PI},
    {"of 45 deg", {1, 0, 0}, {0, 0.7071067811865476, 0.7071067811865476}, 0.25 * PLM_PI},
};

/* Area within half a spacing along the rim (which a grid does not tell: its points may be the middles of cells or their
 * corners), inclination within 1e-3 rad: the points lie on the plane. */
static void check_surface(plm_checker *checker, const plm_cloud *cloud, double area, double inclination)
{
    plm_error why = {0};
    plm_leaf_surface surface;
    const plm_surface_options options = {.noise = -1, .fused = -1};
    if (checker->status != PLM_OK) return;
    const plm_status status =
        plm_leaf_surface_make((const float(*)[3])cloud->xyz, cloud->count, &options, &surface, &why);
    if (!plm_check_ran(checker, "leaf surface", status, &why)) return;
    plm_check_value(checker, "leaf area", surface.area, area,
                    (plm_bound){.error = 2.0 / SIDE, .condition = NAN, .note = "half a spacing along the rim"});
    plm_check_value(checker, "leaf area, standard error", surface.area_std_error, 0,
                    (plm_bound){.error = 0.03, .condition = NAN, .scale = area, .note = "of the area"});
    const double *normal = surface.plane.normal;
    plm_check_value(checker, "leaf inclination, rad", atan2(hypot(normal[0], normal[1]), fabs(normal[2])), inclination,
                    (plm_bound){.error = 1e-6, .condition = 1, .scale = 1, .note = "float coordinates"});
    plm_leaf_surface_free(&surface);
}

static void scaled(const double unit[3], double length, double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = length * unit[k];
}

static void sheet(plm_checker *checker, const pose *at, double unit, bool is_grid, int copies)
{
    plm_maker maker;
    double u[3], v[3];
    const double zero[3] = {0};
    plm_maker_start(&maker, checker, (size_t)(SIDE * SIDE * copies), 5);
    scaled(at->u, edge * unit, u);
    scaled(at->v, edge * unit, v);
    for (int i = 0; is_grid && i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            double point[3];
            for (int k = 0; k < 3; k++) point[k] = (i + 0.5) / SIDE * u[k] + (j + 0.5) / SIDE * v[k];
            plm_maker_add(&maker, point, PLM_LABEL_LEAF, 0);
        }
    if (!is_grid) plm_maker_sheet(&maker, zero, u, v, SIDE, 0, PLM_LABEL_LEAF, 0);
    const size_t made = maker.cloud.count;
    for (int copy = 1; copy < copies && made > 0; copy++, maker.cloud.count += made)
        memcpy(maker.cloud.xyz + (size_t)copy * made, maker.cloud.xyz, made * sizeof *maker.cloud.xyz);
    check_surface(checker, &maker.cloud, edge * unit * edge * unit, at->inclination);
    plm_cloud_free(&maker.cloud);
}

/* One half has a thousand points for each of the other. */
static void two_densities(plm_checker *checker)
{
    plm_maker maker;
    const double left[3] = {0}, right[3] = {edge, 0, 0}, u[3] = {edge, 0, 0}, v[3] = {0, edge, 0};
    plm_maker_start(&maker, checker, 190 * 190 + 6 * 6, 5);
    plm_maker_sheet(&maker, left, u, v, 190, 0, PLM_LABEL_LEAF, 0);
    plm_maker_sheet(&maker, right, u, v, 6, 0, PLM_LABEL_LEAF, 0);
    plm_check_scene(checker, "leaf, densities 1000 : 1 side by side");
    plm_error why = {0};
    plm_leaf_surface surface;
    const plm_surface_options options = {.noise = -1, .fused = -1};
    if (checker->status == PLM_OK) {
        const plm_status status =
            plm_leaf_surface_make((const float(*)[3])maker.cloud.xyz, maker.cloud.count, &options, &surface, &why);
        if (plm_check_ran(checker, "leaf surface", status, &why)) {
            plm_check_value(checker, "leaf area", surface.area, 2 * edge * edge,
                            (plm_bound){.error = 0.55,
                                        .condition = NAN,
                                        .note = "the sparse half, 36 points, may be left out, not be counted twice"});
            plm_leaf_surface_free(&surface);
        }
    }
    plm_cloud_free(&maker.cloud);
}

void plm_stability_leaves(plm_checker *checker)
{
    for (size_t i = 0; i < sizeof poses / sizeof *poses; i++) {
        plm_check_scene(checker, "leaf, %s", poses[i].name);
        sheet(checker, &poses[i], 1, false, 1);
        plm_check_scene(checker, "leaf on a grid, %s", poses[i].name);
        sheet(checker, &poses[i], 1, true, 1);
    }
    for (int digits = -6; digits <= 6; digits += 3) {
        plm_check_scene(checker, "leaf of 45 deg, unit 1e%d", digits);
        sheet(checker, &poses[3], pow(10, digits), false, 1);
    }
    plm_check_scene(checker, "leaf, each point 20 times");
    sheet(checker, &poses[3], 1, false, 20);
    two_densities(checker);
}
